// compose.c - one file after the other: import, override, place, pass the warnings on.

#include "compose.h"

#include "material_file.h"
#include "place.h"

#include <math.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static bool is_gltf(const char* path)
{
    const char* ending = strrchr(path, '.');
    return ending && (!strcasecmp(ending, ".gltf") || !strcasecmp(ending, ".glb"));
}

static bool is_zero_or_positive(double x)
{
    return x >= 0.0 && x <= 1e30;
}

static LsResult check_input(const LsBakeInput* how, LsError* error)
{
    if (!how->path)
        return ls_error_set(error, LS_MESSAGE_USAGE_NO_SCENE, "an input of the bake has no path");
    if ((unsigned)how->up > LS_UP_X)
        return ls_error_set(error, LS_MESSAGE_USAGE_CHOICE, "%s: up is %d, which names no axis",
                            how->path, (int)how->up);
    bool is_good =
        is_zero_or_positive(how->scale) && is_zero_or_positive(how->size) && fabs(how->turn) <= 1e6;
    for (int i = 0; i < 3; i++)
        is_good = is_good && (!how->is_at || fabs(how->at[i]) <= 1e30);
    if (!is_good)
        return ls_error_set(error, LS_MESSAGE_USAGE_NUMBER,
                            "%s: scale, size, turn or at is negative, too large or no number",
                            how->path);
    if (how->scene && !is_gltf(how->path))
        return ls_error_set(error, LS_MESSAGE_USAGE_NOT_GLTF,
                            "%s: holds one scene, only glTF has several; leave out --scene",
                            how->path);
    return LS_OK;
}

LsResult ls_compose_check(const LsBakeDesc* desc, LsError* error)
{
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < desc->input_count && result == LS_OK; i++)
        result = check_input(&desc->inputs[i], error);
    return result;
}

// Where the file being read lies among the bytes of all.
typedef struct Share
{
    LsImportProgress* progress;
    void* user;
    double before, bytes, all;
} Share;

static void note_share(void* user, double fraction)
{
    const Share* share = user;
    if (share->progress)
        share->progress(share->user, (share->before + fraction * share->bytes) / share->all);
}

// At least 1, so that files that are not there have a share too.
static double file_bytes(const char* path)
{
    struct stat status;
    return stat(path, &status) || status.st_size < 1 ? 1.0 : (double)status.st_size;
}

static LsResult add_file(LsInput* input, const LsBakeDesc* desc, const LsBakeInput* how,
                         LsError* error)
{
    const LsInputPart part = ls_input_part(input);
    input->options.scene = how->scene;
    LsResult result = ls_import(input, how->path, error);
    if (result == LS_OK)
        result = ls_input_override(input, &part, how, error);
    if (result == LS_OK)
        result = ls_input_place(input, &part, how, error);
    for (uint32_t i = part.first_warning; desc->warn && i < input->warning_count; i++)
        desc->warn(desc->warn_user, input->warnings[i].message, input->warnings[i].text);
    return result;
}

// Importers refuse too many triangles before they make room for them; this is for what several
// scenes come to and for those that cannot tell beforehand.
static LsResult check_triangles(const LsInput* input, const LsBakeDesc* desc, LsError* error)
{
    uint64_t faces = 0;
    for (uint32_t i = 0; i < input->mesh_count; i++)
        faces += input->meshes[i].triangle_count;
    if (desc->max_triangles && faces > desc->max_triangles)
        return ls_error_set(error, LS_MESSAGE_LIMIT_TRIANGLES,
                            "%s: the scene has %llu triangles, more than the %llu that "
                            "--max-triangles allows; raise it or bake fewer",
                            input->paths[input->file_count - 1], (unsigned long long)faces,
                            (unsigned long long)desc->max_triangles);
    if (input->file_count == desc->input_count && (!faces || !input->instance_count))
        return ls_error_set(error, LS_MESSAGE_SCENE_NO_TRIANGLES,
                            "%s: no triangles in the scene; nothing to bake", desc->inputs[0].path);
    return LS_OK;
}

LsResult ls_compose(LsInput* input, const LsBakeDesc* desc, LsImportProgress* progress,
                    void* progress_user, LsError* error)
{
    Share share = {.progress = progress, .user = progress_user};
    for (uint32_t i = 0; i < desc->input_count; i++)
        share.all += file_bytes(desc->inputs[i].path);
    input->options = (LsImportOptions){
        .strict = desc->strict,
        .max_memory = desc->max_memory,
        .max_triangles = desc->max_triangles,
        .progress = note_share,
        .progress_user = &share,
    };
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < desc->input_count && result == LS_OK; i++)
    {
        share.bytes = file_bytes(desc->inputs[i].path);
        note_share(&share, 0.0);
        result = add_file(input, desc, &desc->inputs[i], error);
        if (result == LS_OK)
            result = check_triangles(input, desc, error);
        share.before += share.bytes;
    }
    input->options.progress = NULL;
    return result;
}
