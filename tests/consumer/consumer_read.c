// consumer_read.c - opens the file named and prints how many triangles it has.
#include "ls_format.h"

#include <stdio.h>

int main(int argc, char** argv)
{
    if (argc != 2)
    {
        return LS_EXIT_USAGE;
    }
    LsError error;
    LsMapping mapping;
    LsResult result = ls_mapping_open(&mapping, argv[1], &error);
    if (result == LS_OK)
    {
        LsFile file;
        result = ls_file_open(&file, mapping.bytes, mapping.size, argv[1], &error);
        if (result == LS_OK)
        {
            result = ls_file_check(&file, argv[1], &error);
        }
        if (result == LS_OK)
        {
            printf("%u triangles\n", ls_file_count(&file, LS_CHUNK_TRIANGLES));
        }
        ls_mapping_close(&mapping);
    }
    if (result != LS_OK)
    {
        fprintf(stderr, "%s\n", error.text);
    }
    return ls_result_exit_code(result);
}
