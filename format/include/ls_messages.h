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

#define LS_MESSAGES_USAGE(X)       \
    X(USAGE_OPTION_UNKNOWN, 1001)  \
    X(USAGE_OPTION_VALUE, 1002)    \
    X(USAGE_NUMBER, 1003)          \
    X(USAGE_CHOICE, 1004)          \
    X(USAGE_NO_SCENE, 1005)        \
    X(USAGE_NO_OUTPUT, 1006)       \
    X(USAGE_OUTPUT_IS_INPUT, 1007) \
    X(USAGE_OPTION_PLACE, 1008)    \
    X(USAGE_NOT_GLTF, 1009)        \
    X(LSTRACE_OPTION, 1020)        \
    X(LSTRACE_VALUE, 1021)         \
    X(LSTRACE_FILES, 1022)         \
    X(LSTRACE_REPLACES, 1023)      \
    X(LSVIEW_OPTION, 1040)         \
    X(LSVIEW_VALUE, 1041)          \
    X(LSVIEW_FILES, 1042)          \
    X(LSVIEW_REPLACES, 1043)       \
    X(LSVIEW_WINDOW, 1044)         \
    X(LSINFO_OPTION, 1060)         \
    X(LSINFO_FILES, 1061)          \
    X(LSINFO_COMMAND, 1062)        \
    X(LSBENCH_OPTION, 1070)        \
    X(LSBENCH_VALUE, 1071)         \
    X(LSBENCH_FILES, 1072)         \
    X(TRACE_METHOD, 1080)          \
    X(TRACE_FLAGS, 1081)           \
    X(TRACE_TIMES, 1082)           \
    X(TRACE_COUNT, 1083)           \
    X(TRACE_ADDRESS, 1084)         \
    X(PICTURE_SETTINGS, 1085)

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
    X(STL_COLORS, 3855)    \
    X(STL_TRAILING, 3856)

#define LS_MESSAGES_GLTF(X)         \
    X(GLTF_JSON, 3070)              \
    X(GLTF_GLB, 3071)               \
    X(GLTF_MEMBER, 3072)            \
    X(GLTF_NODE_PARENTS, 3073)      \
    X(GLTF_TRANSFORM, 3074)         \
    X(GLTF_BUFFER, 3075)            \
    X(GLTF_ACCESSOR_TYPE, 3076)     \
    X(GLTF_ACCESSOR, 3077)          \
    X(GLTF_ATTRIBUTE_COUNT, 3078)   \
    X(GLTF_CORNERS, 3079)           \
    X(GLTF_ANIMATION, 3080)         \
    X(GLTF_INDEX, 3170)             \
    X(GLTF_BOUNDS, 3171)            \
    X(GLTF_VERTEX_INDEX, 3172)      \
    X(GLTF_SCENE, 3173)             \
    X(GLTF_NOT_FINITE, 3270)        \
    X(GLTF_RANGE, 3470)             \
    X(GLTF_VERSION, 3570)           \
    X(GLTF_EXTENSION, 3571)         \
    X(GLTF_COMPRESSED, 3572)        \
    X(GLTF_NODE_DEPTH, 3770)        \
    X(GLTF_JSON_DEPTH, 3771)        \
    X(GLTF_COUNT, 3772)             \
    X(GLTF_WARN_EXTENSION, 3870)    \
    X(GLTF_WARN_SCENES, 3871)       \
    X(GLTF_WARN_CAMERA, 3872)       \
    X(GLTF_WARN_SKIN, 3873)         \
    X(GLTF_WARN_MORPH, 3874)        \
    X(GLTF_WARN_POINTS_LINES, 3875) \
    X(GLTF_WARN_NO_POSITION, 3876)  \
    X(GLTF_WARN_ATTRIBUTE, 3877)    \
    X(GLTF_WARN_NOT_FINITE, 3878)   \
    X(GLTF_WARN_UNDECLARED, 3879)   \
    X(GLTF_WARN_BLEND, 3880)        \
    X(GLTF_WARN_OCCLUSION, 3881)    \
    X(GLTF_WARN_TEXTURE, 3882)      \
    X(GLTF_WARN_IMAGE, 3883)        \
    X(GLTF_WARN_IMAGE_DEPTH, 3884)  \
    X(GLTF_WARN_KEYS, 3885)         \
    X(GLTF_WARN_CHANNEL, 3886)

