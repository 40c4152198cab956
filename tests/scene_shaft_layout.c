#include "scene_shaft_layout.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <stdlib.h>
#include <string.h>

LsSceneShaftLayout ls_scene_shaft_layout(const LsFileDesc* source, uint32_t patches)
{
    const uint32_t words = 15 * patches * patches * patches * patches;
    LsSceneShaftLayout layout = {.desc = *source};
    layout.objects = malloc(source->OBJECTS_count * sizeof(LsObject));
    layout.voxels = malloc(source->VOXELS_count * sizeof(LsVoxel));
    layout.shafts =
        malloc((source->SHAFTS_count + (size_t)words * source->OBJECTS_count) * sizeof(uint32_t));
    assert_true(layout.objects && layout.voxels && layout.shafts);
    memcpy(layout.objects, source->objects, source->OBJECTS_count * sizeof(LsObject));
    memcpy(layout.voxels, source->voxels, source->VOXELS_count * sizeof(LsVoxel));
    uint32_t next = 0;
    for (uint32_t i = 0; i < source->OBJECTS_count; ++i)
    {
        LsObject* object = &layout.objects[i];
        const uint32_t* tables = source->shafts + object->first_shaft_word;
        const uint32_t table_words = object->shaft_word_count;
        object->first_shaft_word = next;
        for (uint32_t k = 0; k < words && object->kind == LS_OBJECT_GRID; ++k)
        {
            layout.shafts[next++] = k % 7 == 0 ? 0 : k * 2654435761u;
        }
        for (uint32_t k = 0; k < object->voxel_count; ++k)
        {
            LsVoxel* voxel = &layout.voxels[object->first_voxel + k];
            voxel->table += (voxel->shape & 255) == LS_VOXEL_MASKS ? words : 0;
        }
        memcpy(layout.shafts + next, tables, table_words * sizeof(uint32_t));
        next += table_words;
        object->shaft_word_count = next - object->first_shaft_word;
        object->scene_patches = object->kind == LS_OBJECT_GRID ? patches : 0;
    }
    layout.desc.objects = layout.objects;
    layout.desc.voxels = layout.voxels;
    layout.desc.shafts = layout.shafts;
    layout.desc.SHAFTS_count = next;
    return layout;
}

void ls_scene_shaft_layout_destroy(LsSceneShaftLayout* layout)
{
    free(layout->objects);
    free(layout->voxels);
    free(layout->shafts);
    *layout = (LsSceneShaftLayout){0};
}
