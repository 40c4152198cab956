// report.c - the same facts twice.

#include "report.h"

#include "ls_format.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double total_seconds(const LsBakeReport* report)
{
    double sum = 0.0;
    for (int i = 0; i < LS_BAKE_STAGE_COUNT; i++)
    {
        sum += report->stage_seconds[i];
    }
    return sum;
}

// ---- Text ---------------------------------------------------------------------------------------

static void print_mesh(const LsMeshReport* mesh)
{
    printf("  mesh: vertices %llu, %llu after welding; edges %llu, %llu of one face, holes %llu, "
           "non-manifold edges %llu\n"
           "  faces: degenerate %llu, duplicate %llu, inverted %llu, unorientable parts %llu\n",
           (unsigned long long)mesh->input_vertex_count, (unsigned long long)mesh->vertex_count,
           (unsigned long long)mesh->edge_count, (unsigned long long)mesh->boundary_edge_count,
           (unsigned long long)mesh->hole_count, (unsigned long long)mesh->nonmanifold_edge_count,
           (unsigned long long)mesh->degenerate_count, (unsigned long long)mesh->duplicate_count,
           (unsigned long long)mesh->inverted_count, (unsigned long long)mesh->unorientable_count);
}

// A fault at its place, in words.
static void print_example(const LsMeshExample* example)
{
    const uint32_t* v = example->vertices;
    switch (example->fault)
    {
    case LS_MESH_FAULT_HOLE:
        printf("one of %u edges at face %u, vertices %u and %u", example->other, example->face,
               v[0], v[1]);
        break;
    case LS_MESH_FAULT_NONMANIFOLD:
        printf("one of %u faces, vertices %u and %u, the first face %u", example->other, v[0], v[1],
               example->face);
        break;
    case LS_MESH_FAULT_DUPLICATE:
        printf("face %u (vertices %u %u %u) as face %u", example->face, v[0], v[1], v[2],
               example->other);
        break;
    case LS_MESH_FAULT_UNORIENTABLE:
        printf("that of face %u (vertices %u %u %u)", example->face, v[0], v[1], v[2]);
        break;
    case LS_MESH_FAULT_DEGENERATE:
    case LS_MESH_FAULT_INVERTED:
    case LS_MESH_FAULT_COUNT:
        printf("face %u (vertices %u %u %u)", example->face, v[0], v[1], v[2]);
        break;
    }
}

// A line per kind of fault, with the first of it.
static void print_faults(const LsObjectReport* object)
{
    for (uint32_t i = 0; i < object->example_count; i++)
    {
        const LsMeshExample* example = &object->examples[i];
        if (i > 0 && example[-1].fault == example->fault)
        {
            continue;
        }
        printf("    %s, object %u", object->input, object->object);
        if (object->name != NULL)
        {
            printf(" (%s)", object->name);
        }
        printf(": %s %llu: ", ls_mesh_fault_text(example->fault),
               (unsigned long long)ls_mesh_fault_count(&object->mesh, example->fault));
        print_example(example);
        putchar('\n');
    }
}

// Voxels by N, and what their masks leave to test.
static void print_patches(const LsBakeReport* report)
{
    if (report->voxel_count == 0)
    {
        return;
    }
    printf("  grids of %u", report->least_grid);
    if (report->most_grid > report->least_grid)
    {
        printf(" to %u", report->most_grid);
    }
    printf(" cells, for tracing %.1f MB; expected of a line: %.1f steps, %.1f masks, %.1f tests\n",
           (double)report->memory_bytes * 1e-6, report->steps_per_line, report->lookups_per_line,
           report->tests_per_line);
    printf("  expected triangle tests in a voxel %.2f", report->tests_per_voxel);
    const char* before = "; voxels by N:";
    for (uint32_t n = 1; n <= LS_MAX_PATCHES; n++)
    {
        if (report->patches_count[n] > 0)
        {
            printf("%s %llu of %u", before, (unsigned long long)report->patches_count[n], n);
            before = ",";
        }
    }
    putchar('\n');
}

