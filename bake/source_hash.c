// source_hash.c - XXH3 over options and blocks of files; blocks so that all threads have some.

#include "source_hash.h"

#include "choose.h"
#include "import/import.h"
#include "ls_format.h"
#include "ls_messages.h"
#include "material_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

// Goes up whenever equal inputs give other bytes.
#define BAKE_REVISION 11

#define BLOCK_BYTES (16u << 20)
#define PIECE_BYTES (256u << 10) // read at once: stays in the cache of a core

// ---- Files --------------------------------------------------------------------------------------

// A part of a file.
typedef struct Block
{
    const LsSourceFile* file;
    uint64_t offset, size;
    XXH128_canonical_t hash;
    bool is_read;
} Block;

static bool read_piece(int descriptor, uint8_t* piece, size_t size, uint64_t offset)
{
    size_t done = 0;
    while (done < size)
    {
        const ssize_t got = pread(descriptor, piece + done, size - done, (off_t)(offset + done));
        if (got == 0 || (got < 0 && errno != EINTR))
            return false;
        done += got > 0 ? (size_t)got : 0;
    }
    return true;
}

static void hash_block(Block* block, uint8_t* piece)
{
    const int descriptor = open(block->file->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    block->is_read = descriptor >= 0;
    for (uint64_t done = 0; done < block->size && block->is_read; done += PIECE_BYTES)
    {
        const uint64_t left = block->size - done;
        const size_t size = left < PIECE_BYTES ? (size_t)left : PIECE_BYTES;
        block->is_read = read_piece(descriptor, piece, size, block->offset + done);
        if (block->is_read)
            XXH3_128bits_update(&state, piece, size);
    }
    if (descriptor >= 0)
        close(descriptor);
    XXH128_canonicalFromHash(&block->hash, XXH3_128bits_digest(&state));
}

// An empty file has one block too.
static uint64_t count_blocks(const LsSourceFile* file)
{
    const uint64_t size = (uint64_t)file->status.st_size;
    return !file->is_there ? 0 : size ? (size + BLOCK_BYTES - 1) / BLOCK_BYTES : 1;
}

// The blocks of all files in order, hashed; NULL when out of memory. To be freed.
static Block* hash_files(const LsSourceFiles* files, uint32_t threads)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < files->count; i++)
        count += count_blocks(&files->list[i]);
    Block* blocks = calloc((size_t)count + 1, sizeof *blocks);
    if (!blocks)
        return NULL;
    Block* block = blocks;
    for (uint32_t i = 0; i < files->count; i++)
        for (uint64_t k = 0; k < count_blocks(&files->list[i]); k++)
        {
            const uint64_t left = (uint64_t)files->list[i].status.st_size - k * BLOCK_BYTES;
            *block++ = (Block){.file = &files->list[i],
                               .offset = k * BLOCK_BYTES,
                               .size = left < BLOCK_BYTES ? left : BLOCK_BYTES};
        }
    bool ok = true;
#pragma omp parallel num_threads(threads) if (count > 1) reduction(&& : ok)
    {
        uint8_t* piece = malloc(PIECE_BYTES);
        ok = piece != NULL;
#pragma omp for schedule(dynamic)
        for (uint64_t i = 0; i < count; i++)
            if (piece)
                hash_block(&blocks[i], piece);
        free(piece);
    }
    if (!ok)
    {
        free(blocks);
        return NULL;
    }
    return blocks;
}

// ---- All of it ----------------------------------------------------------------------------------

// Every array with its size before it, so that nothing can move from one into the next unseen.
static void add_bytes(XXH3_state_t* state, const void* bytes, uint64_t size)
{
    XXH3_128bits_update(state, &size, sizeof size);
    XXH3_128bits_update(state, bytes, size);
}

#define ADD_ARRAY(state, array) add_bytes(state, array, sizeof(array))

static void add_options(XXH3_state_t* state, const LsBakeDesc* desc, const LsPatchesChoice* choice)
{
    const LsDivisionRule rule = ls_division_rule(desc);
    const uint32_t numbers[] = {LS_FORMAT_MAJOR,       LS_FORMAT_MINOR,     LS_VERSION_MAJOR,
                                LS_VERSION_MINOR,      BAKE_REVISION,       desc->grid,
                                choice->patches,       choice->chosen,      choice->by_work,
                                desc->keep_degenerate, desc->normals,       desc->no_weld,
                                desc->input_count,     desc->scene_patches, rule.above,
                                rule.is_weighed};
    const uint64_t memory[] = {desc->memory};
    const double measures[] = {desc->normals == LS_NORMALS_SMOOTH ? desc->smooth_angle : 0.0,
                               choice->byte_price};
    ADD_ARRAY(state, numbers);
    ADD_ARRAY(state, memory);
    ADD_ARRAY(state, measures);
}

static void add_input(XXH3_state_t* state, const LsBakeInput* how)
{
    const bool is_inline = how->materials && ls_materials_are_inline(how->materials);
    const uint32_t numbers[] = {
        ls_import_kind(how->path), how->scene, how->up, how->flip, how->is_at,
        how->materials != NULL};
    const double places[] = {how->scale != 0.0 ? how->scale : 1.0,
                             how->size,
                             how->turn,
                             how->is_at ? how->at[0] : 0.0,
                             how->is_at ? how->at[1] : 0.0,
                             how->is_at ? how->at[2] : 0.0};
    ADD_ARRAY(state, numbers);
    ADD_ARRAY(state, places);
    add_bytes(state, is_inline ? how->materials : "", is_inline ? strlen(how->materials) : 0);
}

// Returns the block behind those of the file.
static const Block* add_file(XXH3_state_t* state, const LsSourceFile* file, const Block* block)
{
    const uint64_t count = count_blocks(file);
    bool is_read = file->is_there;
    for (uint64_t i = 0; i < count; i++)
        is_read = is_read && block[i].is_read;
    const uint64_t numbers[] = {is_read, is_read ? (uint64_t)file->status.st_size : 0};
    ADD_ARRAY(state, numbers);
    for (uint64_t i = 0; i < count && is_read; i++)
        ADD_ARRAY(state, block[i].hash.digest);
    return block + count;
}

LsResult ls_source_hash(const LsSourceFiles* files, const LsBakeDesc* desc,
                        const LsPatchesChoice* choice, uint32_t threads, uint8_t hash[16],
                        LsError* error)
{
    Block* blocks = hash_files(files, threads);
    if (!blocks)
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "%s: out of memory while hashing its files", desc->inputs[0].path);
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    add_options(&state, desc, choice);
    const Block* block = blocks;
    uint32_t file = 0;
    for (uint32_t i = 0; i < desc->input_count; i++)
    {
        const uint32_t first = file;
        add_input(&state, &desc->inputs[i]);
        for (; file < files->count && files->list[file].input == i; file++)
            block = add_file(&state, &files->list[file], block);
        const uint32_t counts[] = {file - first};
        ADD_ARRAY(&state, counts);
    }
    free(blocks);
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(&state));
    memcpy(hash, canonical.digest, sizeof canonical.digest);
    return LS_OK;
}
