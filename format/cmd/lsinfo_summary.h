// lsinfo_summary.h - what the chunks of a file hold together, and why others are not there.

#ifndef LS_LSINFO_SUMMARY_H
#define LS_LSINFO_SUMMARY_H

#include "ls_format.h"

// What the chunks hold together.
typedef struct LsSummary
{
    uint32_t list_object_count, grid_object_count;
    uint64_t triangle_count, face_count;
    uint64_t instanced_triangle_count; // each as often as it is placed
    uint64_t cell_count;               // of all grids, empty ones too
    uint64_t voxel_kind_count[4];
    uint32_t patches_least, patches_most; // of voxels with masks
    uint64_t shaft_count, filled_shaft_count;
    uint64_t scene_shaft_count, filled_scene_shaft_count; // across whole grids
    uint32_t masked_surface_count;
    uint32_t normal_object_count, texcoord_object_count[2], color_object_count; // that have them
    uint64_t bare_corner_count; // of objects with normals, those without
    uint32_t lamp_kind_count[3];
    uint32_t animated_node_count; // in each animation anew
    double longest_animation;     // seconds
    uint64_t padding_bytes;
} LsSummary;

// Of a checked file.
LsSummary ls_summarize(const LsFile* file);

// Why a scene has no such chunk.
const char* ls_explain_absence(const LsFile* file, LsChunk chunk);

#endif
