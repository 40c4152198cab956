// ls_bake.h - from scene files to one .lspace file; the whole offline side.
//
// ls_bake_run is the pipeline: import -> mesh -> choose -> voxels -> linespace -> pack -> write.
// The programs are shells around it, so tests call what users run. Equal inputs and options give
// equal bytes, for any number of threads and for any compiler.

#ifndef LS_BAKE_H
#define LS_BAKE_H

#include "ls_base.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

    // Called as the bake goes on, from one thread at a time: the stage's name, and an estimate of
    // how much of the whole bake is done, in [0,1], which never falls and is 1 at the end.
    typedef void LsProgress(void* user, const char* stage, double fraction);

    // Called once for each warning, as ls_bake_run goes on: what the scene has and the file will
    // not. `message` is an LsMessage of the 38xx, `text` names file, place and remedy and lives for
    // the call.
    typedef void LsWarn(void* user, uint32_t message, const char* text);

    // Which axis of a file points up; the world's is +y.
    typedef enum LsUpAxis
    {
        LS_UP_Y, // as it lies
        LS_UP_Z, // (x, y, z) becomes (x, z, -y)
        LS_UP_X, // (x, y, z) becomes (-y, x, z)
    } LsUpAxis;

    // A scene file and its place in the bake. Zero means default, but for the path. What is done,
    // in this order: its materials are overridden; the file's own space is turned (up) and scaled
    // (scale) and its faces turned round (flip), in the vertices themselves; then the whole is
    // scaled (size) and turned (turn) about the middle of the bottom of its bounding box, which
    // goes to `at`, by a node above the file's own. Cameras and lamps go with it.
    typedef struct LsBakeInput
    {
        const char* path; // the ending names the format
        uint32_t scene;   // of a glTF file: number of the scene to take, plus 1; 0: its default
        LsUpAxis up;
        double scale; // up to 1e30; 0: 1
        bool flip;  // the corners of every face run the other way, and normals point the other way
        bool is_at; // `at` counts; else the middle of the bottom stays where it is
        double at[3]; // world
        double size;  // world: length of the box's longest side, up to 1e30; 0: as it is
        double turn;  // degrees about the vertical, counter-clockwise seen from above
        // JSON that begins with {, or the name of a file of it, that overrides the file's materials
        // (README, Bake); NULL: none.
        const char* materials;
    } LsBakeInput;

    // Where shading normals come from.
    typedef enum LsNormalSource
    {
        LS_NORMALS_INPUT,  // those that the file gives, where it gives any
        LS_NORMALS_NONE,   // none: every triangle has its own
        LS_NORMALS_SMOOTH, // from the faces around a vertex that differ by no more than an angle
    } LsNormalSource;

