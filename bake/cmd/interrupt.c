// interrupt.c - a thread that waits for the signals, which all others block: it may take locks.

#include "interrupt.h"

#include "ls_output.h"

#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <unistd.h>

static sigset_t awaited;

static void* wait_for_signals(void* unused)
{
    int number = 0;
    while (sigwait(&awaited, &number) != 0)
    {
    }
    ls_output_abandon_all();
    if (isatty(STDERR_FILENO))
    {
        // The bar, if there is one, is on this line.
        const ssize_t cleared = write(STDERR_FILENO, "\r\033[K", 4);
        (void)cleared;
    }
    pthread_sigmask(SIG_UNBLOCK, &awaited, NULL);
    raise(number);
    return unused;
}

void ls_interrupt_begin(void)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    sigemptyset(&awaited);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    {
        struct sigaction action;
        // nohup, for one, has SIGHUP ignored.
        if (sigaction(numbers[i], NULL, &action) == 0 && action.sa_handler == SIG_DFL)
        {
            sigaddset(&awaited, numbers[i]);
        }
    }
    sigset_t before;
    pthread_t thread;
    pthread_attr_t attributes;
    if (pthread_sigmask(SIG_BLOCK, &awaited, &before) != 0 || pthread_attr_init(&attributes) != 0)
    {
        return;
    }
    pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    // Without the thread the signals end the program all the same.
    if (pthread_create(&thread, &attributes, wait_for_signals, NULL) != 0)
    {
        pthread_sigmask(SIG_SETMASK, &before, NULL);
    }
    pthread_attr_destroy(&attributes);
}
