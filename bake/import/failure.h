// failure.h - how the C++ shims fail: they throw, and the C face turns it into an LsResult.

#ifndef FAILURE_H
#define FAILURE_H

#include "ls_base.h"
#include "ls_messages.h"

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

// A wrong that ends the import; `text` says what and what to do, without the name of the file.
struct Failure
{
    LsMessage message;
    std::string text;
};

// A wrong that the LsError already tells.
struct Reported
{
    LsResult result;
};

// Runs `import`, which returns nothing and throws; nothing passes beyond it. `unexpected` is the
// LsMessage of exceptions that only a library can throw.
template <class Import>
LsResult run_guarded(const char* path, LsError* error, const Import& import,
                     LsMessage unexpected) noexcept
{
    try
    {
        import();
        return LS_OK;
    }
    catch (const Failure& failure)
    {
        return ls_error_set(error, failure.message, "%s: %s", path, failure.text.c_str());
    }
    catch (const Reported& reported)
    {
        return reported.result;
    }
    catch (const std::bad_alloc&)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory while reading it",
                            path);
    }
    catch (const std::length_error&)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory while reading it",
                            path);
    }
    catch (const std::exception& exception)
    {
        return ls_error_set(error, unexpected, "%s: malformed (%s); export it again", path,
                            exception.what());
    }
}

#endif
