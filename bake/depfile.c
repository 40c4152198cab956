// depfile.c - names, escaped, in one string.

#include "depfile.h"

#include "import/name_table.h"
#include "ls_messages.h"
#include "ls_output.h"

#include <stdlib.h>
#include <string.h>

// A text that grows.
typedef struct Text
{
    char* bytes;
    size_t size, capacity;
    bool is_failed; // out of memory
} Text;

static void add_letter(Text* text, char letter)
{
    if (text->size == text->capacity)
    {
        const size_t grown = text->capacity ? 2 * text->capacity : 1024;
        char* moved = realloc(text->bytes, grown);
        if (!moved)
        {
            text->is_failed = true;
            return;
        }
        text->bytes = moved;
        text->capacity = grown;
    }
    text->bytes[text->size++] = letter;
}

static void add_text(Text* text, const char* letters)
{
    for (; *letters; letters++)
        add_letter(text, *letters);
}

// As gcc does it, which make and Ninja understand: backslashes count only before a space or a #.
static void add_name(Text* text, const char* name)
{
    for (const char* letter = name; *letter; letter++)
    {
        if (*letter == ' ' || *letter == '\t')
            for (const char* before = letter; before > name && before[-1] == '\\'; before--)
                add_letter(text, '\\');
        if (*letter == ' ' || *letter == '\t' || *letter == '#')
            add_letter(text, '\\');
        if (*letter == '$')
            add_letter(text, '$');
        add_letter(text, *letter);
    }
}

static LsResult check_name(const char* name, const LsBakeDesc* desc, LsError* error)
{
    return !strchr(name, '\n') ? LS_OK
                               : ls_error_set(error, LS_MESSAGE_OUTPUT_UNWRITABLE,
                                              "%s: cannot be written: the name %s has a line "
                                              "break; rename that file",
                                              desc->depfile, name);
}

static LsResult add_files(Text* text, const LsSourceFiles* files, const LsBakeDesc* desc,
                          LsError* error)
{
    LsNameTable known = {0};
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < files->count && result == LS_OK; i++)
    {
        const LsSourceFile* file = &files->list[i];
        if (!file->is_there || ls_name_table_find(&known, file->path))
            continue;
        result = check_name(file->path, desc, error);
        text->is_failed = !ls_name_table_set(&known, file->path, 0) || text->is_failed;
        add_text(text, " \\\n ");
        add_name(text, file->path);
    }
    ls_name_table_destroy(&known);
    return result;
}

LsResult ls_depfile_write(const LsSourceFiles* files, const LsBakeDesc* desc, LsError* error)
{
    Text text = {0};
    LsResult result = check_name(desc->output, desc, error);
    if (result == LS_OK)
    {
        add_name(&text, desc->output);
        add_letter(&text, ':');
        result = add_files(&text, files, desc, error);
        add_letter(&text, '\n');
    }
    if (result == LS_OK && text.is_failed)
        result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory", desc->depfile);
    if (result == LS_OK)
        result = ls_bytes_write(text.bytes, text.size, desc->depfile, error);
    free(text.bytes);
    return result;
}
