// image_file.c - images of scenes, decoded by stb_image; the only place that names it.

#include "image_file.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// Not all of its static functions are used.
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_NO_PIC
#define STBI_NO_GIF
#define STBI_NO_PSD
#include <stb_image.h>

static_assert(sizeof(uint32_t) == 4 * sizeof(stbi_uc), "a pixel is four bytes");

LsResult ls_image_decode(LsInput* input, const char* name, const uint8_t* bytes, size_t count,
                         LsInputImage* image, const char** why, LsError* error)
{
    *image = (LsInputImage){0};
    *why = "it is no image of a kind that is read (PNG, JPEG, TGA, BMP, PNM)";
    int width = 0;
    int height = 0;
    int channels = 0;
    if (count == 0 || count > INT_MAX ||
        !stbi_info_from_memory(bytes, (int)count, &width, &height, &channels) || width < 1 ||
        height < 1)
        return LS_OK;
    if (width > LS_MAX_IMAGE_SIDE || height > LS_MAX_IMAGE_SIDE)
    {
        *why = "it has more than 16384 pixels a side";
        return LS_OK;
    }
    const uint64_t image_bytes = (uint64_t)width * (uint64_t)height * 4;
    // The decoder needs about as much twice more for what it unpacks.
    const LsResult result = ls_input_reserve(input, name, 3 * image_bytes, 0, error);
    if (result != LS_OK)
        return result;
    stbi_uc* pixels = stbi_load_from_memory(bytes, (int)count, &width, &height, &channels, 4);
    input->memory_bytes -= 2 * image_bytes;
    if (!pixels)
    {
        input->memory_bytes -= image_bytes;
        const char* reason = stbi_failure_reason();
        if (reason && !strcmp(reason, "outofmem"))
            return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                                "%s: out of memory for an image of %d by %d pixels", name, width,
                                height);
        *why = "its data is damaged";
        return LS_OK;
    }
    // Red is the low byte of a pixel, whatever the byte order.
    uint32_t* words = (uint32_t*)(void*)pixels;
    for (size_t i = 0; i < (size_t)(image_bytes / 4); i++)
        words[i] = pixels[4 * i] | (uint32_t)pixels[4 * i + 1] << 8 |
                   (uint32_t)pixels[4 * i + 2] << 16 | (uint32_t)pixels[4 * i + 3] << 24;
    image->width = (uint32_t)width;
    image->height = (uint32_t)height;
    image->pixels = words;
    *why = NULL;
    return LS_OK;
}

bool ls_image_is_deep(const uint8_t* bytes, size_t count)
{
    return count <= INT_MAX && stbi_is_16_bit_from_memory(bytes, (int)count);
}

LsResult ls_image_file_read(LsInput* input, const char* path, LsInputImage* image, const char** why,
                            LsError* error)
{
    struct stat status;
    *image = (LsInputImage){0};
    *why = "there is no such file";
    if (stat(path, &status) || !S_ISREG(status.st_mode))
        return LS_OK;
    *why = "the file cannot be read";
    FILE* file = fopen(path, "rb");
    if (!file)
        return LS_OK;
    const uint64_t size = (uint64_t)status.st_size;
    LsResult result = LS_OK;
    uint8_t* bytes = NULL;
    if (size <= INT_MAX)
        result = ls_input_reserve(input, path, size, 0, error);
    if (result == LS_OK && size <= INT_MAX)
    {
        bytes = malloc((size_t)size + 1);
        if (!bytes)
            result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory", path);
        else if (fread(bytes, 1, (size_t)size, file) == size)
            result = ls_image_decode(input, path, bytes, (size_t)size, image, why, error);
        // Of the file's own bytes nothing stays.
        input->memory_bytes -= size;
    }
    free(bytes);
    fclose(file);
    return result;
}
