#include "scene.h"

#include "upload.h"

#include <stdlib.h>

// The arrays that tracing reads: chunk and the field of LsTraceScene that says where it lies. Those
// that grow with triangles and cells may be cut.
#define TRACE_CHUNK_LIST(X) \
    X(OBJECTS, objects)     \
    X(INSTANCES, instances) \
    X(TOP_NODES, top_nodes) \
    LARGE_CHUNK_LIST(X)
#define LARGE_CHUNK_LIST(X)     \
    X(TRIANGLES, triangles)     \
    X(BLOCKS, blocks)           \
    X(CELL_BLOCKS, cell_blocks) \
    X(SUBGRIDS, subgrids)       \
    X(VOXELS, voxels)           \
    X(REFERENCES, references)   \
    X(LEAF_NODES, leaf_nodes)   \
    X(SHAFTS, shafts)

// What nobody reads on the device stays in the file: nodes, cameras, looks, lamps, animations.
static bool lies_on_device(LsChunk chunk)
{
    switch (chunk)
    {
#define CHUNK_CASE(NAME, field) case LS_CHUNK_##NAME:
        TRACE_CHUNK_LIST(CHUNK_CASE)
#undef CHUNK_CASE
    case LS_CHUNK_MATERIALS:
    case LS_CHUNK_LIGHTS:
        return true;
    default:
        return false;
    }
}

static bool is_large(LsChunk chunk)
{
    switch (chunk)
    {
#define CHUNK_CASE(NAME, field) case LS_CHUNK_##NAME:
        LARGE_CHUNK_LIST(CHUNK_CASE)
#undef CHUNK_CASE
        return true;
    default:
        return false;
    }
}

// The size of segments, or 0 if none of the arrays needs more than one: then shaders have no table
// to look at.
static uint32_t choose_segments(const LsContext* context, const LsFile* file)
{
    for (LsChunk chunk = 0; chunk < LS_CHUNK_COUNT; chunk++)
    {
        const uint32_t stride = ls_chunk_info(chunk).stride;
        if (is_large(chunk) &&
            ls_file_count(file, chunk) > ls_array_segment_records(stride, context->segment_log2))
        {
            return context->segment_log2;
        }
    }
    return 0;
}

static LsResult upload_array(LsScene* scene, LsUpload* upload, const LsArrayDesc* desc,
                             LsArray* array, LsError* error)
{
    const LsResult result = ls_array_create(upload, desc, array, error);
    scene->device_bytes += array->device_bytes;
    return result;
}

static LsResult upload_chunk(LsScene* scene, LsUpload* upload, const LsFile* file, LsChunk chunk,
                             const char* name, LsError* error)
{
    const LsEntry* entry = file->chunk_entries[chunk];
    const LsArrayDesc desc = {
        .records = file->bytes + entry->offset,
        .count = entry->element_count,
        .stride = entry->stride,
        .segment_log2 = is_large(chunk) ? scene->segment_log2 : 0,
        .name = name,
        .what = ls_chunk_info(chunk).name,
    };
    return upload_array(scene, upload, &desc, &scene->chunks[chunk], error);
}

static LsResult upload_file(LsScene* scene, LsUpload* upload, const LsFile* file, const char* name,
                            LsError* error)
{
    for (LsChunk chunk = 0; chunk < LS_CHUNK_COUNT; chunk++)
    {
        if (file->chunk_entries[chunk] && lies_on_device(chunk))
        {
            LsResult result = upload_chunk(scene, upload, file, chunk, name, error);
            if (result != LS_OK)
            {
                return result;
            }
        }
    }
    scene->trace = (LsTraceScene){
#define CHUNK_ADDRESS(NAME, field) .field = scene->chunks[LS_CHUNK_##NAME].address,
        TRACE_CHUNK_LIST(CHUNK_ADDRESS)
#undef CHUNK_ADDRESS
            .instance_count = ls_file_count(file, LS_CHUNK_INSTANCES),
        .transform_bound = file->header->transform_bound,
    };
    LsDeviceScene table = {
        .trace = scene->trace,
        .materials = scene->chunks[LS_CHUNK_MATERIALS].address,
        .lights = scene->chunks[LS_CHUNK_LIGHTS].address,
        .light_count = ls_file_count(file, LS_CHUNK_LIGHTS),
    };
    const LsArrayDesc desc = {
        .records = &table,
        .count = 1,
        .stride = sizeof(table),
        .name = name,
        .what = "the table of arrays",
    };
    return upload_array(scene, upload, &desc, &scene->table, error);
}

static VkDeviceSize find_largest_upload(const LsFile* file)
{
    VkDeviceSize largest = sizeof(LsDeviceScene);
    for (LsChunk chunk = 0; chunk < LS_CHUNK_COUNT; chunk++)
    {
        const LsEntry* entry = file->chunk_entries[chunk];
        if (entry && lies_on_device(chunk) && entry->stored_bytes > largest)
        {
            largest = entry->stored_bytes;
        }
    }
    return largest;
}

