// failure.h - how the C++ shims fail: they throw, and the C face turns it into an LsResult.

#ifndef FAILURE_H
#define FAILURE_H

#include "ls_base.h"

#include <exception>
#include <new>
#include <string>

// A wrong that ends the import; `text` says what and what to do, without the name of the file.
struct Failure
{
    LsResult result;
    std::string text;
};

// Runs `import`, which returns nothing and throws; nothing passes beyond it.
template <class Import>
LsResult run_guarded(const char* path, LsError* error, const Import& import) noexcept
{
    try
    {
        import();
        return LS_OK;
    }
    catch (const Failure& failure)
    {
        return ls_error_set(error, failure.result, "%s: %s", path, failure.text.c_str());
    }
    catch (const std::bad_alloc&)
    {
        return ls_error_set(error, LS_ERROR_MEMORY, "%s: out of memory while reading it", path);
    }
    catch (const std::exception& exception)
    {
        return ls_error_set(error, LS_ERROR_INPUT_FORMAT, "%s: malformed (%s); export it again",
                            path, exception.what());
    }
}

#endif
