// lsinfo.c - prints what an .lspace file holds, and checks it against every rule of SPEC.md.

#include "lsinfo_summary.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage_text[] =
    "usage: lsinfo [--json] FILE\n"
    "       lsinfo check [--full] FILE\n"
    "\n"
    "Prints header, chunks and scene numbers of an .lspace file, and what was left out of it and "
    "why.\n"
    "check verifies the file against the rules of the format (format/SPEC.md) and names the first "
    "that\n"
    "is broken.\n"
    "\n"
    "  --json     print JSON\n"
    "  --full     also verify the hash of every chunk and that padding is zero\n"
    "  --help     print this\n"
    "  --version  print the versions of program and format\n"
    "\n"
    "exit codes: 0 all is well; 1 usage; 2 the file is missing or unreadable; 3 the output cannot "
    "be\n"
    "written; 4 the file is foreign, cut, damaged or breaks a rule; 6 out of memory\n";

typedef struct Options
{
    const char* path;
    bool check, full, json, help, version;
} Options;

// ---- Words --------------------------------------------------------------------------------------

static const char* const voxel_kinds[4] = {"list", "masks", "subgrid", "bvh"};
static const char* const lamp_kinds[3] = {"point", "spot", "directional"};

typedef struct FeatureName
{
    uint64_t bit;
    const char* name;
} FeatureName;

static const FeatureName required_names[] = {
    {LS_FEATURE_TOP_LEVEL, "top-level"},
    {LS_FEATURE_LISTS, "lists"},
    {LS_FEATURE_GRIDS, "grids"},
    {LS_FEATURE_SUBGRIDS, "sub-grids"},
    {LS_FEATURE_LEAF_BVHS, "leaf-bvhs"},
    {LS_FEATURE_MASKS, "masks"},
    {LS_FEATURE_EXACT_MASKS, "exact-masks"},
    {LS_FEATURE_SCENE_SHAFTS, "scene-shafts"},
    {0, NULL},
};

static const FeatureName optional_names[] = {
    {LS_FEATURE_LIGHTS, "lights"},         {LS_FEATURE_CAMERAS, "cameras"},
    {LS_FEATURE_NODES, "nodes"},           {LS_FEATURE_SURFACES, "surfaces"},
    {LS_FEATURE_ATTRIBUTES, "attributes"}, {LS_FEATURE_LAMPS, "lamps"},
    {LS_FEATURE_ANIMATIONS, "animations"}, {0, NULL},
};

static void format_hex(const uint8_t bytes[16], char text[33])
{
    for (int i = 0; i < 16; ++i)
    {
        snprintf(text + 2 * i, 3, "%02x", bytes[i]);
    }
}

static double percent(uint64_t part, uint64_t whole)
{
    return whole == 0 ? 0 : 100.0 * (double)part / (double)whole;
}

// ---- Text ---------------------------------------------------------------------------------------

static void print_features(const char* title, uint64_t features, const FeatureName* names)
{
    printf("%-18s", title);
    for (; names->name != NULL; ++names)
    {
        if ((features & names->bit) != 0)
        {
            printf(" %s", names->name);
        }
    }
    printf("\n");
}

static void print_header(const LsFile* file, const char* path)
{
    const LsHeader* header = file->header;
    char source[33];
    format_hex(header->source_hash, source);
    printf("%s: .lspace %u.%u, for readers from %u.%u on, %" PRIu64 " bytes\n\n", path,
           header->version_major, header->version_minor, header->version_major,
           header->reader_minor, header->file_bytes);
    print_features("required features", header->required_features, required_names);
    print_features("optional features", header->optional_features, optional_names);
    printf("%-18s (%g, %g, %g) to (%g, %g, %g)\n", "world bounds", (double)header->lower[0],
           (double)header->lower[1], (double)header->lower[2], (double)header->upper[0],
           (double)header->upper[1], (double)header->upper[2]);
    printf("%-18s %g\n", "transform bound", (double)header->transform_bound);
    printf("%-18s %s\n\n", "source hash", source);
}

