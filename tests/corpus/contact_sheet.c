// contact_sheet.c - looks at many pictures at once: which of them are empty, and all of them side by
// side on one sheet for a person.
//
// usage: contact_sheet LIST [SHEET.png]
// LIST has a line for each picture: its path, a tab, its label. Prints for each, in order, the label
// and "flat" (all pixels equal) or "varied". Pictures of different sizes are cut or padded to the
// first one's.

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include <stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>
// A header of static functions, of which some are left.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_easy_font.h>
#pragma GCC diagnostic pop

#define COLUMNS 10
#define MARGIN 4
#define LABEL_LINE 10 // pixels, of the font
#define LABEL_LINES 5

typedef struct Picture
{
    char* path;
    char* label;
    unsigned char* pixels; // RGB
    int width, height;
} Picture;

typedef struct Sheet
{
    unsigned char* pixels; // RGB
    int width, height;
} Sheet;

static bool is_flat(const Picture* picture)
{
    const size_t count = (size_t)picture->width * (size_t)picture->height;
    for (size_t i = 1; i < count; i++)
    {
        if (memcmp(picture->pixels, picture->pixels + 3 * i, 3) != 0)
        {
            return false;
        }
    }
    return true;
}

static void fill(Sheet* sheet, int left, int top, int right, int bottom, unsigned char value)
{
    for (int y = top < 0 ? 0 : top; y < bottom && y < sheet->height; y++)
    {
        for (int x = left < 0 ? 0 : left; x < right && x < sheet->width; x++)
        {
            memset(sheet->pixels + 3 * ((size_t)y * (size_t)sheet->width + (size_t)x), value, 3);
        }
    }
}

// The label from (x, y), broken into lines of `width` pixels.
static void draw_label(Sheet* sheet, const char* label, int x, int y, int width)
{
    // A quad of the font: four of these, clockwise from the upper left.
    typedef struct Corner
    {
        float x, y, z;
        unsigned char color[4];
    } Corner;
    static Corner corners[4 * 4000];

    const char* rest = label;
    for (int line = 0; line < LABEL_LINES && *rest != '\0'; line++)
    {
        char text[256];
        size_t length = strlen(rest);
        length = length < sizeof text ? length : sizeof text - 1;
        do
        {
            memcpy(text, rest, length);
            text[length] = '\0';
        } while (stb_easy_font_width(text) > width && --length > 1);
        rest += length;

        const int quads = stb_easy_font_print(0, 0, text, NULL, corners, (int)sizeof corners);
        for (int i = 0; i < quads; i++)
        {
            const Corner* quad = &corners[4 * i];
            fill(sheet, x + (int)quad[0].x, y + LABEL_LINE * line + (int)quad[0].y,
                 x + (int)quad[2].x, y + LABEL_LINE * line + (int)quad[2].y, 0);
        }
    }
}

static void place(Sheet* sheet, const Picture* picture, int left, int top, int width, int height)
{
    for (int y = 0; y < picture->height && y < height; y++)
    {
        const int kept = picture->width < width ? picture->width : width;
        memcpy(sheet->pixels + 3 * ((size_t)(top + y) * (size_t)sheet->width + (size_t)left),
               picture->pixels + 3 * (size_t)y * (size_t)picture->width, 3 * (size_t)kept);
    }
}

static bool write_sheet(const Picture* pictures, size_t count, const char* path)
{
    const int width = pictures[0].width;
    const int height = pictures[0].height;
    const int step_x = width + MARGIN;
    const int step_y = height + MARGIN + LABEL_LINE * LABEL_LINES;
    const int columns = count < COLUMNS ? (int)count : COLUMNS;
    const int rows = (int)((count + COLUMNS - 1) / COLUMNS);
    Sheet sheet = {.width = columns * step_x + MARGIN, .height = rows * step_y + MARGIN};
    sheet.pixels = malloc(3 * (size_t)sheet.width * (size_t)sheet.height);
    if (sheet.pixels == NULL)
    {
        return false;
    }
    fill(&sheet, 0, 0, sheet.width, sheet.height, 255);
    for (size_t i = 0; i < count; i++)
    {
        const int left = MARGIN + (int)(i % COLUMNS) * step_x;
        const int top = MARGIN + (int)(i / COLUMNS) * step_y;
        place(&sheet, &pictures[i], left, top, width, height);
        draw_label(&sheet, pictures[i].label, left, top + height + 1, width);
    }
    const bool is_written =
        stbi_write_png(path, sheet.width, sheet.height, 3, sheet.pixels, 3 * sheet.width) != 0;
    free(sheet.pixels);
    return is_written;
}

// Reads LIST and the pictures it names; exits when one cannot be read.
static Picture* read_pictures(const char* list_path, size_t* out_count)
{
    FILE* list = fopen(list_path, "r");
    if (list == NULL)
    {
        fprintf(stderr, "contact_sheet: %s cannot be read\n", list_path);
        exit(1);
    }
    Picture* pictures = NULL;
    size_t count = 0;
    char line[2048];
    while (fgets(line, sizeof line, list) != NULL)
    {
        line[strcspn(line, "\n")] = '\0';
        char* tab = strchr(line, '\t');
        Picture* more = realloc(pictures, (count + 1) * sizeof *pictures);
        if (tab == NULL || more == NULL)
        {
            fprintf(stderr, "contact_sheet: %s: no tab in a line, or out of memory\n", list_path);
            exit(1);
        }
        *tab = '\0';
        pictures = more;
        Picture* picture = &pictures[count++];
        picture->path = strdup(line);
        picture->label = strdup(tab + 1);
        picture->pixels = stbi_load(line, &picture->width, &picture->height, NULL, 3);
        if (picture->path == NULL || picture->label == NULL || picture->pixels == NULL)
        {
            fprintf(stderr, "contact_sheet: %s is no picture\n", line);
            exit(1);
        }
    }
    fclose(list);
    *out_count = count;
    return pictures;
}

int main(int argc, char** argv)
{
    if (argc != 2 && argc != 3)
    {
        fputs("usage: contact_sheet LIST [SHEET.png]\n", stderr);
        return 1;
    }
    size_t count = 0;
    Picture* pictures = read_pictures(argv[1], &count);
    for (size_t i = 0; i < count; i++)
    {
        printf("%s\t%s\n", pictures[i].label, is_flat(&pictures[i]) ? "flat" : "varied");
    }
    int code = 0;
    if (argc == 3 && (count == 0 || !write_sheet(pictures, count, argv[2])))
    {
        fprintf(stderr, "contact_sheet: %s cannot be written, or there is no picture\n", argv[2]);
        code = 1;
    }
    for (size_t i = 0; i < count; i++)
    {
        free(pictures[i].path);
        free(pictures[i].label);
        stbi_image_free(pictures[i].pixels);
    }
    free(pictures);
    return code;
}
