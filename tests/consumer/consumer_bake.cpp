// consumer_bake.cpp - bakes a mesh file, in C++17.
#include "ls_bake.h"

#include <cstdio>

int main(int argc, char** argv)
{
    if (argc != 3)
    {
        return LS_EXIT_USAGE;
    }
    LsBakeInput input{};
    input.path = argv[1];
    LsBakeDesc desc{};
    desc.inputs = &input;
    desc.input_count = 1;
    desc.output = argv[2];
    LsError error;
    const LsResult result = ls_bake_run(&desc, nullptr, &error);
    if (result != LS_OK)
    {
        std::fprintf(stderr, "%s\n", error.text);
    }
    return ls_result_exit_code(result);
}