static void print_chunks(const LsFile* file, const LsSummary* summary)
{
    printf("%-12s %12s %6s %14s %8s\n", "chunk", "records", "each", "bytes", "share");
    for (uint32_t i = 0; i < file->header->chunk_count; ++i)
    {
        const LsEntry* entry = &file->entries[i];
        char name[16];
        snprintf(name, sizeof(name), "%02x%02x%02x%02x", entry->type[0], entry->type[1],
                 entry->type[2], entry->type[3]);
        for (int chunk = 0; chunk < LS_CHUNK_COUNT; ++chunk)
        {
            if (file->chunk_entries[chunk] == entry)
            {
                snprintf(name, sizeof(name), "%s", ls_chunk_info((LsChunk)chunk).name);
            }
        }
        printf("%-12s %12" PRIu64 " %6u %14" PRIu64 " %7.2f%%\n", name, entry->element_count,
               entry->stride, entry->stored_bytes, percent(entry->stored_bytes, file->size));
    }
    printf("%-12s %12s %6s %14" PRIu64 " %7.2f%%\n\n", "padding", "", "", summary->padding_bytes,
           percent(summary->padding_bytes, file->size));
}

static void print_scene(const LsFile* file, const LsSummary* summary)
{
    const uint64_t voxels = ls_file_count(file, LS_CHUNK_VOXELS);
    printf("%-18s %u: %u list, %u grid\n", "objects", ls_file_count(file, LS_CHUNK_OBJECTS),
           summary->list_object_count, summary->grid_object_count);
    printf("%-18s %u\n", "instances", ls_file_count(file, LS_CHUNK_INSTANCES));
    printf("%-18s %" PRIu64 " of %" PRIu64 " faces, %" PRIu64 " with all instances\n", "triangles",
           summary->triangle_count, summary->face_count, summary->instanced_triangle_count);
    printf("%-18s %u\n", "materials", ls_file_count(file, LS_CHUNK_MATERIALS));
    printf("%-18s %u\n", "lights", ls_file_count(file, LS_CHUNK_LIGHTS));
    printf("%-18s %u\n", "cameras", ls_file_count(file, LS_CHUNK_CAMERAS));
    printf("%-18s %" PRIu64 " in %u stored blocks\n", "cells", summary->cell_count,
           ls_file_count(file, LS_CHUNK_CELL_BLOCKS));
    printf("%-18s %" PRIu64, "voxels", voxels);
    for (int kind = 0; kind < 4; ++kind)
    {
        printf("%s %" PRIu64 " %s", kind == 0 ? ":" : ",", summary->voxel_kind_count[kind],
               voxel_kinds[kind]);
    }
    printf("\n%-18s %u, at most %u deep\n", "sub-grids", ls_file_count(file, LS_CHUNK_SUBGRIDS),
           file->header->depth);
    printf("%-18s %u to %u per side\n", "patches", summary->patches_least, summary->patches_most);
    printf("%-18s %" PRIu64 ", %.2f%% filled\n", "shafts", summary->shaft_count,
           percent(summary->filled_shaft_count, summary->shaft_count));
    if (summary->scene_shaft_count > 0)
    {
        printf("%-18s %" PRIu64 ", %.2f%% filled\n", "scene shafts", summary->scene_shaft_count,
               percent(summary->filled_scene_shaft_count, summary->scene_shaft_count));
    }
}

static void print_looks(const LsFile* file, const LsSummary* summary)
{
    printf("%-18s %u, %u with holes\n", "surfaces", ls_file_count(file, LS_CHUNK_SURFACES),
           summary->masked_surface_count);
    printf("%-18s %u of %u images, %u pixels\n", "textures", ls_file_count(file, LS_CHUNK_TEXTURES),
           ls_file_count(file, LS_CHUNK_IMAGES), ls_file_count(file, LS_CHUNK_PIXELS));
    printf("%-18s %u objects with normals, %u and %u with texture coordinates 0 and 1, %u with "
           "colours\n",
           "attributes", summary->normal_object_count, summary->texcoord_object_count[0],
           summary->texcoord_object_count[1], summary->color_object_count);
    printf("%-18s %u, %" PRIu64 " of them the face's\n", "corner normals",
           ls_file_count(file, LS_CHUNK_NORMALS), summary->bare_corner_count);
    printf("%-18s %u", "lamps", ls_file_count(file, LS_CHUNK_LAMPS));
    for (int kind = 0; kind < 3; ++kind)
    {
        printf("%s %u %s", kind == 0 ? ":" : ",", summary->lamp_kind_count[kind], lamp_kinds[kind]);
    }
    printf("\n%-18s %u of %u nodes, %u keys, at most %g s\n\n", "animations",
           ls_file_count(file, LS_CHUNK_ANIMATIONS), summary->animated_node_count,
           ls_file_count(file, LS_CHUNK_KEYS), summary->longest_animation);
}

