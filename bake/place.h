// place.h - placement of what one file brought into an LsInput, after its conversion.

#ifndef LS_PLACE_H
#define LS_PLACE_H

#include "convert.h"

// Does to the part what `how` asks for, in the order that LsBakeInput states; without anything
// asked nothing changes. Exact but for `scale` (each number rounded once) and the node above
// (`size`, `turn`, `at`), so that an identity stays an identity. Cameras keep their lens and are
// never scaled; lamps keep their intensities (glTF: W/sr, whatever the scale of their node) and
// have their ranges scaled. The part must be the last of the input. Errors: PLACE_NO_BOX (no
// triangle, or all in a point), PLACE_RANGE (a number leaves the range of float), PLACE_DEPTH (the
// hierarchy has no level left for the node), OUT_OF_MEMORY.
LsResult ls_input_place(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                        LsError* error);

#endif
