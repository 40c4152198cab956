#include "baked.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

static void require(LsResult result, const LsError* error)
{
    if (result != LS_OK)
    {
        fail_msg("%s", error->text);
    }
}

void ls_baked_open(LsBaked* baked, const LsTestMesh* mesh, const char* name,
                   LsTestPlacement placement, uint32_t grid, uint32_t patches, uint32_t threads)
{
    ls_baked_open_desc(baked, mesh, name, placement,
                       &(LsBakeDesc){.grid = grid, .patches = patches, .threads = threads});
}

void ls_baked_open_desc(LsBaked* baked, const LsTestMesh* mesh, const char* name,
                        LsTestPlacement placement, const LsBakeDesc* options)
{
    memset(baked, 0, sizeof *baked);
    const char* folder = LS_BINARY_DIR "/test_scenes";
    mkdir(folder, 0777);
    // The process id keeps test programs that run side by side apart. The scene's name does not hold what
    // is asked of the bake, since a glTF names its buffer and so would be another.
    char stem[400], source[512];
    snprintf(stem, sizeof stem, "%s/%d-%s-%d", folder, (int)getpid(), name, (int)placement);
    bool alone = placement == LS_TEST_ALONE;
    snprintf(source, sizeof source, "%s.%s", stem, alone ? "ply" : "gltf");
    snprintf(baked->path, sizeof baked->path, "%s-%u-%u%s-%u-%u-%u.lspace", stem, options->grid,
             options->patches, options->choose_patches ? "-chosen" : "", options->scene_patches,
             options->divide_above, options->threads);
    if (alone)
    {
        ls_test_mesh_write_ply(mesh, source);
    }
    else
    {
        ls_test_mesh_write_gltf(mesh, source);
    }

    const LsBakeInput input = {.path = source};
    LsError error = {.result = LS_OK};
    LsBakeDesc desc = *options;
    desc.inputs = &input;
    desc.input_count = 1;
    desc.output = baked->path;
    desc.force = true;
    desc.keep_degenerate = mesh->keep_degenerate;
    require(ls_bake_run(&desc, &baked->report, &error), &error);
    remove(source);
    if (!alone)
    {
        snprintf(source, sizeof source, "%s.bin", stem);
        remove(source);
    }

    require(ls_mapping_open(&baked->mapping, baked->path, &error), &error);
    require(
        ls_file_open(&baked->file, baked->mapping.bytes, baked->mapping.size, baked->path, &error),
        &error);
    require(ls_file_check(&baked->file, baked->path, &error), &error);
    require(ls_file_check_hashes(&baked->file, baked->path, &error), &error);
}

void ls_baked_close(LsBaked* baked)
{
    ls_bake_report_destroy(&baked->report);
    ls_mapping_close(&baked->mapping);
    remove(baked->path);
    memset(baked, 0, sizeof *baked);
}