static void print_absent(const LsFile* file)
{
    printf("left out\n");
    bool any = false;
    for (int chunk = 0; chunk < LS_CHUNK_COUNT; ++chunk)
    {
        if (file->chunk_entries[chunk] == NULL)
        {
            printf("  %s\n", ls_explain_absence(file, (LsChunk)chunk));
            any = true;
        }
    }
    printf("%s", any ? "" : "  nothing: the scene uses every chunk\n");
}

// ---- JSON ---------------------------------------------------------------------------------------

static void add_features(cJSON* parent, const char* key, uint64_t features,
                         const FeatureName* names)
{
    cJSON* array = cJSON_AddArrayToObject(parent, key);
    for (; names->name != NULL; ++names)
    {
        if ((features & names->bit) != 0)
        {
            cJSON_AddItemToArray(array, cJSON_CreateString(names->name));
        }
    }
}

static void add_header(cJSON* root, const LsFile* file)
{
    const LsHeader* header = file->header;
    char version[32], source[33];
    snprintf(version, sizeof(version), "%u.%u", header->version_major, header->version_minor);
    format_hex(header->source_hash, source);
    cJSON_AddStringToObject(root, "format", version);
    snprintf(version, sizeof(version), "%u.%u", header->version_major, header->reader_minor);
    cJSON_AddStringToObject(root, "reader_format", version);
    cJSON_AddNumberToObject(root, "file_bytes", (double)header->file_bytes);
    add_features(root, "required_features", header->required_features, required_names);
    add_features(root, "optional_features", header->optional_features, optional_names);
    cJSON_AddItemToObject(root, "lower", cJSON_CreateFloatArray(header->lower, 3));
    cJSON_AddItemToObject(root, "upper", cJSON_CreateFloatArray(header->upper, 3));
    cJSON_AddNumberToObject(root, "transform_bound", (double)header->transform_bound);
    cJSON_AddStringToObject(root, "source_hash", source);
}

static void add_chunks(cJSON* root, const LsFile* file)
{
    cJSON* chunks = cJSON_AddArrayToObject(root, "chunks");
    for (int chunk = 0; chunk < LS_CHUNK_COUNT; ++chunk)
    {
        const LsEntry* entry = file->chunk_entries[chunk];
        if (entry == NULL)
        {
            continue;
        }
        cJSON* item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", ls_chunk_info((LsChunk)chunk).name);
        cJSON_AddNumberToObject(item, "records", (double)entry->element_count);
        cJSON_AddNumberToObject(item, "stride", entry->stride);
        cJSON_AddNumberToObject(item, "bytes", (double)entry->stored_bytes);
        cJSON_AddNumberToObject(item, "percent", percent(entry->stored_bytes, file->size));
        cJSON_AddItemToArray(chunks, item);
    }
}

