// ls_base.h - result codes, error texts and the version of the Line Space libraries.
//
// Stands alone. Three kinds of wrong have three answers: a caller's bug is an assertion; a bad file
// or a failing environment is an LsResult, with one line in an LsError that names the thing and
// says what to do. Nothing here keeps global state.

#ifndef LS_BASE_H
#define LS_BASE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

#define LS_VERSION_MAJOR 0
#define LS_VERSION_MINOR 1
#define LS_VERSION_TEXT "0.1"

#if defined(__GNUC__)
#define LS_PRINTF(format_index, first_index) \
    __attribute__((format(printf, format_index, first_index)))
#else
#define LS_PRINTF(format_index, first_index)
#endif

// Every way a call can fail. The numbers never move and never come back with another meaning;
// decades group them and decide the exit code of the programs (ls_result_exit_code).
#define LS_RESULT_LIST(X)                                                              \
    X(OK, 0, "no error")                                                               \
    X(ERROR_ARGUMENT, 10, "wrong argument")                                            \
    X(ERROR_FILE_MISSING, 20, "file not found")                                        \
    X(ERROR_FILE_READ, 21, "file cannot be read")                                      \
    X(ERROR_FILE_EMPTY, 22, "file is empty")                                           \
    X(ERROR_FILE_IS_DIRECTORY, 23, "a directory stands where a file was expected")     \
    X(ERROR_INPUT_FORMAT, 30, "malformed input")                                       \
    X(ERROR_INPUT_INDEX, 31, "index out of range in the input")                        \
    X(ERROR_INPUT_NOT_FINITE, 32, "a coordinate that is not a finite number")          \
    X(ERROR_INPUT_NO_TRIANGLES, 33, "no triangles")                                    \
    X(ERROR_INPUT_RANGE, 34, "coordinates outside the range that float can represent") \
    X(ERROR_INPUT_UNSUPPORTED, 35, "input of a kind that is not supported")            \
    X(ERROR_INPUT_TRANSFORM, 36, "ill-conditioned transform")                          \
    X(ERROR_INPUT_LIMIT, 37, "input exceeds a limit")                                  \
    X(ERROR_INPUT_WARNING, 38, "a warning, refused by --strict")                       \
    X(ERROR_OUTPUT, 40, "file cannot be written")                                      \
    X(ERROR_OUTPUT_FULL, 41, "no space left for the output")                           \
    X(ERROR_NOT_LSPACE, 50, "not an .lspace file")                                     \
    X(ERROR_BYTE_ORDER, 51, "byte order reversed")                                     \
    X(ERROR_VERSION, 52, "format version not readable")                                \
    X(ERROR_FEATURE, 53, "unknown required feature")                                   \
    X(ERROR_TRUNCATED, 54, "file cut short")                                           \
    X(ERROR_HASH, 55, "hash mismatch")                                                 \
    X(ERROR_RULE, 56, "a rule of the format is broken")                                \
    X(ERROR_NO_VULKAN, 60, "no Vulkan driver")                                         \
    X(ERROR_NO_DEVICE, 61, "no usable Vulkan device")                                  \
    X(ERROR_DEVICE_FEATURE, 62, "the Vulkan device lacks a feature")                   \
    X(ERROR_DEVICE_MEMORY, 63, "out of device memory")                                 \
    X(ERROR_DEVICE_LOST, 64, "device lost")                                            \
    X(ERROR_DEVICE, 65, "a Vulkan call failed")                                        \
    X(ERROR_DEVICE_ANSWERS, 66, "wrong answers")                                       \
    X(ERROR_MEMORY, 70, "out of memory")

    typedef enum LsResult
    {
#define LS_RESULT_ENUMERATOR(name, number, text) LS_##name = number,
        LS_RESULT_LIST(LS_RESULT_ENUMERATOR)
#undef LS_RESULT_ENUMERATOR
    } LsResult;

    // Exit codes of every program of this project; the README lists them.
    typedef enum LsExit
    {
        LS_EXIT_OK = 0,
        LS_EXIT_USAGE = 1,  // unknown option, missing argument
        LS_EXIT_INPUT = 2,  // an input file is missing, unreadable or not a legal scene or ray file
        LS_EXIT_OUTPUT = 3, // the output cannot be written
        LS_EXIT_LSPACE = 4, // an .lspace file is foreign, cut, damaged or breaks a rule
        LS_EXIT_DEVICE = 5, // no Vulkan, no usable device, or the device failed
        LS_EXIT_MEMORY = 6, // out of memory
    } LsExit;

    // One line for a person: what went wrong, where, and what to do. The caller owns it (usually on
    // the stack). Functions that take an LsError* accept NULL and then report by their result
    // alone.
    typedef struct LsError
    {
        LsResult result;
        uint32_t message; // an LsMessage (ls_messages.h): the stable number of this very wrong
        char text[1000];
    } LsError;

    // Fills `error` (may be NULL) and returns the result of `message`, an LsMessage, so that `return
    // ls_error_set(...)` reads well. Control characters, which words of a file may hold, become '?'.
    LsResult ls_error_set(LsError* error, int message, const char* format, ...) LS_PRINTF(3, 4);

    // Short static text of a code ("file not found"), never NULL.
    const char* ls_result_text(LsResult result);

    // The programs' exit code for a result.
    LsExit ls_result_exit_code(LsResult result);

#ifdef __cplusplus
}
#endif

#endif
