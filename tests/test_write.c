// test_write.c - writing files when it cannot be done: whatever fails, the old file stays as it was
// and nothing is left beside it.

#define _GNU_SOURCE // symlink, O_TMPFILE

#include "file_fixture.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

// ---- Faults -------------------------------------------------------------------------------------

// The linker leads these calls of the writer through here (--wrap in format.cmake).
typedef enum Call
{
    CALL_OPEN,
    CALL_FALLOCATE,
    CALL_TRUNCATE,
    CALL_WRITE,
    CALL_SYNC,
    CALL_RENAME,
    CALL_LINK,
} Call;

#define SHORT_WRITE 0 // a reason of CALL_WRITE: half is written, and that is no error

static struct
{
    Call call;
    int after; // so many calls go well, then one fails; -1: none fails
    int reason;
} fault = {.after = -1};

static bool has_nameless = true; // whether the file system has files without a name
static uint32_t nameless_count;  // opened

static bool is_failing(Call call)
{
    if (fault.call != call || fault.after < 0 || fault.after-- > 0)
    {
        return false;
    }
    errno = fault.reason;
    return true;
}

int __real_open64(const char* path, int flags, ...);
int __wrap_open64(const char* path, int flags, ...);
int __wrap_open64(const char* path, int flags, ...)
{
    if ((flags & O_TMPFILE) == O_TMPFILE)
    {
        if (!has_nameless)
        {
            errno = EOPNOTSUPP;
            return -1;
        }
        ++nameless_count;
    }
    return (flags & O_CREAT) != 0 && is_failing(CALL_OPEN) ? -1 : __real_open64(path, flags, 0666);
}

int __real_posix_fallocate64(int descriptor, off_t offset, off_t size);
int __wrap_posix_fallocate64(int descriptor, off_t offset, off_t size);
int __wrap_posix_fallocate64(int descriptor, off_t offset, off_t size)
{
    return is_failing(CALL_FALLOCATE) ? fault.reason
                                      : __real_posix_fallocate64(descriptor, offset, size);
}

int __real_ftruncate64(int descriptor, off_t size);
int __wrap_ftruncate64(int descriptor, off_t size);
int __wrap_ftruncate64(int descriptor, off_t size)
{
    return is_failing(CALL_TRUNCATE) ? -1 : __real_ftruncate64(descriptor, size);
}

ssize_t __real_pwrite64(int descriptor, const void* bytes, size_t size, off_t offset);
ssize_t __wrap_pwrite64(int descriptor, const void* bytes, size_t size, off_t offset);
ssize_t __wrap_pwrite64(int descriptor, const void* bytes, size_t size, off_t offset)
{
    if (!is_failing(CALL_WRITE))
    {
        return __real_pwrite64(descriptor, bytes, size, offset);
    }
    return fault.reason == SHORT_WRITE ? __real_pwrite64(descriptor, bytes, size / 2, offset) : -1;
}

int __real_fsync(int descriptor);
int __wrap_fsync(int descriptor);
int __wrap_fsync(int descriptor)
{
    return is_failing(CALL_SYNC) ? -1 : __real_fsync(descriptor);
}

int __real_rename(const char* from, const char* to);
int __wrap_rename(const char* from, const char* to);
int __wrap_rename(const char* from, const char* to)
{
    return is_failing(CALL_RENAME) ? -1 : __real_rename(from, to);
}

int __real_linkat(int from_folder, const char* from, int to_folder, const char* to, int flags);
int __wrap_linkat(int from_folder, const char* from, int to_folder, const char* to, int flags);
int __wrap_linkat(int from_folder, const char* from, int to_folder, const char* to, int flags)
{
    return is_failing(CALL_LINK) ? -1 : __real_linkat(from_folder, from, to_folder, to, flags);
}

// ---- Helpers ------------------------------------------------------------------------------------

