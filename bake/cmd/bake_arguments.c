// bake_arguments.c - reads lsbake's command line.

#include "bake_arguments.h"

#include "ls_layout.h"
#include "ls_messages.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

const char ls_bake_help[] =
    "lsbake - bakes scenes into one .lspace file\n"
    "\n"
    "usage: lsbake SCENE [its options] [SCENE [its options]]... -o OUT.lspace [options]\n"
    "\n"
    "SCENE is a .gltf, .glb, .obj, .ply, .off or .stl file; several are put together, their\n"
    "objects numbered in order. Example:\n"
    "\n"
    "  lsbake box.gltf bunny.ply --size 1.2 --turn 30 --at 0,-1,0 -o scene.lspace\n"
    "\n"
    "A value follows its option, or stands behind it and \"=\": --grid 64, --grid=64. Of an "
    "option\n"
    "given twice the last counts.\n"
    "\n"
    "Options of the scene file before them, done in this order:\n"
    "      --scene N          of glTF: the scene to take, from 0 (default: the file's own choice)\n"
    "      --material M       override its materials: JSON that begins with {, or a file of it\n"
    "      --up y|z|x         the axis of the file that points up (default y)\n"
    "      --scale F          multiply its coordinates\n"
    "      --flip             turn the corners of its faces, and its normals, round\n"
    "      --size L           scale it until the longest side of its box is L\n"
    "      --turn DEGREES     about the vertical axis, counter-clockwise seen from above\n"
    "      --at X,Y,Z         put the middle of its box's bottom there (default: where it is)\n"
    "\n"
    "Meshes:\n"
    "      --no-weld          keep vertices of equal position apart\n"
    "      --keep-degenerate  keep faces without area; no ray hits them\n"
    "      --normals WHAT     shading normals: input (default), none, or an angle in degrees up\n"
    "                         to which neighbouring faces are smoothed\n"
    "\n"
    "Line Space:\n"
    "                         Without any of these options, or with --memory, cells, what is\n"
    "                         divided and N are chosen by expected work; with --grid alone N is\n"
    "                         2, with --patches alone cells are 0.3 times the root of an object's\n"
    "                         triangle count.\n"
    "      --memory S         at most so many bytes on the device for tracing, or with K, M or G\n"
    "                         behind (powers of 1024); normals, images and the like come on top\n"
    "                         (default: as much as pays)\n"
    "      --grid G           cells along the longest side of each object's box, 1 to 4096\n"
    "      --patches N        N, patches along a voxel's edge, 1 to 16; auto: chosen for each\n"
    "                         voxel, up to 5; auto:N up to N, 1 to 8. Beside --memory only auto\n"
    "      --byte-price F     with --patches auto, without --memory: what a byte of a table must\n"
    "                         save, in triangle tests of a ray in the voxel (default 0.001)\n"
    "      --divide-above T   divide all voxels of more than T triangles again, into 4 x 4 x 4, 3\n"
    "                         to 1000000; others of more than 32 have a BVH (default: 32, and\n"
    "                         where cells are chosen only if that is worth its bytes)\n"
    "      --scene-shafts M   also shafts across each whole grid, between M x M patches a face, 1\n"
    "                         to 32, so that rays pass long empty stretches in one step\n"
    "\n"
    "The bake:\n"
    "  -o, --output FILE      where to write (required)\n"
    "      --depfile FILE     write there what was read, as a rule of make (CMake, Ninja)\n"
    "  -f, --force            bake although the output is up to date\n"
    "      --strict           take warnings for errors\n"
    "      --threads T        threads; the result does not depend on it (default: all processors)\n"
    "      --max-memory S     of this process, in bytes or with K, M or G behind (powers of 1024)\n"
    "      --max-triangles N  of all scenes together\n"
    "      --report json      print the report as JSON on standard output\n"
    "  -q, --quiet            print nothing but errors\n"
    "  -h, --help             this text\n"
    "      --version          version of program and format\n"
    "\n"
    "exit codes: 0 done, 1 usage, 2 input, 3 output, 6 out of memory\n";

// ---- Values -------------------------------------------------------------------------------------

typedef struct Option Option;

// Reads `text` into `target`; false if it cannot be.
typedef bool ReadValue(const Option* option, const char* text, void* target);

