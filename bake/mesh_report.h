// mesh_report.h - what the mesh stage found, gathered over all objects.

#ifndef LS_MESH_REPORT_H
#define LS_MESH_REPORT_H

#include "mesh.h"

// Adds an object's findings to the totals of `report`, and to its list if there is any fault.
// `input` is the object's file, `name` its name or NULL; both are copied. False when out of memory.
bool ls_mesh_report_add(LsBakeReport* report, uint32_t object, const char* input, const char* name,
                        const LsMeshFindings* findings);

#endif
