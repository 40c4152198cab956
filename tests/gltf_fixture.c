// gltf_fixture.c - see gltf_fixture.h.

#include "gltf_fixture.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

static char folder[] = "/tmp/ls-test-gltf-XXXXXX";

int gltf_make_folder(void** state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

int gltf_remove_folder(void** state)
{
    (void)state;
    DIR* files = opendir(folder);
    for (struct dirent* file; files && (file = readdir(files));)
        if (file->d_name[0] != '.')
            unlink(gltf_find_path(file->d_name));
    if (files)
        closedir(files);
    return rmdir(folder);
}

const char* gltf_find_path(const char* name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

void gltf_write_bytes(const char* name, const void* bytes, size_t size)
{
    unlink(gltf_find_path(name)); // some file systems wait for the disk when a file is cut
    FILE* file = fopen(gltf_find_path(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

// ---- Buffer, views, accessors -------------------------------------------------------------------

static uint8_t buffer[1 << 16];
static size_t buffer_bytes;
static char views[1 << 14], accessors[1 << 14];
static size_t views_length, accessors_length;
static int view_count, accessor_count;

void gltf_begin(void)
{
    buffer_bytes = views_length = accessors_length = 0;
    view_count = accessor_count = 0;
    views[0] = accessors[0] = '\0';
    memset(buffer, 0, sizeof buffer);
}

const float gltf_corners[7][3] = {
    {0, 0, 0},     {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5f, -1.25f, 0.1f}, {1e-7f, 2.5e6f, -0.3f},
    {2, 0, -0.0f},
};

void gltf_begin_corners(size_t count)
{
    gltf_begin();
    assert_int_equal(gltf_add_floats(&gltf_corners[0][0], count, 3), 0);
}

int gltf_add_view(const void* bytes, size_t size, int stride)
{
    buffer_bytes = (buffer_bytes + 3) / 4 * 4;
    assert_true(size <= sizeof buffer - buffer_bytes);
    if (size)
        memcpy(buffer + buffer_bytes, bytes, size);
    char stride_text[64] = "";
    if (stride)
        snprintf(stride_text, sizeof stride_text, ",\"byteStride\":%d", stride);
    views_length += (size_t)snprintf(views + views_length, sizeof views - views_length,
                                     "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu%s}",
                                     view_count ? "," : "", buffer_bytes, size, stride_text);
    buffer_bytes += size;
    return view_count++;
}

int gltf_add_accessor(int view, size_t offset, int component, size_t count, const char* type,
                      const char* more)
{
    char view_text[64] = "";
    if (view >= 0)
        snprintf(view_text, sizeof view_text, "\"bufferView\":%d,\"byteOffset\":%zu,", view,
                 offset);
    accessors_length += (size_t)snprintf(
        accessors + accessors_length, sizeof accessors - accessors_length,
        "%s{%s\"componentType\":%d,\"count\":%zu,\"type\":\"%s\"%s%s}", accessor_count ? "," : "",
        view_text, component, count, type, *more ? "," : "", more);
    return accessor_count++;
}

int gltf_add_floats(const float* values, size_t count, int width)
{
    static const char* const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    const int view = gltf_add_view(values, count * (size_t)width * sizeof(float), 0);
    return gltf_add_accessor(view, 0, F32, count, types[width], "");
}

int gltf_add_words(const uint16_t* values, size_t count)
{
    return gltf_add_accessor(gltf_add_view(values, count * sizeof *values, 0), 0, U16, count,
                             "SCALAR", "");
}

const char* gltf_print(const char* uri, const char* members)
{
    static char text[1 << 17];
    const int length =
        snprintf(text, sizeof text,
                 "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu%s%s%s}],"
                 "\"bufferViews\":[%s],\"accessors\":[%s]%s%s}",
                 buffer_bytes, uri ? ",\"uri\":\"" : "", uri ? uri : "", uri ? "\"" : "", views,
                 accessors, *members ? "," : "", members);
    assert_true(length > 0 && (size_t)length < sizeof text);
    return text;
}

void gltf_write(const char* members)
{
    gltf_write_bytes("a.bin", buffer, buffer_bytes);
    const char* text = gltf_print("a.bin", members);
    gltf_write_bytes("a.gltf", text, strlen(text));
}

size_t gltf_print_glb(const char* members, uint8_t* bytes)
{
    const char* text = gltf_print(NULL, members);
    const size_t length = strlen(text), padded = (length + 3) / 4 * 4;
    const size_t data = (buffer_bytes + 3) / 4 * 4;
    const uint32_t header[5] = {0x46546C67, 2, (uint32_t)(28 + padded + data), (uint32_t)padded,
                                0x4E4F534A};
    const uint32_t chunk[2] = {(uint32_t)data, 0x004E4942};
    memcpy(bytes, header, sizeof header);
    memset(bytes + 20, ' ', padded);
    memcpy(bytes + 20, text, length);
    memcpy(bytes + 20 + padded, chunk, sizeof chunk);
    memcpy(bytes + 28 + padded, buffer, data);
    return 28 + padded + data;
}

const char* gltf_print_data_uri(const char* kind, const void* bytes, size_t size)
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static char text[1 << 16];
    size_t length = (size_t)snprintf(text, sizeof text, "data:%s;base64,", kind);
    const uint8_t* data = bytes;
    for (size_t i = 0; i < size; i += 3)
    {
        const uint32_t word = (uint32_t)data[i] << 16 |
                              (i + 1 < size ? (uint32_t)data[i + 1] << 8 : 0) |
                              (i + 2 < size ? (uint32_t)data[i + 2] : 0);
        assert_true(length + 5 < sizeof text);
        for (int k = 0; k < 4; k++)
            text[length++] = i + (size_t)k > size ? '=' : letters[word >> (18 - 6 * k) & 63];
    }
    text[length] = '\0';
    return text;
}

// ---- Imports ------------------------------------------------------------------------------------

LsInput gltf_import(const char* name)
{
    LsInput input = {0};
    LsError error;
    if (ls_import(&input, gltf_find_path(name), &error) != LS_OK)
        fail_msg("%s", error.text);
    return input;
}

void gltf_check_refused(const char* name, LsMessage message, const char* word)
{
    LsInput input = {0};
    LsError error = {0};
    const LsResult result = ls_import(&input, gltf_find_path(name), &error);
    ls_input_destroy(&input);
    if (result != (LsResult)(message / 100) || error.message != (uint32_t)message ||
        !strstr(error.text, name) || !strstr(error.text, word) || strchr(error.text, '\n'))
        fail_msg("%s: %u instead of %d, or no \"%s\" in: %s", name, error.message, message, word,
                 error.text);
}

void gltf_check_members_refused(const char* members, LsMessage message, const char* word)
{
    gltf_write(members);
    gltf_check_refused("a.gltf", message, word);
}

void gltf_check_warned(const LsInput* input, const char* name, LsMessage message, const char* word)
{
    bool is_found = false;
    for (uint32_t i = 0; i < input->warning_count; i++)
        is_found = is_found || (input->warnings[i].message == (uint32_t)message &&
                                strstr(input->warnings[i].text, name) &&
                                strstr(input->warnings[i].text, word) &&
                                !strchr(input->warnings[i].text, '\n'));
    for (uint32_t i = 0; i < input->warning_count && !is_found; i++)
        print_message("%u: %s\n", input->warnings[i].message, input->warnings[i].text);
    if (!is_found)
        fail_msg("no warning %d with \"%s\"", message, word);
    LsInput strict = {.options.strict = true};
    LsError error = {0};
    const LsResult result = ls_import(&strict, gltf_find_path(name), &error);
    ls_input_destroy(&strict);
    assert_int_equal(result, LS_ERROR_INPUT_WARNING);
    assert_int_equal(error.message / 100, LS_ERROR_INPUT_WARNING);
}

// ---- PNG ----------------------------------------------------------------------------------------

static void put_big(uint8_t* bytes, uint32_t word)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(word >> (24 - 8 * i));
}

// ISO 3309, as PNG's annex D asks.
static uint32_t find_crc(const uint8_t* bytes, size_t size)
{
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < size; i++)
    {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    }
    return ~crc;
}

static size_t put_chunk(uint8_t* png, const char* kind, const uint8_t* data, size_t size)
{
    put_big(png, (uint32_t)size);
    memcpy(png + 4, kind, 4);
    if (size)
        memcpy(png + 8, data, size);
    put_big(png + 8 + size, find_crc(png + 4, size + 4));
    return size + 12;
}

size_t gltf_make_png(uint8_t* png, uint32_t width, uint32_t height, int depth,
                     const uint8_t* pixels)
{
    static const uint8_t start[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    static uint8_t packed[1 << 16];
    const size_t row = (size_t)width * 4;
    size_t size = 7; // zlib's header and that of one stored block
    for (uint32_t y = 0; y < height; y++)
    {
        packed[size++] = 0; // no filter
        for (size_t i = 0; i < row; i++)
            for (int k = 0; k < depth / 8; k++)
                packed[size++] = pixels[y * row + i];
    }
    const uint16_t length = (uint16_t)(size - 7), complement = (uint16_t)~length;
    packed[0] = 0x78, packed[1] = 0x01, packed[2] = 1;
    memcpy(packed + 3, &length, 2);
    memcpy(packed + 5, &complement, 2);
    uint32_t a = 1, b = 0; // Adler-32
    for (size_t i = 7; i < size; i++)
        a = (a + packed[i]) % 65521, b = (b + a) % 65521;
    put_big(packed + size, b << 16 | a);

    uint8_t header[13] = {0};
    put_big(header, width);
    put_big(header + 4, height);
    header[8] = (uint8_t)depth;
    header[9] = 6; // RGBA
    memcpy(png, start, sizeof start);
    size_t written = sizeof start;
    written += put_chunk(png + written, "IHDR", header, sizeof header);
    written += put_chunk(png + written, "IDAT", packed, size + 4);
    return written + put_chunk(png + written, "IEND", NULL, 0);
}