// A directory with one old file, and a scene to replace it by.
typedef struct Target
{
    char directory[LS_SCRATCH_PATH];
    char path[LS_SCRATCH_PATH + 32];
    LsFixture fixture;
} Target;

static const char old_text[] = "what stood here before";

static void join_path(char path[LS_SCRATCH_PATH + 32], const char* directory, const char* name)
{
    snprintf(path, LS_SCRATCH_PATH + 32, "%s/%s", directory, name);
}

static void write_old(const char* path)
{
    FILE* file = fopen(path, "wb");
    assert_non_null(file);
    fputs(old_text, file);
    assert_int_equal(fclose(file), 0);
}

static Target* create_target(void)
{
    Target* target = calloc(1, sizeof(Target));
    assert_non_null(target);
    ls_scratch_create(target->directory);
    join_path(target->path, target->directory, "scene.lspace");
    write_old(target->path);
    ls_fixture_fill(&target->fixture);
    return target;
}

static void destroy_target(Target* target)
{
    ls_scratch_remove(target->directory);
    free(target);
}

typedef LsResult Write(const Target* target, const char* path, LsError* error);

static LsResult write_scene(const Target* target, const char* path, LsError* error)
{
    return ls_file_write(&target->fixture.desc, path, error);
}

static LsResult write_array(const Target* target, const char* path, LsError* error)
{
    return ls_bytes_write(target->fixture.shafts, sizeof(target->fixture.shafts), path, error);
}

// The array again, piece by piece.
static LsResult write_pieces(const Target* target, const char* path, LsError* error)
{
    LsOutput output;
    LsResult result = ls_output_open(&output, path, 100, error); // it grows beyond
    const uint8_t* bytes = (const uint8_t*)target->fixture.shafts;
    for (uint64_t at = 0; at < sizeof(target->fixture.shafts) && result == LS_OK; at += 100)
    {
        const uint64_t left = sizeof(target->fixture.shafts) - at;
        result = ls_output_put(&output, bytes + at, left < 100 ? left : 100, at, error);
    }
    if (result != LS_OK)
    {
        ls_output_drop(&output); // zero where opening failed
        return result;
    }
    return ls_output_commit(&output, error);
}

enum
{
    WRITES = 3
};
static Write* const writes[WRITES] = {write_scene, write_array, write_pieces};

static void expect_old(const Target* target)
{
    LsFixtureBytes old = ls_fixture_read(target->path);
    assert_int_equal(old.size, sizeof(old_text) - 1);
    assert_memory_equal(old.bytes, old_text, old.size);
    ls_fixture_free(&old);
    assert_int_equal(ls_scratch_count(target->directory), 1);
}

// One line of that number that begins with the path, and nothing changed.
static void expect_refusal(const Target* target, const char* path, LsMessage message,
                           const LsError* error)
{
    assert_int_equal(error->message, message);
    assert_int_equal(error->result, message / 100);
    assert_memory_equal(error->text, path, strlen(path));
    assert_null(strchr(error->text, '\n'));
    expect_old(target);
}

static void expect_new(const Target* target, Write* write)
{
    LsFixtureBytes bytes = ls_fixture_read(target->path);
    if (write != write_scene)
    {
        assert_int_equal(bytes.size, sizeof(target->fixture.shafts));
        assert_memory_equal(bytes.bytes, target->fixture.shafts, bytes.size);
    }
    else
    {
        LsFile file;
        LsError error = {0};
        assert_int_equal(ls_file_open(&file, bytes.bytes, bytes.size, "new", &error), LS_OK);
        assert_int_equal(ls_file_check_hashes(&file, "new", &error), LS_OK);
    }
    ls_fixture_free(&bytes);
    assert_int_equal(ls_scratch_count(target->directory), 1);
}

// ---- Tests --------------------------------------------------------------------------------------

