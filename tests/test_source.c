// What a bake is known by: the files it reads, their hash with the options, and the depfile.

#define _XOPEN_SOURCE 700 // nftw

#include "choose.h"
#include "depfile.h"
#include "ls_format.h"
#include "ls_messages.h"
#include "source_files.h"
#include "source_hash.h"

#include <fcntl.h>
#include <ftw.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- Files in a folder of this run --------------------------------------------------------------

static char folder[] = "/tmp/ls-test-source-XXXXXX";

// Path of a file in the folder; 64 are alive at a time.
static const char* path_of(const char* name)
{
    static char paths[64][256];
    static unsigned next;
    char* path = paths[next++ % 64];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void write_bytes(const char* name, const void* bytes, size_t size)
{
    FILE* file = fopen(path_of(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void write_text(const char* name, const char* text)
{
    write_bytes(name, text, strlen(text));
}

static char* read_text(const char* name)
{
    static char text[4096];
    FILE* file = fopen(path_of(name), "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

static int remove_one(const char* path, const struct stat* status, int kind, struct FTW* place)
{
    (void)status;
    (void)kind;
    (void)place;
    return remove(path);
}

static int make_folder(void** state)
{
    (void)state;
    return mkdtemp(folder) && !mkdir(path_of("a"), 0777) && !mkdir(path_of("other"), 0777) ? 0 : -1;
}

static int remove_folder(void** state)
{
    (void)state;
    return nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS);
}

// ---- Scenes of several files --------------------------------------------------------------------

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
// A picture of one pixel.
#define PPM "P6\n1 1\n255\nabc"

// Two libraries, one of them with a name that has a space; each with maps, also one that has options.
static void write_obj(const char* in, bool is_far)
{
    char name[64];
    char* text = malloc(300000);
    assert_non_null(text);
    snprintf(name, sizeof name, "%s/scene.obj", in);
    strcpy(text, "mtllib my own.mtl\n# mtllib none.mtl\nusemtl red\n" TRIANGLE);
    for (int i = 0; is_far && i < 20000; i++)
        strcat(text + 5 * i, "# ...\n");
    strcat(text, "mtllib \\\n second.mtl third.mtl");
    write_text(name, text);
    free(text);
    snprintf(name, sizeof name, "%s/my own.mtl", in);
    write_text(name, "newmtl red\nKd 1 0 0\nMAP_KD -s 2 2 -clamp on red one.ppm\nmap_d holes.ppm\n"
                     "map_Ks unread.ppm\n");
    snprintf(name, sizeof name, "%s/second.mtl", in);
    write_text(name, "newmtl lamp\nmap_Ke lamp.ppm\nnorm bumps.ppm\n");
    static const char* const images[] = {"red one.ppm", "holes.ppm", "lamp.ppm", "bumps.ppm",
                                         "unread.ppm"};
    for (size_t i = 0; i < sizeof images / sizeof *images; i++)
    {
        snprintf(name, sizeof name, "%s/%s", in, images[i]);
        write_text(name, PPM);
    }
}

// In the order in which they are looked for.
static const char* const obj_files[] = {
    "scene.obj",  "my own.mtl", "holes.ppm", "red one.ppm", "second.mtl third.mtl",
    "second.mtl", "lamp.ppm",   "bumps.ppm", "third.mtl"};

#define GLTF                                                                                       \
    "{\"asset\":{\"version\":\"2.0\"},\"extras\":{\"buffers\":[{\"uri\":\"extra.bin\"}]},"         \
    "\"images\":[{\"extras\":{\"uri\":\"x.png\"},\"uri\":\"sub\\/a%20b.png\"},"                    \
    "{\"uri\":\"data:image/png;base64,AAAA\"},{\"uri\":\"http://a/b.png\"}],"                      \
    "\"nodes\":[{\"uri\":\"node.bin\",\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],"                  \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"                           \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"     \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"                                          \
    "\"buffers\" : [ { \"byteLength\" : 36, \"u\\u0072i\" : \"\\u0061.bin\", \"name\" : \"\\\\\" " \
    "} ]}"

static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

static void write_gltf(void)
{
    write_text("a/scene.gltf", GLTF);
    write_bytes("a/a.bin", corners, sizeof corners);
}

static void check_list(const LsBakeInput* how, const char* in, const char* const* names,
                       uint32_t count)
{
    LsSourceFiles files = {0};
    LsError error = {0};
    const LsBakeDesc desc = {.inputs = how, .input_count = 1};
    assert_int_equal(ls_source_files_list(&files, &desc, &error), LS_OK);
    char name[128];
    for (uint32_t i = 0; i < count && i < files.count; i++)
    {
        snprintf(name, sizeof name, "%s/%s", in, names[i]);
        assert_string_equal(files.list[i].path, path_of(name));
        assert_int_equal(files.list[i].is_there, access(path_of(name), F_OK) == 0);
    }
    assert_int_equal(files.count, count);
    ls_source_files_destroy(&files);
}

static void files_of_formats(void** state)
{
    (void)state;
    LsBakeInput how = {.path = path_of("a/scene.obj"), .materials = path_of("a/third.mtl")};
    for (int is_far = 0; is_far < 2; is_far++)
    {
        write_obj("a", is_far);
        // Once more as the file of materials, which is not there either.
        const char* names[sizeof obj_files / sizeof *obj_files + 1];
        memcpy(names, obj_files, sizeof obj_files);
        names[sizeof obj_files / sizeof *obj_files] = "third.mtl";
        check_list(&how, "a", names, sizeof names / sizeof *names);
    }
    write_gltf();
    static const char* const gltf_files[] = {"scene.gltf", "sub/a b.png", "a.bin"};
    how = (LsBakeInput){.path = path_of("a/scene.gltf"), .materials = " {}"};
    check_list(&how, "a", gltf_files, 3);

    // A GLB: the JSON is its first chunk, padded; what follows is not looked at.
    uint8_t glb[2048] = "glTF\2\0\0\0....";
    const uint32_t size = (uint32_t)(strlen(GLTF) + 3) & ~3u;
    memcpy(glb + 12, &size, 4);
    memcpy(glb + 16, "JSON", 4);
    memset(glb + 20, ' ', size);
    memcpy(glb + 20, GLTF, strlen(GLTF));
    strcpy((char*)glb + 20 + size, "\"images\":[{\"uri\":\"behind.png\"}]");
    write_bytes("a/scene.glb", glb, sizeof glb);
    static const char* const glb_files[] = {"scene.glb", "sub/a b.png", "a.bin"};
    how = (LsBakeInput){.path = path_of("a/scene.glb")};
    check_list(&how, "a", glb_files, 3);

    // Cut anywhere it lists what it can, and nothing else happens.
    for (size_t length = 0; length < strlen(GLTF); length++)
    {
        write_bytes("a/cut.gltf", GLTF, length);
        const LsBakeInput cut = {.path = path_of("a/cut.gltf")};
        const LsBakeDesc desc = {.inputs = &cut, .input_count = 1};
        LsSourceFiles files = {0};
        assert_int_equal(ls_source_files_list(&files, &desc, NULL), LS_OK);
        assert_in_range(files.count, 1, 3);
        ls_source_files_destroy(&files);
    }
}

// ---- The hash -----------------------------------------------------------------------------------

static void hash_desc(const LsBakeDesc* desc, uint8_t hash[16])
{
    LsSourceFiles files = {0};
    LsError error = {0};
    assert_int_equal(ls_source_files_list(&files, desc, &error), LS_OK);
    const LsPatchesChoice choice = ls_patches_choice(desc);
    assert_int_equal(ls_source_hash(&files, desc, &choice, 2, hash, &error), LS_OK);
    ls_source_files_destroy(&files);
}

static void hash_inputs(const LsBakeInput* inputs, uint32_t count, uint8_t hash[16])
{
    const LsBakeDesc desc = {.inputs = inputs, .input_count = count};
    hash_desc(&desc, hash);
}

// Every byte of every file, and whether it is there.
static void every_file_moves_the_hash(void** state)
{
    (void)state;
    write_obj("a", false);
    const LsBakeInput how = {.path = path_of("a/scene.obj")};
    uint8_t plain[16], hash[16];
    hash_inputs(&how, 1, plain);
    for (size_t i = 0; i < sizeof obj_files / sizeof *obj_files; i++)
    {
        char name[64];
        snprintf(name, sizeof name, "a/%s", obj_files[i]);
        if (access(path_of(name), F_OK))
        {
            write_text(name, "");
            hash_inputs(&how, 1, hash);
            assert_memory_not_equal(plain, hash, sizeof hash);
            unlink(path_of(name));
            continue;
        }
        FILE* file = fopen(path_of(name), "r+b");
        assert_non_null(file);
        assert_int_equal(fseek(file, -2, SEEK_END), 0);
        const int letter = fgetc(file);
        for (int round = 0; round < 2; round++)
        {
            assert_int_equal(fseek(file, -2, SEEK_END), 0);
            assert_int_not_equal(fputc(round == 0 ? letter ^ 1 : letter, file), EOF);
            assert_int_equal(fflush(file), 0);
            hash_inputs(&how, 1, hash);
            assert_int_equal(memcmp(plain, hash, sizeof hash) == 0, round == 1);
        }
        fclose(file);
    }
    unlink(path_of("a/holes.ppm"));
    hash_inputs(&how, 1, hash);
    assert_memory_not_equal(plain, hash, sizeof hash);
    // What no import reads moves nothing.
    write_obj("a", false);
    write_text("a/unread.ppm", "P6");
    hash_inputs(&how, 1, hash);
    assert_memory_equal(plain, hash, sizeof hash);
}

static void names_do_not_move_the_hash(void** state)
{
    (void)state;
    write_obj("a", false);
    write_obj("other", false);
    const LsBakeInput inputs[] = {{.path = path_of("a/scene.obj")},
                                  {.path = path_of("other/scene.obj")}};
    uint8_t hashes[2][16];
    hash_inputs(&inputs[0], 1, hashes[0]);
    hash_inputs(&inputs[1], 1, hashes[1]);
    assert_memory_equal(hashes[0], hashes[1], 16);

    // The order of inputs does, and so do materials, be they a file or words.
    write_text("first.stl", "solid a");
    write_text("second.stl", "solid b");
    write_text("words.json", "{\"ior\":2}");
    const LsBakeInput pairs[][2] = {
        {{.path = path_of("first.stl")}, {.path = path_of("second.stl")}},
        {{.path = path_of("second.stl")}, {.path = path_of("first.stl")}},
        {{.path = path_of("first.stl"), .materials = "{\"ior\":2}"},
         {.path = path_of("second.stl")}},
        {{.path = path_of("first.stl")},
         {.path = path_of("second.stl"), .materials = "{\"ior\":2}"}},
        {{.path = path_of("first.stl"), .materials = path_of("words.json")},
         {.path = path_of("second.stl")}}};
    enum
    {
        COUNT = sizeof pairs / sizeof *pairs
    };
    uint8_t hash[COUNT][16];
    for (int i = 0; i < COUNT; i++)
        hash_inputs(pairs[i], 2, hash[i]);
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < i; k++)
            assert_memory_not_equal(hash[i], hash[k], 16);
}

static void options_move_the_hash(void** state)
{
    (void)state;
    write_text("first.stl", "solid a");
    write_text("first.off", "solid a");
    const LsBakeInput how = {.path = path_of("first.stl")};
    const LsBakeInput hows[] = {{.path = path_of("first.off")},
                                {.path = how.path, .scene = 1},
                                {.path = how.path, .up = LS_UP_Z},
                                {.path = how.path, .scale = 2},
                                {.path = how.path, .flip = true},
                                {.path = how.path, .is_at = true},
                                {.path = how.path, .is_at = true, .at = {0, 0, 1}},
                                {.path = how.path, .size = 2},
                                {.path = how.path, .turn = 2}};
#define DESC .inputs = &how, .input_count = 1
    const LsBakeDesc moving[] = {{DESC, .grid = 9},
                                 {DESC, .patches = 2},
                                 {DESC, .choose_patches = true},
                                 {DESC, .choose_patches = true, .byte_price = 0.5},
                                 {DESC, .choose_patches = true, .patches = 4},
                                 {DESC, .choose_patches = true, .grid = 9},
                                 {DESC, .memory = 1000},
                                 {DESC, .memory = 1001},
                                 {DESC, .memory = 1000, .grid = 9},
                                 {DESC, .memory = 1000, .divide_above = 32},
                                 {DESC, .memory = 1000, .choose_patches = true, .patches = 4},
                                 {DESC, .scene_patches = 1},
                                 {DESC, .divide_above = 8},
                                 {DESC, .divide_above = 64},
                                 {DESC, .no_weld = true},
                                 {DESC, .keep_degenerate = true},
                                 {DESC, .normals = LS_NORMALS_NONE},
                                 {DESC, .normals = LS_NORMALS_SMOOTH, .smooth_angle = 30},
                                 {DESC, .normals = LS_NORMALS_SMOOTH, .smooth_angle = 31}};
    const LsBakeDesc still[] = {{DESC, .threads = 7},
                                {DESC, .force = true},
                                {DESC, .strict = true},
                                {DESC, .output = "x", .depfile = "y"},
                                {DESC, .max_memory = 1, .max_triangles = 1}};
    enum
    {
        HOWS = sizeof hows / sizeof *hows,
        MOVING = sizeof moving / sizeof *moving
    };
    uint8_t hashes[1 + HOWS + MOVING][16], hash[16];
    hash_inputs(&how, 1, hashes[0]);
    for (int i = 0; i < HOWS; i++)
        hash_inputs(&hows[i], 1, hashes[1 + i]);
    for (int i = 0; i < MOVING; i++)
        hash_desc(&moving[i], hashes[1 + HOWS + i]);
    for (int i = 0; i < 1 + HOWS + MOVING; i++)
        for (int k = 0; k < i; k++)
            assert_memory_not_equal(hashes[i], hashes[k], 16);
    for (size_t i = 0; i < sizeof still / sizeof *still; i++)
    {
        hash_desc(&still[i], hash);
        assert_memory_equal(hashes[0], hash, 16);
    }
    // Said or left to the default.
    const LsBakeInput said = {.path = how.path, .scale = 1};
    hash_inputs(&said, 1, hash);
    assert_memory_equal(hashes[0], hash, 16);
    const LsBakeDesc same[][2] = {
        {{DESC, .grid = 9}, {DESC, .grid = 9, .patches = 2, .divide_above = 32}},
        {{DESC, .choose_patches = true},
         {DESC, .choose_patches = true, .patches = 5, .byte_price = 0.001}},
        {{DESC, .memory = 1000}, {DESC, .memory = 1000, .choose_patches = true, .patches = 5}},
    };
    for (size_t i = 0; i < sizeof same / sizeof *same; i++)
    {
        hash_desc(&same[i][0], hashes[0]);
        hash_desc(&same[i][1], hash);
        assert_memory_equal(hashes[0], hash, 16);
    }
#undef DESC
}

// Several blocks, the last of a single byte; for any number of threads.
static void large_files(void** state)
{
    (void)state;
    const off_t size = (3 << 24) + 1;
    write_text("large.ply", "");
    assert_int_equal(truncate(path_of("large.ply"), size), 0);
    const LsBakeInput how = {.path = path_of("large.ply")};
    const LsBakeDesc desc = {.inputs = &how, .input_count = 1};
    LsSourceFiles files = {0};
    LsError error = {0};
    assert_int_equal(ls_source_files_list(&files, &desc, &error), LS_OK);
    const int file = open(how.path, O_WRONLY);
    assert_true(file >= 0);
    uint8_t plain[16], hash[16];
    for (uint32_t threads = 1; threads <= 5; threads++)
    {
        assert_int_equal(
            ls_source_hash(&files, &desc, &(LsPatchesChoice){.patches = 3}, threads, hash, &error),
            LS_OK);
        if (threads == 1)
            memcpy(plain, hash, 16);
        assert_memory_equal(plain, hash, 16);
    }
    static const off_t places[] = {0, 1 << 18, (1 << 24) - 1, 1 << 24, (3 << 24) - 1, 3 << 24};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
    {
        assert_int_equal(pwrite(file, "x", 1, places[i]), 1);
        assert_int_equal(
            ls_source_hash(&files, &desc, &(LsPatchesChoice){.patches = 3}, 2, hash, &error),
            LS_OK);
        assert_memory_not_equal(plain, hash, 16);
        assert_int_equal(pwrite(file, "\0", 1, places[i]), 1);
    }
    // Cut short after it was listed: as one that is not there, not a crash.
    assert_int_equal(ftruncate(file, 1 << 20), 0);
    assert_int_equal(
        ls_source_hash(&files, &desc, &(LsPatchesChoice){.patches = 3}, 2, hash, &error), LS_OK);
    assert_memory_not_equal(plain, hash, 16);
    close(file);
    ls_source_files_destroy(&files);
}

static void files_that_change_are_noticed(void** state)
{
    (void)state;
    write_obj("a", false);
    const LsBakeInput how = {.path = path_of("a/scene.obj")};
    const LsBakeDesc desc = {.inputs = &how, .input_count = 1};
    LsSourceFiles files = {0};
    LsError error = {0};
    assert_int_equal(ls_source_files_list(&files, &desc, &error), LS_OK);
    assert_int_equal(ls_source_files_check(&files, &error), LS_OK);
    unlink(path_of("a/lamp.ppm"));
    assert_int_equal(ls_source_files_check(&files, &error), LS_ERROR_FILE_READ);
    assert_int_equal(error.message, LS_MESSAGE_FILE_CHANGED);
    assert_non_null(strstr(error.text, "lamp.ppm"));
    ls_source_files_destroy(&files);

    assert_int_equal(ls_source_files_list(&files, &desc, &error), LS_OK);
    const struct timespec times[2] = {{.tv_nsec = UTIME_OMIT}, {.tv_sec = 12345}};
    assert_int_equal(utimensat(AT_FDCWD, path_of("a/second.mtl"), times, 0), 0);
    assert_int_equal(ls_source_files_check(&files, &error), LS_ERROR_FILE_READ);
    assert_non_null(strstr(error.text, "second.mtl"));
    ls_source_files_destroy(&files);
}

// ---- Bakes --------------------------------------------------------------------------------------

static bool is_up_to_date(const LsBakeDesc* desc)
{
    LsBakeReport report = {0};
    LsError error = {0};
    assert_int_equal(ls_bake_run(desc, &report, &error), LS_OK);
    const bool answer = report.up_to_date;
    assert_true(report.file_bytes > 0);
    ls_bake_report_destroy(&report);
    return answer;
}

static void bakes_are_known_by_their_files(void** state)
{
    (void)state;
    write_obj("a", false);
    const LsBakeInput how = {.path = path_of("a/scene.obj")};
    const char* output = path_of("out.lspace");
    LsBakeDesc desc = {.inputs = &how, .input_count = 1, .output = output};
    assert_false(is_up_to_date(&desc));
    struct stat before, after;
    assert_int_equal(stat(output, &before), 0);
    assert_true(is_up_to_date(&desc));
    assert_int_equal(stat(output, &after), 0);
    assert_int_equal(before.st_ino, after.st_ino);
    assert_int_equal(before.st_mtim.tv_nsec, after.st_mtim.tv_nsec);
    write_text("a/bumps.ppm", "P6\n1 1\n255\nabd");
    assert_false(is_up_to_date(&desc));
    assert_true(is_up_to_date(&desc));
    desc.grid = 5;
    assert_false(is_up_to_date(&desc));
    desc.force = true;
    assert_false(is_up_to_date(&desc));
    desc.force = false;
    assert_true(is_up_to_date(&desc));
    // A file that is gone is the import's to judge: a buffer is missed, a texture warned of.
    unlink(path_of("a/bumps.ppm"));
    assert_false(is_up_to_date(&desc));
    write_gltf();
    const LsBakeInput gltf = {.path = path_of("a/scene.gltf")};
    desc.inputs = &gltf;
    unlink(path_of("a/a.bin"));
    LsError error = {0};
    assert_int_equal(ls_bake_run(&desc, NULL, &error) == LS_OK, false);
    assert_int_equal(error.message, LS_MESSAGE_GLTF_BUFFER);
}

// ---- The depfile --------------------------------------------------------------------------------

static void depfiles(void** state)
{
    (void)state;
    write_obj("a", false);
    write_text("a/words.json", "{}");
    const LsBakeInput inputs[] = {
        {.path = path_of("a/scene.obj"), .materials = path_of("a/words.json")},
        {.path = path_of("a/scene.obj")}};
    LsBakeDesc desc = {.inputs = inputs,
                       .input_count = 2,
                       .output = path_of("out.lspace"),
                       .depfile = path_of("out.d")};
    char expected[4096];
    snprintf(expected, sizeof expected,
             "%1$s/out.lspace: \\\n %1$s/a/scene.obj \\\n %1$s/a/my\\ own.mtl \\\n "
             "%1$s/a/holes.ppm \\\n %1$s/a/red\\ one.ppm \\\n %1$s/a/second.mtl \\\n "
             "%1$s/a/lamp.ppm \\\n %1$s/a/bumps.ppm \\\n %1$s/a/words.json\n",
             folder);
    assert_false(is_up_to_date(&desc));
    assert_string_equal(read_text("out.d"), expected);
    unlink(desc.depfile);
    assert_true(is_up_to_date(&desc));
    assert_string_equal(read_text("out.d"), expected);

    // Not of a bake that fails.
    unlink(desc.depfile);
    desc.max_triangles = 1;
    desc.force = true;
    assert_int_equal(ls_bake_run(&desc, NULL, NULL), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(access(desc.depfile, F_OK), -1);
}

static void names_in_depfiles(void** state)
{
    (void)state;
    char name[] = "x";
    LsSourceFile list[] = {{.path = name, .is_there = true}};
    const LsSourceFiles files = {.list = list, .count = 1};
    static const struct
    {
        const char* name;
        const char* escaped;
    } names[] = {{"a b", "a\\ b"},
                 {"a#b", "a\\#b"},
                 {"a$b", "a$$b"},
                 {"a\\b", "a\\b"},
                 {"a\\ b", "a\\\\\\ b"},
                 {"a\\\\ b", "a\\\\\\\\\\ b"},
                 {"caf\303\251", "caf\303\251"}};
    LsError error = {0};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    {
        const LsBakeDesc desc = {.output = names[i].name, .depfile = path_of("out.d")};
        char expected[128];
        snprintf(expected, sizeof expected, "%s: \\\n x\n", names[i].escaped);
        assert_int_equal(ls_depfile_write(&files, &desc, &error), LS_OK);
        assert_string_equal(read_text("out.d"), expected);
    }
    unlink(path_of("out.d"));
    const LsBakeDesc desc = {.output = "a\nb", .depfile = path_of("out.d")};
    assert_int_equal(ls_depfile_write(&files, &desc, &error), LS_ERROR_OUTPUT);
    assert_int_equal(error.message, LS_MESSAGE_OUTPUT_UNWRITABLE);
    assert_int_equal(access(path_of("out.d"), F_OK), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_of_formats),
        cmocka_unit_test(every_file_moves_the_hash),
        cmocka_unit_test(names_do_not_move_the_hash),
        cmocka_unit_test(options_move_the_hash),
        cmocka_unit_test(large_files),
        cmocka_unit_test(files_that_change_are_noticed),
        cmocka_unit_test(bakes_are_known_by_their_files),
        cmocka_unit_test(depfiles),
        cmocka_unit_test(names_in_depfiles),
    };
    return cmocka_run_group_tests_name("source", tests, make_folder, remove_folder);
}
