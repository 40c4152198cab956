// ref_topology.c - by sorting and by joining sets, where the baker hashes and walks.
//
// Holes: at each vertex the corners of faces that share an edge of two faces there are joined into
// fans. A boundary edge joins the two fans at its ends. A hole is a set of fans so joined each of
// which has two boundary edges.

#include "ref_topology.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- Files --------------------------------------------------------------------------------------

typedef struct Text
{
    char* bytes;
    size_t size;
    char* at;
} Text;

static bool read_all(Text* text, const char* path)
{
    FILE* file = fopen(path, "rb");
    if (file == NULL)
    {
        return false;
    }
    fseek(file, 0, SEEK_END);
    text->size = (size_t)ftell(file);
    rewind(file);
    text->bytes = malloc(text->size + 1);
    bool ok = text->bytes != NULL && fread(text->bytes, 1, text->size, file) == text->size;
    fclose(file);
    if (ok)
    {
        text->bytes[text->size] = '\0';
        text->at = text->bytes;
    }
    return ok;
}

// The next line that is not blank, without its comment; NULL at the end.
static char* next_line(Text* text)
{
    while (text->at < text->bytes + text->size)
    {
        char* line = text->at;
        size_t length = strcspn(line, "\n\r");
        text->at += length + 1;
        line[length] = '\0';
        line[strcspn(line, "#")] = '\0';
        while (isspace((unsigned char)*line))
        {
            line++;
        }
        if (*line != '\0')
        {
            return line;
        }
    }
    return NULL;
}

static bool make_vertices(LsRefMesh* mesh, uint64_t count)
{
    mesh->vertex_count = (uint32_t)count;
    mesh->positions = calloc(count + 1, 3 * sizeof(float));
    return mesh->positions != NULL;
}

static bool read_vertices(LsRefMesh* mesh, Text* text, uint64_t count)
{
    bool ok = make_vertices(mesh, count);
    for (uint64_t v = 0; v < count && ok; v++)
    {
        char* line = next_line(text);
        ok = line != NULL;
        for (int k = 0; k < 3 && ok; k++)
        {
            char* end;
            mesh->positions[3 * v + k] = strtof(line, &end);
            ok = end != line;
            line = end;
        }
    }
    return ok;
}

static bool add_polygon(LsRefMesh* mesh, uint64_t* room, char* line)
{
    char* end;
    unsigned long corners = strtoul(line, &end, 10), polygon[2] = {0, 0};
    bool ok = end != line;
    for (unsigned long k = 0; k < corners && ok; k++)
    {
        line = end;
        unsigned long corner = strtoul(line, &end, 10);
        ok = end != line && corner < mesh->vertex_count;
        if (k >= 2 && ok)
        {
            if (mesh->face_count == *room)
            {
                *room = 2 * *room + 64;
                mesh->indices = realloc(mesh->indices, *room * 3 * sizeof(uint32_t));
            }
            uint32_t* face = mesh->indices + 3 * (size_t)mesh->face_count++;
            face[0] = (uint32_t)polygon[0];
            face[1] = (uint32_t)polygon[1];
            face[2] = (uint32_t)corner;
        }
        polygon[k == 0 ? 0 : 1] = corner;
    }
    return ok;
}

static bool read_polygons(LsRefMesh* mesh, Text* text, uint64_t count)
{
    uint64_t room = 0;
    bool ok = true;
    for (uint64_t f = 0; f < count && ok; f++)
    {
        char* line = next_line(text);
        ok = line != NULL && add_polygon(mesh, &room, line);
    }
    return ok;
}

static bool read_off(LsRefMesh* mesh, Text* text)
{
    char* line = next_line(text);
    char* counts = line != NULL ? strstr(line, "OFF") : NULL;
    if (counts == NULL)
    {
        return false;
    }
    counts += 3;
    while (isspace((unsigned char)*counts))
    {
        counts++;
    }
    counts = *counts != '\0' ? counts : next_line(text);
    unsigned long vertices, faces;
    return counts != NULL && sscanf(counts, "%lu %lu", &vertices, &faces) == 2 &&
           read_vertices(mesh, text, vertices) && read_polygons(mesh, text, faces);
}