typedef enum Scope
{
    SCOPE_PROGRAM, // a field of BakeArguments
    SCOPE_BAKE,    // of its desc
    SCOPE_INPUT,   // of the input before
} Scope;

struct Option
{
    const char* name;
    const char* letter;
    Scope scope;
    size_t offset;
    ReadValue* read;     // NULL: no value, sets a bool
    const char* takes;   // for the error: "--grid takes ..."
    LsMessage message;   // of that error
    double lower, upper; // of numbers, inclusive
};

static bool read_number(const char* text, const char** end, double* out)
{
    // strtod takes more: blanks, hexadecimal, infinity and names of no number.
    if (strspn(text, "+-.0123456789") == 0 || strpbrk(text, "xXnN"))
        return false;
    char* stop = NULL;
    *out = strtod(text, &stop);
    *end = stop;
    return stop != text && isfinite(*out);
}

static bool read_double(const Option* option, const char* text, void* target)
{
    const char* end = NULL;
    double* number = target;
    return read_number(text, &end, number) && *end == '\0' && *number >= option->lower &&
           *number <= option->upper;
}

static bool read_whole(const char* text, const char** end, uint64_t* out)
{
    char* stop = NULL;
    errno = 0;
    *out = text[0] >= '0' && text[0] <= '9' ? strtoull(text, &stop, 10) : 0;
    *end = stop;
    return stop && !errno;
}

static bool read_uint32(const Option* option, const char* text, void* target)
{
    const char* end = NULL;
    uint64_t number = 0;
    if (!read_whole(text, &end, &number) || *end || (double)number < option->lower ||
        (double)number > option->upper)
        return false;
    *(uint32_t*)target = (uint32_t)number;
    return true;
}

static bool read_count(const Option* option, const char* text, void* target)
{
    (void)option;
    const char* end = NULL;
    return read_whole(text, &end, target) && *end == '\0' && *(uint64_t*)target > 0;
}

static bool read_scene(const Option* option, const char* text, void* target)
{
    if (!read_uint32(option, text, target))
        return false;
    *(uint32_t*)target += 1;
    return true;
}

// Bytes, with a suffix or without.
static bool read_bytes(const Option* option, const char* text, void* target)
{
    (void)option;
    static const char suffixes[] = "KMG";
    uint64_t* bytes = target;
    const char* end = NULL;
    if (!read_whole(text, &end, bytes) || *bytes == 0)
        return false;
    const char* suffix = *end ? strchr(suffixes, *end) : NULL;
    const unsigned shift = suffix ? 10 * (unsigned)(suffix - suffixes + 1) : 0;
    if (*bytes > UINT64_MAX >> shift || (suffix ? end[1] : end[0]))
        return false;
    *bytes <<= shift;
    return true;
}

static bool read_text(const Option* option, const char* text, void* target)
{
    (void)option;
    *(const char**)target = text;
    return text[0] != '\0';
}

static bool read_up(const Option* option, const char* text, void* target)
{
    (void)option;
    LsUpAxis* up = target;
    *up = text[0] == 'x' ? LS_UP_X : text[0] == 'z' ? LS_UP_Z : LS_UP_Y;
    return strlen(text) == 1 && strchr("xyz", text[0]);
}

static bool read_at(const Option* option, const char* text, void* target)
{
    LsBakeInput* input = target;
    input->is_at = true;
    for (int i = 0; i < 3; i++)
    {
        const char* end = NULL;
        if (!read_number(text, &end, &input->at[i]) || *end != (i < 2 ? ',' : '\0') ||
            input->at[i] < option->lower || input->at[i] > option->upper)
            return false;
        text = end + 1;
    }
    return true;
}

static bool read_normals(const Option* option, const char* text, void* target)
{
    LsBakeDesc* desc = target;
    desc->normals = !strcmp(text, "input")  ? LS_NORMALS_INPUT
                    : !strcmp(text, "none") ? LS_NORMALS_NONE
                                            : LS_NORMALS_SMOOTH;
    return desc->normals != LS_NORMALS_SMOOTH || read_double(option, text, &desc->smooth_angle);
}