static uint64_t count_brute_rounds(const LsFile* file)
{
    uint64_t rounds = 0;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_INSTANCES); i++)
    {
        uint64_t triangles = file->objects[file->instances[i].object].triangle_count;
        rounds += 1 + (triangles + LS_BRUTE_ROUND - 1) / LS_BRUTE_ROUND;
    }
    return rounds;
}

// Instances that every ray of a first pass looks at, one after the other, and triangles of them all
// that are lists; lsbake makes lists of 32 triangles at most.
#define MAX_PASS_INSTANCES 32
#define MAX_PASS_TRIANGLES 1024

static bool has_short_lists(const LsFile* file, uint32_t grid_instance)
{
    uint64_t triangle_count = 0;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_INSTANCES); i++)
    {
        const LsObject* object = &file->objects[file->instances[i].object];
        triangle_count += i == grid_instance ? 0 : object->triangle_count;
    }
    return ls_file_count(file, LS_CHUNK_INSTANCES) <= MAX_PASS_INSTANCES &&
           triangle_count <= MAX_PASS_TRIANGLES;
}

// The instance of a file's only object with a grid, or LS_NONE when there are more or none of
// either.
static uint32_t find_grid_instance(const LsFile* file)
{
    uint32_t grid_count = 0;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_OBJECTS); i++)
    {
        grid_count += file->objects[i].kind == LS_OBJECT_GRID;
    }
    uint32_t instance_count = 0;
    uint32_t found = LS_NONE;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_INSTANCES); i++)
    {
        if (file->objects[file->instances[i].object].kind == LS_OBJECT_GRID)
        {
            instance_count++;
            found = i;
        }
    }
    return grid_count == 1 && instance_count == 1 ? found : LS_NONE;
}

// At most: rounds of loops that a ray takes in lockstep through the lists. Lanes look at eight
// triangles together, one after the other, and then at those of them that are left.
static uint64_t count_list_rounds(const LsFile* file)
{
    uint64_t rounds = 0;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_INSTANCES); i++)
    {
        const LsObject* object = &file->objects[file->instances[i].object];
        rounds += 4 + (object->kind == LS_OBJECT_LIST ? 3 * (uint64_t)object->triangle_count : 0);
    }
    return rounds;
}

// Rays of a lane in lockstep, 0 if not worth it: the more, the better, while the lists and a way
// across all of the grid, at three rounds a cell, take LS_LOCKSTEP_ROUNDS each at most. Rays that
// meet more tests than that allows are traced once more. What loops within a step of the walk is
// not counted among those rounds, so nothing may.
static uint32_t choose_lane_rays(const LsScene* scene, const LsFile* file, const LsObject* object)
{
    const uint64_t loops = LS_FEATURE_SUBGRIDS | LS_FEATURE_LEAF_BVHS | LS_FEATURE_SCENE_SHAFTS;
    if (scene->texels.set == VK_NULL_HANDLE || (scene->features & loops) != 0 ||
        ls_file_count(file, LS_CHUNK_INSTANCES) > scene->context->shared_lanes)
    {
        return 0;
    }
    const uint64_t list_rounds = count_list_rounds(file);
    const uint64_t grid_rounds =
        3 * ((uint64_t)object->cells[0] + object->cells[1] + object->cells[2]);
    const uint64_t rays =
        LS_LOCKSTEP_ROUNDS / (list_rounds > grid_rounds ? list_rounds : grid_rounds);
    const uint32_t most = (uint32_t)(rays < LS_MAX_LANE_RAYS ? rays : LS_MAX_LANE_RAYS);
    return most / LS_BLOCK_LANE_RAYS * LS_BLOCK_LANE_RAYS;
}

// Whether the scene can be traced in two passes or in lockstep, and then what these need to know.
// Their kernels take the grid's parts of the arrays to begin at 0, so other objects with a grid,
// even if without an instance, rule it out.
static LsResult prepare_one_grid(LsScene* scene, LsUpload* upload, const LsFile* file,
                                 const char* name, LsError* error)
{
    const uint32_t index = find_grid_instance(file);
    const LsContext* context = scene->context;
    if (index == LS_NONE || context->shared_lanes == 0)
    {
        return LS_OK;
    }
    const LsInstance* instance = &file->instances[index];
    const LsObject* object = &file->objects[instance->object];
    // On a CPU one pass is faster, and kernels take seconds to compile.
    scene->has_passes = has_short_lists(file, index) && (!context->is_cpu || context->measures);
    scene->lane_rays = choose_lane_rays(scene, file, object);
    scene->grid = (LsGridParams){
        .triangles = scene->trace.triangles,
        .blocks = scene->trace.blocks,
        .cell_blocks = scene->trace.cell_blocks,
        .subgrids = scene->trace.subgrids,
        .voxels = scene->trace.voxels,
        .references = scene->trace.references,
        .leaf_nodes = scene->trace.leaf_nodes,
        .shafts = scene->trace.shafts,
        .grid_lower = object->grid_lower,
        .inverse_cell = object->inverse_cell,
        .cells = {object->cells[0], object->cells[1], object->cells[2]},
        .flags = ((instance->flags & LS_INSTANCE_MIRRORED) != 0 ? LS_GRID_MIRRORED : 0) |
                 object->scene_patches << LS_GRID_SCENE_PATCHES,
        .instance = index,
        .object = instance->object,
        .first_triangle = object->first_triangle,
        .first_subgrid_block = object->cell_block_count - object->subgrid_count,
    };
    if (!scene->has_passes)
    {
        return LS_OK;
    }
    const LsResult result = ls_lists_create(upload, file, index, name, &scene->lists, error);
    scene->device_bytes += scene->lists.instances.device_bytes + scene->lists.boxes.device_bytes;
    return result;
}

