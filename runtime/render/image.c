#include "image.h"

#include "ls_write.h"

#include <math.h>
#include <stb_image_write.h>
#include <stdlib.h>
#include <string.h>
#include <tinyexr.h>

typedef struct ByteSink
{
    unsigned char* bytes;
    size_t size;
} ByteSink;

// stb hands over the whole file at once; a failed copy leaves the sink empty.
static void take_bytes(void* user, void* data, int size)
{
    ByteSink* sink = user;
    sink->bytes = malloc((size_t)size);
    if (sink->bytes)
    {
        memcpy(sink->bytes, data, (size_t)size);
        sink->size = (size_t)size;
    }
}

static unsigned char encode_srgb(float linear)
{
    double x = linear > 0.0f ? fmin(linear, 1.0) : 0.0;
    double y = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
    return (unsigned char)(255.0 * y + 0.5);
}

LsResult ls_image_write_png(const float* rgba, uint32_t width, uint32_t height, const char* path,
                            LsError* error)
{
    size_t count = (size_t)width * height;
    unsigned char* rgb = malloc(3 * count);
    ByteSink sink = {0};
    if (rgb)
    {
        for (size_t i = 0; i < count; i++)
        {
            for (size_t c = 0; c < 3; c++)
            {
                rgb[3 * i + c] = encode_srgb(rgba[4 * i + c]);
            }
        }
        stbi_write_png_to_func(take_bytes, &sink, (int)width, (int)height, 3, rgb, 0);
    }
    free(rgb);

    LsResult result = sink.bytes ? ls_bytes_write(sink.bytes, sink.size, path, error)
                                 : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                                                "%s: no memory to encode the picture", path);
    free(sink.bytes);
    return result;
}

// Fills `planes` with B, G, R, the order in which EXR sorts channels by name.
static void split_planes(const float* rgba, size_t count, float* planes)
{
    for (size_t i = 0; i < count; i++)
    {
        planes[i] = rgba[4 * i + 2];
        planes[count + i] = rgba[4 * i + 1];
        planes[2 * count + i] = rgba[4 * i];
    }
}

LsResult ls_image_write_exr(const float* rgba, uint32_t width, uint32_t height, const char* path,
                            LsError* error)
{
    size_t count = (size_t)width * height;
    float* planes = malloc(3 * count * sizeof(float));
    if (!planes)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: no memory to encode the picture",
                            path);
    }
    split_planes(rgba, count, planes);

    EXRChannelInfo channels[3] = {{.name = "B"}, {.name = "G"}, {.name = "R"}};
    int types[3] = {TINYEXR_PIXELTYPE_FLOAT, TINYEXR_PIXELTYPE_FLOAT, TINYEXR_PIXELTYPE_FLOAT};
    unsigned char* pointers[3] = {(unsigned char*)planes, (unsigned char*)(planes + count),
                                  (unsigned char*)(planes + 2 * count)};
    EXRHeader header;
    EXRImage image;
    InitEXRHeader(&header);
    InitEXRImage(&image);
    header.num_channels = 3;
    header.channels = channels;
    header.pixel_types = types;
    header.requested_pixel_types = types;
    header.compression_type = TINYEXR_COMPRESSIONTYPE_ZIP;
    image.num_channels = 3;
    image.images = pointers;
    image.width = (int)width;
    image.height = (int)height;

    unsigned char* bytes = NULL;
    const char* complaint = NULL;
    size_t size = SaveEXRImageToMemory(&image, &header, &bytes, &complaint);
    LsResult result = size > 0 ? ls_bytes_write(bytes, size, path, error)
                               : ls_error_set(error, LS_MESSAGE_OUTPUT_UNWRITABLE,
                                              "%s: cannot be encoded as EXR: %s", path,
                                              complaint ? complaint : "no reason given");
    FreeEXRErrorMessage(complaint);
    free(bytes);
    free(planes);
    return result;
}
