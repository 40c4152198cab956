// bar.c - the pace from an anchor on, a line rewritten in place.

#include "bar.h"

#include <stdio.h>
#include <time.h>

#define BAR_WIDTH 30
#define BAR_ANCHOR 0.04 // files are read and meshes welded
#define LEAST_SECONDS 1.0
#define LEAST_DONE 0.1

void ls_bar_time_left(double seconds, char* text)
{
    const int whole = seconds < 1e6 ? (int)(seconds + 0.5) : 1000000;
    if (seconds < 0.0)
        text[0] = '\0';
    else if (whole < 10)
        snprintf(text, 32, "%d s left", whole);
    else if (whole < 90)
        snprintf(text, 32, "about %d s left", (whole + 2) / 5 * 5);
    else if (whole < 5400)
        snprintf(text, 32, "about %d min left", (whole + 30) / 60);
    else
        snprintf(text, 32, "about %d h left", (whole + 1800) / 3600);
}

// Seconds, or -1 as long as nothing can be said.
static double estimate(const Bar* bar, double time, double fraction)
{
    const double passed = time - bar->anchor;
    const double done = fraction - bar->anchor_done;
    if (!bar->is_anchored || passed < LEAST_SECONDS || done < LEAST_DONE)
        return -1.0;
    return passed * (1.0 - fraction) / done;
}

void ls_bar_note(Bar* bar, double time, const char* stage, double fraction)
{
    if (!bar->is_anchored && fraction >= BAR_ANCHOR)
    {
        bar->is_anchored = true;
        bar->anchor = time;
        bar->anchor_done = fraction;
    }
    char left[32];
    ls_bar_time_left(estimate(bar, time, fraction), left);
    snprintf(bar->text, sizeof bar->text, "%-10s [%-*.*s] %3d %%  %s", stage, BAR_WIDTH,
             (int)(fraction * BAR_WIDTH), "##############################", (int)(fraction * 100.0),
             left);
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void ls_bar_draw(void* user, const char* stage, double fraction)
{
    Bar* bar = user;
    const double time = now();
    ls_bar_note(bar, time, stage, fraction);
    if (fraction >= 1.0)
    {
        ls_bar_clear(bar);
        return;
    }
    if (bar->is_drawn && time < bar->drawn + 0.1)
        return;
    bar->is_drawn = true;
    bar->drawn = time;
    fprintf(stderr, "\r%s\033[K", bar->text);
    fflush(stderr);
}

void ls_bar_clear(Bar* bar)
{
    if (bar->is_drawn)
        fputs("\r\033[K", stderr);
    bar->is_drawn = false;
}
