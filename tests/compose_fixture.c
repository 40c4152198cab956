// compose_fixture.c - small files in a folder of the run, and composing them.

#include "compose_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- Files in a folder of this run --------------------------------------------------------------

static char folder[] = "/tmp/ls-test-compose-XXXXXX";

static const char* const file_names[] = {"a.gltf", "b.gltf",     "a.ply",      "b.ply",
                                         "a.json", "empty.json", "out.lspace", "large.json"};

const char* ls_compose_path(const char* name)
{
    static char paths[4][256];
    static unsigned next;
    char* path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

int ls_compose_make_folder(void** state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

int ls_compose_remove_folder(void** state)
{
    (void)state;
    for (size_t i = 0; i < sizeof file_names / sizeof *file_names; i++)
        unlink(ls_compose_path(file_names[i]));
    return rmdir(folder);
}

void ls_compose_write_bytes(const char* name, const void* bytes, size_t size)
{
    FILE* file = fopen(ls_compose_path(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

void ls_compose_write_text(const char* name, const char* text)
{
    ls_compose_write_bytes(name, text, strlen(text));
}

// Four vertices and two triangles; the fifth vertex is used by none.
const float ls_compose_corners[5][3] = {
    {0.0f, 0.0f, 0.0f}, {2.0f, 0.0f, -0.5f}, {0.0f, 1.0f, 0.25f}, {0.125f, 0.5f, 3.0f}, {9, 9, 9}};

void ls_compose_write_ply(const char* name)
{
    char text[1000];
    int length = snprintf(text, sizeof text,
                          "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
                          "property float y\nproperty float z\nelement face 2\n"
                          "property list uchar int vertex_indices\nend_header\n");
    for (int i = 0; i < 5; i++)
        length +=
            snprintf(text + length, sizeof text - (size_t)length, "%.9g %.9g %.9g\n",
                     ls_compose_corners[i][0], ls_compose_corners[i][1], ls_compose_corners[i][2]);
    snprintf(text + length, sizeof text - (size_t)length, "3 0 1 2\n3 0 3 1\n");
    ls_compose_write_text(name, text);
}

// (0,0,0), (x,0,0), (0,x,0).
void ls_compose_write_triangle(const char* name, const char* x)
{
    char text[500];
    snprintf(text, sizeof text,
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\n%s 0 0\n0 %s 0\n3 0 1 2\n",
             x, x);
    ls_compose_write_text(name, text);
}

// The bytes of `ls_compose_corners` and of the indices 0 1 2 0 3 1.
#define GLTF_BUFFER                                                \
    "AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAC/AAAAAAAAgD8AAIA+AAAAPgAAAD8A" \
    "AEBAAAAQQQAAEEEAABBBAAABAAIAAAADAAEA"

// `nodes` and `materials` are JSON lists' content; the mesh's triangles have the materials 0 and 1,
// if there are any.
void ls_compose_write_gltf(const char* name, const char* roots, const char* nodes,
                           const char* materials)
{
    char text[8000];
    const bool has_materials = materials[0] != '\0';
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[%s]}],\"nodes\":[%s],"
             "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.7,\"znear\":1}}],"
             "\"materials\":[%s],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1%s},"
             "{\"attributes\":{\"POSITION\":0},\"indices\":2%s}]}],"
             "\"buffers\":[{\"byteLength\":72,\"uri\":\"data:application/octet-stream;base64," //
             GLTF_BUFFER "\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":72}],"
             "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":"
             "\"VEC3\",\"min\":[0,0,-0.5],\"max\":[9,9,9]},"
             "{\"bufferView\":0,\"byteOffset\":60,\"componentType\":5123,\"count\":3,\"type\":"
             "\"SCALAR\"},"
             "{\"bufferView\":0,\"byteOffset\":66,\"componentType\":5123,\"count\":3,\"type\":"
             "\"SCALAR\"}]}",
             roots, nodes, materials, has_materials ? ",\"material\":0" : "",
             has_materials ? ",\"material\":1" : "");
    if (!has_materials)
    {
        // An empty list is no legal glTF.
        char* list = strstr(text, "\"materials\":[],");
        assert_non_null(list);
        memset(list, ' ', strlen("\"materials\":[],"));
    }
    ls_compose_write_text(name, text);
}

// ---- Composing ----------------------------------------------------------------------------------

LsInput ls_compose_inputs(const LsBakeInput* inputs, uint32_t count)
{
    const LsBakeDesc desc = {.inputs = inputs, .input_count = count};
    LsInput input = {0};
    LsError error = {0};
    if (ls_compose_check(&desc, &error) != LS_OK ||
        ls_compose(&input, &desc, NULL, NULL, &error) != LS_OK)
        fail_msg("%s", error.text);
    return input;
}

// Refused with this message, and the text has `word`.
void ls_compose_check_refused_desc(const LsBakeDesc* desc, LsMessage expected, const char* word)
{
    LsInput input = {0};
    LsError error = {0};
    LsResult result = ls_compose_check(desc, &error);
    if (result == LS_OK)
        result = ls_compose(&input, desc, NULL, NULL, &error);
    ls_input_destroy(&input);
    assert_int_equal(error.message, expected);
    assert_int_equal(result, expected / 100);
    if (!strstr(error.text, word) || strchr(error.text, '\n'))
        fail_msg("no \"%s\", or more than a line: %s", word, error.text);
}

void ls_compose_check_refused(const LsBakeInput* how, LsMessage expected, const char* word)
{
    const LsBakeDesc desc = {.inputs = how, .input_count = 1};
    ls_compose_check_refused_desc(&desc, expected, word);
}

void ls_compose_check_close(const double* a, const double* b, int count, double tolerance)
{
    for (int i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= tolerance * fmax(1.0, fabs(b[i]))))
            fail_msg("number %d is %.17g instead of %.17g", i, a[i], b[i]);
}
