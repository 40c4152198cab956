#include "small_scenes.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <stdlib.h>

static const LsMaterial MATERIALS[2] = {
    {.base_color = {1, 0, 0}, .roughness = 1},
    {.base_color = {0, 1, 0}, .roughness = 1},
};

static LsTriangle make_triangle(LsVec3 v0, LsVec3 v1, LsVec3 v2, uint32_t primitive,
                                uint32_t material)
{
    return (LsTriangle){.v0 = v0, .v1 = v1, .v2 = v2, .primitive = primitive, .material = material};
}

static void make_quad(LsTriangle quad[2], float z, uint32_t first_primitive)
{
    quad[0] =
        make_triangle((LsVec3){0, 0, z}, (LsVec3){1, 0, z}, (LsVec3){1, 1, z}, first_primitive, 0);
    quad[1] = make_triangle((LsVec3){0, 0, z}, (LsVec3){1, 1, z}, (LsVec3){0, 1, z},
                            first_primitive + 2, 1);
}

// p = scale * (sign * x, y, z) + (move, 0, 0) from object to world.
static LsInstance make_instance(float scale, float sign, float move, uint32_t mask)
{
    bool identity = scale == 1 && sign == 1 && move == 0;
    return (LsInstance){
        .object_from_world = {{sign / scale, 0, 0, 0 - sign * move / scale},
                              {0, 1 / scale, 0, 0},
                              {0, 0, 1 / scale, 0}},
        .world_from_object = {{sign * scale, 0, 0, move}, {0, scale, 0, 0}, {0, 0, scale, 0}},
        .node = LS_NONE,
        .mask = mask,
        .flags = (sign < 0 ? LS_INSTANCE_MIRRORED : 0) | (identity ? LS_INSTANCE_IDENTITY : 0),
    };
}

static LsBvhNode make_node(float x0, float x1, float y1, uint32_t escape, uint32_t leaf)
{
    return (LsBvhNode){
        .lower = {x0 - 0.001f, -0.001f, -0.001f},
        .upper = {x1 + 0.001f, y1 + 0.001f, 0.001f},
        .escape = escape,
        .leaf = leaf,
    };
}

static void write_desc(LsFileDesc* desc, const LsObject* object, const char* path)
{
    desc->objects = object;
    desc->OBJECTS_count = 1;
    desc->materials = MATERIALS;
    desc->MATERIALS_count = 2;
    LsError error;
    if (ls_file_write(desc, path, &error) != LS_OK)
    {
        fail_msg("%s", error.text);
    }
}

static LsObject make_list(uint32_t triangle_count, uint32_t face_count, float side)
{
    return (LsObject){
        .upper = {side, side, 0},
        .kind = LS_OBJECT_LIST,
        .reach = 2 * side,
        .triangle_count = triangle_count,
        .face_count = face_count,
    };
}

static void write_list(const char* path)
{
    LsTriangle triangles[2];
    make_quad(triangles, 0, 0);
    LsObject object = make_list(2, 3, 1);
    LsInstance instance = make_instance(1, 1, 0, 255);
    LsFileDesc desc = {
        .instances = &instance,
        .INSTANCES_count = 1,
        .triangles = triangles,
        .TRIANGLES_count = 2,
        .upper = {1, 1, 0},
    };
    write_desc(&desc, &object, path);
}

static void write_grid(const char* path)
{
    LsTriangle triangles[4];
    make_quad(triangles, 0, 0);
    make_quad(triangles + 2, -1, 3);
    LsObject object = {
        .lower = {0, 0, -1},
        .upper = {1, 1, 0},
        .kind = LS_OBJECT_GRID,
        .reach = 2,
        .grid_lower = {-0.5f, -0.5f, -1.5f},
        .inverse_cell = 0.5f, // one cell, twice as wide as the box
        .cells = {1, 1, 1},
        .bound = 0x1p-18f,
        .triangle_count = 4,
        .block_count = 1,
        .cell_block_count = 1,
        .voxel_count = 1,
        .reference_count = 4,
        .shaft_word_count = 2,
        .face_count = 6,
        .patches = 1,
    };
    uint32_t block = 0; // a link to cell block 0
    LsCellBlock cells;
    for (uint32_t i = 0; i < LS_BLOCK_CELLS; i++)
    {
        cells.cells[i] = 0x11111111u;
    }
    cells.cells[0] = 0; // a link to voxel 0
    LsVoxel voxel = {.reference_count = 4, .shape = LS_VOXEL_MASKS | 1u << 8 | 2u << 16};
    uint32_t references[4] = {0, 1, 2, 3};
    uint32_t shafts[2] = {0xFFFFFFFFu, 0x0FFFFFFFu}; // 15 masks of four bits
    LsInstance instance = make_instance(1, 1, 0, 255);
    LsFileDesc desc = {
        .instances = &instance,
        .INSTANCES_count = 1,
        .triangles = triangles,
        .TRIANGLES_count = 4,
        .blocks = &block,
        .BLOCKS_count = 1,
        .cell_blocks = &cells,
        .CELL_BLOCKS_count = 1,
        .voxels = &voxel,
        .VOXELS_count = 1,
        .references = references,
        .REFERENCES_count = 4,
        .shafts = shafts,
        .SHAFTS_count = 2,
        .lower = {0, 0, -1},
        .upper = {1, 1, 0},
    };
    write_desc(&desc, &object, path);
}