static bool read_patches(const Option* option, const char* text, void* target)
{
    LsBakeDesc* desc = target;
    desc->patches = 0;
    desc->choose_patches = strncmp(text, "auto", 4) == 0;
    if (!desc->choose_patches)
        return read_uint32(option, text, &desc->patches);
    return text[4] == '\0' || (text[4] == ':' && read_uint32(option, text + 5, &desc->patches) &&
                               desc->patches <= LS_MAX_CHOSEN_PATCHES);
}

static bool read_report(const Option* option, const char* text, void* target)
{
    (void)option;
    *(bool*)target = !strcmp(text, "json");
    return *(bool*)target;
}

// ---- Options ------------------------------------------------------------------------------------

#define PROGRAM(field) SCOPE_PROGRAM, offsetof(BakeArguments, field)
#define BAKE(field) SCOPE_BAKE, offsetof(LsBakeDesc, field)
#define INPUT(field) SCOPE_INPUT, offsetof(LsBakeInput, field)
#define FLAG NULL, NULL, LS_MESSAGE_USAGE_OPTION_UNKNOWN, 0, 0
#define NUMBER(takes) takes, LS_MESSAGE_USAGE_NUMBER
#define CHOICE(takes) takes, LS_MESSAGE_USAGE_CHOICE, 0, 0
#define FILE_NAME "a file name", LS_MESSAGE_USAGE_OPTION_VALUE, 0, 0

// clang-format off: a table
static const Option options[] = {
    {"--scene", NULL, INPUT(scene), read_scene, NUMBER("a whole number from 0 to 1000000"), 0, 1e6},
    {"--material", NULL, INPUT(materials), read_text, "JSON or the name of a file of it",
     LS_MESSAGE_USAGE_OPTION_VALUE, 0, 0},
    {"--up", NULL, INPUT(up), read_up, CHOICE("y, z or x")},
    {"--scale", NULL, INPUT(scale), read_double, NUMBER("a number from 1e-30 to 1e30"), 1e-30,
     1e30},
    {"--flip", NULL, INPUT(flip), FLAG},
    {"--size", NULL, INPUT(size), read_double, NUMBER("a number from 1e-30 to 1e30"), 1e-30, 1e30},
    {"--turn", NULL, INPUT(turn), read_double, NUMBER("degrees from -360 to 360"), -360, 360},
    {"--at", NULL, SCOPE_INPUT, 0, read_at, NUMBER("three numbers X,Y,Z from -1e30 to 1e30"), -1e30,
     1e30},
    {"--no-weld", NULL, BAKE(no_weld), FLAG},
    {"--keep-degenerate", NULL, BAKE(keep_degenerate), FLAG},
    {"--normals", NULL, SCOPE_BAKE, 0, read_normals, "input, none or an angle from 0 to 180",
     LS_MESSAGE_USAGE_CHOICE, 0, 180},
    {"--memory", NULL, BAKE(memory), read_bytes,
     NUMBER("a whole number of bytes above 0, with K, M or G behind or none"), 0, 0},
    {"--grid", NULL, BAKE(grid), read_uint32, NUMBER("a whole number from 1 to 4096"), 1,
     LS_MAX_CELLS},
    {"--patches", NULL, SCOPE_BAKE, 0, read_patches,
     NUMBER("a whole number from 1 to 16, auto, or auto: and one from 1 to 8"), 1, LS_MAX_PATCHES},
    {"--byte-price", NULL, BAKE(byte_price), read_double, NUMBER("a number from 1e-9 to 1e9"), 1e-9,
     1e9},
    {"--divide-above", NULL, BAKE(divide_above), read_uint32,
     NUMBER("a whole number from 3 to 1000000"), LS_MIN_DIVIDE_ABOVE, LS_MAX_DIVIDE_ABOVE},
    {"--scene-shafts", NULL, BAKE(scene_patches), read_uint32,
     NUMBER("a whole number from 1 to 32"), 1, LS_MAX_SCENE_PATCHES},
    {"--output", "-o", BAKE(output), read_text, FILE_NAME},
    {"--depfile", NULL, BAKE(depfile), read_text, FILE_NAME},
    {"--force", "-f", BAKE(force), FLAG},
    {"--strict", NULL, BAKE(strict), FLAG},
    {"--threads", NULL, BAKE(threads), read_uint32, NUMBER("a whole number from 1 to 1024"), 1,
     1024},
    {"--max-memory", NULL, BAKE(max_memory), read_bytes,
     NUMBER("a whole number of bytes above 0, with K, M or G behind or none"), 0, 0},
    {"--max-triangles", NULL, BAKE(max_triangles), read_count, NUMBER("a whole number above 0"), 0,
     0},
    {"--report", NULL, PROGRAM(json), read_report, CHOICE("json")},
    {"--quiet", "-q", PROGRAM(quiet), FLAG},
    {"--help", "-h", PROGRAM(help), FLAG},
    {"--version", NULL, PROGRAM(version), FLAG},
};
// clang-format on

