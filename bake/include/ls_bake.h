// ls_bake.h - from scene files to one .lspace file; the whole offline side.
//
// ls_bake_run is the pipeline: import -> mesh -> voxels -> linespace -> pack -> write. The programs
// are shells around it, so tests call what users run. Equal inputs and options give equal bytes,
// for any number of threads and for any compiler.

#ifndef LS_BAKE_H
#define LS_BAKE_H

#include "ls_base.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

    // Called as stages go on, from one thread at a time; fraction in [0,1] of the stage.
    typedef void LsProgress(void* user, const char* stage, double fraction);

    // Input of a bake. Zero means default.
    typedef struct LsBakeDesc
    {
        const char* const*
            inputs; // scene files, put together as they lie; the ending names the format
        uint32_t input_count;
        const char* output; // .lspace file
        uint32_t
            grid; // G: cells along the longest side of an object's box, 1..4096; 0: by triangles
        uint32_t patches; // N: patches per voxel side, 1..16; 0: 3
        uint32_t threads; // 0: all processors
        bool force;       // bake also when the output is up to date
        LsProgress* progress;
        void* progress_user;
    } LsBakeDesc;

#define LS_BAKE_STAGE_LIST(X) \
    X(IMPORT, "import")       \
    X(MESH, "mesh")           \
    X(VOXELS, "voxels")       \
    X(LINESPACE, "linespace") \
    X(PACK, "pack")           \
    X(WRITE, "write")

    typedef enum LsBakeStage
    {
#define LS_BAKE_STAGE_ENUMERATOR(name, text) LS_BAKE_STAGE_##name,
        LS_BAKE_STAGE_LIST(LS_BAKE_STAGE_ENUMERATOR)
#undef LS_BAKE_STAGE_ENUMERATOR
            LS_BAKE_STAGE_COUNT
    } LsBakeStage;

    // What a bake did. Counts are over all objects.
    typedef struct LsBakeReport
    {
        bool up_to_date; // nothing was written; the fields below are zero but file_bytes
        uint32_t object_count, instance_count, material_count, light_count, camera_count;
        uint64_t face_count;       // triangles of the input, polygons fanned
        uint64_t degenerate_count; // dropped: no area, so no ray hits them
        uint64_t triangle_count;
        uint64_t cell_count; // cells of all grids, empty ones too
        uint64_t cell_block_count, voxel_count, subgrid_count, reference_count;
        uint64_t voxel_kind_count[4]; // by LS_VOXEL_*
        uint64_t list_object_count;
        uint64_t shaft_count, filled_shaft_count; // of stored tables
        uint32_t depth;
        double max_condition; // largest condition number of an instance's transform
        uint64_t chunk_bytes[16];
        uint64_t file_bytes;
        uint64_t peak_memory_bytes; // of this process
        double stage_seconds[LS_BAKE_STAGE_COUNT];
    } LsBakeReport;

    // Bakes. `report` may be NULL. On failure nothing is left at desc->output but what was there
    // before.
    LsResult ls_bake_run(const LsBakeDesc* desc, LsBakeReport* report, LsError* error);

    // Name of a stage as reports print it.
    const char* ls_bake_stage_text(LsBakeStage stage);

#ifdef __cplusplus
}
#endif

#endif
