// mesh_files.c - what tests of importers share: files in a folder of the run, and what is said of them.

#include "mesh_files.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

static char folder[] = "/tmp/ls-test-mesh-XXXXXX";

int make_mesh_folder(void** state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

int remove_mesh_folder(void** state)
{
    (void)state;
    DIR* entries = opendir(folder);
    if (!entries)
        return -1;
    for (struct dirent* entry; (entry = readdir(entries));)
        if (entry->d_name[0] != '.')
            unlink(find_mesh_path(entry->d_name));
    closedir(entries);
    return rmdir(folder);
}

const char* find_mesh_path(const char* name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

void write_mesh_bytes(const char* name, const void* bytes, size_t size)
{
    FILE* file = fopen(find_mesh_path(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

void write_mesh_text(const char* name, const char* text)
{
    write_mesh_bytes(name, text, strlen(text));
}

LsInput import_mesh_file(const char* name)
{
    LsInput input = {0};
    LsError error;
    if (ls_import(&input, find_mesh_path(name), &error) != LS_OK)
        fail_msg("%s", error.text);
    return input;
}

LsInput import_mesh_text(const char* name, const char* text)
{
    write_mesh_text(name, text);
    return import_mesh_file(name);
}

static void check_line(const char* name, const char* text, uint32_t found, LsMessage message,
                       const char* word)
{
    if (found != (uint32_t)message || !strstr(text, name) || !strstr(text, word) ||
        strchr(text, '\n'))
        fail_msg("%s: message %u instead of %d, or no \"%s\" in: %s", name, found, (int)message,
                 word, text);
}

void check_mesh_refused(const char* name, LsMessage message, const char* word)
{
    LsInput input = {0};
    LsError error = {0};
    const LsResult result = ls_import(&input, find_mesh_path(name), &error);
    ls_input_destroy(&input);
    assert_int_equal(result, error.result);
    assert_int_equal(result, message / 100);
    check_line(name, error.text, error.message, message, word);
}

void check_mesh_text_refused(const char* name, const char* text, LsMessage message,
                             const char* word)
{
    write_mesh_text(name, text);
    check_mesh_refused(name, message, word);
}

void check_mesh_text_warned(const char* name, const char* text, LsMessage message, const char* word)
{
    LsInput input = import_mesh_text(name, text);
    const LsInputWarning* warning = NULL;
    for (uint32_t i = 0; i < input.warning_count && !warning; i++)
        if (input.warnings[i].message == (uint32_t)message)
            warning = &input.warnings[i];
    if (!warning)
        fail_msg("%s: no warning %d", text, (int)message);
    else
        check_line("", warning->text, warning->message, message, word);
    const bool is_only = input.warning_count == 1;
    ls_input_destroy(&input);

    LsInput strict = {.options.strict = true};
    LsError error = {0};
    assert_int_equal(ls_import(&strict, find_mesh_path(name), &error), LS_ERROR_INPUT_WARNING);
    if (is_only)
        check_line("", error.text, error.message, message, word);
    ls_input_destroy(&strict);
}

// Imports whatever the file is; true if it was taken.
static bool try_import(const char* name)
{
    LsInput input = {0};
    LsError error = {0};
    const bool is_taken = ls_import(&input, find_mesh_path(name), &error) == LS_OK;
    if (!is_taken && (error.message < 2000 || !strstr(error.text, folder)))
        fail_msg("%s: message %u: %s", name, error.message, error.text);
    for (uint32_t m = 0; is_taken && m < input.mesh_count; m++)
    {
        const LsInputMesh* mesh = &input.meshes[m];
        for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++)
        {
            assert_true(mesh->indices[i] < mesh->vertex_count);
            assert_true(mesh->materials[i / 3] < input.material_count);
            for (int kind = 0; kind < LS_STREAM_COUNT; kind++)
                if (mesh->streams[kind].indices)
                    assert_true(mesh->streams[kind].indices[i] < mesh->streams[kind].count ||
                                mesh->streams[kind].indices[i] == LS_NONE);
        }
    }
    ls_input_destroy(&input);
    return is_taken;
}

void check_mesh_cut(const char* name, const void* bytes, size_t size, size_t may_lack)
{
    for (size_t length = size - may_lack; length-- > 0;)
    {
        write_mesh_bytes(name, bytes, length);
        if (try_import(name))
            fail_msg("%s, cut after %zu bytes, was taken", name, length);
    }
}

void check_mesh_damage(const char* name, const void* bytes, size_t size, int rounds)
{
    static const char likely[] = "0123456789 -\n./#e";
    uint32_t random = 1;
    unsigned refused = 0;
    char* damaged = malloc(size);
    assert_non_null(damaged);
    for (int i = 0; i < rounds; i++)
    {
        memcpy(damaged, bytes, size);
        for (int k = 0; k <= i % 3; k++)
        {
            random = random * 1664525u + 1013904223u;
            const size_t place = (random >> 8) % size;
            random = random * 1664525u + 1013904223u;
            damaged[place] = i % 2 ? likely[random >> 28] : (char)(random >> 24);
        }
        write_mesh_bytes(name, damaged, size);
        refused += !try_import(name);
    }
    free(damaged);
    assert_true(refused > 0);
}