static void write_instances(const char* path)
{
    LsTriangle triangles[2];
    make_quad(triangles, 0, 0);
    LsObject object = make_list(2, 3, 1);
    LsInstance instances[3] = {
        make_instance(1, 1, 0, 1),
        make_instance(2, 1, 10, 2),
        make_instance(1, -1, 21, 4),
    };
    LsBvhNode nodes[5] = {
        make_node(0, 21, 2, 5, 0),           make_node(0, 1, 1, 2, 0 << 4 | 1),
        make_node(10, 21, 2, 5, 0),          make_node(10, 12, 2, 4, 1 << 4 | 1),
        make_node(20, 21, 1, 5, 2 << 4 | 1),
    };
    LsFileDesc desc = {
        .instances = instances,
        .INSTANCES_count = 3,
        .top_nodes = nodes,
        .TOP_NODES_count = 5,
        .triangles = triangles,
        .TRIANGLES_count = 2,
        .upper = {21, 2, 0},
        .transform_bound = 0x1p-18f,
    };
    write_desc(&desc, &object, path);
}

static void write_large(const char* path)
{
    const uint32_t count = LS_LARGE_SIDE * LS_LARGE_SIDE;
    LsTriangle* triangles = malloc(count * sizeof(*triangles));
    assert_non_null(triangles);
    for (uint32_t i = 0; i < count; i++)
    {
        float x = (float)(i % LS_LARGE_SIDE);
        float y = (float)(i / LS_LARGE_SIDE);
        triangles[i] = make_triangle((LsVec3){x, y, 0}, (LsVec3){x + 1, y, 0},
                                     (LsVec3){x, y + 1, 0}, i, i % 2);
    }
    LsObject object = make_list(count, count, LS_LARGE_SIDE);
    LsInstance instance = make_instance(1, 1, 0, 255);
    LsFileDesc desc = {
        .instances = &instance,
        .INSTANCES_count = 1,
        .triangles = triangles,
        .TRIANGLES_count = count,
        .upper = {LS_LARGE_SIDE, LS_LARGE_SIDE, 0},
    };
    write_desc(&desc, &object, path);
    free(triangles);
}

static void write_many(const char* path)
{
    LsTriangle triangles[2];
    make_quad(triangles, 0, 0);
    LsObject object = make_list(1, 3, 1);
    LsInstance* instances = malloc(LS_MANY_INSTANCES * sizeof(*instances));
    LsBvhNode* nodes = malloc((LS_MANY_INSTANCES + 1) * sizeof(*nodes));
    assert_true(instances && nodes);
    nodes[0] = make_node(-0.6f, 1, 1, LS_MANY_INSTANCES + 1, 0);
    for (uint32_t i = 0; i < LS_MANY_INSTANCES; i++)
    {
        float move = i + 1 < LS_MANY_INSTANCES ? 0 : -0.6f;
        instances[i] = make_instance(1, 1, move, 255);
        nodes[i + 1] = make_node(move, move + 1, 1, i + 2, i << 4 | 1);
    }
    LsFileDesc desc = {
        .instances = instances,
        .INSTANCES_count = LS_MANY_INSTANCES,
        .top_nodes = nodes,
        .TOP_NODES_count = LS_MANY_INSTANCES + 1,
        .triangles = triangles,
        .TRIANGLES_count = 1,
        .lower = {-0.6f, 0, 0},
        .upper = {1, 1, 0},
        .transform_bound = 0x1p-18f,
    };
    write_desc(&desc, &object, path);
    free(instances);
    free(nodes);
}

void ls_small_scene_write(LsSmallScene scene, const char* path)
{
    static void (*const writers[LS_SMALL_COUNT])(const char*) = {
        [LS_SMALL_LIST] = write_list,           [LS_SMALL_GRID] = write_grid,
        [LS_SMALL_INSTANCES] = write_instances, [LS_SMALL_LARGE] = write_large,
        [LS_SMALL_MANY] = write_many,
    };
    writers[scene](path);
}