static bool read_ply(LsRefMesh* mesh, Text* text)
{
    unsigned long vertices = 0, faces = 0;
    bool is_text = false;
    for (char* line = next_line(text); line != NULL; line = next_line(text))
    {
        is_text = is_text || strncmp(line, "format ascii", 12) == 0;
        sscanf(line, "element vertex %lu", &vertices);
        sscanf(line, "element face %lu", &faces);
        if (strncmp(line, "end_header", 10) == 0)
        {
            break;
        }
    }
    return is_text && read_vertices(mesh, text, vertices) && read_polygons(mesh, text, faces);
}

static bool read_stl(LsRefMesh* mesh, const Text* text)
{
    uint32_t count = 0;
    if (text->size >= 84)
    {
        memcpy(&count, text->bytes + 80, sizeof count);
    }
    if (text->size < 84 || text->size - 84 != 50ull * count || !make_vertices(mesh, 3ull * count))
    {
        return false;
    }
    mesh->face_count = count;
    mesh->indices = malloc((count + 1ull) * 3 * sizeof(uint32_t));
    for (uint32_t f = 0; f < count && mesh->indices != NULL; f++)
    {
        memcpy(mesh->positions + 9 * (size_t)f, text->bytes + 84 + 50 * (size_t)f + 12, 36);
        for (uint32_t k = 0; k < 3; k++)
        {
            mesh->indices[3 * (size_t)f + k] = 3 * f + k;
        }
    }
    return mesh->indices != NULL;
}

bool ls_ref_mesh_read(LsRefMesh* mesh, const char* path)
{
    *mesh = (LsRefMesh){0};
    Text text = {0};
    const char* ending = strrchr(path, '.');
    bool ok = ending != NULL && read_all(&text, path);
    if (ok)
    {
        ok = strcmp(ending, ".off") == 0   ? read_off(mesh, &text)
             : strcmp(ending, ".ply") == 0 ? read_ply(mesh, &text)
                                           : read_stl(mesh, &text);
    }
    free(text.bytes);
    return ok;
}

void ls_ref_mesh_destroy(LsRefMesh* mesh)
{
    free(mesh->positions);
    free(mesh->indices);
    *mesh = (LsRefMesh){0};
}

// ---- Vertices and faces -------------------------------------------------------------------------

static const float* sorted_positions; // of the mesh being sorted

static int compare_positions(const void* a, const void* b)
{
    const float* p = sorted_positions + 3 * (size_t) * (const uint32_t*)a;
    const float* q = sorted_positions + 3 * (size_t) * (const uint32_t*)b;
    for (int k = 0; k < 3; k++)
    {
        if (p[k] != q[k])
        {
            return p[k] < q[k] ? -1 : 1;
        }
    }
    return 0;
}

static void* allocate(uint64_t count, size_t size)
{
    void* memory = calloc(count + 1, size);
    if (memory == NULL)
    {
        abort();
    }
    return memory;
}

// Corners by welded vertex.
static uint32_t* weld_corners(const LsRefMesh* mesh, bool weld, uint64_t* vertices)
{
    uint32_t* order = allocate(mesh->vertex_count, sizeof *order);
    uint32_t* ids = allocate(mesh->vertex_count, sizeof *ids);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
    {
        order[v] = v;
        ids[v] = v;
    }
    *vertices = mesh->vertex_count;
    if (weld)
    {
        sorted_positions = mesh->positions;
        qsort(order, mesh->vertex_count, sizeof *order, compare_positions);
        *vertices = 0;
        for (uint32_t i = 0; i < mesh->vertex_count; i++)
        {
            *vertices += i == 0 || compare_positions(&order[i - 1], &order[i]) != 0;
            ids[order[i]] = (uint32_t)*vertices - 1;
        }
    }
    uint32_t* corners = allocate(3ull * mesh->face_count, sizeof *corners);
    for (uint64_t c = 0; c < 3ull * mesh->face_count; c++)
    {
        corners[c] = ids[mesh->indices[c]];
    }
    free(order);
    free(ids);
    return corners;
}

static bool is_flat(const LsRefMesh* mesh, uint32_t face)
{
    const uint32_t* v = mesh->indices + 3 * (size_t)face;
    long double a[3], b[3];
    for (int k = 0; k < 3; k++)
    {
        long double origin = mesh->positions[3 * (size_t)v[0] + k];
        a[k] = mesh->positions[3 * (size_t)v[1] + k] - origin;
        b[k] = mesh->positions[3 * (size_t)v[2] + k] - origin;
    }
    return a[0] * b[1] == a[1] * b[0] && a[1] * b[2] == a[2] * b[1] && a[2] * b[0] == a[0] * b[2];
}

