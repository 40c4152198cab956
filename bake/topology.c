// topology.c - sides of faces sorted by their two vertices; faces joined into parts with a parity
// each.

#include "topology.h"

#include <stdlib.h>
#include <string.h>

// Per face.
#define FLAG_DUPLICATE 1u
#define FLAG_UNORIENTABLE 2u // of a part's root

// A side of a face, in the list of its lesser vertex.
typedef struct Side
{
    uint32_t high; // the greater vertex
    uint32_t face; // face << 1 | 1 if the face runs from the greater vertex to the lesser
} Side;

typedef struct Table
{
    const LsFaces* faces;
    Side* sides;     // by lesser vertex, then greater, then face
    uint64_t* first; // vertex_count + 1: where a vertex's sides begin
    uint32_t* links; // per face, to a face of its part: face << 1 | 1 if the two disagree
    uint8_t* flags;  // per face
    LsMeshReport* report;
    LsMeshExamples* examples;
} Table;

// A run of sides with the same two vertices: an edge.
typedef struct Run
{
    uint32_t low, high;
    uint64_t begin, count;
} Run;

// Adds a fault to the examples, if there is room. Without a third vertex it is UINT32_MAX.
static void add_example(LsMeshExamples* examples, LsMeshExample example)
{
    uint32_t* count = &examples->count[example.fault];
    if (*count < LS_MESH_EXAMPLES)
    {
        examples->of[example.fault][(*count)++] = example;
    }
}

static void add_face(const Table* table, LsMeshFault fault, uint32_t face, uint32_t other)
{
    const uint32_t* v = table->faces->indices + 3 * (size_t)face;
    add_example(table->examples,
                (LsMeshExample){
                    .fault = fault, .face = face, .vertices = {v[0], v[1], v[2]}, .other = other});
}

// The edge as its first face runs through it.
static void add_edge(const Table* table, LsMeshFault fault, const Run* run, uint32_t other)
{
    uint32_t face = table->sides[run->begin].face >> 1;
    const uint32_t* corners = table->faces->corners + 3 * (size_t)face;
    const uint32_t* v = table->faces->indices + 3 * (size_t)face;
    int k = 0;
    while (corners[(k + 2) % 3] == run->low || corners[(k + 2) % 3] == run->high)
    {
        k++;
    }
    add_example(table->examples, (LsMeshExample){.fault = fault,
                                                 .face = face,
                                                 .vertices = {v[k], v[(k + 1) % 3], UINT32_MAX},
                                                 .other = other});
}

// The corner of a face that is not on its edge (a, b).
static uint32_t third_corner(const LsFaces* faces, uint32_t face, uint32_t a, uint32_t b)
{
    const uint32_t* c = faces->corners + 3 * (size_t)face;
    return c[0] ^ c[1] ^ c[2] ^ a ^ b;
}

// ---- The table ----------------------------------------------------------------------------------

static int compare_sides(const void* a, const void* b)
{
    const Side* x = a;
    const Side* y = b;
    if (x->high != y->high)
    {
        return x->high < y->high ? -1 : 1;
    }
    return (x->face > y->face) - (x->face < y->face);
}

// Sorts the sides of one vertex; they come in the order of faces, and mostly are few.
static void sort_sides(Side* sides, uint64_t count)
{
    if (count > 32)
    {
        qsort(sides, count, sizeof *sides, compare_sides);
        return;
    }
    for (uint64_t i = 1; i < count; i++)
    {
        Side side = sides[i];
        uint64_t j = i;
        for (; j > 0 && sides[j - 1].high > side.high; j--)
        {
            sides[j] = sides[j - 1];
        }
        sides[j] = side;
    }
}

