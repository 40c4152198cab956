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

#define LS_MESSAGES_PLY(X)       \
    X(PLY_HEADER, 3001)          \
    X(PLY_HEADER_CUT, 3002)      \
    X(PLY_NO_POSITIONS, 3003)    \
    X(PLY_NO_CORNERS, 3004)      \
    X(PLY_CUT, 3005)             \
    X(PLY_NUMBER, 3006)          \
    X(PLY_CORNER, 3101)          \
    X(PLY_TYPE, 3501)            \
    X(PLY_LIMIT, 3701)           \
    X(PLY_HEADER_LIMIT, 3702)    \
    X(PLY_PROPERTIES_LEFT, 3801) \
    X(PLY_ELEMENT_LEFT, 3802)    \
    X(PLY_HEADER_LINE, 3803)     \
    X(PLY_TEXTURE, 3804)         \
    X(PLY_SMALL_FACES, 3805)     \
    X(PLY_TRAILING, 3806)        \
    X(PLY_POINTS, 3807)

#define LS_MESSAGES_OBJ(X)   \
    X(OBJ_NOTHING, 3020)     \
    X(OBJ_NUMBER, 3021)      \
    X(MTL_NUMBER, 3022)      \
    X(TEXT_ZERO_BYTE, 3023)  \
    X(OBJ_CORNER, 3120)      \
    X(OBJ_LIMIT, 3720)       \
    X(OBJ_LIBRARY, 3820)     \
    X(OBJ_MATERIAL, 3821)    \
    X(OBJ_STATEMENT, 3822)   \
    X(OBJ_VERTEX_REST, 3823) \
    X(OBJ_SMOOTHING, 3824)   \
    X(OBJ_SMALL_FACES, 3825) \
    X(OBJ_POINTS, 3826)      \
    X(MTL_STATEMENT, 3827)   \
    X(MTL_OPTION, 3828)      \
    X(MTL_IMAGE, 3829)       \
    X(MTL_BLEND, 3830)       \
    X(MTL_ALPHA_MAP, 3831)

#define LS_MESSAGES_OFF(X)   \
    X(OFF_HEADER, 3040)      \
    X(OFF_CUT, 3041)         \
    X(OFF_NUMBER, 3042)      \
    X(OFF_LAYOUT, 3043)      \
    X(OFF_CORNER, 3140)      \
    X(OFF_DIMENSION, 3540)   \
    X(OFF_LIMIT, 3740)       \
    X(OFF_REST, 3840)        \
    X(OFF_SMALL_FACES, 3841) \
    X(OFF_FACE_COLORS, 3842) \
    X(OFF_POINTS, 3843)      \
    X(OFF_TRAILING, 3844)

#define LS_MESSAGES_STL(X) \
    X(STL_LINE, 3055)      \
    X(STL_CUT, 3056)       \
    X(STL_NUMBER, 3057)    \
    X(STL_SIZE, 3058)      \
    X(STL_LIMIT, 3755)     \
    X(STL_COLORS, 3855)    \
    X(STL_TRAILING, 3856)

#define LS_MESSAGES_GLTF(X)

// The scene as a whole, whatever its files: mesh stage, placement, materials, limits.
#define LS_MESSAGES_SCENE(X)

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