typedef struct Triple
{
    uint32_t corner[3];
} Triple;

static int compare_triples(const void* a, const void* b)
{
    const Triple* x = a;
    const Triple* y = b;
    for (int k = 0; k < 3; k++)
    {
        if (x->corner[k] != y->corner[k])
        {
            return x->corner[k] < y->corner[k] ? -1 : 1;
        }
    }
    return 0;
}

static int compare_words(const void* a, const void* b)
{
    uint32_t x = *(const uint32_t*)a, y = *(const uint32_t*)b;
    return (x > y) - (x < y);
}

// ---- Edges --------------------------------------------------------------------------------------

// A side of a face, which runs from vertex `from` to the other of its two.
typedef struct RefSide
{
    uint32_t low, high, face, from;
} RefSide;

static int compare_ref_sides(const void* a, const void* b)
{
    const RefSide* x = a;
    const RefSide* y = b;
    if (x->low != y->low)
    {
        return x->low < y->low ? -1 : 1;
    }
    if (x->high != y->high)
    {
        return x->high < y->high ? -1 : 1;
    }
    return (x->face > y->face) - (x->face < y->face);
}

// How many of `count` sorted sides have the two vertices of the first.
static uint64_t run_length(const RefSide* sides, uint64_t count)
{
    uint64_t n = 1;
    while (n < count && sides[n].low == sides->low && sides[n].high == sides->high)
    {
        n++;
    }
    return n;
}

static uint64_t find_set(uint64_t* sets, uint64_t i)
{
    while (sets[i] != i)
    {
        sets[i] = sets[sets[i]];
        i = sets[i];
    }
    return i;
}

static uint64_t* make_sets(uint64_t count)
{
    uint64_t* sets = allocate(count, sizeof *sets);
    for (uint64_t i = 0; i < count; i++)
    {
        sets[i] = i;
    }
    return sets;
}

// The corner of a face at a vertex.
static uint64_t corner_at(const uint32_t* corners, uint32_t face, uint32_t vertex)
{
    uint64_t c = 3ull * face;
    while (corners[c] != vertex)
    {
        c++;
    }
    return c;
}

static uint64_t count_holes(const uint32_t* corners, uint64_t corner_count, const RefSide* sides,
                            uint64_t side_count)
{
    uint64_t* fans = make_sets(corner_count);
    for (uint64_t i = 0, n = 0; i < side_count; i += n)
    {
        const RefSide* side = &sides[i];
        n = run_length(side, side_count - i);
        for (int end = 0; end < 2 && n == 2; end++)
        {
            uint32_t vertex = end == 0 ? side->low : side->high;
            uint64_t a = find_set(fans, corner_at(corners, side[0].face, vertex));
            fans[a] = find_set(fans, corner_at(corners, side[1].face, vertex));
        }
    }
    uint64_t* loops = make_sets(corner_count);
    uint32_t* degrees = allocate(corner_count, sizeof *degrees);
    for (uint64_t i = 0, n = 0; i < side_count; i += n)
    {
        const RefSide* side = &sides[i];
        n = run_length(side, side_count - i);
        if (n == 1)
        {
            uint64_t a = find_set(fans, corner_at(corners, side->face, side->low));
            uint64_t b = find_set(fans, corner_at(corners, side->face, side->high));
            degrees[a]++;
            degrees[b]++;
            loops[find_set(loops, a)] = find_set(loops, b);
        }
    }
    bool* open = allocate(corner_count, sizeof *open);
    for (uint64_t c = 0; c < corner_count; c++)
    {
        uint64_t loop = find_set(loops, c);
        open[loop] = open[loop] || (degrees[c] != 2 && fans[c] == c);
    }
    uint64_t holes = 0;
    for (uint64_t c = 0; c < corner_count; c++)
    {
        holes += loops[c] == c && fans[c] == c && degrees[c] > 0 && !open[c];
    }
    free(fans);
    free(loops);
    free(degrees);
    free(open);
    return holes;
}

// ---- Orientation --------------------------------------------------------------------------------

