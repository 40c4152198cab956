// progress.h - how far a stage is with a part of its work, for who listens.

#ifndef LS_PROGRESS_H
#define LS_PROGRESS_H

#include <stddef.h>

// Hears it from one thread at a time; fraction in [0,1] of the part.
typedef struct LsStageProgress
{
    void (*note)(void* user, double fraction);
    void* user;
} LsStageProgress;

// `progress` may be NULL.
static inline void ls_stage_note(const LsStageProgress* progress, double fraction)
{
    if (progress != NULL)
    {
        progress->note(progress->user, fraction);
    }
}

#endif
