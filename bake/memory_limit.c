// memory_limit.c - sums over what the stages are about to allocate.

#include "memory_limit.h"

#include "linespace.h"
#include "ls_format.h"

#include <stdio.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

uint64_t ls_memory_in_use(void)
{
    // Linux: pages of size, resident, shared with files.
    unsigned long long size = 0, resident = 0, shared = 0;
    FILE* file = fopen("/proc/self/statm", "r");
    if (!file)
        return 0;
    const int count = fscanf(file, "%llu %llu %llu", &size, &resident, &shared);
    fclose(file);
    return count == 3 && resident > shared ? (resident - shared) * (uint64_t)sysconf(_SC_PAGESIZE)
                                           : 0;
}

LsResult ls_memory_check(uint64_t limit, uint64_t needed, const char* scene, const char* what,
                         LsError* error)
{
    const uint64_t in_use = limit ? ls_memory_in_use() : 0;
    if (!limit || (in_use <= limit && needed <= limit - in_use))
        return LS_OK;
    return ls_error_set(
        error, LS_MESSAGE_LIMIT_MEMORY,
        "%s: %s takes %.1f MB beside the %.1f MB in use, more than the %.1f MB that "
        "--max-memory allows; raise it, or bake less, coarser or with fewer patches",
        scene, what, (double)needed * 1e-6, (double)in_use * 1e-6, (double)limit * 1e-6);
}

void ls_memory_give_back(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

uint64_t ls_mesh_need(const LsInput* input)
{
    uint64_t most = 0;
    for (uint32_t i = 0; i < input->mesh_count; i++)
        most = input->meshes[i].triangle_count > most ? input->meshes[i].triangle_count : most;
    return (sizeof(LsTriangle) + 3 * sizeof(uint32_t) + sizeof(uint8_t)) * most;
}

uint64_t ls_grid_need(const LsGridFrame* frame, uint32_t triangle_count)
{
    uint64_t blocks = 1;
    for (int axis = 0; axis < 3; axis++)
        blocks *= (frame->cells[axis] + LS_BLOCK_SIDE - 1) / LS_BLOCK_SIDE;
    const uint64_t order = (sizeof(LsTriangle) + sizeof(uint32_t)) * triangle_count;
    return sizeof(uint32_t) * blocks + order;
}

// What packing takes besides what it packs. A voxel's record of the file is made beside the one
// that it was worked with, object by object; then each block of tables is copied into an array that
// grows, and freed.
static uint64_t count_packing(const LsBakedObject* objects, uint32_t count, uint64_t table_bytes,
                              uint64_t most_in_block)
{
    uint64_t most = 0;
    for (uint32_t i = 0; i < count; i++)
        most = objects[i].voxels.voxel_count > most ? objects[i].voxels.voxel_count : most;
    return sizeof(LsVoxel) * most + ls_pack_spare(table_bytes) + most_in_block;
}

// Bytes of an object's tables, all of one N; `most_in_block` becomes those of its largest block if
// they are more.
static uint64_t count_tables(const LsVoxels* voxels, uint32_t patches, uint64_t* most_in_block)
{
    uint64_t sum = 0;
    for (uint64_t i = 0; i < voxels->voxel_count; i += LS_TABLE_VOXELS)
    {
        const uint64_t left = voxels->voxel_count - i;
        const uint32_t count = left < LS_TABLE_VOXELS ? (uint32_t)left : LS_TABLE_VOXELS;
        const uint64_t bytes =
            sizeof(uint32_t) * ls_tables_words(voxels->voxels + i, count, patches);
        sum += bytes;
        *most_in_block = bytes > *most_in_block ? bytes : *most_in_block;
    }
    return sum;
}

uint64_t ls_tables_need(const LsBakedObject* objects, uint32_t count, const LsPatchesChoice* choice,
                        uint32_t threads)
{
    uint64_t most = 0, block = 0;
    for (uint32_t i = 0; i < count; i++)
        most += count_tables(&objects[i].voxels, choice->patches, &block);
    if (choice->chosen)
    {
        return threads *
               (ls_tables_work_bytes(choice) + block); // tables of a block wait for their size
    }
    const uint64_t packing = count_packing(objects, count, most, block);
    const uint64_t working = threads * ls_tables_work_bytes(choice);
    return most + (working > packing ? working : packing);
}

uint64_t ls_pack_need(const LsBakedObject* objects, uint32_t count)
{
    uint64_t tables = 0, most_in_block = 0;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t b = 0; b < objects[i].tables.block_count; b++)
        {
            const uint64_t bytes = sizeof(uint32_t) * objects[i].tables.blocks[b].word_count;
            tables += bytes;
            most_in_block = bytes > most_in_block ? bytes : most_in_block;
        }
    return count_packing(objects, count, tables, most_in_block);
}
