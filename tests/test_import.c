// test_import.c - what the importers take from files, and what they refuse.

#include "import.h"

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

static char folder[] = "/tmp/ls-test-import-XXXXXX";

static int make_folder(void** state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

// Everything that the tests write is named here, so that the folder can go again.
static const char* const file_names[] = {"a.ply", "b.ply", "a.obj", "a.mtl", "a.gltf",
                                         "a.bin", "a.glb", "a.xyz", "a"};

static int remove_folder(void** state)
{
    (void)state;
    for (size_t i = 0; i < sizeof file_names / sizeof *file_names; i++)
    {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", folder, file_names[i]);
        unlink(path);
    }
    return rmdir(folder);
}

static const char* find_path(const char* name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_bytes(const char* name, const void* bytes, size_t size)
{
    FILE* file = fopen(find_path(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void write_text(const char* name, const char* text)
{
    write_bytes(name, text, strlen(text));
}

static LsInput import_file(const char* name)
{
    LsInput input = {0};
    LsError error;
    if (ls_import(&input, find_path(name), &error) != LS_OK)
        fail_msg("%s", error.text);
    return input;
}

// The file is refused with this result, and the message names the file and `word`.
static void check_refused(const char* name, LsResult expected, const char* word)
{
    LsInput input = {0};
    LsError error = {0};
    const LsResult result = ls_import(&input, find_path(name), &error);
    ls_input_destroy(&input);
    if (result != expected || !strstr(error.text, name) || !strstr(error.text, word) ||
        strchr(error.text, '\n'))
        fail_msg("%s: result %d instead of %d, or no \"%s\" in: %s", name, result, expected, word,
                 error.text);
}

static void check_refused_text(const char* name, const char* text, LsResult expected,
                               const char* word)
{
    write_text(name, text);
    check_refused(name, expected, word);
}

// ---- One mesh in every format -------------------------------------------------------------------

// Two tetrahedron faces, a third face on one edge (not manifold), a face twice, one with equal
// corners, one of three points on a line, and a pentagon.
#define MESH_VERTICES 7
static const float mesh_positions[MESH_VERTICES][3] = {
    {0.0f, 0.0f, 0.0f},   {1.0f, 0.0f, 0.0f},       {0.0f, 1.0f, 0.0f},  {0.0f, 0.0f, 1.0f},
    {0.5f, -1.25f, 0.1f}, {1.0e-7f, 2.5e6f, -0.3f}, {2.0f, 0.0f, -0.0f},
};
static const uint8_t mesh_faces[][6] = {
    // count, corners
    {3, 0, 1, 2}, {3, 0, 3, 1}, {3, 0, 1, 4},       {3, 0, 1, 2},
    {3, 5, 5, 2}, {3, 0, 1, 6}, {5, 0, 1, 2, 3, 5},
};
#define MESH_FACES (sizeof mesh_faces / sizeof *mesh_faces)
#define MESH_TRIANGLES 9
static const uint32_t mesh_indices[MESH_TRIANGLES][3] = {
    {0, 1, 2}, {0, 3, 1}, {0, 1, 4}, {0, 1, 2}, {5, 5, 2},
    {0, 1, 6}, {0, 1, 2}, {0, 2, 3}, {0, 3, 5},
};

static void check_mesh(const LsInput* input)
{
    assert_int_equal(input->mesh_count, 1);
    assert_int_equal(input->instance_count, 1);
    const LsInputMesh* mesh = &input->meshes[0];
    assert_int_equal(mesh->vertex_count, MESH_VERTICES);
    assert_int_equal(mesh->triangle_count, MESH_TRIANGLES);
    assert_memory_equal(mesh->positions, mesh_positions, sizeof mesh_positions);
    assert_memory_equal(mesh->indices, mesh_indices, sizeof mesh_indices);
    for (uint32_t i = 0; i < MESH_TRIANGLES; i++)
        assert_int_equal(mesh->materials[i], 0);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            assert_true(input->instances[0].world_from_object[i][j] == (i == j ? 1.0 : 0.0));
    assert_int_equal(input->material_count, 1);
    assert_true(input->materials[0].core.base_color.x == 0.8f);
    assert_true(input->materials[0].core.base_color.y == 0.8f);
    assert_true(input->materials[0].core.base_color.z == 0.8f);
    assert_int_equal(input->materials[0].core.flags, 0);
}

static void import_and_check_mesh(const char* name)
{
    LsInput input = import_file(name);
    check_mesh(&input);
    ls_input_destroy(&input);
}

static size_t print_ply_header(char* text, const char* format, const char* vertex_extra)
{
    return (size_t)sprintf(text,
                           "ply\nformat %s 1.0\ncomment a mesh\nobj_info made by hand\n"
                           "element vertex %d\nproperty float x\nproperty float y\n"
                           "property float z\n%selement face %zu\n"
                           "property list uchar int vertex_indices\nend_header\n",
                           format, MESH_VERTICES, vertex_extra, MESH_FACES);
}

static size_t print_ascii_ply(char* text)
{
    size_t length = print_ply_header(text, "ascii", "");
    for (int i = 0; i < MESH_VERTICES; i++)
        length += (size_t)sprintf(text + length, "%.9g %.9g %.9g\n", (double)mesh_positions[i][0],
                                  (double)mesh_positions[i][1], (double)mesh_positions[i][2]);
    for (size_t i = 0; i < MESH_FACES; i++)
        for (int k = 0; k <= mesh_faces[i][0]; k++)
            length += (size_t)sprintf(text + length, "%d%c", mesh_faces[i][k],
                                      k < mesh_faces[i][0] ? ' ' : '\n');
    return length;
}

static void append_word(char* bytes, size_t* length, const void* word, bool is_big)
{
    for (int i = 0; i < 4; i++)
        bytes[(*length)++] = ((const char*)word)[is_big ? 3 - i : i];
}

static size_t print_binary_ply(char* bytes, bool is_big, const float positions[][3])
{
    size_t length =
        print_ply_header(bytes, is_big ? "binary_big_endian" : "binary_little_endian", "");
    for (int i = 0; i < MESH_VERTICES; i++)
        for (int axis = 0; axis < 3; axis++)
            append_word(bytes, &length, &positions[i][axis], is_big);
    for (size_t i = 0; i < MESH_FACES; i++)
    {
        bytes[length++] = (char)mesh_faces[i][0];
        for (int k = 1; k <= mesh_faces[i][0]; k++)
        {
            const int32_t index = mesh_faces[i][k];
            append_word(bytes, &length, &index, is_big);
        }
    }
    return length;
}

static size_t print_obj(char* text)
{
    size_t length = (size_t)sprintf(text, "# a mesh\n");
    for (int i = 0; i < MESH_VERTICES; i++)
        length += (size_t)sprintf(text + length, "v %.9g %.9g %.9g\n", (double)mesh_positions[i][0],
                                  (double)mesh_positions[i][1], (double)mesh_positions[i][2]);
    for (size_t i = 0; i < MESH_FACES; i++)
    {
        length += (size_t)sprintf(text + length, "f");
        for (int k = 1; k <= mesh_faces[i][0]; k++)
            length += (size_t)sprintf(text + length, " %d", mesh_faces[i][k] + 1);
        length += (size_t)sprintf(text + length, "\n");
    }
    return length;
}

// The buffer of the glTF forms: positions, then the indices as u8, u16 and u32.
#define GLTF_U8 sizeof mesh_positions
#define GLTF_U16 (GLTF_U8 + 28)
#define GLTF_U32 (GLTF_U16 + 56)
#define GLTF_BYTES (GLTF_U32 + sizeof mesh_indices)

static void fill_gltf_buffer(uint8_t bytes[GLTF_BYTES])
{
    memset(bytes, 0, GLTF_BYTES);
    memcpy(bytes, mesh_positions, sizeof mesh_positions);
    memcpy(bytes + GLTF_U32, mesh_indices, sizeof mesh_indices);
    for (int i = 0; i < 3 * MESH_TRIANGLES; i++)
    {
        const uint16_t index = (uint16_t)mesh_indices[i / 3][i % 3];
        bytes[GLTF_U8 + i] = (uint8_t)index;
        memcpy(bytes + GLTF_U16 + 2 * i, &index, sizeof index);
    }
}

// A scene over that buffer. Accessors: 0 positions, 1 u8, 2 u16, 3 u32 indices. `scene` gives
// nodes, meshes and whatever else.
static size_t print_gltf(char* text, const char* uri, const char* scene)
{
    return (size_t)sprintf(
        text,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu%s%s%s}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu},{\"buffer\":0,\"byteOffset\":%zu,"
        "\"byteLength\":28},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":56},{\"buffer\":0,"
        "\"byteOffset\":%zu,\"byteLength\":%zu}],\"accessors\":["
        "{\"bufferView\":0,\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5121,\"count\":%d,\"type\":\"SCALAR\"},"
        "{\"bufferView\":2,\"componentType\":5123,\"count\":%d,\"type\":\"SCALAR\"},"
        "{\"bufferView\":3,\"componentType\":5125,\"count\":%d,\"type\":\"SCALAR\"}],%s}",
        GLTF_BYTES, uri ? ",\"uri\":\"" : "", uri ? uri : "", uri ? "\"" : "", GLTF_U8, GLTF_U8,
        GLTF_U16, GLTF_U32, sizeof mesh_indices, MESH_VERTICES, 3 * MESH_TRIANGLES,
        3 * MESH_TRIANGLES, 3 * MESH_TRIANGLES, scene);
}

static void write_gltf(const char* scene)
{
    static char text[16384];
    uint8_t buffer[GLTF_BYTES];
    fill_gltf_buffer(buffer);
    write_bytes("a.bin", buffer, sizeof buffer);
    write_bytes("a.gltf", text, print_gltf(text, "a.bin", scene));
}

#define ONE_NODE "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}]"

static size_t print_glb(uint8_t* bytes)
{
    char text[8192];
    size_t text_length = print_gltf(text, NULL,
                                    ONE_NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":"
                                             "{\"POSITION\":0},\"indices\":2}]}]");
    while (text_length % 4)
        text[text_length++] = ' ';
    const uint32_t json_header[5] = {0x46546C67, 2, (uint32_t)(28 + text_length + GLTF_BYTES),
                                     (uint32_t)text_length, 0x4E4F534A};
    const uint32_t bin_header[2] = {GLTF_BYTES, 0x004E4942};
    memcpy(bytes, json_header, 20);
    memcpy(bytes + 20, text, text_length);
    memcpy(bytes + 20 + text_length, bin_header, 8);
    fill_gltf_buffer(bytes + 28 + text_length);
    return 28 + text_length + GLTF_BYTES;
}

static void test_ply_ascii(void** state)
{
    (void)state;
    char text[4096];
    write_bytes("a.ply", text, print_ascii_ply(text));
    import_and_check_mesh("a.ply");
}

static void test_ply_binary(void** state)
{
    (void)state;
    char bytes[4096];
    for (int is_big = 0; is_big < 2; is_big++)
    {
        write_bytes("a.ply", bytes, print_binary_ply(bytes, is_big, mesh_positions));
        import_and_check_mesh("a.ply");
    }
}

static void test_obj(void** state)
{
    (void)state;
    char text[4096];
    write_bytes("a.obj", text, print_obj(text));
    import_and_check_mesh("a.obj");
}

static void test_gltf(void** state)
{
    (void)state;
    for (int indices = 1; indices <= 3; indices++)
    {
        char scene[1024];
        snprintf(scene, sizeof scene,
                 ONE_NODE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                          "\"indices\":%d}]}]",
                 indices);
        write_gltf(scene);
        import_and_check_mesh("a.gltf");
    }
}

static void test_glb(void** state)
{
    (void)state;
    uint8_t bytes[8192];
    write_bytes("a.glb", bytes, print_glb(bytes));
    import_and_check_mesh("a.glb");
}

#define PLY_START "ply\nformat ascii 1.0\nelement vertex 3\n"
#define PLY_XYZ "property float x\nproperty float y\nproperty float z\n"
#define PLY_FACES "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define PLY_POINTS "0 0 0\n1 0 0\n0 1 0\n"

#define POSITION "\"attributes\":{\"POSITION\":0}"

static void test_together(void** state)
{
    (void)state;
    char text[4096];
    write_gltf(ONE_NODE ",\"meshes\":[{\"primitives\":[{" POSITION
                        ",\"indices\":1,\"material\":0}]}],\"materials\":[{}]");
    write_bytes("a.ply", text, print_ascii_ply(text));
    write_bytes("a.obj", text, print_obj(text));
    LsInput input = {0};
    LsError error;
    const char* const names[] = {"a.ply", "a.gltf", "a.obj", "a.gltf"};
    for (int i = 0; i < 4; i++)
        assert_int_equal(ls_import(&input, find_path(names[i]), &error), LS_OK);
    assert_int_equal(input.mesh_count, 4);
    assert_int_equal(input.instance_count, 4);
    assert_int_equal(input.node_count, 2);
    assert_int_equal(input.material_count, 3); // the default once
    const uint32_t materials[4] = {0, 1, 0, 2};
    const uint32_t nodes[4] = {LS_NONE, 0, LS_NONE, 1};
    for (uint32_t i = 0; i < 4; i++)
    {
        assert_int_equal(input.meshes[i].input_index, i);
        assert_int_equal(input.meshes[i].materials[MESH_TRIANGLES - 1], materials[i]);
        assert_int_equal(input.instances[i].mesh, i);
        assert_int_equal(input.instances[i].node, nodes[i]);
        assert_memory_equal(input.meshes[i].positions, mesh_positions, sizeof mesh_positions);
    }
    ls_input_destroy(&input);
    assert_null(input.meshes);
    assert_int_equal(input.mesh_count, 0);
}

static void test_no_file(void** state)
{
    (void)state;
    unlink(find_path("b.ply"));
    check_refused("b.ply", LS_ERROR_FILE_MISSING, "no such file");
    check_refused("b.ply/x.ply", LS_ERROR_FILE_MISSING, "no such file");
    check_refused("", LS_ERROR_FILE_IS_DIRECTORY, "directory");
    check_refused_text("b.ply", "", LS_ERROR_FILE_EMPTY, "empty");
    check_refused_text("a.xyz", "0 0 0\n", LS_ERROR_INPUT_UNSUPPORTED, ".ply");
    check_refused_text("a", "0 0 0\n", LS_ERROR_INPUT_UNSUPPORTED, ".ply");
}

static void test_no_triangles(void** state)
{
    (void)state;
    write_text("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\n" PLY_XYZ "end_header\n1 2 3\n");
    LsInput input = import_file("a.ply");
    assert_int_equal(input.mesh_count, 0);
    assert_int_equal(input.instance_count, 0);
    ls_input_destroy(&input);
    write_text("a.obj", "v 0 0 0\n");
    input = import_file("a.obj");
    assert_int_equal(input.mesh_count, 0);
    ls_input_destroy(&input);
    write_gltf(ONE_NODE ",\"meshes\":[{\"primitives\":[{" POSITION ",\"mode\":0}]}]");
    input = import_file("a.gltf");
    assert_int_equal(input.mesh_count, 0);
    assert_int_equal(input.instance_count, 0);
    assert_int_equal(input.node_count, 1);
    ls_input_destroy(&input);
}

// ---- Cut and damaged files ----------------------------------------------------------------------

static void test_cut(void** state)
{
    (void)state;
    char bytes[8192];
    LsError error;
    for (int form = 0; form < 3; form++)
    {
        const char* name = form == 2 ? "a.glb" : "a.ply";
        size_t length = form == 0   ? print_ascii_ply(bytes) - 1 // the last newline may be missing
                        : form == 1 ? print_binary_ply(bytes, false, mesh_positions)
                                    : print_glb((uint8_t*)bytes);
        write_bytes(name, bytes, length);
        import_and_check_mesh(name);
        while (length-- > 0)
        {
            write_bytes(name, bytes, length);
            LsInput input = {0};
            if (ls_import(&input, find_path(name), &error) == LS_OK)
                fail_msg("%s, cut after %zu bytes, was taken", name, length);
            ls_input_destroy(&input);
        }
    }
}

// Random bytes in good files: any result, but within bounds and with a message.
static void test_damage(void** state)
{
    (void)state;
    uint32_t random = 1;
    unsigned refused = 0;
    for (int form = 0; form < 5; form++)
    {
        const char* const names[] = {"a.ply", "a.ply", "a.obj", "a.glb", "a.gltf"};
        char good[8192];
        size_t length = 0;
        switch (form)
        {
        case 0:
            length = print_ascii_ply(good);
            break;
        case 1:
            length = print_binary_ply(good, false, mesh_positions);
            break;
        case 2:
            length = print_obj(good);
            break;
        case 3:
            length = print_glb((uint8_t*)good);
            break;
        default:
            length = print_gltf(good, "a.bin",
                                ONE_NODE ",\"meshes\":[{\"primitives\":[{" POSITION "}]}]");
            break;
        }
        for (int i = 0; i < 1000; i++)
        {
            char bytes[8192];
            memcpy(bytes, good, length);
            for (int k = 0; k <= i % 3; k++)
            {
                random = random * 1664525u + 1013904223u;
                const size_t place = (random >> 8) % length;
                random = random * 1664525u + 1013904223u;
                bytes[place] = (char)(random >> 24);
            }
            write_bytes(names[form], bytes, length);
            LsInput input = {0};
            LsError error = {0};
            if (ls_import(&input, find_path(names[form]), &error) != LS_OK)
            {
                assert_non_null(strstr(error.text, names[form]));
                refused++;
            }
            for (uint32_t m = 0; m < input.mesh_count; m++)
                for (uint32_t t = 0;
                     error.result == LS_OK && t < 3 * input.meshes[m].triangle_count; t++)
                    assert_true(input.meshes[m].indices[t] < input.meshes[m].vertex_count);
            ls_input_destroy(&input);
        }
    }
    assert_true(refused > 500);
}

// The libraries keep quiet: all that a user reads is our one line.
static void test_silence(void** state)
{
    (void)state;
    fflush(stderr);
    const int saved = dup(STDERR_FILENO);
    FILE* caught = tmpfile();
    assert_true(saved >= 0 && caught);
    dup2(fileno(caught), STDERR_FILENO);
    write_text("a.ply", PLY_START PLY_XYZ "element face 1\nproperty list uchar int vertex_indices\n"
                                          "element edge 1\nproperty int a\nend_header\n" PLY_POINTS
                                          "3 0 0 1\n0\n");
    LsInput input = {0};
    LsError error;
    const LsResult result = ls_import(&input, find_path("a.ply"), &error);
    ls_input_destroy(&input);
    write_text("a.ply", PLY_START PLY_XYZ PLY_FACES "0 0 0\n");
    LsInput cut = {0};
    const LsResult cut_result = ls_import(&cut, find_path("a.ply"), &error);
    ls_input_destroy(&cut);
    fflush(stderr);
    dup2(saved, STDERR_FILENO);
    close(saved);
    assert_int_equal(lseek(fileno(caught), 0, SEEK_END), 0);
    fclose(caught);
    assert_int_equal(result, LS_OK);
    assert_int_equal(cut_result, LS_ERROR_INPUT_FORMAT);
}

// ---- The bundled scenes -------------------------------------------------------------------------

static void test_cornell(void** state)
{
    (void)state;
    LsInput input = {0};
    LsError error = {0};
    if (ls_import(&input, LS_SOURCE_DIR "/scenes/cornell.gltf", &error) != LS_OK)
        fail_msg("%s", error.text);
    assert_int_equal(input.mesh_count, 2);
    assert_int_equal(input.instance_count, 2);
    assert_int_equal(input.meshes[0].triangle_count, 10);
    assert_int_equal(input.meshes[1].triangle_count, 2);
    assert_int_equal(input.material_count, 4);
    assert_int_equal(input.materials[3].core.flags, LS_MATERIAL_EMISSIVE);
    assert_int_equal(input.meshes[1].materials[0], 3);
    for (uint32_t i = 0; i < input.meshes[1].vertex_count; i++)
        assert_true(input.meshes[1].positions[3 * i + 1] == 0.99f);

    // Every triangle faces the inside of the box: its plane has the middle of the room in front.
    for (uint32_t m = 0; m < 2; m++)
        for (uint32_t t = 0; t < input.meshes[m].triangle_count; t++)
        {
            const float* p[3];
            for (int k = 0; k < 3; k++)
                p[k] = &input.meshes[m].positions[3 * input.meshes[m].indices[3 * t + (uint32_t)k]];
            float volume = 0.0f; // of the three corners as seen from the origin
            for (int k = 0; k < 3; k++)
                volume += p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] -
                                     p[1][(k + 2) % 3] * p[2][(k + 1) % 3]);
            assert_true(volume < 0.0f);
        }
    assert_int_equal(input.camera_count, 1);
    assert_true(input.cameras[0].tan_half_y == 0.38f);
    assert_true(input.cameras[0].world_from_camera[2].w == 3.2f);
    ls_input_destroy(&input);
}

static void test_bunny(void** state)
{
    (void)state;
    LsInput input = {0};
    LsError error = {0};
    if (ls_import(&input, LS_SOURCE_DIR "/scenes/bunny.ply", &error) != LS_OK)
        fail_msg("%s", error.text);
    assert_int_equal(input.mesh_count, 1);
    const LsInputMesh* mesh = &input.meshes[0];
    assert_int_equal(mesh->triangle_count, 69666);
    assert_int_equal(mesh->vertex_count, 34835);
    float lower[3] = {INFINITY, INFINITY, INFINITY};
    float upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < 3 * mesh->vertex_count; i++)
    {
        lower[i % 3] = fminf(lower[i % 3], mesh->positions[i]);
        upper[i % 3] = fmaxf(upper[i % 3], mesh->positions[i]);
    }
    float longest = 0.0f;
    for (int i = 0; i < 3; i++)
        longest = fmaxf(longest, upper[i] - lower[i]);
    assert_true(fabsf(longest - 1.2f) < 1e-6f);
    assert_true(lower[1] == -1.0f);
    assert_true(fabsf(lower[0] + upper[0]) < 1e-6f && fabsf(lower[2] + upper[2]) < 1e-6f);
    ls_input_destroy(&input);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ply_ascii), cmocka_unit_test(test_ply_binary),
        cmocka_unit_test(test_obj),       cmocka_unit_test(test_gltf),
        cmocka_unit_test(test_glb),       cmocka_unit_test(test_together),
        cmocka_unit_test(test_no_file),   cmocka_unit_test(test_no_triangles),
        cmocka_unit_test(test_cut),       cmocka_unit_test(test_damage),
        cmocka_unit_test(test_silence),   cmocka_unit_test(test_cornell),
        cmocka_unit_test(test_bunny),
    };
    return cmocka_run_group_tests_name("import", tests, make_folder, remove_folder);
}
