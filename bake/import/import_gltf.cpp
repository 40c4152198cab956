// import_gltf.cpp - glTF 2.0 and GLB files through tinygltf: the stages in order, grants, warnings.
//
// What is taken: the nodes of one scene with their transforms and animation, triangle lists, strips
// and fans with normals, two sets of texture coordinates and colours, the core material with its
// textures, perspective cameras, and the extensions that gltf_extensions.cpp lists. All else that a
// scene shows is named in a warning.

#include "gltf_import.h"

namespace
{

constexpr size_t THINGS_NAMED = 6; // of a warning

// The warnings in the order in which their first things came.
void send_notices(GltfImport& import)
{
    for (const GltfNotice& notice : import.notices)
    {
        std::string text = notice.what;
        for (size_t i = 0; i < notice.things.size(); i++)
            text += (i == 0 ? ": " : ", ") + notice.things[i];
        if (notice.count > notice.things.size())
            text += " and " + std::to_string(notice.count - notice.things.size()) + " more";
        const LsResult result =
            ls_input_warn(import.input, import.error, notice.message, "%s: %s; %s",
                          import.path.c_str(), text.c_str(), notice.remedy.c_str());
        if (result != LS_OK)
            throw Reported{result};
    }
}

void run(GltfImport& import)
{
    ls_input_note_progress(import.input, 0.0);
    ls_gltf_read_file(import);
    ls_gltf_check_members(import);
    ls_gltf_check_extensions(import);
    ls_gltf_read_model(import);
    ls_input_note_progress(import.input, 0.1);
    ls_gltf_read_buffers(import);
    ls_input_note_progress(import.input, 0.2);
    ls_gltf_read_nodes(import);
    ls_gltf_read_materials(import);
    ls_input_note_progress(import.input, 0.4);
    ls_gltf_read_meshes(import);
    ls_gltf_read_animations(import);
    send_notices(import);
    import.input->memory_bytes -= import.temporary_bytes;
    ls_input_note_progress(import.input, 1.0);
}

} // namespace

void ls_gltf_reserve(GltfImport& import, uint64_t bytes, uint64_t triangles, bool is_temporary)
{
    const LsResult result =
        ls_input_reserve(import.input, import.path.c_str(), bytes, triangles, import.error);
    if (result != LS_OK)
        throw Reported{result};
    import.temporary_bytes += is_temporary ? bytes : 0;
}

void ls_gltf_note(GltfImport& import, LsMessage message, const std::string& what,
                  const std::string& thing, const std::string& remedy)
{
    const auto [place, is_new] =
        import.notice_numbers.try_emplace({message, what}, import.notices.size());
    if (is_new)
        import.notices.push_back({message, what, remedy, {}, 0});
    GltfNotice& notice = import.notices[place->second];
    notice.count += !thing.empty();
    if (!thing.empty() && notice.things.size() < THINGS_NAMED)
        notice.things.push_back(thing);
}

LsResult ls_import_gltf(LsInput* input, const char* path, LsError* error)
{
    return run_guarded(
        path, error,
        [=]
        {
            GltfImport import;
            import.input = input;
            import.error = error;
            import.path = path;
            run(import);
        },
        LS_MESSAGE_GLTF_JSON);
}
