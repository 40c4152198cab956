// pack.h - working arrays of all objects into the arrays of a file.

#ifndef LS_PACK_H
#define LS_PACK_H

#include "ls_write.h"
#include "pack_looks.h"
#include "tables.h"
#include "world.h"

// One baked object. A list has empty voxels and tables.
typedef struct LsBakedObject
{
    LsVoxels voxels;
    LsTables tables;
    bool has_grid;
} LsBakedObject;

// The arrays of a file, owned; `desc` points into them and into the world and input.
typedef struct LsPack
{
    LsFileDesc desc;
    LsObject* objects;
    LsTriangle* triangles;
    uint32_t* blocks;
    LsCellBlock* cell_blocks;
    uint32_t* subgrids;
    LsVoxel* voxels;
    uint32_t* references;
    LsBvhNode* leaf_nodes;
    uint32_t* shafts;
    LsMaterial* materials;
    LsPackLooks looks;
} LsPack;

// meshes, baked: input->mesh_count each. Each object's working arrays, and the input's images, are freed as
// soon as they are packed. Errors: OUT_OF_MEMORY, LIMIT_RECORDS (sums beyond what the format counts).
LsResult ls_pack_create(LsPack* pack, LsInput* input, LsMesh* meshes, LsBakedObject* baked,
                        const LsWorld* world, uint32_t patches, LsError* error);
void ls_pack_destroy(LsPack* pack);

#endif
