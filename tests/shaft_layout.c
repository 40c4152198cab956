#include "shaft_layout.h"

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

static uint32_t log2_width(uint32_t count)
{
    return count <= 4 ? 2 : count <= 8 ? 3 : count <= 16 ? 4 : 5;
}

// Bit by bit, so that it shares nothing with what it tests.
static void copy_masks(const uint32_t* from, uint32_t from_width, uint32_t* to, uint32_t to_width,
                       uint32_t shafts, uint32_t count)
{
    for (uint64_t shaft = 0; shaft < shafts; ++shaft)
    {
        for (uint64_t k = 0; k < count; ++k)
        {
            const uint64_t read = shaft * from_width + k, written = shaft * to_width + k;
            to[written / 32] |= (from[read / 32] >> read % 32 & 1) << written % 32;
        }
    }
}

// Lays out a voxel's table anew from word `next` of the object's part on. Returns the words it takes.
static uint32_t lay_table(LsVoxel* voxel, const uint32_t* from, uint32_t* to, uint32_t next,
                          bool exact)
{
    const uint32_t old_log2 = voxel->shape >> 16 & 255, count = voxel->reference_count;
    const uint32_t old_width = old_log2 == 0 ? count : 1u << old_log2;
    const uint32_t new_log2 = exact ? 0 : log2_width(count);
    const uint32_t new_width = exact ? count : 1u << new_log2;
    const uint32_t patches = voxel->shape >> 8 & 255;
    const uint32_t shafts = LS_SHAFT_COUNT(patches);
    copy_masks(from + voxel->table, old_width, to + next, new_width, shafts, count);
    voxel->shape = (voxel->shape & 0xFFFF) | new_log2 << 16;
    voxel->table = next;
    return (shafts * new_width + 31) / 32;
}

// The source with arrays of its own for objects, voxels and up to `words` shaft words.
static LsShaftLayout start_layout(const LsFileDesc* source, size_t words)
{
    LsShaftLayout layout = {.desc = *source};
    layout.objects = malloc(source->OBJECTS_count * sizeof(LsObject));
    layout.voxels = malloc(source->VOXELS_count * sizeof(LsVoxel));
    layout.shafts = calloc(words, sizeof(uint32_t));
    assert_true(layout.objects && layout.voxels && layout.shafts);
    memcpy(layout.objects, source->objects, source->OBJECTS_count * sizeof(LsObject));
    memcpy(layout.voxels, source->voxels, source->VOXELS_count * sizeof(LsVoxel));
    layout.desc.objects = layout.objects;
    layout.desc.voxels = layout.voxels;
    layout.desc.shafts = layout.shafts;
    return layout;
}

LsShaftLayout ls_mask_layout(const LsFileDesc* source, bool exact)
{
    LsShaftLayout layout = start_layout(source, 8 * (size_t)source->SHAFTS_count); // a bit to four
    uint32_t first = 0;
    for (uint32_t i = 0; i < source->OBJECTS_count; ++i)
    {
        LsObject* object = &layout.objects[i];
        const uint32_t* from = source->shafts + object->first_shaft_word;
        uint32_t next = 0;
        for (uint32_t k = 0; k < object->voxel_count; ++k)
        {
            LsVoxel* voxel = &layout.voxels[object->first_voxel + k];
            if ((voxel->shape & 255) == LS_VOXEL_MASKS)
            {
                next += lay_table(voxel, from, layout.shafts + first, next, exact);
            }
        }
        object->first_shaft_word = first;
        object->shaft_word_count = next;
        first += next;
    }
    layout.desc.SHAFTS_count = first;
    return layout;
}

LsShaftLayout ls_scene_shaft_layout(const LsFileDesc* source, uint32_t patches)
{
    const uint32_t words = LS_SHAFT_COUNT(patches);
    LsShaftLayout layout =
        start_layout(source, source->SHAFTS_count + (size_t)words * source->OBJECTS_count);
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
    layout.desc.SHAFTS_count = next;
    return layout;
}

void ls_shaft_layout_destroy(LsShaftLayout* layout)
{
    free(layout->objects);
    free(layout->voxels);
    free(layout->shafts);
    *layout = (LsShaftLayout){0};
}