static void add_scene(cJSON* root, const LsFile* file, const LsSummary* summary)
{
    const struct
    {
        const char* key;
        uint64_t value;
    } numbers[] = {
        {"objects", ls_file_count(file, LS_CHUNK_OBJECTS)},
        {"list_objects", summary->list_object_count},
        {"grid_objects", summary->grid_object_count},
        {"instances", ls_file_count(file, LS_CHUNK_INSTANCES)},
        {"triangles", summary->triangle_count},
        {"faces", summary->face_count},
        {"instanced_triangles", summary->instanced_triangle_count},
        {"materials", ls_file_count(file, LS_CHUNK_MATERIALS)},
        {"lights", ls_file_count(file, LS_CHUNK_LIGHTS)},
        {"cameras", ls_file_count(file, LS_CHUNK_CAMERAS)},
        {"cells", summary->cell_count},
        {"cell_blocks", ls_file_count(file, LS_CHUNK_CELL_BLOCKS)},
        {"voxels", ls_file_count(file, LS_CHUNK_VOXELS)},
        {"subgrids", ls_file_count(file, LS_CHUNK_SUBGRIDS)},
        {"references", ls_file_count(file, LS_CHUNK_REFERENCES)},
        {"depth", file->header->depth},
        {"patches_least", summary->patches_least},
        {"patches_most", summary->patches_most},
        {"shafts", summary->shaft_count},
        {"filled_shafts", summary->filled_shaft_count},
        {"scene_shafts", summary->scene_shaft_count},
        {"filled_scene_shafts", summary->filled_scene_shaft_count},
        {"surfaces", ls_file_count(file, LS_CHUNK_SURFACES)},
        {"surfaces_with_holes", summary->masked_surface_count},
        {"textures", ls_file_count(file, LS_CHUNK_TEXTURES)},
        {"images", ls_file_count(file, LS_CHUNK_IMAGES)},
        {"pixels", ls_file_count(file, LS_CHUNK_PIXELS)},
        {"objects_with_normals", summary->normal_object_count},
        {"objects_with_texcoords_0", summary->texcoord_object_count[0]},
        {"objects_with_texcoords_1", summary->texcoord_object_count[1]},
        {"objects_with_colors", summary->color_object_count},
        {"corner_normals", ls_file_count(file, LS_CHUNK_NORMALS)},
        {"corners_without_normal", summary->bare_corner_count},
        {"lamps", ls_file_count(file, LS_CHUNK_LAMPS)},
        {"animations", ls_file_count(file, LS_CHUNK_ANIMATIONS)},
        {"animated_nodes", summary->animated_node_count},
        {"keys", ls_file_count(file, LS_CHUNK_KEYS)},
        {"padding_bytes", summary->padding_bytes},
    };
    cJSON* scene = cJSON_AddObjectToObject(root, "scene");
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); ++i)
    {
        cJSON_AddNumberToObject(scene, numbers[i].key, (double)numbers[i].value);
    }
    cJSON_AddNumberToObject(scene, "longest_animation_seconds", summary->longest_animation);
    cJSON* kinds = cJSON_AddObjectToObject(scene, "voxel_kinds");
    for (int kind = 0; kind < 4; ++kind)
    {
        cJSON_AddNumberToObject(kinds, voxel_kinds[kind], (double)summary->voxel_kind_count[kind]);
    }
    cJSON* lamps = cJSON_AddObjectToObject(scene, "lamp_kinds");
    for (int kind = 0; kind < 3; ++kind)
    {
        cJSON_AddNumberToObject(lamps, lamp_kinds[kind], summary->lamp_kind_count[kind]);
    }
}

static LsExit report(const LsError* error)
{
    fprintf(stderr, "lsinfo: error %u: %s\n", error->message, error->text);
    return ls_result_exit_code(error->result);
}

static LsExit refuse(LsMessage message, const char* what, const char* argument)
{
    LsError error;
    ls_error_set(&error, message, "%s%s", what, argument);
    return report(&error);
}

static LsExit print_json(const LsFile* file, const char* path, const LsSummary* summary)
{
    cJSON* root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "file", path);
    add_header(root, file);
    add_chunks(root, file);
    add_scene(root, file, summary);
    cJSON* absent = cJSON_AddObjectToObject(root, "left_out");
    for (int chunk = 0; chunk < LS_CHUNK_COUNT; ++chunk)
    {
        if (file->chunk_entries[chunk] == NULL)
        {
            cJSON_AddStringToObject(absent, ls_chunk_info((LsChunk)chunk).name,
                                    ls_explain_absence(file, (LsChunk)chunk));
        }
    }
    char* text = cJSON_Print(root);
    cJSON_Delete(root);
    if (text == NULL)
    {
        return refuse(LS_MESSAGE_OUT_OF_MEMORY, "out of memory for the JSON of ", path);
    }
    printf("%s\n", text);
    cJSON_free(text);
    return LS_EXIT_OK;
}