static bool fill_table(Table* table, uint32_t threads)
{
    const LsFaces* faces = table->faces;
    // One more than needed, so that filling moves each vertex's begin to where the next one's is.
    table->first = calloc(faces->vertex_count + 2ull, sizeof *table->first);
    if (table->first == NULL)
    {
        return false;
    }
    uint64_t* next = table->first + 2;
    for (size_t i = 0; i < 3 * (size_t)faces->face_count; i += 3)
    {
        const uint32_t* c = faces->corners + i;
        for (int k = 0; k < 3 && !faces->flat[i / 3]; k++)
        {
            uint32_t a = c[k], b = c[k < 2 ? k + 1 : 0];
            uint32_t low = a < b ? a : b;
            next[low]++;
        }
    }
    uint64_t sum = 0;
    for (uint64_t v = 0; v + 2 < faces->vertex_count + 2ull; v++)
    {
        sum += next[v];
        next[v] = sum;
    }
    table->sides = malloc((sum + 1) * sizeof *table->sides);
    if (table->sides == NULL)
    {
        return false;
    }
    uint64_t* position = table->first + 1;
    for (uint32_t face = 0; face < faces->face_count; face++)
    {
        const uint32_t* c = faces->corners + 3 * (size_t)face;
        for (int k = 0; k < 3 && !faces->flat[face]; k++)
        {
            uint32_t a = c[k], b = c[k < 2 ? k + 1 : 0];
            uint32_t low = a < b ? a : b;
            table->sides[position[low]++] = (Side){a < b ? b : a, face << 1 | (a > b)};
        }
    }
#pragma omp parallel for schedule(dynamic, 4096) num_threads(threads)
    for (uint32_t v = 0; v < faces->vertex_count; v++)
    {
        sort_sides(table->sides + table->first[v], table->first[v + 1] - table->first[v]);
    }
    return true;
}

// The edge that begins at a side of vertex `low`.
static Run run_at(const Table* table, uint32_t low, uint64_t begin)
{
    uint64_t end = begin + 1, limit = table->first[low + 1];
    while (end < limit && table->sides[end].high == table->sides[begin].high)
    {
        end++;
    }
    return (Run){low, table->sides[begin].high, begin, end - begin};
}

// Where the edge between two vertices begins, which is there.
static uint64_t find_begin(const Table* table, uint32_t a, uint32_t b)
{
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    uint64_t begin = table->first[low], end = table->first[low + 1];
    while (begin < end)
    {
        uint64_t middle = begin + (end - begin) / 2;
        if (table->sides[middle].high < high)
        {
            begin = middle + 1;
        }
        else
        {
            end = middle;
        }
    }
    return begin;
}

static Run find_run(const Table* table, uint32_t a, uint32_t b)
{
    return run_at(table, a < b ? a : b, find_begin(table, a, b));
}

// The same with a count of at most 3: edges of very many faces are not counted again and again.
static Run find_short_run(const Table* table, uint32_t a, uint32_t b)
{
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    const uint64_t begin = find_begin(table, a, b), limit = table->first[low + 1];
    uint64_t end = begin + 1;
    while (end < limit && end - begin < 3 && table->sides[end].high == high)
    {
        end++;
    }
    return (Run){low, high, begin, end - begin};
}

// ---- Parts --------------------------------------------------------------------------------------

// The first face of a part stands for it. Stores whether `face` disagrees with it.
static uint32_t find_part(uint32_t* links, uint32_t face, uint32_t* parity)
{
    uint32_t odd = 0;
    while (links[face] >> 1 != face)
    {
        uint32_t above = links[links[face] >> 1];
        links[face] = (above & ~1u) | ((links[face] ^ above) & 1u);
        odd ^= links[face] & 1u;
        face = links[face] >> 1;
    }
    *parity = odd;
    return face;
}

static void join_faces(Table* table, uint32_t face_a, uint32_t face_b, uint32_t disagree)
{
    uint32_t parity_a, parity_b;
    uint32_t a = find_part(table->links, face_a, &parity_a);
    uint32_t b = find_part(table->links, face_b, &parity_b);
    uint32_t parity = parity_a ^ parity_b ^ disagree;
    if (a == b)
    {
        table->flags[a] |= parity != 0 ? FLAG_UNORIENTABLE : 0;
        return;
    }
    uint32_t first = a < b ? a : b, second = a < b ? b : a;
    table->links[second] = first << 1 | parity;
    table->flags[first] |= table->flags[second] & FLAG_UNORIENTABLE;
}

