// ply_header.h - the header of a PLY file: which elements stand in it, and of what they consist.

#ifndef LS_PLY_HEADER_H
#define LS_PLY_HEADER_H

#include "byte_reader.h"

#define LS_PLY_NAME_BYTES 64
#define LS_PLY_MAX_ELEMENTS 64
#define LS_PLY_MAX_PROPERTIES 1024 // of all elements together

typedef enum LsPlyForm
{
    LS_PLY_ASCII,
    LS_PLY_LITTLE,
    LS_PLY_BIG,
} LsPlyForm;

typedef enum LsPlyType
{
    LS_PLY_NO_TYPE, // in place of the count of what is no list
    LS_PLY_INT8,
    LS_PLY_UINT8,
    LS_PLY_INT16,
    LS_PLY_UINT16,
    LS_PLY_INT32,
    LS_PLY_UINT32,
    LS_PLY_FLOAT32,
    LS_PLY_FLOAT64,
} LsPlyType;

// What a property means to us.
typedef enum LsPlyRole
{
    LS_PLY_X,
    LS_PLY_Y,
    LS_PLY_Z,
    LS_PLY_NX,
    LS_PLY_NY,
    LS_PLY_NZ,
    LS_PLY_U,
    LS_PLY_V,
    LS_PLY_RED,
    LS_PLY_GREEN,
    LS_PLY_BLUE,
    LS_PLY_ALPHA,
    LS_PLY_CORNERS,
    LS_PLY_LEFT, // nothing
} LsPlyRole;

typedef struct LsPlyProperty
{
    char name[LS_PLY_NAME_BYTES];
    LsPlyType type;       // of the numbers
    LsPlyType count_type; // of a list's count, or LS_PLY_NO_TYPE
    LsPlyRole role;
} LsPlyProperty;

typedef enum LsPlyKind
{
    LS_PLY_VERTICES,
    LS_PLY_FACES,
    LS_PLY_STRIPS, // triangle strips with -1 between them
    LS_PLY_OTHERS,
} LsPlyKind;

typedef struct LsPlyElement
{
    char name[LS_PLY_NAME_BYTES];
    LsPlyKind kind;
    uint64_t count;
    uint32_t first_property;
    uint32_t property_count;
    uint32_t roles;       // a bit per LsPlyRole that a property has
    uint32_t fixed_bytes; // of a record in binary; 0 if it has lists
} LsPlyElement;

typedef struct LsPlyHeader
{
    LsPlyForm form;
    LsPlyElement elements[LS_PLY_MAX_ELEMENTS];
    uint32_t element_count;
    LsPlyProperty properties[LS_PLY_MAX_PROPERTIES];
    uint32_t property_count;
} LsPlyHeader;

// Reads the header; the reader then stands at the first element. Unknown lines and what the elements
// have beyond what we take are warned of in `input`.
LsResult ls_ply_header_read(LsPlyHeader* header, LsByteReader* reader, LsInput* input);

// Bytes of a number in binary.
uint32_t ls_ply_type_bytes(LsPlyType type);

// The first element of a kind, or NULL.
const LsPlyElement* ls_ply_header_find(const LsPlyHeader* header, LsPlyKind kind);

#endif
