// scene.h - an uploaded file.

#ifndef LS_SCENE_H
#define LS_SCENE_H

#include "lists.h"
#include "pipeline.h"
#include "texels.h"

struct LsScene
{
    const LsContext* context;
    uint64_t features;              // required features of the file
    uint32_t segment_log2;          // of arrays that grow with the scene; 0: none is cut
    LsArray chunks[LS_CHUNK_COUNT]; // zero for those that are absent or of no use on the device
    LsArray table;                  // LsDeviceScene
    LsTraceScene trace;
    LsTexels texels; // zero where the kernels read buffers
    LsTraceKernel kernel;
    LsGridParams grid; // of scenes with one grid, without what belongs to a batch
    LsLists lists;      // of those that can be traced in two passes
    bool has_passes;    // the scene has one grid, and the device can trace it in two passes
    uint32_t lane_rays; // of a lane, if it is traced in lockstep; else 0
    uint64_t device_bytes;
    uint64_t brute_rounds; // of loops when a ray tests every triangle of every instance
};

#endif