// Each call that the writer makes fails once, the first, then the second, until none is left to
// fail. `spared` calls of the kind come before, in which a failure is none.
static uint32_t fail_every_call(const Target* target, Write* write, Call call, int reason,
                                LsMessage message, int spared)
{
    uint32_t failures = 0;
    LsResult result = (LsResult)(message / 100);
    for (int after = spared; result != LS_OK; ++after)
    {
        fault.call = call;
        fault.reason = reason;
        fault.after = after;
        LsError error = {0};
        result = write(target, target->path, &error);
        fault.after = -1;
        if (result == LS_OK)
        {
            assert_true(after > spared);
            expect_new(target, write);
            write_old(target->path);
        }
        else
        {
            expect_refusal(target, target->path, message, &error);
            assert_int_equal(result, error.result);
            ++failures;
        }
    }
    return failures;
}

static void test_every_call_fails(void** state)
{
    (void)state;
    static const struct
    {
        Call call;
        int reason;
        LsMessage message;
        bool is_named, is_nameless; // the files of which this happens
    } faults[] = {
        {CALL_OPEN, EACCES, LS_MESSAGE_OUTPUT_UNWRITABLE, true, false},
        {CALL_OPEN, ENOSPC, LS_MESSAGE_OUTPUT_FULL, true, false},
        {CALL_FALLOCATE, ENOSPC, LS_MESSAGE_OUTPUT_FULL, true, true},
        {CALL_FALLOCATE, EFBIG, LS_MESSAGE_OUTPUT_FULL, true, true},
        {CALL_TRUNCATE, EIO, LS_MESSAGE_OUTPUT_UNWRITABLE, true, true},
        {CALL_WRITE, ENOSPC, LS_MESSAGE_OUTPUT_FULL, true, true},
        {CALL_WRITE, EDQUOT, LS_MESSAGE_OUTPUT_FULL, true, true},
        {CALL_WRITE, EIO, LS_MESSAGE_OUTPUT_UNWRITABLE, true, true},
        {CALL_SYNC, EIO, LS_MESSAGE_OUTPUT_UNWRITABLE, true, true},
        {CALL_SYNC, ENOSPC, LS_MESSAGE_OUTPUT_FULL, true, true},
        {CALL_RENAME, EACCES, LS_MESSAGE_OUTPUT_UNWRITABLE, true, true},
        {CALL_LINK, EACCES, LS_MESSAGE_OUTPUT_UNWRITABLE, false, true},
    };
    Target* target = create_target();
    uint32_t failures = 0;
    for (size_t i = 0; i < 2 * WRITES * sizeof(faults) / sizeof(faults[0]); ++i)
    {
        const size_t k = i / WRITES / 2;
        has_nameless = i / WRITES % 2 == 1;
        if (has_nameless ? faults[k].is_nameless : faults[k].is_named)
        {
            // The first link is the trial whether there can be one.
            failures +=
                fail_every_call(target, writes[i % WRITES], faults[k].call, faults[k].reason,
                                faults[k].message, faults[k].call == CALL_LINK);
        }
    }
    print_message("%u failing calls, %u files without a name\n", failures, nameless_count);
    destroy_target(target);
}

// What is no failure: interrupted and short writes, file systems that set no room aside, names that are taken,
// systems on which a file without a name stays so.
static void test_calls_that_are_retried(void** state)
{
    (void)state;
    static const struct
    {
        Call call;
        int reason;
        int after;
        bool is_nameless;
    } faults[] = {
        {CALL_WRITE, EINTR, 0, false},      {CALL_WRITE, SHORT_WRITE, 0, false},
        {CALL_FALLOCATE, EINVAL, 0, false}, {CALL_FALLOCATE, EOPNOTSUPP, 0, false},
        {CALL_OPEN, EEXIST, 0, false},      {CALL_LINK, ENOENT, 0, true},
        {CALL_LINK, EEXIST, 1, true},       {CALL_LINK, EEXIST, 2, true},
    };
    Target* target = create_target();
    for (size_t i = 0; i < WRITES * sizeof(faults) / sizeof(faults[0]); ++i)
    {
        fault.call = faults[i / WRITES].call;
        fault.reason = faults[i / WRITES].reason;
        fault.after = faults[i / WRITES].after;
        has_nameless = faults[i / WRITES].is_nameless;
        LsError error = {0};
        assert_int_equal(writes[i % WRITES](target, target->path, &error), LS_OK);
        assert_int_equal(fault.after, -1);
        expect_new(target, writes[i % WRITES]);
    }
    has_nameless = true;
    destroy_target(target);
}

