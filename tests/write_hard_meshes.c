// write_hard_meshes.c - writes one of the meshes of hard_meshes.h as PLY, for tools/hard_geometry.sh.

#include "hard_meshes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char** argv)
{
    for (LsHardMeshId id = 0; argc == 4 && id < LS_HARD_MESH_COUNT; id++)
    {
        if (strcmp(argv[1], ls_hard_mesh_name(id)) == 0)
        {
            LsTestMesh mesh = ls_hard_mesh_make(id, (uint32_t)strtoul(argv[2], NULL, 10));
            ls_test_mesh_write_ply(&mesh, argv[3]);
            ls_test_mesh_destroy(&mesh);
            return EXIT_SUCCESS;
        }
    }
    fputs("usage: write_hard_meshes NAME COUNT OUT.ply; for the names see tests/hard_meshes.h\n",
          stderr);
    return EXIT_FAILURE;
}
