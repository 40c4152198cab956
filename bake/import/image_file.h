// image_file.h - images of scenes, decoded by stb_image; its file is the only place that names it.

#ifndef LS_IMAGE_FILE_H
#define LS_IMAGE_FILE_H

#include "import.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C"
{
#endif

    // Decodes PNG, JPEG, TGA, BMP or PNM to eight bits a channel, row by row from the top, as
    // PIXELS has it. An image that is none, or larger than LS_MAX_IMAGE_SIDE, is no error: *why then says
    // in a few words what is wrong with it, and the image is left empty; otherwise *why is NULL. `name`
    // is for messages. Errors: LIMIT_MEMORY, OUT_OF_MEMORY.
    LsResult ls_image_decode(LsInput* input, const char* name, const uint8_t* bytes, size_t count,
                             LsInputImage* image, const char** why, LsError* error);

    // Whether an image has sixteen bits a channel, of which decoding keeps eight.
    bool ls_image_is_deep(const uint8_t* bytes, size_t count);

    // Reads and decodes a file. One that cannot be read is no error either.
    LsResult ls_image_file_read(LsInput* input, const char* path, LsInputImage* image,
                                const char** why, LsError* error);

#ifdef __cplusplus
}
#endif

#endif