// ---- Commands -----------------------------------------------------------------------------------

static LsExit print_info(const LsFile* file, const Options* options)
{
    const LsSummary summary = ls_summarize(file);
    if (options->json)
    {
        return print_json(file, options->path, &summary);
    }
    print_header(file, options->path);
    print_chunks(file, &summary);
    print_scene(file, &summary);
    print_looks(file, &summary);
    print_absent(file);
    return LS_EXIT_OK;
}

static LsExit run_on_file(const LsFile* file, const Options* options)
{
    LsError error;
    if (ls_file_check(file, options->path, &error) != LS_OK ||
        (options->full && ls_file_check_hashes(file, options->path, &error) != LS_OK))
    {
        return report(&error);
    }
    if (!options->check)
    {
        return print_info(file, options);
    }
    printf("%s: every rule holds (%s)\n", options->path,
           options->full ? "full check: structure, hashes and padding"
                         : "structure; --full also reads hashes and padding");
    return LS_EXIT_OK;
}

static LsExit run(const Options* options)
{
    LsError error;
    LsMapping mapping;
    if (ls_mapping_open(&mapping, options->path, &error) != LS_OK)
    {
        return report(&error);
    }
    LsFile file;
    const LsResult result = ls_file_open(&file, mapping.bytes, mapping.size, options->path, &error);
    const LsExit code = result == LS_OK ? run_on_file(&file, options) : report(&error);
    ls_mapping_close(&mapping);
    return code;
}

// Reports a wrong command line in one line.
static bool refuse_usage(LsMessage message, const char* what, const char* argument)
{
    LsError error;
    ls_error_set(&error, message, "%s%s; see lsinfo --help", what, argument);
    report(&error);
    return false;
}

static bool read_options(Options* options, int argument_count, char** arguments)
{
    bool only_paths = false;
    for (int i = 1; i < argument_count; ++i)
    {
        const char* argument = arguments[i];
        if (only_paths || argument[0] != '-' || argument[1] == '\0')
        {
            if (i == 1 && strcmp(argument, "check") == 0)
            {
                options->check = true;
            }
            else if (options->path != NULL)
            {
                return refuse_usage(LS_MESSAGE_LSINFO_FILES, "more than one file: ", argument);
            }
            else
            {
                options->path = argument;
            }
        }
        else if (strcmp(argument, "--") == 0)
        {
            only_paths = true;
        }
        else if (strcmp(argument, "--json") == 0)
        {
            options->json = true;
        }
        else if (strcmp(argument, "--full") == 0)
        {
            options->full = true;
        }
        else if (strcmp(argument, "--help") == 0)
        {
            options->help = true;
        }
        else if (strcmp(argument, "--version") == 0)
        {
            options->version = true;
        }
        else
        {
            return refuse_usage(LS_MESSAGE_LSINFO_OPTION, "unknown option ", argument);
        }
    }
    if (options->help || options->version)
    {
        return true;
    }
    if (options->path == NULL)
    {
        return refuse_usage(LS_MESSAGE_LSINFO_FILES, "no file", "");
    }
    if (options->full && !options->check)
    {
        return refuse_usage(LS_MESSAGE_LSINFO_COMMAND, "--full belongs to lsinfo check", "");
    }
    if (options->json && options->check)
    {
        return refuse_usage(LS_MESSAGE_LSINFO_COMMAND, "--json does not belong to lsinfo check",
                            "");
    }
    return true;
}

int main(int argument_count, char** arguments)
{
    Options options = {0};
    if (!read_options(&options, argument_count, arguments))
    {
        return LS_EXIT_USAGE;
    }
    LsExit code = LS_EXIT_OK;
    if (options.help)
    {
        fputs(usage_text, stdout);
    }
    else if (options.version)
    {
        printf("lsinfo " LS_VERSION_TEXT ", format %d.%d\n", LS_FORMAT_MAJOR, LS_FORMAT_MINOR);
    }
    else
    {
        code = run(&options);
    }
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == LS_EXIT_OK)
    {
        code = refuse(LS_MESSAGE_OUTPUT_STANDARD,
                      "standard output cannot be written; is the disk full?", "");
    }
    return code;
}
