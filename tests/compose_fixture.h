// compose_fixture.h - small files in a folder of the run, and composing them: for the tests of what
// happens to inputs before the mesh stage.

#ifndef LS_COMPOSE_FIXTURE_H
#define LS_COMPOSE_FIXTURE_H

#include "compose.h"
#include "ls_messages.h"

#include <stddef.h>

// Group setup and teardown: the folder. Only files of the names that the .c lists are removed.
int ls_compose_make_folder(void** state);
int ls_compose_remove_folder(void** state);

// Path of a file in the folder; four are alive at a time.
const char* ls_compose_path(const char* name);
void ls_compose_write_bytes(const char* name, const void* bytes, size_t size);
void ls_compose_write_text(const char* name, const char* text);

// Four vertices and two triangles, 0 1 2 and 0 3 1; the fifth vertex is used by none.
extern const float ls_compose_corners[5][3];
void ls_compose_write_ply(const char* name);

// (0,0,0), (x,0,0), (0,x,0).
void ls_compose_write_triangle(const char* name, const char* x);

// `nodes` and `materials` are what stands in JSON lists. Mesh 0 is of ls_compose_corners, its
// triangles of materials 0 and 1, if there are any.
void ls_compose_write_gltf(const char* name, const char* roots, const char* nodes,
                           const char* materials);

// Nodes with a rotation, scales of three kinds, two instances of the mesh and a camera; root 0.
#define LS_COMPOSE_TREE                                                                      \
    "{\"children\":[1,2],\"translation\":[0.5,-2,0.75],\"rotation\":[0.18257419,0.36514837," \
    "0.54772256,0.73029674]},"                                                               \
    "{\"mesh\":0,\"scale\":[1,2,0.5],\"translation\":[1,0,0]},"                              \
    "{\"children\":[3,4],\"rotation\":[0,0.6,0,0.8]},"                                       \
    "{\"mesh\":0,\"translation\":[3,1,-1]},"                                                 \
    "{\"camera\":0,\"translation\":[0,0,4],\"scale\":[2,2,2]}"

// "red", rough; "lamp", emissive and double-sided.
#define LS_COMPOSE_MATERIALS                                                     \
    "{\"name\":\"red\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,1]," \
    "\"metallicFactor\":0,\"roughnessFactor\":0.75}},"                           \
    "{\"name\":\"lamp\",\"emissiveFactor\":[1,1,1],\"doubleSided\":true}"

// Composes, and fails the calling cmocka test with the error's text.
LsInput ls_compose_inputs(const LsBakeInput* inputs, uint32_t count);

// Refused with this message, whose text is one line and has `word`.
void ls_compose_check_refused_desc(const LsBakeDesc* desc, LsMessage expected, const char* word);
void ls_compose_check_refused(const LsBakeInput* how, LsMessage expected, const char* word);

// Each of `count` numbers, relative to the larger of 1 and itself.
void ls_compose_check_close(const double* a, const double* b, int count, double tolerance);

#endif