// Until a file is whole there is no name of it, where the file system can do that; nor ever one but its own,
// if there was none before.
static void test_files_without_a_name(void** state)
{
    (void)state;
    Target* target = create_target();
    assert_int_equal(unlink(target->path), 0);
    for (int i = 0; i < 4; ++i)
    {
        has_nameless = i < 2;
        const uint32_t count = nameless_count;
        LsOutput output;
        LsError error = {0};
        assert_int_equal(ls_output_open(&output, target->path, 10, &error), LS_OK);
        const bool is_nameless = nameless_count > count && output.temporary[0] == '\0';
        assert_true(has_nameless || !is_nameless);
        assert_int_equal(ls_scratch_count(target->directory), i % 2 + (is_nameless ? 0 : 1));
        fault.call = CALL_RENAME;
        fault.reason = EIO;
        fault.after = is_nameless && i % 2 == 0 ? 0 : -1; // nothing to rename
        assert_int_equal(ls_output_commit(&output, &error), LS_OK);
        fault.after = -1;
        assert_int_equal(ls_scratch_count(target->directory), 1);
        if (i % 2 == 1)
        {
            assert_int_equal(unlink(target->path), 0);
        }
    }
    has_nameless = true;
    write_old(target->path);
    destroy_target(target);
}

// What is open when the program ends goes with it, and only that.
static void test_abandoned_outputs(void** state)
{
    (void)state;
    Target* target = create_target();
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
    {
        has_nameless = false;
        LsOutput outputs[3];
        LsError error = {0};
        bool ok = true;
        for (int i = 0; i < 3; ++i)
        {
            ok = ok && ls_output_open(&outputs[i], target->path, 10, &error) == LS_OK;
        }
        ok = ok && ls_scratch_count(target->directory) == 4;
        ls_output_drop(&outputs[1]);
        ok = ok && ls_scratch_count(target->directory) == 3;
        ls_output_abandon_all();
        _exit(ok ? 7 : 1);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 7);
    expect_old(target);
    destroy_target(target);
}

static void expect_output_error(const Target* target, const char* path, LsMessage message)
{
    for (int i = 0; i < WRITES; ++i)
    {
        LsError error = {0};
        assert_int_equal(writes[i](target, path, &error), LS_ERROR_OUTPUT);
        assert_int_equal(ls_result_exit_code(error.result), LS_EXIT_OUTPUT);
        expect_refusal(target, path, message, &error);
        // Known beforehand too, but for what only trying tells.
        if (message != LS_MESSAGE_OUTPUT_UNWRITABLE)
        {
            LsError early = {0};
            assert_int_equal(ls_output_check(path, &early), LS_ERROR_OUTPUT);
            assert_int_equal(early.message, message);
        }
    }
}

static void test_places_that_are_no_files(void** state)
{
    (void)state;
    Target* target = create_target();
    char path[LS_SCRATCH_PATH + 32];
    expect_output_error(target, target->directory, LS_MESSAGE_OUTPUT_IS_FOLDER);
    join_path(path, target->directory, "");
    expect_output_error(target, path, LS_MESSAGE_OUTPUT_IS_FOLDER);
    join_path(path, target->directory, "missing/scene.lspace");
    expect_output_error(target, path, LS_MESSAGE_OUTPUT_UNWRITABLE);
    join_path(path, target->directory, "scene.lspace/below");
    expect_output_error(target, path, LS_MESSAGE_OUTPUT_UNWRITABLE);
    join_path(path, target->directory, "new/");
    expect_output_error(target, path, LS_MESSAGE_OUTPUT_IS_FOLDER);
    expect_output_error(target, "", LS_MESSAGE_OUTPUT_UNWRITABLE);
    expect_output_error(target, "/dev/null", LS_MESSAGE_OUTPUT_NOT_REGULAR);
    expect_output_error(target, "/dev/full", LS_MESSAGE_OUTPUT_NOT_REGULAR);
    struct stat status;
    assert_int_equal(stat("/dev/null", &status), 0);
    assert_true(S_ISCHR(status.st_mode));
    destroy_target(target);
}