void ls_report_print_text(const LsBakeReport* report, const char* output)
{
    if (report->up_to_date)
    {
        printf("%s is up to date (%.1f MB)\n", output, (double)report->file_bytes * 1e-6);
        return;
    }
    printf("%s: %.1f MB, baked in %.2f s\n", output, (double)report->file_bytes * 1e-6,
           total_seconds(report));
    printf("  objects %u (%llu as lists), instances %u, lights %u, cameras %u\n",
           report->object_count, (unsigned long long)report->list_object_count,
           report->instance_count, report->light_count, report->camera_count);
    printf("  triangles %llu of %llu", (unsigned long long)report->triangle_count,
           (unsigned long long)report->face_count);
    if (report->degenerate_count > 0)
    {
        printf(" (%llu %s: they have no area)", (unsigned long long)report->degenerate_count,
               report->dropped_count > 0 ? "dropped" : "kept");
    }
    putchar('\n');
    print_mesh(&report->mesh);
    for (uint32_t i = 0; i < report->faulty_count; i++)
    {
        print_faults(&report->faulty[i]);
    }
    printf("  voxels %llu in %llu cells: %llu lists, %llu with masks, %llu divided (depth %u), "
           "%llu BVHs\n",
           (unsigned long long)report->voxel_count, (unsigned long long)report->cell_count,
           (unsigned long long)report->voxel_kind_count[LS_VOXEL_LIST],
           (unsigned long long)report->voxel_kind_count[LS_VOXEL_MASKS],
           (unsigned long long)report->voxel_kind_count[LS_VOXEL_SUBGRID], report->depth,
           (unsigned long long)report->voxel_kind_count[LS_VOXEL_BVH]);
    if (report->crowded_object_count > 0)
    {
        printf("  objects with fewer cells than asked for, since their triangles crowd: %llu\n",
               (unsigned long long)report->crowded_object_count);
    }
    if (report->shaft_count > 0)
    {
        printf("  shafts %llu, %.1f %% filled\n", (unsigned long long)report->shaft_count,
               100.0 * (double)report->filled_shaft_count / (double)report->shaft_count);
    }
    if (report->scene_shaft_count > 0)
    {
        printf("  shafts across whole grids %llu, %.1f %% filled\n",
               (unsigned long long)report->scene_shaft_count,
               100.0 * (double)report->filled_scene_shaft_count /
                   (double)report->scene_shaft_count);
    }
    print_patches(report);
    printf("  largest condition number of a transform %.3g, peak memory %.0f MB\n ",
           report->max_condition, (double)report->peak_memory_bytes * 1e-6);
    for (int i = 0; i < LS_BAKE_STAGE_COUNT; i++)
    {
        printf(" %s %.2f s%s", ls_bake_stage_text((LsBakeStage)i), report->stage_seconds[i],
               i + 1 < LS_BAKE_STAGE_COUNT ? "," : "\n");
    }
}

// ---- JSON ---------------------------------------------------------------------------------------

