// interrupt.h - Ctrl-C, a hang-up, a request to end: the program ends at once and leaves no temporary file.

#ifndef LS_INTERRUPT_H
#define LS_INTERRUPT_H

// From now on SIGINT, SIGTERM and SIGHUP, those that are not ignored, remove the temporary files of outputs
// (ls_output.h) before they end the program as they always do, so that its parent sees by which it
// ended. Call it before there are other threads.
void ls_interrupt_begin(void);

#endif
