// pack.h - working arrays of all objects into the arrays of a file.

#ifndef LS_PACK_H
#define LS_PACK_H

#include "ls_write.h"
#include "pack_looks.h"
#include "scene_shafts.h"
#include "tables.h"
#include "world.h"

// One baked object. A list has empty voxels, scene shafts and tables.
typedef struct LsBakedObject
{
    LsVoxels voxels;
    LsSceneShafts scene_shafts;
    LsTables tables;
    bool has_grid;
} LsBakedObject;

// An array of the file, made of the objects' parts.
typedef struct LsPackArray
{
    void* records;
    uint64_t count;
    uint64_t capacity;
} LsPackArray;

// The arrays of a file, owned; `desc` points into them and into the world and input.
typedef struct LsPack
{
    LsFileDesc desc;
    LsObject* objects;
    LsMaterial* materials;
    LsPackArray triangles, blocks, cell_blocks, subgrids, voxels, references, leaf_nodes, shafts;
    LsPackLooks looks;
} LsPack;

// meshes, baked: input->mesh_count each. Each object's working arrays, and the input's images, are
// freed as soon as they are packed, array by array: what is large is in memory once. Errors:
// OUT_OF_MEMORY, LIMIT_RECORDS (sums beyond what the format counts).
LsResult ls_pack_create(LsPack* pack, LsInput* input, LsMesh* meshes, LsBakedObject* baked,
                        const LsWorld* world, uint32_t patches, LsError* error);
void ls_pack_destroy(LsPack* pack);

// Room that an array of so many bytes has too much while it grows.
uint64_t ls_pack_spare(uint64_t bytes);

#endif
