// bar.h - a bar on the terminal's last line: stage, share done, time left.

#ifndef LS_BAR_H
#define LS_BAR_H

#include <stdbool.h>
#include <stddef.h>

// Zero it before the first call.
typedef struct Bar
{
    bool is_drawn, is_anchored;
    double drawn;       // when, in seconds
    double anchor;      // from when on the pace is taken
    double anchor_done; // what was done then
    char text[128];     // as last made
} Bar;

// Takes note of how far all is at a time and makes the text. A pure function of the calls: no clock.
//
// The time left is what the pace so far makes of the rest. It is shown once it means something: when the
// reading of files is over, whose pace tells little of the rest, and when the pace is that of a
// second and a tenth of the whole at least.
void ls_bar_note(Bar* bar, double time, const char* stage, double fraction);

// "about 3 min left", or "" for a negative number. `text` has room for 32 bytes.
void ls_bar_time_left(double seconds, char* text);

// An LsProgress; `user` is a Bar. Draws on standard error, ten times a second at most.
void ls_bar_draw(void* user, const char* stage, double fraction);

// Takes the bar off the screen, if it is there.
void ls_bar_clear(Bar* bar);

#endif
