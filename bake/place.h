// place.h - conversion and placement of what one file brought into an LsInput.

#ifndef LS_PLACE_H
#define LS_PLACE_H

#include "import/import.h"
#include "ls_bake.h"

// The part of an LsInput that one file brought: from these counts to the end of each array.
typedef struct LsInputPart
{
    uint32_t first_mesh, first_instance, first_node, first_material, first_camera, first_lamp,
        first_channel, first_key, first_warning;
} LsInputPart;

// Where the next file's part will begin: to be called before its import.
LsInputPart ls_input_part(const LsInput* input);

// Does to the part what `how` asks for, in the order that LsBakeInput states; without anything
// asked nothing changes. Exact but for `scale` (each number rounded once) and the node above
// (`size`, `turn`, `at`), so that an identity stays an identity. Cameras keep their lens and are
// never scaled; lamps keep their intensities (glTF: W/sr, whatever the scale of their node) and
// have their ranges scaled. The part must be the last of the input. Errors: INPUT_FORMAT (no
// triangle, or all in a point: no box to place), INPUT_RANGE (a number leaves the range of float),
// INPUT_LIMIT (the hierarchy has no level left for the node), MEMORY.
LsResult ls_input_place(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                        LsError* error);

#endif
