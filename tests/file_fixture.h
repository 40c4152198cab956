// file_fixture.h - a small made-up scene that uses every chunk, every kind of voxel and every width
// of mask that is a power of two, for tests of the format; ls_mask_layout gives it masks of exact width,
// ls_scene_shaft_layout scene shafts.
// Its arrays obey every rule; its masks and distances describe no geometry.

#ifndef LS_FILE_FIXTURE_H
#define LS_FILE_FIXTURE_H

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include "ls_write.h"
#include "shaft_layout.h"

#define LS_FIXTURE_TRIANGLES 43 // 2 in a list, 40 in a grid, 1 in a grid
#define LS_FIXTURE_VOXELS 13
#define LS_FIXTURE_REFERENCES 102
#define LS_FIXTURE_SHAFT_WORDS 237

typedef struct LsFixture
{
    LsFileDesc desc; // of the arrays below
    LsObject objects[3];
    LsInstance instances[4];
    LsBvhNode top_nodes[7];
    LsSceneNode nodes[3];
    LsMaterial materials[2];
    LsLight lights[2];
    LsCamera cameras[1];
    LsTriangle triangles[LS_FIXTURE_TRIANGLES];
    uint32_t blocks[5];
    LsCellBlock cell_blocks[6];
    uint32_t subgrids[3];
    LsVoxel voxels[LS_FIXTURE_VOXELS];
    uint32_t references[LS_FIXTURE_REFERENCES];
    LsBvhNode leaf_nodes[6];
    uint32_t shafts[LS_FIXTURE_SHAFT_WORDS];
    LsSurface surfaces[1];
    LsTexture textures[2];
    LsImage images[2]; // 2x1 and 1x3
    uint32_t pixels[5];
    LsAttributes attributes[3]; // of the first object all, of the second none, of the third colours
    uint32_t normals[6];
    LsTexcoord texcoords[12];
    LsCornerColor colors[9];
    LsLamp lamps[3];
    LsAnimation animations[2];
    LsChannel channels[6];
    float keys[56];
} LsFixture;

// Always the same scene.
void ls_fixture_fill(LsFixture* fixture);

// A whole file in writable memory, aligned to 4096; fails the test when it cannot be read.
typedef struct LsFixtureBytes
{
    uint8_t* bytes;
    uint64_t size;
} LsFixtureBytes;

// The bytes that ls_file_write makes of `desc`.
LsFixtureBytes ls_fixture_bytes(const LsFileDesc* desc);
LsFixtureBytes ls_fixture_read(const char* path);
void ls_fixture_free(LsFixtureBytes* bytes);

// Makes all hashes of an edited file right again, those of chunks that lie outside it excepted.
void ls_fixture_rehash(const LsFixtureBytes* bytes);

// An empty directory of this process, and its removal with the files in it.
#define LS_SCRATCH_PATH 512
void ls_scratch_create(char directory[LS_SCRATCH_PATH]);
void ls_scratch_remove(const char* directory);
uint32_t ls_scratch_count(const char* directory); // entries in it

// Steps a state that must not be zero, and returns it: xorshift.
uint64_t ls_random_next(uint64_t* state);

#endif