// By its name, which may end in "=" and a value, or by its letter.
static const Option* find_option(const char* word)
{
    const size_t length = strcspn(word, "=");
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if ((strlen(options[i].name) == length && !strncmp(word, options[i].name, length)) ||
            (options[i].letter && !strcmp(word, options[i].letter)))
            return &options[i];
    return NULL;
}

// The field of an option; NULL where there is no input yet.
static void* find_target(BakeArguments* arguments, const Option* option)
{
    switch (option->scope)
    {
    case SCOPE_PROGRAM:
        return (char*)arguments + option->offset;
    case SCOPE_BAKE:
        return (char*)&arguments->desc + option->offset;
    case SCOPE_INPUT:
        break;
    }
    const uint32_t count = arguments->desc.input_count;
    return count ? (char*)&arguments->inputs[count - 1] + option->offset : NULL;
}

static LsResult take_option(BakeArguments* arguments, const Option* option, const char* word,
                            const char* value, LsError* error)
{
    void* target = find_target(arguments, option);
    if (!target)
        return ls_error_set(error, LS_MESSAGE_USAGE_OPTION_PLACE,
                            "%s belongs to a scene file; write it behind one", word);
    if (!option->read && value)
        return ls_error_set(error, LS_MESSAGE_USAGE_OPTION_VALUE, "%s takes no value; leave it out",
                            option->name);
    if (!option->read)
    {
        *(bool*)target = true;
        return LS_OK;
    }
    if (!value)
        return ls_error_set(error, LS_MESSAGE_USAGE_OPTION_VALUE, "%s takes %s, and none follows",
                            word, option->takes);
    return option->read(option, value, target)
               ? LS_OK
               : ls_error_set(error, (int)option->message, "%s takes %s, not '%s'", option->name,
                              option->takes, value);
}

static LsResult parse_words(BakeArguments* arguments, int argc, char** argv, LsError* error)
{
    bool options_end = false;
    LsResult result = LS_OK;
    for (int i = 1; i < argc && result == LS_OK; i++)
    {
        const char* word = argv[i];
        if (options_end || word[0] != '-' || word[1] == '\0')
        {
            arguments->inputs[arguments->desc.input_count++].path = word;
            continue;
        }
        options_end = !strcmp(word, "--");
        if (options_end)
            continue;
        const Option* option = find_option(word);
        if (!option)
            return ls_error_set(error, LS_MESSAGE_USAGE_OPTION_UNKNOWN,
                                "unknown option '%s'; lsbake --help lists all", word);
        const char* value = strchr(word, '=');
        if (value)
            value++;
        else if (option->read && i + 1 < argc)
            value = argv[++i];
        result = take_option(arguments, option, word, value, error);
        if (arguments->help || arguments->version)
            break;
    }
    return result;
}

LsResult ls_bake_arguments_parse(BakeArguments* arguments, int argc, char** argv, LsError* error)
{
    *arguments = (BakeArguments){.inputs = calloc((size_t)argc + 1, sizeof(LsBakeInput))};
    if (!arguments->inputs)
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory");
    arguments->desc.inputs = arguments->inputs;
    const LsResult result = parse_words(arguments, argc, argv, error);
    if (result != LS_OK || arguments->help || arguments->version)
        return result;
    if (!arguments->desc.input_count)
        return ls_error_set(error, LS_MESSAGE_USAGE_NO_SCENE,
                            "no scene given; lsbake --help shows how");
    if (!arguments->desc.output)
        return ls_error_set(error, LS_MESSAGE_USAGE_NO_OUTPUT,
                            "no output given; name it with -o OUT.lspace");
    return LS_OK;
}

void ls_bake_arguments_destroy(BakeArguments* arguments)
{
    free(arguments->inputs);
    *arguments = (BakeArguments){0};
}