// Most patches along a voxel's edge that are chosen by voxel.
#define LS_MAX_CHOSEN_PATCHES 8
// The fewest and the most triangles that may be asked to be divided.
#define LS_MIN_DIVIDE_ABOVE 3
#define LS_MAX_DIVIDE_ABOVE 1000000

    // Input of a bake. Zero means default.
    typedef struct LsBakeDesc
    {
        const LsBakeInput* inputs; // put together, their objects numbered in order
        uint32_t input_count;
        const char* output; // .lspace file; neither it nor the depfile may be a file that is read
        // Beside it a rule of make that names all files that were read, for build systems, written
        // when the bake has succeeded or the output is up to date; NULL: none.
        const char* depfile;
        // Cells, divisions and N are chosen by expected work (docs/cost-model.md) if this is given,
        // or none of grid, patches and choose_patches; of given ones grid stays, and chosen patches
        // are the most. Bytes that tracing may take on the device, without what shading alone
        // reads; 0: as many as pay, a doubling having to save a twelfth of the work.
        uint64_t memory;
        // G: cells along the longest side of an object's box, 1..4096; 0: chosen, or by triangles
        // where only patches are given.
        uint32_t grid;
        uint32_t patches; // N: patches per voxel side, 1..16, 0: 2; if chosen the most, 1..8, 0: 5
        // By voxel: the N, or no table, of the least tests + byte_price * bytes.
        bool choose_patches;
        // Of tables, in triangle tests of a ray in a voxel, for choose_patches without memory; 0:
        // 0.001.
        double byte_price;
        // T: voxels of more triangles are divided into sub-grids of 4 x 4 x 4, 3..1000000. 0: where
        // cells are chosen those of more than 32, the most that masks hold, that are worth it, else
        // all of them. What is not divided and has more than 32 has a BVH.
        uint32_t divide_above;
        // M: each grid also gets shafts across the whole of it, between M x M patches on the faces
        // of its box, that say which parts of their way may be filled; 1..32, 60 M^4 bytes a grid.
        // 0: none.
        uint32_t scene_patches;
        uint32_t threads;     // 0: all processors
        bool force;           // bake also when the output is up to date
        bool no_weld;         // vertices of equal position stay apart in the mesh stage
        bool keep_degenerate; // faces without area are kept; no ray hits them
        LsNormalSource normals;
        double smooth_angle;    // degrees, for LS_NORMALS_SMOOTH
        bool strict;            // a warning is an error
        uint64_t max_memory;    // bytes of this process, held against what a stage is known to need
                                // before it begins; 0: no limit
        uint64_t max_triangles; // of all inputs together; 0: no limit
        LsWarn* warn;
        void* warn_user;
        LsProgress* progress;
        void* progress_user;
    } LsBakeDesc;

#define LS_BAKE_STAGE_LIST(X) \
    X(IMPORT, "import")       \
    X(MESH, "mesh")           \
    X(CHOOSE, "choose")       \
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

    // What the mesh stage found, of one object or all. Vertices are those after welding; an edge is
    // a pair of them that is a side of a face. Faces without area have no edges here; duplicates
    // have theirs.
    typedef struct LsMeshReport
    {
        uint64_t input_vertex_count;
        uint64_t vertex_count;     // after welding
        uint64_t face_count;       // triangles of the input, polygons fanned
        uint64_t degenerate_count; // no area, so no ray hits them
        uint64_t duplicate_count;  // the corners of an earlier face, in any order
        // Faces that must be turned round for all neighbours, across edges of two faces, to agree;
        // two faces of the same corners in the same order are no neighbours. Of the two ways to
        // turn a part (faces connected across such edges) the one with fewer counts; if both are
        // alike, that which leaves the part's first face as it is.
        uint64_t inverted_count;
        // Parts that no turning of faces brings to agree, such as a Moebius strip. None of their
        // faces counts as inverted.
        uint64_t unorientable_count;
        uint64_t edge_count;
        uint64_t boundary_edge_count;    // of one face
        uint64_t nonmanifold_edge_count; // of three faces or more
        // Closed loops of boundary edges. At its end an edge's loop goes on round the vertex, from
        // face to face across edges of two faces, to the boundary edge at the other end of that
        // fan. So every loop is one boundary of the surface, were it taken apart where fans touch
        // in a vertex: two sheets that touch so have two, two gaps that do have one. A chain that
        // comes to an edge of three faces or more is no loop.
        uint64_t hole_count;
    } LsMeshReport;

#define LS_MESH_FAULT_LIST(X)             \
    X(DEGENERATE, "degenerate faces")     \
    X(DUPLICATE, "duplicate faces")       \
    X(INVERTED, "inverted faces")         \
    X(UNORIENTABLE, "unorientable parts") \
    X(HOLE, "holes")                      \
    X(NONMANIFOLD, "non-manifold edges")

    typedef enum LsMeshFault
    {
#define LS_MESH_FAULT_ENUMERATOR(name, text) LS_MESH_FAULT_##name,
        LS_MESH_FAULT_LIST(LS_MESH_FAULT_ENUMERATOR)
#undef LS_MESH_FAULT_ENUMERATOR
            LS_MESH_FAULT_COUNT
    } LsMeshFault;

