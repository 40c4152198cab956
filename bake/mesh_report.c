// mesh_report.c - totals, and a list of the objects with faults.

#include "mesh_report.h"

#include <stdlib.h>
#include <string.h>

const char* ls_mesh_fault_text(LsMeshFault fault)
{
    static const char* const texts[] = {
#define LS_MESH_FAULT_TEXT(name, text) text,
        LS_MESH_FAULT_LIST(LS_MESH_FAULT_TEXT)
#undef LS_MESH_FAULT_TEXT
    };
    return (unsigned)fault < LS_MESH_FAULT_COUNT ? texts[fault] : "unknown";
}

uint64_t ls_mesh_fault_count(const LsMeshReport* mesh, LsMeshFault fault)
{
    switch (fault)
    {
    case LS_MESH_FAULT_DEGENERATE:
        return mesh->degenerate_count;
    case LS_MESH_FAULT_DUPLICATE:
        return mesh->duplicate_count;
    case LS_MESH_FAULT_INVERTED:
        return mesh->inverted_count;
    case LS_MESH_FAULT_UNORIENTABLE:
        return mesh->unorientable_count;
    case LS_MESH_FAULT_HOLE:
        return mesh->hole_count;
    case LS_MESH_FAULT_NONMANIFOLD:
        return mesh->nonmanifold_edge_count;
    case LS_MESH_FAULT_COUNT:
        break;
    }
    return 0;
}

static void add_counts(LsMeshReport* sum, const LsMeshReport* mesh)
{
    sum->input_vertex_count += mesh->input_vertex_count;
    sum->vertex_count += mesh->vertex_count;
    sum->face_count += mesh->face_count;
    sum->degenerate_count += mesh->degenerate_count;
    sum->duplicate_count += mesh->duplicate_count;
    sum->inverted_count += mesh->inverted_count;
    sum->unorientable_count += mesh->unorientable_count;
    sum->edge_count += mesh->edge_count;
    sum->boundary_edge_count += mesh->boundary_edge_count;
    sum->nonmanifold_edge_count += mesh->nonmanifold_edge_count;
    sum->hole_count += mesh->hole_count;
}

static bool copy_examples(LsObjectReport* object, const LsMeshExamples* examples)
{
    object->examples = malloc(sizeof(LsMeshExample) * LS_MESH_FAULT_COUNT * LS_MESH_EXAMPLES);
    if (object->examples == NULL)
    {
        return false;
    }
    for (int fault = 0; fault < LS_MESH_FAULT_COUNT; fault++)
    {
        memcpy(object->examples + object->example_count, examples->of[fault],
               sizeof(LsMeshExample) * examples->count[fault]);
        object->example_count += examples->count[fault];
    }
    // A scene may have very many objects with a fault or two.
    LsMeshExample* fitting =
        realloc(object->examples, sizeof(LsMeshExample) * object->example_count);
    object->examples = fitting != NULL ? fitting : object->examples;
    return true;
}

bool ls_mesh_report_add(LsBakeReport* report, uint32_t object, const char* input, const char* name,
                        const LsMeshFindings* findings)
{
    add_counts(&report->mesh, &findings->report);
    uint32_t faults = 0;
    for (int fault = 0; fault < LS_MESH_FAULT_COUNT; fault++)
    {
        faults += findings->examples.count[fault];
    }
    if (faults == 0)
    {
        return true;
    }
    // The room doubles whenever the count reaches a power of two.
    uint32_t count = report->faulty_count;
    if ((count & (count - 1)) == 0)
    {
        size_t room = count > 0 ? 2 * (size_t)count : 1;
        LsObjectReport* grown = realloc(report->faulty, room * sizeof *grown);
        if (grown == NULL)
        {
            return false;
        }
        report->faulty = grown;
    }
    LsObjectReport* added = &report->faulty[report->faulty_count++];
    *added = (LsObjectReport){.object = object,
                              .input = strdup(input),
                              .name = name != NULL ? strdup(name) : NULL,
                              .mesh = findings->report};
    return copy_examples(added, &findings->examples) && added->input != NULL &&
           (name == NULL || added->name != NULL);
}

void ls_bake_report_destroy(LsBakeReport* report)
{
    for (uint32_t i = 0; i < report->faulty_count; i++)
    {
        free(report->faulty[i].input);
        free(report->faulty[i].name);
        free(report->faulty[i].examples);
    }
    free(report->faulty);
    *report = (LsBakeReport){0};
}