// Leaves the scene without texels where the device would not gain, or an array is too large or cut.
static LsResult create_texels(LsScene* scene, LsError* error)
{
    static const LsChunk chunks[] = {
#define CHUNK_NAME(NAME, field) LS_CHUNK_##NAME,
        TRACE_CHUNK_LIST(CHUNK_NAME)
#undef CHUNK_NAME
    };
    static_assert(sizeof(chunks) / sizeof(chunks[0]) == LS_TEXEL_ARRAY_COUNT, "one for each array");
    LsTexelArray arrays[LS_TEXEL_ARRAY_COUNT] = {0};
    bool fits = scene->context->max_texels != 0 && scene->segment_log2 == 0;
    for (uint32_t i = 0; i < LS_TEXEL_ARRAY_COUNT; i++)
    {
        const LsBuffer* buffer = scene->chunks[chunks[i]].segments;
        if (buffer)
        {
            const uint32_t stride = ls_chunk_info(chunks[i]).stride;
            const bool is_words = stride == sizeof(uint32_t) || stride == sizeof(LsCellBlock);
            arrays[i] = (LsTexelArray){.buffer = buffer, .is_words = is_words};
            fits = fits && buffer->bytes / (is_words ? 4 : 16) <= scene->context->max_texels;
        }
    }
    return fits ? ls_texels_create(scene->context, arrays, &scene->texels, error) : LS_OK;
}

static LsResult fill_scene(LsScene* scene, const LsFile* file, const char* name, LsError* error)
{
    LsUpload upload;
    LsResult result =
        ls_upload_begin(&upload, scene->context, find_largest_upload(file), name, error);
    if (result == LS_OK)
    {
        result = upload_file(scene, &upload, file, name, error);
    }
    if (result == LS_OK)
    {
        result = create_texels(scene, error);
    }
    if (result == LS_OK)
    {
        result = prepare_one_grid(scene, &upload, file, name, error);
    }
    if (result == LS_OK)
    {
        const LsTraceKernelDesc desc = {
            .features = scene->features,
            .segment_log2 = scene->segment_log2,
            .has_passes = scene->has_passes,
            .lane_rays = scene->lane_rays,
            .texel_layout = scene->texels.layout,
        };
        result = ls_trace_kernel_create(scene->context, &desc, &scene->kernel, error);
    }
    LsResult ended = ls_upload_end(&upload, result == LS_OK ? error : NULL);
    return result == LS_OK ? ended : result;
}

LsResult ls_scene_create(LsContext* context, const LsFile* file, const char* name, LsScene** scene,
                         LsError* error)
{
    *scene = NULL;
    LsResult result = ls_file_check(file, name, error);
    if (result != LS_OK)
    {
        return result;
    }
    LsScene* made = calloc(1, sizeof(*made));
    if (!made)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory for a scene", name);
    }
    made->context = context;
    made->features = file->header->required_features;
    made->segment_log2 = choose_segments(context, file);
    made->brute_rounds = count_brute_rounds(file);
    result = fill_scene(made, file, name, error);
    if (result != LS_OK)
    {
        ls_scene_destroy(made);
        return result;
    }
    *scene = made;
    return LS_OK;
}

void ls_scene_destroy(LsScene* scene)
{
    if (!scene)
    {
        return;
    }
    const LsContext* context = scene->context;
    ls_trace_kernel_destroy(context, &scene->kernel);
    ls_texels_destroy(context, &scene->texels);
    for (LsChunk chunk = 0; chunk < LS_CHUNK_COUNT; chunk++)
    {
        ls_array_destroy(context, &scene->chunks[chunk]);
    }
    ls_array_destroy(context, &scene->table);
    ls_lists_destroy(context, &scene->lists);
    free(scene);
}

VkDeviceAddress ls_scene_address(const LsScene* scene)
{
    return scene->table.address;
}

LsTraceScene ls_scene_trace(const LsScene* scene)
{
    return scene->trace;
}

uint64_t ls_scene_features(const LsScene* scene)
{
    return scene->features;
}

uint32_t ls_scene_segment_log2(const LsScene* scene)
{
    return scene->segment_log2;
}

uint64_t ls_scene_device_bytes(const LsScene* scene)
{
    return scene->device_bytes;
}
