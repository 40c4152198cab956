// bake.c - ls_bake_run: one call per stage, straight down.

#include "choose.h"
#include "compose.h"
#include "cost_model.h"
#include "depfile.h"
#include "ls_bake.h"
#include "ls_write.h"
#include "memory_limit.h"
#include "mesh.h"
#include "mesh_report.h"
#include "pack.h"
#include "shaft_cost.h"
#include "source_files.h"
#include "source_hash.h"
#include "tables.h"
#include "voxels.h"
#include "world.h"

#include <float.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

const char* ls_bake_stage_text(LsBakeStage stage)
{
    static const char* const texts[] = {
#define LS_BAKE_STAGE_TEXT(name, text) text,
        LS_BAKE_STAGE_LIST(LS_BAKE_STAGE_TEXT)
#undef LS_BAKE_STAGE_TEXT
    };
    return (unsigned)stage < LS_BAKE_STAGE_COUNT ? texts[stage] : "unknown";
}

// The state of one run.
typedef struct Bake
{
    const LsBakeDesc* desc;
    LsBakeReport report;
    LsSourceFiles files;
    LsInput input;
    LsMesh* meshes;
    LsBakedObject* objects;
    LsWorld world;
    LsPack pack;
    uint8_t source_hash[16];
    LsPatchesChoice patches;
    LsDivisionRule rule;
    LsShaftWeights weights[LS_MAX_PATCHES + 1]; // of each N that may be used
    LsChoice* choices;                          // of each object
    uint32_t threads;
    LsBakeStage stage; // the one that runs
    double stage_begin;
    double part_before, part_share; // of the stage: the objects that are done, and the one at hand
    double face_total;              // of all objects
    double progress;                // of the whole bake, as last told
} Bake;

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// Shares of a bake's time, in hundredths, as scanned models of a hundred thousand to a million
// triangles have them with three patches. They say how the bar moves, nothing else.
static const double stage_shares[LS_BAKE_STAGE_COUNT] = {
    [LS_BAKE_STAGE_IMPORT] = 2,  [LS_BAKE_STAGE_MESH] = 2,       [LS_BAKE_STAGE_CHOOSE] = 38,
    [LS_BAKE_STAGE_VOXELS] = 12, [LS_BAKE_STAGE_LINESPACE] = 30, [LS_BAKE_STAGE_PACK] = 5,
    [LS_BAKE_STAGE_WRITE] = 11,
};

// `fraction` of the stage that runs. What is told never falls.
static void note_progress(Bake* bake, double fraction)
{
    if (bake->desc->progress == NULL)
    {
        return;
    }
    double done = 0.0, all = 0.0;
    for (int i = 0; i < LS_BAKE_STAGE_COUNT; i++)
    {
        const double share =
            i == LS_BAKE_STAGE_CHOOSE && !bake->patches.by_work ? 0.0 : stage_shares[i];
        const double part = i == (int)bake->stage ? fmin(fraction, 1.0) : 1.0;
        done += i <= (int)bake->stage ? share * part : 0.0;
        all += share;
    }
    bake->progress = fmax(bake->progress, done / all);
    bake->desc->progress(bake->desc->progress_user, ls_bake_stage_text(bake->stage),
                         fmin(bake->progress, 1.0));
}

static void begin_stage(Bake* bake, LsBakeStage stage)
{
    bake->stage = stage;
    bake->stage_begin = now();
    bake->part_before = bake->part_share = 0.0;
    note_progress(bake, 0.0);
}

static void end_stage(Bake* bake)
{
    bake->report.stage_seconds[bake->stage] += now() - bake->stage_begin;
    note_progress(bake, 1.0);
}

static void note_part(void* user, double fraction)
{
    Bake* bake = user;
    note_progress(bake, bake->part_before + bake->part_share * fraction);
}

// Goes on to an object, whose share of the stage is that of its triangles.
static LsStageProgress begin_part(Bake* bake, uint32_t mesh)
{
    double all = 0.0;
    for (uint32_t i = 0; mesh == 0 && i < bake->input.mesh_count; i++)
    {
        all += bake->input.meshes[i].triangle_count;
    }
    bake->face_total = mesh == 0 ? fmax(all, 1.0) : bake->face_total;
    bake->part_before += bake->part_share;
    bake->part_share = bake->input.meshes[mesh].triangle_count / bake->face_total;
    return (LsStageProgress){.note = note_part, .user = bake};
}

