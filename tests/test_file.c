// test_file.c - mapping and opening files: what is missing, cut, changed or of another version.

#define _DEFAULT_SOURCE // truncate and symlink

#include "file_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

// ---- Opening ------------------------------------------------------------------------------------

static LsFixtureBytes make_file(void)
{
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    return ls_fixture_bytes(&fixture.desc);
}

static void test_cut_at_every_length(void** state)
{
    (void)state;
    LsFixtureBytes bytes = make_file();
    for (uint64_t size = 0; size < bytes.size; ++size)
    {
        LsFile file;
        LsError error = {0};
        assert_int_equal(ls_file_open(&file, bytes.bytes, size, "cut", &error), LS_ERROR_TRUNCATED);
        assert_int_equal(error.message, LS_MESSAGE_LSPACE_CUT);
        assert_non_null(strstr(error.text, "cut short"));
        assert_null(file.header);
    }
    ls_fixture_free(&bytes);
}

// In memory of exactly that size, so that a sanitizer sees a read behind the end.
static void test_cut_reads_nothing_behind(void** state)
{
    (void)state;
    LsFixtureBytes bytes = make_file();
    // Beyond header and directory.
    for (uint64_t size = 1; size < LS_HEADER_BYTES + (LS_CHUNK_COUNT + 3) * LS_ENTRY_BYTES; ++size)
    {
        void* copy = NULL;
        assert_int_equal(posix_memalign(&copy, 64, size), 0);
        memcpy(copy, bytes.bytes, size);
        LsFile file;
        assert_int_equal(ls_file_open(&file, copy, size, "cut", NULL), LS_ERROR_TRUNCATED);
        free(copy);
    }
    ls_fixture_free(&bytes);
}

static void test_one_byte_more(void** state)
{
    (void)state;
    LsFixtureBytes bytes = make_file(); // its memory is a multiple of 4096, the file is not
    bytes.bytes[bytes.size] = 0;
    LsFile file;
    LsError error = {0};
    const LsResult result = ls_file_open(&file, bytes.bytes, bytes.size + 1, "long", &error);
    assert_int_equal(result, LS_ERROR_RULE);
    assert_non_null(strstr(error.text, "R2.6"));
    ls_fixture_free(&bytes);
}

// Turns the chunk of lights into one of a type that nobody knows.
static void make_unknown_chunk(const LsFixtureBytes* bytes, uint32_t flags)
{
    LsHeader* header = (LsHeader*)(void*)bytes->bytes;
    LsEntry* entry = (LsEntry*)(void*)(bytes->bytes + LS_HEADER_BYTES) + LS_CHUNK_LIGHTS;
    memcpy(entry->type, "\xFFNEW", 4);
    entry->flags = flags;
    entry->stride = 1;
    entry->element_count = entry->stored_bytes;
    header->counts[LS_CHUNK_LIGHTS] = 0;
    header->optional_features &= ~LS_FEATURE_LIGHTS;
    ls_fixture_rehash(bytes);
}

static void test_unknown_chunks(void** state)
{
    (void)state;
    LsFixtureBytes bytes = make_file();
    LsFile file;
    LsError error = {0};
    make_unknown_chunk(&bytes, 0);
    assert_int_equal(ls_file_open(&file, bytes.bytes, bytes.size, "new", &error), LS_OK);
    assert_int_equal(ls_file_check(&file, "new", &error), LS_OK);
    assert_int_equal(ls_file_check_hashes(&file, "new", &error), LS_OK);
    assert_null(file.lights);
    assert_int_equal(file.header->chunk_count, LS_CHUNK_COUNT);
    make_unknown_chunk(&bytes, LS_ENTRY_REQUIRED);
    assert_int_equal(ls_file_open(&file, bytes.bytes, bytes.size, "new", &error), LS_ERROR_FEATURE);
    ls_fixture_free(&bytes);
}

// What a later minor may add: it is read, and its optional features are ignored.
static void test_later_minor(void** state)
{
    (void)state;
    LsFixtureBytes bytes = make_file();
    LsHeader* header = (LsHeader*)(void*)bytes.bytes;
    header->version_minor = 7;
    header->optional_features |= 1ull << 40;
    ls_fixture_rehash(&bytes);
    LsFile file;
    LsError error = {0};
    assert_int_equal(ls_file_open(&file, bytes.bytes, bytes.size, "later", &error), LS_OK);
    assert_int_equal(ls_file_check(&file, "later", &error), LS_OK);
    ls_fixture_free(&bytes);
}

