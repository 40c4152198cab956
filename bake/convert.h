// convert.h - the part of an LsInput that one file brought, and its conversion into the scene's
// axes and unit of length.

#ifndef LS_CONVERT_H
#define LS_CONVERT_H

#include "import/import.h"
#include "ls_bake.h"

#include <string.h>

// The part of an LsInput that one file brought: from these counts to the end of each array.
typedef struct LsInputPart
{
    uint32_t first_mesh, first_instance, first_node, first_material, first_camera, first_lamp,
        first_channel, first_key, first_warning;
} LsInputPart;

// Where the next file's part will begin: to be called before its import.
LsInputPart ls_input_part(const LsInput* input);

// What `how` asks for by up, scale and flip, in the vertices, node matrices, instances, cameras,
// lamps and keys themselves; the first half of ls_input_place, which says more.
LsResult ls_input_convert(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                          LsError* error);

// Matrices of records to double and back.
static inline void ls_rows_load(const LsVec4 rows[3], double matrix[3][4])
{
    for (int i = 0; i < 3; i++)
        memcpy(matrix[i], (const double[]){rows[i].x, rows[i].y, rows[i].z, rows[i].w},
               sizeof matrix[i]);
}

static inline void ls_rows_store(const double matrix[3][4], LsVec4 rows[3])
{
    for (int i = 0; i < 3; i++)
        rows[i] = (LsVec4){(float)matrix[i][0], (float)matrix[i][1], (float)matrix[i][2],
                           (float)matrix[i][3]};
}

#endif