static LsResult check_desc(const LsBakeDesc* desc, LsError* error)
{
    if (desc->input_count == 0)
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_NO_SCENE, "a bake needs a scene file");
    }
    if (desc->output == NULL)
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_NO_OUTPUT, "a bake needs an output");
    }
    if (desc->grid > LS_MAX_CELLS)
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_NUMBER, "grid %u is outside 1..%u", desc->grid,
                            LS_MAX_CELLS);
    }
    const uint32_t most = desc->choose_patches ? LS_MAX_CHOSEN_PATCHES : LS_MAX_PATCHES;
    if (desc->patches > most)
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_NUMBER, "patches %u is outside 1..%u",
                            desc->patches, most);
    }
    if (desc->scene_patches > LS_MAX_SCENE_PATCHES)
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_NUMBER, "scene_patches %u is outside 1..%u",
                            desc->scene_patches, LS_MAX_SCENE_PATCHES);
    }
    if (desc->divide_above != 0 &&
        (desc->divide_above < LS_MIN_DIVIDE_ABOVE || desc->divide_above > LS_MAX_DIVIDE_ABOVE))
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_NUMBER, "divide_above %u is outside %d..%d",
                            desc->divide_above, LS_MIN_DIVIDE_ABOVE, LS_MAX_DIVIDE_ABOVE);
    }
    if (!(desc->byte_price >= 0.0 && desc->byte_price <= DBL_MAX))
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_NUMBER, "byte_price %g is not a price",
                            desc->byte_price);
    }
    if (desc->memory != 0 && desc->patches != 0 && !desc->choose_patches)
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_CHOICE,
                            "patches %u cannot go with memory, which chooses them; auto:%u, which "
                            "sets the most, can",
                            desc->patches, desc->patches);
    }
    if (desc->byte_price != 0.0 && (desc->memory != 0 || !desc->choose_patches))
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_CHOICE,
                            "byte_price is of use with patches auto alone, and not with memory");
    }
    if ((unsigned)desc->normals > LS_NORMALS_SMOOTH)
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_CHOICE, "normals is %d, which names no source",
                            (int)desc->normals);
    }
    if (!(desc->smooth_angle >= 0.0 && desc->smooth_angle <= 180.0))
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_NUMBER, "smooth_angle %g is outside 0..180",
                            desc->smooth_angle);
    }
    return ls_compose_check(desc, error);
}

static LsResult check_memory(const Bake* bake, uint64_t needed, const char* what, LsError* error)
{
    return ls_memory_check(bake->desc->max_memory, needed, bake->desc->inputs[0].path, what, error);
}

static void note_import(void* user, double fraction)
{
    note_progress(user, fraction);
}

// What the bake is made of, none of which it may replace.
static LsResult hash_source(Bake* bake, LsError* error)
{
    const LsBakeDesc* desc = bake->desc;
    LsResult result = ls_source_files_list(&bake->files, desc, error);
    result = result == LS_OK ? ls_source_files_spare(&bake->files, desc->output, error) : result;
    if (result == LS_OK && desc->depfile != NULL)
    {
        result = ls_source_files_spare(&bake->files, desc->depfile, error);
    }
    return result == LS_OK ? ls_source_hash(&bake->files, desc, &bake->patches, bake->threads,
                                            bake->source_hash, error)
                           : result;
}

static LsResult import_all(Bake* bake, LsError* error)
{
    const LsResult result = ls_compose(&bake->input, bake->desc, note_import, bake, error);
    return result == LS_OK ? ls_source_files_check(&bake->files, error) : result;
}

static bool are_hashes_right(const Bake* bake, const LsFile* file)
{
    bool ok = true;
#pragma omp parallel for schedule(dynamic) num_threads(bake->threads) reduction(&& : ok)
    for (uint32_t i = 0; i < file->header->chunk_count; i++)
    {
        ok = ls_file_check_chunk_hash(file, i, bake->desc->output, NULL) == LS_OK && ok;
    }
    return ok;
}

// Whether the output is a sound file of just this input. With all hashes right it is, byte for
// byte, what a bake wrote, and that kept every rule.
static bool is_up_to_date(Bake* bake)
{
    LsMapping mapping;
    if (ls_mapping_open(&mapping, bake->desc->output, NULL) != LS_OK)
    {
        return false;
    }
    LsFile file;
    bool current =
        ls_file_open(&file, mapping.bytes, mapping.size, bake->desc->output, NULL) == LS_OK &&
        memcmp(file.header->source_hash, bake->source_hash, sizeof bake->source_hash) == 0 &&
        are_hashes_right(bake, &file);
    bake->report.file_bytes = current ? mapping.size : 0;
    ls_mapping_close(&mapping);
    return current;
}