// Colours each part from its first face on, breadth first. Faces that come twice alike are no
// neighbours.
static void count_inverted(LsRefTopology* out, const uint32_t* corners, uint32_t face_count,
                           const bool* flat, const RefSide* sides, uint64_t side_count)
{
    // Of each face: up to three neighbours, face << 1 | disagrees.
    uint64_t(*neighbours)[3] = allocate(face_count, sizeof *neighbours);
    uint32_t* degrees = allocate(face_count, sizeof *degrees);
    for (uint64_t i = 0, n = 0; i < side_count; i += n)
    {
        const RefSide* side = &sides[i];
        n = run_length(side, side_count - i);
        if (n == 2)
        {
            bool disagrees = side[0].from == side[1].from;
            uint32_t a = side[0].face, b = side[1].face;
            const uint32_t *p = corners + 3 * (size_t)a, *q = corners + 3 * (size_t)b;
            // Two corners are the same, so all are if their sums are.
            bool is_twin = (uint64_t)p[0] + p[1] + p[2] == (uint64_t)q[0] + q[1] + q[2];
            if (is_twin && disagrees)
            {
                continue;
            }
            neighbours[a][degrees[a]++] = (uint64_t)b << 1 | disagrees;
            neighbours[b][degrees[b]++] = (uint64_t)a << 1 | disagrees;
        }
    }
    int8_t* colors = allocate(face_count, sizeof *colors);
    uint32_t* queue = allocate(face_count, sizeof *queue);
    for (uint32_t first = 0; first < face_count; first++)
    {
        if (flat[first] || colors[first] != 0)
        {
            continue;
        }
        uint64_t head = 0, tail = 0, kept = 0;
        bool orientable = true;
        queue[tail++] = first;
        colors[first] = 1;
        for (; head < tail; head++)
        {
            uint32_t face = queue[head];
            kept += colors[face] == 1;
            for (uint32_t k = 0; k < degrees[face]; k++)
            {
                uint32_t other = (uint32_t)(neighbours[face][k] >> 1);
                int8_t color =
                    (int8_t)((neighbours[face][k] & 1) != 0 ? -colors[face] : colors[face]);
                if (colors[other] == 0)
                {
                    colors[other] = color;
                    queue[tail++] = other;
                }
                orientable = orientable && colors[other] == color;
            }
        }
        out->unorientable += !orientable;
        out->inverted += !orientable ? 0 : (kept < tail - kept ? kept : tail - kept);
    }
    free(neighbours);
    free(degrees);
    free(colors);
    free(queue);
}

LsRefTopology ls_ref_topology(const LsRefMesh* mesh, bool weld)
{
    LsRefTopology out = {.faces = mesh->face_count};
    uint32_t* corners = weld_corners(mesh, weld, &out.vertices);
    bool* flat = allocate(mesh->face_count, sizeof *flat);
    RefSide* sides = allocate(3ull * mesh->face_count, sizeof *sides);
    Triple* triples = allocate(mesh->face_count, sizeof *triples);
    uint64_t side_count = 0, triple_count = 0;
    for (uint32_t face = 0; face < mesh->face_count; face++)
    {
        flat[face] = is_flat(mesh, face);
        out.degenerate += flat[face];
        const uint32_t* c = corners + 3 * (size_t)face;
        for (uint32_t k = 0; k < 3 && !flat[face]; k++)
        {
            uint32_t a = c[k], b = c[(k + 1) % 3];
            sides[side_count++] = (RefSide){a < b ? a : b, a < b ? b : a, face, a};
        }
        if (!flat[face])
        {
            Triple* triple = &triples[triple_count++];
            memcpy(triple->corner, c, sizeof triple->corner);
            qsort(triple->corner, 3, sizeof(uint32_t), compare_words);
        }
    }
    qsort(sides, side_count, sizeof *sides, compare_ref_sides);
    qsort(triples, triple_count, sizeof *triples, compare_triples);
    for (uint64_t i = 1; i < triple_count; i++)
    {
        out.duplicate += compare_triples(&triples[i - 1], &triples[i]) == 0;
    }
    for (uint64_t i = 0, n = 0; i < side_count; i += n)
    {
        const RefSide* side = &sides[i];
        n = run_length(side, side_count - i);
        out.edges++;
        out.boundary += n == 1;
        out.nonmanifold += n > 2;
    }
    out.holes = count_holes(corners, 3ull * mesh->face_count, sides, side_count);
    count_inverted(&out, corners, mesh->face_count, flat, sides, side_count);
    free(corners);
    free(flat);
    free(sides);
    free(triples);
    return out;
}