static void expect_flips_caught(const LsFixtureBytes* bytes)
{
    uint64_t caught = 0;
    for (uint64_t bit = 0; bit < bytes->size * 8; ++bit)
    {
        bytes->bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        LsFile file;
        LsResult result = ls_file_open(&file, bytes->bytes, bytes->size, "flip", NULL);
        if (result == LS_OK)
        {
            ls_file_check(&file, "flip", NULL); // may pass: a colour may have any value
            result = ls_file_check_hashes(&file, "flip", NULL);
        }
        caught += result != LS_OK;
        bytes->bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    print_message("%llu of %llu bit flips caught\n", (unsigned long long)caught,
                  (unsigned long long)bytes->size * 8);
    assert_int_equal(caught, bytes->size * 8);
}

// The promise of the full check: not one bit of a file can change unseen.
static void test_every_bit_flip_is_caught(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsShaftLayout exact = ls_mask_layout(&fixture.desc, true);
    const LsFileDesc* const descs[] = {&fixture.desc, &exact.desc};
    for (int i = 0; i < 2; ++i)
    {
        LsFixtureBytes bytes = ls_fixture_bytes(descs[i]);
        expect_flips_caught(&bytes);
        ls_fixture_free(&bytes);
    }
    ls_shaft_layout_destroy(&exact);
}

// ---- Mapping ------------------------------------------------------------------------------------

// Cut just before the mapping's pages are brought in; the linker leads that call through here.
static const char* path_to_cut;

int __real_madvise(void* bytes, size_t size, int advice);
int __wrap_madvise(void* bytes, size_t size, int advice);
int __wrap_madvise(void* bytes, size_t size, int advice)
{
    if (path_to_cut != NULL)
    {
        assert_int_equal(truncate(path_to_cut, 1), 0);
    }
    return __real_madvise(bytes, size, advice);
}

static void join_path(char path[LS_SCRATCH_PATH + 32], const char* directory, const char* name)
{
    snprintf(path, LS_SCRATCH_PATH + 32, "%s/%s", directory, name);
}

static void write_text(const char* path, const char* text)
{
    FILE* file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static void expect_mapping(const char* path, LsResult result, uint32_t message)
{
    LsMapping mapping = {.bytes = path, .size = 1};
    LsError error = {0};
    assert_int_equal(ls_mapping_open(&mapping, path, &error), result);
    if (result != LS_OK)
    {
        assert_null(mapping.bytes);
        assert_int_equal(error.result, result);
        assert_int_equal(error.message, message);
        assert_memory_equal(error.text, path, strlen(path));
        assert_null(strchr(error.text, '\n'));
    }
    ls_mapping_close(&mapping);
    assert_null(mapping.bytes);
    assert_int_equal(mapping.size, 0);
}

static void test_mapping_errors(void** state)
{
    (void)state;
    char directory[LS_SCRATCH_PATH], path[LS_SCRATCH_PATH + 32];
    ls_scratch_create(directory);
    expect_mapping(directory, LS_ERROR_FILE_IS_DIRECTORY, LS_MESSAGE_FILE_IS_FOLDER);
    join_path(path, directory, "missing");
    expect_mapping(path, LS_ERROR_FILE_MISSING, LS_MESSAGE_FILE_MISSING);
    join_path(path, directory, "empty");
    write_text(path, "");
    expect_mapping(path, LS_ERROR_FILE_EMPTY, LS_MESSAGE_FILE_EMPTY);
    join_path(path, directory, "empty/below");
    expect_mapping(path, LS_ERROR_FILE_MISSING, LS_MESSAGE_FILE_MISSING);
    join_path(path, directory, "pipe");
    assert_int_equal(mkfifo(path, 0600), 0);
    expect_mapping(path, LS_ERROR_FILE_READ, LS_MESSAGE_FILE_NOT_REGULAR);
    join_path(path, directory, "loop");
    assert_int_equal(symlink("loop", path), 0);
    expect_mapping(path, LS_ERROR_FILE_READ, LS_MESSAGE_FILE_UNREADABLE);
    join_path(path, directory, "full");
    write_text(path, "x");
    expect_mapping(path, LS_OK, 0);
    ls_scratch_remove(directory);
}

static void test_cut_while_read(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    char directory[LS_SCRATCH_PATH], path[LS_SCRATCH_PATH + 32];
    ls_scratch_create(directory);
    join_path(path, directory, "scene.lspace");
    assert_int_equal(ls_file_write(&fixture.desc, path, NULL), LS_OK);
    path_to_cut = path;
    expect_mapping(path, LS_ERROR_FILE_READ, LS_MESSAGE_FILE_CHANGED);
    path_to_cut = NULL;
    ls_scratch_remove(directory);
}

// A file that is replaced while it is mapped stays whole, as it was.
static void test_mapping_survives_replacement(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    char directory[LS_SCRATCH_PATH], path[LS_SCRATCH_PATH + 32];
    ls_scratch_create(directory);
    join_path(path, directory, "scene.lspace");
    LsError error = {0};
    assert_int_equal(ls_file_write(&fixture.desc, path, &error), LS_OK);
    LsMapping mapping;
    LsFile file;
    assert_int_equal(ls_mapping_open(&mapping, path, &error), LS_OK);
    assert_int_equal(mapping.size, ls_file_desc_bytes(&fixture.desc));
    assert_int_equal(ls_file_open(&file, mapping.bytes, mapping.size, path, &error), LS_OK);
    fixture.materials[0].roughness = 0.5f;
    assert_int_equal(ls_file_write(&fixture.desc, path, &error), LS_OK);
    assert_int_equal(ls_file_check_hashes(&file, path, &error), LS_OK);
    assert_true(file.materials[0].roughness == 1);
    ls_mapping_close(&mapping);
    ls_scratch_remove(directory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cut_at_every_length),
        cmocka_unit_test(test_cut_reads_nothing_behind),
        cmocka_unit_test(test_one_byte_more),
        cmocka_unit_test(test_unknown_chunks),
        cmocka_unit_test(test_later_minor),
        cmocka_unit_test(test_every_bit_flip_is_caught),
        cmocka_unit_test(test_mapping_errors),
        cmocka_unit_test(test_cut_while_read),
        cmocka_unit_test(test_mapping_survives_replacement),
    };
    return cmocka_run_group_tests_name("file", tests, NULL, NULL);
}