// The mesh has its own copy; large scenes need the room.
static void free_geometry(LsInputMesh* source)
{
    free(source->positions);
    free(source->indices);
    free(source->materials);
    source->positions = NULL;
    source->indices = NULL;
    source->materials = NULL;
    for (int kind = 0; kind < LS_STREAM_COUNT; kind++)
    {
        free(source->streams[kind].values);
        free(source->streams[kind].indices);
        source->streams[kind] = (LsInputStream){0};
    }
}

// Those of the mesh stage; imports pass on their own.
static void pass_warnings(const Bake* bake, uint32_t first)
{
    for (uint32_t i = first; bake->desc->warn != NULL && i < bake->input.warning_count; i++)
    {
        const LsInputWarning* warning = &bake->input.warnings[i];
        bake->desc->warn(bake->desc->warn_user, warning->message, warning->text);
    }
}

static LsResult make_meshes(Bake* bake, LsError* error)
{
    uint32_t count = bake->input.mesh_count;
    uint64_t triangles = 0;
    const LsResult allowed =
        check_memory(bake, ls_mesh_need(&bake->input), "the largest object's mesh", error);
    if (allowed != LS_OK)
    {
        return allowed;
    }
    bake->meshes = calloc(count, sizeof(LsMesh));
    bake->objects = calloc(count, sizeof(LsBakedObject));
    if (bake->meshes == NULL || bake->objects == NULL)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for %u objects", count);
    }
    for (uint32_t i = 0; i < count; i++)
    {
        const LsStageProgress progress = begin_part(bake, i);
        LsInputMesh* source = &bake->input.meshes[i];
        const char* path = bake->input.paths[source->input_index];
        LsMeshFindings findings;
        LsMesh* mesh = &bake->meshes[i];
        uint32_t first_warning = bake->input.warning_count;
        LsResult result = ls_mesh_create(mesh, &bake->input, i, bake->desc, bake->threads,
                                         &progress, &findings, error);
        if (result != LS_OK)
        {
            return result;
        }
        pass_warnings(bake, first_warning);
        if (!ls_mesh_report_add(&bake->report, i, path, source->name, &findings))
        {
            return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory for the report",
                                path);
        }
        bake->report.face_count += mesh->face_count;
        bake->report.degenerate_count += mesh->degenerate_count;
        bake->report.dropped_count += mesh->face_count - mesh->triangle_count;
        triangles += mesh->triangle_count;
        free_geometry(source);
    }
    bake->report.triangle_count = triangles;
    return triangles > 0 ? LS_OK
                         : ls_error_set(error, LS_MESSAGE_SCENE_ALL_FLAT,
                                        "%s: all %llu triangles are degenerate; nothing to bake",
                                        bake->desc->inputs[0].path,
                                        (unsigned long long)bake->report.face_count);
}

static void count_voxels(Bake* bake, const LsVoxels* voxels)
{
    LsBakeReport* report = &bake->report;
    const uint32_t* cells = voxels->frame.cells;
    report->cell_count += (uint64_t)cells[0] * cells[1] * cells[2];
    report->cell_block_count += voxels->cell_block_count;
    report->voxel_count += voxels->voxel_count;
    report->subgrid_count += voxels->subgrid_count;
    report->reference_count += voxels->reference_count;
    report->depth = voxels->depth > report->depth ? voxels->depth : report->depth;
}

// Once their tables are made.
static void count_kinds(LsBakeReport* report, const LsVoxels* voxels)
{
    for (uint32_t i = 0; i < voxels->voxel_count; i++)
    {
        const LsWorkVoxel* voxel = &voxels->voxels[i];
        report->voxel_kind_count[voxel->kind]++;
        if (voxel->kind == LS_VOXEL_MASKS)
        {
            report->patches_count[voxel->patches]++;
        }
    }
}

// Bytes of what tracing reads and no choice alters.
static uint64_t count_fixed_bytes(const Bake* bake)
{
    uint64_t sum = sizeof(LsObject) * (uint64_t)bake->input.mesh_count +
                   (sizeof(LsInstance) + 2 * sizeof(LsBvhNode)) * bake->input.instance_count;
    for (uint32_t i = 0; i < bake->input.mesh_count; i++)
    {
        const uint64_t triangles = bake->meshes[i].triangle_count;
        sum += triangles <= LS_LIST_TRIANGLES
                   ? sizeof(LsTriangle) * triangles
                   : sizeof(uint32_t) * (uint64_t)LS_SHAFT_COUNT(bake->desc->scene_patches);
    }
    return sum;
}

