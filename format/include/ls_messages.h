// ls_messages.h - the catalogue of errors and warnings: a stable number for each.
//
// number / 100 is the LsResult, so number, result and exit code can never disagree. A number never
// moves and never comes back with another meaning. docs/errors.md has an entry for each: what it
// means, what to do. Places that fail for the same reason share a number; the text names the place.

#ifndef LS_MESSAGES_H
#define LS_MESSAGES_H

#include "ls_base.h"

// A list per topic: NAME, number. Within each hundred of the 3xxx a topic has its own block: PLY from
// 01, OBJ and MTL from 20, OFF from 40, STL from 55, glTF from 70, all else from 90.

#define LS_MESSAGES_USAGE(X)

#define LS_MESSAGES_FILES(X)  \
    X(FILE_MISSING, 2001)     \
    X(FILE_UNREADABLE, 2101)  \
    X(FILE_CHANGED, 2102)     \
    X(FILE_NOT_REGULAR, 2103) \
    X(FILE_EMPTY, 2201)       \
    X(FILE_IS_FOLDER, 2301)

#define LS_MESSAGES_PLY(X)

#define LS_MESSAGES_OBJ(X)

#define LS_MESSAGES_OFF(X)

#define LS_MESSAGES_STL(X)

#define LS_MESSAGES_GLTF(X)

// The scene as a whole, whatever its files: mesh stage, placement, materials, limits.
#define LS_MESSAGES_SCENE(X)     \
    X(MESH_NOT_FINITE, 3290)     \
    X(SCENE_NO_TRIANGLES, 3390)  \
    X(SCENE_ALL_FLAT, 3391)      \
    X(MESH_FAR, 3490)            \
    X(MESH_EXTENT, 3491)         \
    X(SCENE_RANGE, 3492)         \
    X(TRANSFORM_SINGULAR, 3690)  \
    X(TRANSFORM_CONDITION, 3691) \
    X(TRANSFORM_RANGE, 3692)     \
    X(LIMIT_RECORDS, 3792)       \
    X(MESH_NORMAL, 3895)         \
    X(MESH_TEXCOORD, 3896)       \
    X(MESH_NO_TEXCOORD, 3897)

#define LS_MESSAGES_INPUT(X) \
    X(INPUT_ENDING, 3590)    \
    X(LIMIT_TRIANGLES, 3790) \
    X(LIMIT_MEMORY, 3791)

#define LS_MESSAGES_OUTPUT(X)

#define LS_MESSAGES_LSPACE(X)

#define LS_MESSAGES_DEVICE(X)

#define LS_MESSAGES_MEMORY(X) X(OUT_OF_MEMORY, 7001)

#define LS_MESSAGE_LIST(X) \
    LS_MESSAGES_USAGE(X)   \
    LS_MESSAGES_FILES(X)   \
    LS_MESSAGES_PLY(X)     \
    LS_MESSAGES_OBJ(X)     \
    LS_MESSAGES_OFF(X)     \
    LS_MESSAGES_STL(X)     \
    LS_MESSAGES_GLTF(X)    \
    LS_MESSAGES_SCENE(X)   \
    LS_MESSAGES_INPUT(X)   \
    LS_MESSAGES_OUTPUT(X)  \
    LS_MESSAGES_LSPACE(X)  \
    LS_MESSAGES_DEVICE(X)  \
    LS_MESSAGES_MEMORY(X)

typedef enum LsMessage
{
#define LS_MESSAGE_ENUMERATOR(name, number) LS_MESSAGE_##name = number,
    LS_MESSAGE_LIST(LS_MESSAGE_ENUMERATOR)
#undef LS_MESSAGE_ENUMERATOR
} LsMessage;

#endif
