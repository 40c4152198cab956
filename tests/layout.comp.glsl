// layout.comp.glsl - a buffer of each struct of ls_layout.h, for test_layout.c to reflect.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "ls_layout.h"

layout(local_size_x = 1) in;

#define BUFFER(number, type)                                                                       \
    layout(std430, set = 0, binding = number) buffer Buffer##type                                  \
    {                                                                                              \
        type records[];                                                                            \
    }                                                                                              \
    buffer_##type

BUFFER(0, LsTriangle);
BUFFER(1, LsVoxel);
BUFFER(2, LsCellBlock);
BUFFER(3, LsBvhNode);
BUFFER(4, LsObject);
BUFFER(5, LsInstance);
BUFFER(6, LsSceneNode);
BUFFER(7, LsMaterial);
BUFFER(8, LsLight);
BUFFER(9, LsCamera);
BUFFER(10, LsRay);
BUFFER(11, LsHit);
BUFFER(12, LsDeviceScene);
BUFFER(13, LsTraceParams);
BUFFER(14, LsTraceScene);
BUFFER(15, LsSurface);
BUFFER(16, LsTexture);
BUFFER(17, LsImage);
BUFFER(18, LsAttributes);
BUFFER(19, LsTexcoord);
BUFFER(20, LsCornerColor);
BUFFER(21, LsLamp);
BUFFER(22, LsAnimation);
BUFFER(23, LsChannel);
BUFFER(24, LsTraceQueue);
BUFFER(25, LsGridRay);
BUFFER(26, LsListParams);
BUFFER(27, LsGridParams);
BUFFER(28, LsLockstepParams);
BUFFER(29, LsPassInstance);
BUFFER(30, LsPairBox);

void main()
{
}