// The scene as a whole, whatever its files: mesh stage, placement, materials, limits.
#define LS_MESSAGES_SCENE(X)     \
    X(PLACE_NO_BOX, 3090)        \
    X(MATERIAL_JSON, 3091)       \
    X(MATERIAL_KEY, 3092)        \
    X(MATERIAL_VALUE, 3093)      \
    X(MATERIAL_NAME, 3094)       \
    X(MESH_NOT_FINITE, 3290)     \
    X(SCENE_NO_TRIANGLES, 3390)  \
    X(SCENE_ALL_FLAT, 3391)      \
    X(MESH_FAR, 3490)            \
    X(MESH_EXTENT, 3491)         \
    X(PLACE_RANGE, 3495)         \
    X(TRANSFORM_SINGULAR, 3690)  \
    X(TRANSFORM_CONDITION, 3691) \
    X(TRANSFORM_RANGE, 3692)     \
    X(LIMIT_RECORDS, 3792)       \
    X(PLACE_DEPTH, 3795)         \
    X(LIMIT_BUDGET, 3796)        \
    X(MESH_NORMAL, 3895)         \
    X(MESH_TEXCOORD, 3896)       \
    X(MESH_NO_TEXCOORD, 3897)

#define LS_MESSAGES_INPUT(X)  \
    X(RAYS_CUT, 3099)         \
    X(INPUT_ENDING, 3590)     \
    X(LIMIT_TRIANGLES, 3790)  \
    X(LIMIT_MEMORY, 3791)     \
    X(LIMIT_MESH, 3793)       \
    X(LIMIT_FILE_BYTES, 3799) \
    X(PICTURE_NOT_FINITE, 3899)

#define LS_MESSAGES_OUTPUT(X)   \
    X(OUTPUT_UNWRITABLE, 4001)  \
    X(OUTPUT_IS_FOLDER, 4002)   \
    X(OUTPUT_NOT_REGULAR, 4003) \
    X(OUTPUT_STANDARD, 4004)    \
    X(OUTPUT_FULL, 4101)

#define LS_MESSAGES_LSPACE(X)     \
    X(LSPACE_FOREIGN, 5001)       \
    X(LSPACE_BYTE_ORDER, 5101)    \
    X(LSPACE_MAJOR, 5201)         \
    X(LSPACE_READER, 5202)        \
    X(LSPACE_FEATURE, 5301)       \
    X(LSPACE_CHUNK, 5302)         \
    X(LSPACE_CUT, 5401)           \
    X(LSPACE_DAMAGED_HEAD, 5501)  \
    X(LSPACE_DAMAGED_CHUNK, 5502) \
    X(LSPACE_RULE, 5601)

#define LS_MESSAGES_DEVICE(X)      \
    X(VULKAN_DRIVER, 6001)         \
    X(VULKAN_LAYER, 6002)          \
    X(DEVICE_NONE, 6101)           \
    X(DEVICE_NAME, 6102)           \
    X(DEVICE_VERSION, 6201)        \
    X(DEVICE_BUFFER_ADDRESS, 6202) \
    X(DEVICE_COMPUTE, 6203)        \
    X(DEVICE_LOOPS, 6204)          \
    X(DEVICE_MEMORY_FULL, 6301)    \
    X(DEVICE_BUFFER_LIMIT, 6302)   \
    X(DEVICE_LOST, 6401)           \
    X(VULKAN_FUNCTION, 6501)       \
    X(VULKAN_CALL, 6502)           \
    X(DEVICE_MEMORY_KIND, 6503)    \
    X(ANSWERS_DIFFER, 6601)

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
