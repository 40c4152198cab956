// mesh_files.h - what tests of importers share: files in a folder of the run, and what is said of them.

#ifndef MESH_FILES_H
#define MESH_FILES_H

#include "import.h"

#include <stddef.h>

// Setup and teardown of a group; the folder goes again with all that the tests wrote.
int make_mesh_folder(void** state);
int remove_mesh_folder(void** state);

// The path of a file in the folder; valid until the next call.
const char* find_mesh_path(const char* name);
void write_mesh_bytes(const char* name, const void* bytes, size_t size);
void write_mesh_text(const char* name, const char* text);

// Imports a file; a refusal fails the test.
LsInput import_mesh_file(const char* name);
LsInput import_mesh_text(const char* name, const char* text);

// The file is refused with this message, in one line that names the file and `word`.
void check_mesh_refused(const char* name, LsMessage message, const char* word);
void check_mesh_text_refused(const char* name, const char* text, LsMessage message,
                             const char* word);

// The text is taken with a warning that names the file and `word`, and refused with the same under
// strict.
void check_mesh_text_warned(const char* name, const char* text, LsMessage message,
                            const char* word);

// Cuts a good file at every length and damages it in many ways: never more than a refusal, and no
// index out of range. Every cut of more than `may_lack` bytes must be refused.
void check_mesh_cut(const char* name, const void* bytes, size_t size, size_t may_lack);
void check_mesh_damage(const char* name, const void* bytes, size_t size, int rounds);

#endif