// ---- Edges --------------------------------------------------------------------------------------

// Marks faces with the corners of an earlier one among those of an edge. Faces are compared at the
// edge of their two least vertices alone.
static bool mark_duplicates(Table* table, const Run* run)
{
    Side* third = malloc(run->count * sizeof *third); // `high` is the third corner here
    if (third == NULL)
    {
        return false;
    }
    uint64_t count = 0;
    for (uint64_t i = run->begin; i < run->begin + run->count; i++)
    {
        uint32_t face = table->sides[i].face >> 1;
        uint32_t corner = third_corner(table->faces, face, run->low, run->high);
        if (corner > run->high)
        {
            third[count++] = (Side){corner, face << 1};
        }
    }
    sort_sides(third, count);
    for (uint64_t i = 1; i < count; i++)
    {
        if (third[i].high == third[i - 1].high)
        {
            table->flags[third[i].face >> 1] |= FLAG_DUPLICATE;
        }
    }
    free(third);
    return true;
}

static bool visit_edges(Table* table)
{
    const LsFaces* faces = table->faces;
    LsMeshReport* report = table->report;
    for (uint32_t low = 0; low < faces->vertex_count; low++)
    {
        Run run;
        for (uint64_t i = table->first[low]; i < table->first[low + 1]; i += run.count)
        {
            run = run_at(table, low, i);
            const Side* side = &table->sides[i];
            report->edge_count++;
            report->boundary_edge_count += run.count == 1;
            if (run.count == 2)
            {
                uint32_t a = side[0].face >> 1, b = side[1].face >> 1;
                bool is_same_way = ((side[0].face ^ side[1].face) & 1) == 0;
                bool is_twin =
                    third_corner(faces, a, low, run.high) == third_corner(faces, b, low, run.high);
                if (is_twin)
                {
                    table->flags[b] |= FLAG_DUPLICATE;
                }
                // A face that comes twice alike is no neighbour that one could turn.
                if (!is_twin || !is_same_way)
                {
                    join_faces(table, a, b, is_same_way);
                }
            }
            else if (run.count > 2)
            {
                report->nonmanifold_edge_count++;
                add_edge(table, LS_MESH_FAULT_NONMANIFOLD, &run,
                         run.count < UINT32_MAX ? (uint32_t)run.count : UINT32_MAX);
                if (!mark_duplicates(table, &run))
                {
                    return false;
                }
            }
        }
    }
    return true;
}

// The first face with the corners of `face`, a duplicate.
static uint32_t find_original(const Table* table, uint32_t face)
{
    const uint32_t* c = table->faces->corners + 3 * (size_t)face;
    Run run = find_run(table, c[0], c[1]);
    for (uint64_t i = run.begin; i < run.begin + run.count; i++)
    {
        uint32_t other = table->sides[i].face >> 1;
        if (third_corner(table->faces, other, c[0], c[1]) == c[2])
        {
            return other; // a run is in the order of faces
        }
    }
    return face;
}

// ---- Faces --------------------------------------------------------------------------------------

