// gltf_fixture.h - small glTF files made by tests: a buffer that grows, views and accessors over it.

#ifndef GLTF_FIXTURE_H
#define GLTF_FIXTURE_H

#include "import.h"

#include <stddef.h>

// Component types.
enum
{
    I8 = 5120,
    U8 = 5121,
    I16 = 5122,
    U16 = 5123,
    U32 = 5125,
    F32 = 5126,
};

// Members of a file of one node with the mesh "thing", of one primitive.
#define ONE_NODE "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}]"
#define PRIMITIVE(text) "\"meshes\":[{\"name\":\"thing\",\"primitives\":[{" text "}]}]"
#define POSITION "\"attributes\":{\"POSITION\":0}"
#define PLAIN ONE_NODE "," PRIMITIVE(POSITION)

#define POINTS "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"

extern const float gltf_corners[7][3];

// A folder of this run, made and removed around the tests of a program (cmocka's group functions).
int gltf_make_folder(void** state);
int gltf_remove_folder(void** state);

// Path of a file in it, in a static buffer.
const char* gltf_find_path(const char* name);
void gltf_write_bytes(const char* name, const void* bytes, size_t size);

// Forgets buffer, views and accessors.
void gltf_begin(void);

// Appends bytes to the buffer, at a multiple of four, and a view of them; stride 0: none. Returns the
// view's number.
int gltf_add_view(const void* bytes, size_t size, int stride);

// Adds an accessor; view -1: none; `more` is further members or "". Returns its number.
int gltf_add_accessor(int view, size_t offset, int component, size_t count, const char* type,
                      const char* more);

// Begins anew with accessor 0, so many of the corners.
void gltf_begin_corners(size_t count);

// View and accessor in one.
int gltf_add_floats(const float* values, size_t count, int width);
int gltf_add_words(const uint16_t* values, size_t count); // scalars

// The JSON with further members, "%s" in which is nothing special; `uri` of the buffer, or NULL for
// none. In a static buffer.
const char* gltf_print(const char* uri, const char* members);

// Writes a.gltf and a.bin, or a.glb.
void gltf_write(const char* members);
size_t gltf_print_glb(const char* members, uint8_t* bytes);

// Bytes of the buffer as a data URI, in a static buffer.
const char* gltf_print_data_uri(const char* kind, const void* bytes, size_t size);

// Imports a file; fails the test if it is refused.
LsInput gltf_import(const char* name);

// The file is refused with this message, whose text names the file and `word`.
void gltf_check_refused(const char* name, LsMessage message, const char* word);

// Writes a.gltf with these members, which is refused.
void gltf_check_members_refused(const char* members, LsMessage message, const char* word);

// The import has this warning, its text names `word`; under strict the file is refused with it.
void gltf_check_warned(const LsInput* input, const char* name, LsMessage message, const char* word);

// Makes a PNG of RGBA pixels, of 8 or 16 bits a channel (the high byte twice), its data stored.
// Returns its size.
size_t gltf_make_png(uint8_t* png, uint32_t width, uint32_t height, int depth,
                     const uint8_t* pixels);

#endif