static LsResult choose_grids(Bake* bake, LsError* error)
{
    const LsBakeDesc* desc = bake->desc;
    const uint32_t count = bake->input.mesh_count;
    bake->choices = calloc(count, sizeof *bake->choices);
    if (bake->choices == NULL)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for %u objects", count);
    }
    const uint32_t first = bake->patches.chosen ? 1 : bake->patches.patches;
    if (!ls_shaft_weights_create_all(bake->weights, first, bake->patches.patches))
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for weights of shafts");
    }
    if (!bake->patches.by_work)
    {
        ls_choose_given(bake->choices, &bake->input, bake->meshes, desc->grid);
        return LS_OK;
    }
    const LsChooseDesc choose = {
        .memory = desc->memory,
        .fixed_bytes = count_fixed_bytes(bake),
        .grid = desc->grid,
        .patches = bake->patches.patches,
        .rule = bake->rule,
        .weights = bake->weights,
        .threads = bake->threads,
        .max_memory = desc->max_memory,
        .scene = desc->inputs[0].path,
    };
    bake->part_share = 1.0;
    const LsStageProgress progress = {.note = note_part, .user = bake};
    return ls_choose(bake->choices, &bake->input, bake->meshes, &choose, &progress, error);
}

static void note_grid(LsBakeReport* report, uint32_t grid)
{
    report->least_grid =
        report->least_grid == 0 || grid < report->least_grid ? grid : report->least_grid;
    report->most_grid = grid > report->most_grid ? grid : report->most_grid;
}

static LsResult make_voxels(Bake* bake, LsError* error)
{
    for (uint32_t i = 0; i < bake->input.mesh_count; i++)
    {
        const LsStageProgress progress = begin_part(bake, i);
        const LsChoice* choice = &bake->choices[i];
        LsMesh* mesh = &bake->meshes[i];
        LsVoxels* voxels = &bake->objects[i].voxels;
        if (choice->grid == 0)
        {
            bake->report.list_object_count++;
            continue;
        }
        LsDivisionRule rule = bake->rule;
        rule.price = rule.is_weighed ? choice->price : 0.0;
        const LsGridFrame frame = ls_grid_frame(mesh, choice->grid);
        LsResult result = check_memory(bake, ls_grid_need(&frame, mesh->triangle_count),
                                       "the grid of an object", error);
        if (result == LS_OK)
        {
            result = ls_voxels_create(voxels, mesh, choice->grid, &rule, bake->threads, &progress,
                                      error);
        }
        if (result == LS_OK)
        {
            bake->objects[i].has_grid = true;
            result = ls_voxels_order_triangles(voxels, mesh, bake->threads, error);
        }
        if (result != LS_OK)
        {
            return result;
        }
        note_grid(&bake->report, voxels->frame.grid);
        bake->report.crowded_object_count += voxels->frame.grid < choice->grid;
        count_voxels(bake, voxels);
    }
    ls_memory_give_back(); // of divided voxels: more than what lasts, where many are
    return LS_OK;
}

static LsResult make_scene_shafts(Bake* bake, LsBakedObject* object, LsError* error)
{
    const uint32_t patches = bake->desc->scene_patches;
    if (patches == 0)
    {
        return LS_OK;
    }
    const uint64_t needed = ls_scene_shafts_need(&object->voxels.frame, patches);
    LsResult result = check_memory(bake, needed, "the table of shafts across a grid", error);
    if (result == LS_OK)
    {
        result = ls_scene_shafts_create(&object->scene_shafts, &object->voxels, patches,
                                        bake->threads, error);
        bake->report.scene_shaft_count += object->scene_shafts.word_count;
        bake->report.filled_scene_shaft_count += object->scene_shafts.filled_count;
    }
    return result;
}

// Of all objects.
static LsResult make_object_tables(Bake* bake, LsError* error)
{
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < bake->input.mesh_count && result == LS_OK; i++)
    {
        const LsStageProgress progress = begin_part(bake, i);
        LsBakedObject* object = &bake->objects[i];
        LsPatchesChoice patches = bake->patches;
        if (!object->has_grid)
        {
            continue;
        }
        if (patches.by_work)
        {
            patches.byte_price = bake->choices[i].price / ls_cell_visits(&object->voxels.frame);
        }
        ls_tables_destroy(&object->tables);
        result = ls_tables_create(&object->tables, &object->voxels, &bake->meshes[i], &patches,
                                  bake->weights, bake->threads, &progress, error);
    }
    return result;
}