// The kernel's own refusal of room, as on a full disk.
static void test_limit_of_file_size(void** state)
{
    (void)state;
    Target* target = create_target();
    signal(SIGXFSZ, SIG_IGN);
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    const struct rlimit small = {.rlim_cur = 100, .rlim_max = before.rlim_max};
    LsError errors[WRITES] = {{0}, {0}, {0}};
    LsResult results[WRITES];
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    results[0] = write_scene(target, target->path, &errors[0]);
    results[1] = write_array(target, target->path, &errors[1]);
    results[2] = write_pieces(target, target->path, &errors[2]);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, SIG_DFL);
    for (int i = 0; i < WRITES; ++i)
    {
        assert_int_equal(results[i], LS_ERROR_OUTPUT_FULL);
        expect_refusal(target, target->path, LS_MESSAGE_OUTPUT_FULL, &errors[i]);
    }
    destroy_target(target);
}

// A link stays a link; what it names is replaced.
static void test_links_are_followed(void** state)
{
    (void)state;
    Target* target = create_target();
    char link_path[LS_SCRATCH_PATH + 32];
    join_path(link_path, target->directory, "link.lspace");
    assert_int_equal(symlink("scene.lspace", link_path), 0);
    LsError error = {0};
    assert_int_equal(write_scene(target, link_path, &error), LS_OK);
    struct stat status;
    assert_int_equal(lstat(link_path, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(unlink(link_path), 0);
    expect_new(target, write_scene);
    destroy_target(target);
}

// Without a folder in the path the working directory is meant; and no bytes are bytes too.
static void test_plain_names(void** state)
{
    (void)state;
    Target* target = create_target();
    char* before = realpath(".", NULL);
    assert_non_null(before);
    assert_int_equal(chdir(target->directory), 0);
    LsError error = {0};
    assert_int_equal(write_scene(target, "scene.lspace", &error), LS_OK);
    assert_int_equal(ls_bytes_write(NULL, 0, "empty", &error), LS_OK);
    assert_int_equal(unlink("empty"), 0);
    assert_int_equal(chdir(before), 0);
    free(before);
    expect_new(target, write_scene);
    destroy_target(target);
}

// Refused before a byte of the arrays is looked at.
static void test_limit_of_the_format(void** state)
{
    (void)state;
    Target* target = create_target();
    target->fixture.desc.CELL_BLOCKS_count = UINT32_MAX;
    assert_true(ls_file_desc_bytes(&target->fixture.desc) > 0xFFFFFFFFull * sizeof(LsCellBlock));
    LsError error = {0};
    assert_int_equal(write_scene(target, target->path, &error), LS_ERROR_INPUT_LIMIT);
    expect_refusal(target, target->path, LS_MESSAGE_LIMIT_FILE_BYTES, &error);
    destroy_target(target);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_call_fails),
        cmocka_unit_test(test_calls_that_are_retried),
        cmocka_unit_test(test_files_without_a_name),
        cmocka_unit_test(test_abandoned_outputs),
        cmocka_unit_test(test_places_that_are_no_files),
        cmocka_unit_test(test_limit_of_file_size),
        cmocka_unit_test(test_links_are_followed),
        cmocka_unit_test(test_plain_names),
        cmocka_unit_test(test_limit_of_the_format),
    };
    return cmocka_run_group_tests_name("write", tests, NULL, NULL);
}