static void add_counts(cJSON* to, const LsMeshReport* mesh)
{
    const struct
    {
        const char* name;
        uint64_t value;
    } numbers[] = {
        {"input_vertices", mesh->input_vertex_count},
        {"vertices", mesh->vertex_count},
        {"faces", mesh->face_count},
        {"degenerate_faces", mesh->degenerate_count},
        {"duplicate_faces", mesh->duplicate_count},
        {"inverted_faces", mesh->inverted_count},
        {"unorientable_parts", mesh->unorientable_count},
        {"edges", mesh->edge_count},
        {"boundary_edges", mesh->boundary_edge_count},
        {"nonmanifold_edges", mesh->nonmanifold_edge_count},
        {"holes", mesh->hole_count},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    {
        cJSON_AddNumberToObject(to, numbers[i].name, (double)numbers[i].value);
    }
}

static cJSON* make_example(const LsMeshExample* example)
{
    cJSON* out = cJSON_CreateObject();
    cJSON_AddStringToObject(out, "fault", ls_mesh_fault_text(example->fault));
    cJSON_AddNumberToObject(out, "face", example->face);
    cJSON* vertices = cJSON_AddArrayToObject(out, "vertices");
    for (int k = 0; k < 3 && example->vertices[k] != UINT32_MAX; k++)
    {
        cJSON_AddItemToArray(vertices, cJSON_CreateNumber(example->vertices[k]));
    }
    static const char* const others[LS_MESH_FAULT_COUNT] = {
        [LS_MESH_FAULT_DUPLICATE] = "first_face",
        [LS_MESH_FAULT_HOLE] = "edges",
        [LS_MESH_FAULT_NONMANIFOLD] = "faces",
    };
    if (others[example->fault] != NULL)
    {
        cJSON_AddNumberToObject(out, others[example->fault], example->other);
    }
    return out;
}

static cJSON* make_object(const LsObjectReport* object)
{
    cJSON* out = cJSON_CreateObject();
    cJSON_AddNumberToObject(out, "object", object->object);
    cJSON_AddStringToObject(out, "input", object->input);
    if (object->name != NULL)
    {
        cJSON_AddStringToObject(out, "name", object->name);
    }
    add_counts(out, &object->mesh);
    cJSON* examples = cJSON_AddArrayToObject(out, "examples");
    for (uint32_t i = 0; i < object->example_count; i++)
    {
        cJSON_AddItemToArray(examples, make_example(&object->examples[i]));
    }
    return out;
}

bool ls_report_print_json(const LsBakeReport* report, const char* output,
                          const BakeWarnings* warnings)
{
    cJSON* root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "output", output);
    cJSON_AddBoolToObject(root, "up_to_date", report->up_to_date);
    cJSON_AddNumberToObject(root, "file_bytes", (double)report->file_bytes);
    ls_bake_warnings_json(warnings, root);
    if (!report->up_to_date)
    {
        const struct
        {
            const char* name;
            double value;
        } numbers[] = {
            {"seconds", total_seconds(report)},
            {"peak_memory_bytes", (double)report->peak_memory_bytes},
            {"objects", report->object_count},
            {"list_objects", (double)report->list_object_count},
            {"crowded_objects", (double)report->crowded_object_count},
            {"instances", report->instance_count},
            {"materials", report->material_count},
            {"lights", report->light_count},
            {"cameras", report->camera_count},
            {"faces", (double)report->face_count},
            {"degenerate_faces", (double)report->degenerate_count},
            {"dropped_faces", (double)report->dropped_count},
            {"triangles", (double)report->triangle_count},
            {"least_grid", report->least_grid},
            {"most_grid", report->most_grid},
            {"memory_bytes", (double)report->memory_bytes},
            {"cells", (double)report->cell_count},
            {"cell_blocks", (double)report->cell_block_count},
            {"voxels", (double)report->voxel_count},
            {"voxels_list", (double)report->voxel_kind_count[LS_VOXEL_LIST]},
            {"voxels_masks", (double)report->voxel_kind_count[LS_VOXEL_MASKS]},
            {"voxels_subgrid", (double)report->voxel_kind_count[LS_VOXEL_SUBGRID]},
            {"voxels_bvh", (double)report->voxel_kind_count[LS_VOXEL_BVH]},
            {"subgrids", (double)report->subgrid_count},
            {"depth", report->depth},
            {"references", (double)report->reference_count},
            {"shafts", (double)report->shaft_count},
            {"filled_shafts", (double)report->filled_shaft_count},
            {"scene_shafts", (double)report->scene_shaft_count},
            {"filled_scene_shafts", (double)report->filled_scene_shaft_count},
            {"tests_per_voxel", report->tests_per_voxel},
            {"steps_per_line", report->steps_per_line},
            {"lookups_per_line", report->lookups_per_line},
            {"tests_per_line", report->tests_per_line},
            {"max_condition", report->max_condition},
        };
        for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        {
            cJSON_AddNumberToObject(root, numbers[i].name, numbers[i].value);
        }
        add_counts(cJSON_AddObjectToObject(root, "mesh"), &report->mesh);
        cJSON* faulty = cJSON_AddArrayToObject(root, "faulty_objects");
        for (uint32_t i = 0; i < report->faulty_count; i++)
        {
            cJSON_AddItemToArray(faulty, make_object(&report->faulty[i]));
        }
        cJSON* patches = cJSON_AddArrayToObject(root, "voxels_by_patches"); // from 0 on
        for (uint32_t n = 0; n <= LS_MAX_PATCHES; n++)
        {
            cJSON_AddItemToArray(patches, cJSON_CreateNumber((double)report->patches_count[n]));
        }
        cJSON* stages = cJSON_AddObjectToObject(root, "stage_seconds");
        for (int i = 0; i < LS_BAKE_STAGE_COUNT; i++)
        {
            cJSON_AddNumberToObject(stages, ls_bake_stage_text((LsBakeStage)i),
                                    report->stage_seconds[i]);
        }
        cJSON* chunks = cJSON_AddObjectToObject(root, "chunk_bytes");
        for (int i = 0; i < LS_CHUNK_COUNT; i++)
        {
            cJSON_AddNumberToObject(chunks, ls_chunk_info((LsChunk)i).name,
                                    (double)report->chunk_bytes[i]);
        }
    }
    char* text = cJSON_Print(root);
    bool ok = text != NULL;
    if (ok)
    {
        puts(text);
    }
    cJSON_free(text);
    cJSON_Delete(root);
    return ok;
}