static bool visit_faces(Table* table)
{
    const LsFaces* faces = table->faces;
    LsMeshReport* report = table->report;
    // By part: faces that agree with its first less those that do not.
    int32_t* balance = calloc(faces->face_count + 1ull, sizeof *balance);
    if (balance == NULL)
    {
        return false;
    }
    uint32_t parity;
    for (uint32_t face = 0; face < faces->face_count; face++)
    {
        uint32_t part = find_part(table->links, face, &parity);
        balance[part] += parity != 0 ? -1 : 1;
    }
    for (uint32_t face = 0; face < faces->face_count; face++)
    {
        if (faces->flat[face])
        {
            report->degenerate_count++;
            add_face(table, LS_MESH_FAULT_DEGENERATE, face, 0);
            continue;
        }
        if (table->flags[face] & FLAG_DUPLICATE)
        {
            report->duplicate_count++;
            if (table->examples->count[LS_MESH_FAULT_DUPLICATE] < LS_MESH_EXAMPLES)
            {
                add_face(table, LS_MESH_FAULT_DUPLICATE, face, find_original(table, face));
            }
        }
        uint32_t part = find_part(table->links, face, &parity);
        if (table->flags[part] & FLAG_UNORIENTABLE)
        {
            if (part == face)
            {
                report->unorientable_count++;
                add_face(table, LS_MESH_FAULT_UNORIENTABLE, face, 0);
            }
        }
        else if (parity == (balance[part] >= 0))
        {
            report->inverted_count++;
            add_face(table, LS_MESH_FAULT_INVERTED, face, 0);
        }
    }
    free(balance);
    return true;
}

// ---- Holes --------------------------------------------------------------------------------------

// A boundary edge on a walk: it leads from one vertex to another along a face.
typedef struct Step
{
    uint32_t from, to, face;
} Step;

// The boundary edge behind a step, round its end. Its count is not 1 where the fan ends at an edge
// of three faces or more.
static Run next_edge(const Table* table, Step* step)
{
    for (;;)
    {
        uint32_t third = third_corner(table->faces, step->face, step->from, step->to);
        Run run = find_short_run(table, step->to, third);
        if (run.count != 2)
        {
            step->from = step->to;
            step->to = third;
            return run;
        }
        const Side* side = &table->sides[run.begin];
        step->face = side[side->face >> 1 == step->face ? 1 : 0].face >> 1;
        step->from = third;
    }
}

static bool visit_holes(Table* table)
{
    uint64_t side_count = table->first[table->faces->vertex_count];
    uint8_t* seen = calloc(side_count / 8 + 1, 1);
    if (seen == NULL)
    {
        return false;
    }
    for (uint32_t low = 0; low < table->faces->vertex_count; low++)
    {
        Run start;
        for (uint64_t i = table->first[low]; i < table->first[low + 1]; i += start.count)
        {
            start = run_at(table, low, i);
            if (start.count != 1 || (seen[i / 8] >> i % 8 & 1) != 0)
            {
                continue;
            }
            // An edge seen before belongs to a chain that is no loop: loops are walked at once.
            Step step = {low, start.high, table->sides[i].face >> 1};
            Run run = start;
            uint32_t length = 0;
            do
            {
                seen[run.begin / 8] |= (uint8_t)(1u << run.begin % 8);
                length += length < UINT32_MAX;
                run = next_edge(table, &step);
            } while (run.count == 1 && (seen[run.begin / 8] >> run.begin % 8 & 1) == 0);
            if (run.count == 1 && run.begin == i)
            {
                table->report->hole_count++;
                add_edge(table, LS_MESH_FAULT_HOLE, &start, length);
            }
        }
    }
    free(seen);
    return true;
}

bool ls_topology_check(const LsFaces* faces, uint32_t threads, LsMeshReport* report,
                       LsMeshExamples* examples)
{
    Table table = {.faces = faces, .report = report, .examples = examples};
    table.links = malloc((faces->face_count + 1ull) * sizeof *table.links);
    table.flags = calloc(faces->face_count + 1ull, 1);
    bool ok = table.links != NULL && table.flags != NULL && fill_table(&table, threads);
    for (uint32_t face = 0; face < faces->face_count && ok; face++)
    {
        table.links[face] = face << 1;
    }
    ok = ok && visit_edges(&table) && visit_faces(&table);
    ok = ok && (report->boundary_edge_count == 0 || visit_holes(&table));
    free(table.sides);
    free(table.first);
    free(table.links);
    free(table.flags);
    return ok;
}
