// mtl_map.h - the textures of MTL materials: options, files, and the images they become.

#ifndef LS_MTL_MAP_H
#define LS_MTL_MAP_H

#include "import_mtl.h"
#include "text_lines.h"

// A map_ statement as it stands in the file.
typedef struct LsMtlMap
{
    char* file; // owned; NULL: the material has no such map
    float scale[2];
    float offset[2];
    float multiplier; // -bm
    bool is_clamped;
} LsMtlMap;

// Takes options and file name of a statement, replacing what `map` had before.
LsResult ls_mtl_map_parse(LsMtl* mtl, const LsTextLines* lines, const char* keyword,
                          const char* arguments, LsMtlMap* map);
void ls_mtl_map_destroy(LsMtlMap* map);

// Adds the texture that a map is and sets *texture to its index; LS_NONE if its image is left out,
// which is warned of. A map without a file leaves *texture as it is.
LsResult ls_mtl_map_add(LsMtl* mtl, const LsMtlMap* map, uint32_t texture_flags, uint32_t* texture);

// Adds the texture of a material with holes: the colours of `color`, or white without a file, with
// the alpha of `alpha`. *has_holes is set if that came about.
LsResult ls_mtl_map_add_masked(LsMtl* mtl, const LsMtlMap* color, const LsMtlMap* alpha,
                               uint32_t* texture, bool* has_holes);

// The path of a file named in the OBJ or MTL: beside the OBJ, backslashes turned where it helps.
// Owned by the caller; NULL when out of memory.
char* ls_mtl_find_file(const LsMtl* mtl, const char* name);

#endif
