// source_files.c - asks the importers for their files and remembers what those were like.

#include "source_files.h"

#include "import/input_files.h"
#include "ls_format.h"
#include "ls_messages.h"
#include "material_file.h"

#include <stdlib.h>
#include <string.h>

static void read_status(LsSourceFile* file)
{
    file->is_there = !stat(file->path, &file->status) && S_ISREG(file->status.st_mode);
}

static bool add_file(LsSourceFiles* files, const char* path, uint32_t input)
{
    if (files->count == files->capacity)
    {
        const uint32_t grown = files->capacity ? 2 * files->capacity : 16;
        LsSourceFile* moved = realloc(files->list, grown * sizeof *moved);
        if (!moved)
            return false;
        files->list = moved;
        files->capacity = grown;
    }
    LsSourceFile file = {.path = strdup(path), .input = input};
    if (!file.path)
        return false;
    read_status(&file);
    files->list[files->count++] = file;
    return true;
}

static bool add_input(LsSourceFiles* files, const LsBakeInput* how, uint32_t input)
{
    LsNameTable names = {0};
    bool ok = ls_input_list_files(how->path, &names);
    for (uint32_t i = 0; i < names.count && ok; i++)
        ok = add_file(files, names.entries[i].name, input);
    ls_name_table_destroy(&names);
    if (ok && how->materials && !ls_materials_are_inline(how->materials))
        ok = add_file(files, how->materials, input);
    return ok;
}

LsResult ls_source_files_list(LsSourceFiles* files, const LsBakeDesc* desc, LsError* error)
{
    for (uint32_t i = 0; i < desc->input_count; i++)
        if (!add_input(files, &desc->inputs[i], i))
            return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                                "%s: out of memory for the list of its files",
                                desc->inputs[i].path);
    return LS_OK;
}

LsResult ls_source_files_check(const LsSourceFiles* files, LsError* error)
{
    for (uint32_t i = 0; i < files->count; i++)
    {
        const LsSourceFile* old = &files->list[i];
        LsSourceFile now = *old;
        read_status(&now);
        if (now.is_there != old->is_there ||
            (now.is_there && (now.status.st_ino != old->status.st_ino ||
                              now.status.st_size != old->status.st_size ||
                              now.status.st_mtim.tv_sec != old->status.st_mtim.tv_sec ||
                              now.status.st_mtim.tv_nsec != old->status.st_mtim.tv_nsec)))
            return ls_error_set(error, LS_MESSAGE_FILE_CHANGED,
                                "%s: changed while it was read; try again when nobody writes it",
                                old->path);
    }
    return LS_OK;
}

LsResult ls_source_files_spare(const LsSourceFiles* files, const char* path, LsError* error)
{
    for (uint32_t i = 0; i < files->count; i++)
        if (ls_path_is_same(files->list[i].path, path))
            return ls_error_set(error, LS_MESSAGE_USAGE_OUTPUT_IS_INPUT,
                                "%s: the output would replace the input %s; choose another name",
                                path, files->list[i].path);
    return LS_OK;
}

void ls_source_files_destroy(LsSourceFiles* files)
{
    for (uint32_t i = 0; i < files->count; i++)
        free(files->list[i].path);
    free(files->list);
    *files = (LsSourceFiles){0};
}