static uint64_t count_memory(const Bake* bake)
{
    uint64_t sum = count_fixed_bytes(bake);
    for (uint32_t i = 0; i < bake->input.mesh_count; i++)
    {
        const LsBakedObject* object = &bake->objects[i];
        const uint64_t triangles = bake->meshes[i].triangle_count;
        sum += object->has_grid
                   ? sizeof(LsTriangle) * triangles + ls_voxels_bytes(&object->voxels) +
                         sizeof(uint32_t) * (uint64_t)object->tables.word_count
                   : 0;
    }
    return sum;
}

static void count_tables(Bake* bake)
{
    LsBakeReport* report = &bake->report;
    double visits = 0.0, tests = 0.0;
    for (uint32_t i = 0; i < bake->input.mesh_count; i++)
    {
        const LsBakedObject* object = &bake->objects[i];
        if (!object->has_grid)
        {
            continue;
        }
        const double weight = bake->choices[i].weight;
        const double each = weight * ls_cell_visits(&object->voxels.frame);
        report->shaft_count += object->tables.shaft_count;
        report->filled_shaft_count += object->tables.filled_count;
        count_kinds(report, &object->voxels);
        visits += object->tables.visits;
        tests += object->tables.tests;
        report->steps_per_line += weight * ls_expected_steps(&object->voxels);
        report->lookups_per_line += object->tables.lookups * each;
        report->tests_per_line += object->tables.tests * each;
    }
    report->tests_per_voxel = visits > 0.0 ? tests / visits : 0.0;
    report->memory_bytes = count_memory(bake);
}

// The price comes from samples, so what the tables really take may be a little more than the memory
// allows: then once more, dearer, at the end without any masks, which fit (ls_choose).
static LsResult make_tables(Bake* bake, LsError* error)
{
    const uint64_t needed =
        ls_tables_need(bake->objects, bake->input.mesh_count, &bake->patches, bake->threads);
    LsResult result = check_memory(bake, needed, "the table of shafts", error);
    for (uint32_t i = 0; i < bake->input.mesh_count && result == LS_OK; i++)
    {
        result =
            bake->objects[i].has_grid ? make_scene_shafts(bake, &bake->objects[i], error) : LS_OK;
    }
    result = result == LS_OK ? make_object_tables(bake, error) : result;
    double dearer = 1.01;
    while (result == LS_OK && bake->desc->memory != 0 && count_memory(bake) > bake->desc->memory)
    {
        for (uint32_t i = 0; i < bake->input.mesh_count; i++)
        {
            bake->choices[i].price *= dearer;
        }
        dearer *= dearer;
        result = make_object_tables(bake, error);
    }
    if (result == LS_OK)
    {
        count_tables(bake);
    }
    return result;
}

// Nothing is written that readers would refuse.
static LsResult check_pack(const Bake* bake, LsError* error)
{
    LsError broken = {0};
    const LsResult result = ls_file_desc_check(&bake->pack.desc, bake->desc->output, &broken);
    return result == LS_OK
               ? LS_OK
               : ls_error_set(error, (int)broken.message,
                              "%s: a fault of lsbake, the file would break a rule (%.800s); please "
                              "report the scene",
                              bake->desc->inputs[0].path, broken.text);
}