// Examples kept of each kind of fault of an object.
#define LS_MESH_EXAMPLES 8

    // A place where a fault is. Numbers are the input's, from 0, within its object; faces are
    // triangles, a polygon's one after the other.
    typedef struct LsMeshExample
    {
        LsMeshFault fault;
        uint32_t face; // the first that has the fault, or the edge
        // Of the face; of holes and non-manifold edges the two of an edge, then UINT32_MAX.
        uint32_t vertices[3];
        // Duplicates: the first face of these corners. Holes: edges of the loop. Non-manifold
        // edges: faces that share it. Else 0.
        uint32_t other;
    } LsMeshExample;

    // What was found in one object.
    typedef struct LsObjectReport
    {
        uint32_t object;
        char* input; // the file, owned
        char* name;  // as the file has it, owned; NULL without
        LsMeshReport mesh;
        LsMeshExample* examples; // by fault, the first of each, owned
        uint32_t example_count;
    } LsObjectReport;

    // What a bake did. Counts are over all objects.
    typedef struct LsBakeReport
    {
        bool up_to_date; // nothing was baked or written; of the fields below only file_bytes and
                         // peak_memory_bytes are set
        uint32_t object_count, instance_count, material_count, light_count, camera_count;
        uint64_t face_count;       // triangles of the input, polygons fanned
        uint64_t degenerate_count; // no area, so no ray hits them
        uint64_t dropped_count;    // of those: left out of the file
        uint64_t triangle_count;   // in the file
        LsMeshReport mesh;
        LsObjectReport* faulty; // objects in which a fault was found, in order; owned
        uint32_t faulty_count;
        // Cells along the longest side of gridded objects' boxes: the fewest and the most.
        uint32_t least_grid, most_grid;
        uint64_t memory_bytes; // what tracing takes on the device
        uint64_t cell_count;   // cells of all grids, empty ones too
        uint64_t cell_block_count, voxel_count, subgrid_count, reference_count;
        uint64_t voxel_kind_count[4]; // by LS_VOXEL_*
        uint64_t list_object_count;
        uint64_t crowded_object_count; // given fewer cells than asked for: triangles crowd in them
        uint64_t shaft_count, filled_shaft_count;             // of stored tables
        uint64_t scene_shaft_count, filled_scene_shaft_count; // across whole grids
        uint64_t patches_count[17];                           // voxels with masks by N
        double tests_per_voxel; // triangles that a line is expected to test in a voxel it crosses
        // What a line that meets the box of a gridded object is expected to do there: cells it
        // steps to, masks, triangles. Objects count by their boxes' surfaces.
        double steps_per_line, lookups_per_line, tests_per_line;
        uint32_t depth;
        double max_condition;     // largest condition number of an instance's transform
        uint64_t chunk_bytes[32]; // by LsChunk
        uint64_t file_bytes;
        uint64_t peak_memory_bytes; // of this process
        double stage_seconds[LS_BAKE_STAGE_COUNT];
    } LsBakeReport;

    // Bakes, unless the output is up to date: a sound file whose source hash is that of the files
    // to be read and the options. Then nothing is imported, so no warnings come. `report` may be
    // NULL; else ls_bake_report_destroy frees what it owns, which is nothing after a failure. On
    // failure nothing is left at desc->output but what was there before.
    LsResult ls_bake_run(const LsBakeDesc* desc, LsBakeReport* report, LsError* error);
    void ls_bake_report_destroy(LsBakeReport* report);

    // Name of a kind of fault as reports print it, and how many of it a mesh has.
    const char* ls_mesh_fault_text(LsMeshFault fault);
    uint64_t ls_mesh_fault_count(const LsMeshReport* mesh, LsMeshFault fault);

    // Name of a stage as reports print it.
    const char* ls_bake_stage_text(LsBakeStage stage);

#ifdef __cplusplus
}
#endif

#endif