static LsResult pack_all(Bake* bake, LsError* error)
{
    // Where N is given, this was asked before the tables were made.
    const uint64_t needed =
        bake->patches.chosen ? ls_pack_need(bake->objects, bake->input.mesh_count) : 0;
    LsResult result = check_memory(bake, needed, "the file in memory", error);
    if (result == LS_OK)
    {
        result = ls_world_create(&bake->world, &bake->input, bake->meshes, error);
    }
    if (result == LS_OK)
    {
        result = ls_pack_create(&bake->pack, &bake->input, bake->meshes, bake->objects,
                                &bake->world, bake->patches.patches, error);
    }
    if (result == LS_OK)
    {
        memcpy(bake->pack.desc.source_hash, bake->source_hash, sizeof bake->source_hash);
        LsBakeReport* report = &bake->report;
        const LsFileDesc* desc = &bake->pack.desc;
        report->object_count = desc->OBJECTS_count;
        report->instance_count = desc->INSTANCES_count;
        report->material_count = desc->MATERIALS_count;
        report->light_count = desc->LIGHTS_count;
        report->camera_count = desc->CAMERAS_count;
        report->max_condition = bake->world.max_condition;
        report->file_bytes = ls_file_desc_bytes(desc);
#define LS_CHUNK_BYTES(NAME, field, type, code) \
    report->chunk_bytes[LS_CHUNK_##NAME] = sizeof(type) * (uint64_t)desc->NAME##_count;
        LS_CHUNK_LIST(LS_CHUNK_BYTES)
#undef LS_CHUNK_BYTES
        result = check_pack(bake, error);
    }
    return result;
}

// Linux tells it of this program alone; getrusage's figure may be that of the one that started it.
static uint64_t peak_memory(void)
{
    unsigned long long kilobytes = 0;
    FILE* file = fopen("/proc/self/status", "r");
    char line[256];
    while (file != NULL && kilobytes == 0 && fgets(line, sizeof line, file) != NULL)
    {
        sscanf(line, "VmHWM: %llu", &kilobytes);
    }
    if (file != NULL)
    {
        fclose(file);
    }
    struct rusage usage;
    if (kilobytes == 0 && getrusage(RUSAGE_SELF, &usage) == 0)
    {
        kilobytes = (unsigned long long)usage.ru_maxrss;
    }
    return kilobytes * 1024;
}

static LsResult write_file(Bake* bake, LsError* error)
{
    return ls_file_write(&bake->pack.desc, bake->desc->output, error);
}

static LsResult run_stages(Bake* bake, LsError* error)
{
    static const struct
    {
        LsBakeStage stage;
        LsResult (*run)(Bake*, LsError*);
    } stages[] = {{LS_BAKE_STAGE_IMPORT, import_all},     {LS_BAKE_STAGE_MESH, make_meshes},
                  {LS_BAKE_STAGE_CHOOSE, choose_grids},   {LS_BAKE_STAGE_VOXELS, make_voxels},
                  {LS_BAKE_STAGE_LINESPACE, make_tables}, {LS_BAKE_STAGE_PACK, pack_all},
                  {LS_BAKE_STAGE_WRITE, write_file}};
    LsResult result = LS_OK;
    for (size_t i = 0; i < sizeof stages / sizeof *stages && result == LS_OK; i++)
    {
        begin_stage(bake, stages[i].stage);
        result = stages[i].run(bake, error);
        end_stage(bake);
    }
    return result;
}

static LsResult run(Bake* bake, LsError* error)
{
    LsResult result = hash_source(bake, error);
    if (result != LS_OK)
    {
        return result;
    }
    // Whether there are warnings is found out by baking alone, so a strict bake takes no short cut.
    if (!bake->desc->force && !bake->desc->strict && is_up_to_date(bake))
    {
        bake->report.up_to_date = true;
    }
    else
    {
        result = run_stages(bake, error);
    }
    return result == LS_OK && bake->desc->depfile != NULL
               ? ls_depfile_write(&bake->files, bake->desc, error)
               : result;
}

LsResult ls_bake_run(const LsBakeDesc* desc, LsBakeReport* report, LsError* error)
{
    if (report != NULL)
    {
        *report = (LsBakeReport){0};
    }
    LsResult result = check_desc(desc, error);
    if (result != LS_OK)
    {
        return result;
    }
    Bake bake = {.desc = desc,
                 .patches = ls_patches_choice(desc),
                 .rule = ls_division_rule(desc),
                 .threads = desc->threads != 0 ? desc->threads : (uint32_t)omp_get_num_procs()};
    result = run(&bake, error);
    bake.report.peak_memory_bytes = peak_memory();
    if (report != NULL && result == LS_OK)
    {
        *report = bake.report;
    }
    else
    {
        ls_bake_report_destroy(&bake.report);
    }
    for (uint32_t i = 0; i < bake.input.mesh_count; i++)
    {
        if (bake.meshes != NULL)
        {
            ls_mesh_destroy(&bake.meshes[i]);
        }
        if (bake.objects != NULL)
        {
            ls_voxels_destroy(&bake.objects[i].voxels);
            ls_scene_shafts_destroy(&bake.objects[i].scene_shafts);
            ls_tables_destroy(&bake.objects[i].tables);
        }
    }
    free(bake.meshes);
    free(bake.objects);
    free(bake.choices);
    ls_shaft_weights_destroy_all(bake.weights);
    ls_pack_destroy(&bake.pack);
    ls_world_destroy(&bake.world);
    ls_input_destroy(&bake.input);
    ls_source_files_destroy(&bake.files);
    return result;
}
