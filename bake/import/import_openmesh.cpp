// import_openmesh.cpp - PLY files through OpenMesh's reader, past its mesh.
//
// OpenMesh's own importers build a half-edge mesh: they drop faces with equal vertices and split
// those that are not manifold, so numbers shift. FaceCollector takes what the reader finds as it
// comes.
//
// The reader of OpenMesh 9 loses its place in some legal files without a word (lists that it does
// not know, colours in double) and never ends on a header that is cut. So the header is read here
// first, what the reader would misread is refused by name, and the stream throws at the first
// number that is not one.

#include "failure.h"
#include "import.h"

#include <fstream>
#include <iostream>
#include <limits>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/IOManager.hh>
#include <sstream>
#include <string>
#include <vector>

namespace
{

using OpenMesh::EdgeHandle;
using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

// Handles hold an int.
constexpr uint64_t MAX_VERTICES = std::numeric_limits<int>::max();

// ---- What the reader hands over -----------------------------------------------------------------

// Vertices and faces in the order of the file; everything else is ignored.
class FaceCollector final : public OpenMesh::IO::BaseImporter
{
  public:
    std::vector<OpenMesh::Vec3f> positions;
    std::vector<uint32_t> indices; // three per triangle
    uint64_t face_count = 0;

    VertexHandle add_vertex(const OpenMesh::Vec3f& point) override
    {
        positions.push_back(point);
        return VertexHandle(static_cast<int>(positions.size() - 1));
    }
    VertexHandle add_vertex() override
    {
        return add_vertex(OpenMesh::Vec3f(0.0f));
    }
    void set_point(VertexHandle vertex, const OpenMesh::Vec3f& point) override
    {
        positions[static_cast<size_t>(vertex.idx())] = point;
    }
    FaceHandle add_face(const VHandles& corners) override
    {
        const std::string name = "face " + std::to_string(face_count);
        if (corners.size() < 3)
            throw Failure{LS_ERROR_INPUT_FORMAT, name + " has " + std::to_string(corners.size()) +
                                                     " corners, a face needs three; remove it"};
        for (const VertexHandle corner : corners)
            if (corner.idx() < 0 || static_cast<size_t>(corner.idx()) >= positions.size())
                throw Failure{LS_ERROR_INPUT_INDEX,
                              name + " names vertex " + std::to_string(corner.idx()) +
                                  ", but the file has " + std::to_string(positions.size()) +
                                  " vertices; export it again"};
        for (size_t i = 2; i < corners.size(); i++)
            for (const size_t corner : {size_t(0), i - 1, i})
                indices.push_back(static_cast<uint32_t>(corners[corner].idx()));
        return FaceHandle(static_cast<int>(face_count++ & MAX_VERTICES));
    }
    size_t n_vertices() const override
    {
        return positions.size();
    }
    size_t n_faces() const override
    {
        return static_cast<size_t>(face_count);
    }
    size_t n_edges() const override
    {
        return 0;
    }

    // The rest of the interface: edges, attributes, textures.
    HalfedgeHandle add_edge(VertexHandle, VertexHandle) override
    {
        return HalfedgeHandle();
    }
    FaceHandle add_face(HalfedgeHandle) override
    {
        return FaceHandle();
    }
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<OpenMesh::Vec2f>&) override
    {
    }
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<OpenMesh::Vec3f>&) override
    {
    }
    void set_face_texindex(FaceHandle, int) override
    {
    }
    void set_halfedge(VertexHandle, HalfedgeHandle) override
    {
    }
    void set_normal(VertexHandle, const OpenMesh::Vec3f&) override
    {
    }
    void set_normal(VertexHandle, const OpenMesh::Vec3d&) override
    {
    }
    void set_color(VertexHandle, const OpenMesh::Vec3uc&) override
    {
    }
    void set_color(VertexHandle, const OpenMesh::Vec4uc&) override
    {
    }
    void set_color(VertexHandle, const OpenMesh::Vec3f&) override
    {
    }
    void set_color(VertexHandle, const OpenMesh::Vec4f&) override
    {
    }
    void set_texcoord(VertexHandle, const OpenMesh::Vec2f&) override
    {
    }
    void set_status(VertexHandle, const OpenMesh::Attributes::StatusInfo&) override
    {
    }
    void set_next(HalfedgeHandle, HalfedgeHandle) override
    {
    }
    void set_face(HalfedgeHandle, FaceHandle) override
    {
    }
    void request_face_texcoords2D() override
    {
    }
    void set_texcoord(HalfedgeHandle, const OpenMesh::Vec2f&) override
    {
    }
    void set_texcoord(VertexHandle, const OpenMesh::Vec3f&) override
    {
    }
    void set_texcoord(HalfedgeHandle, const OpenMesh::Vec3f&) override
    {
    }
    void set_status(HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override
    {
    }
    void set_color(EdgeHandle, const OpenMesh::Vec3uc&) override
    {
    }
    void set_color(EdgeHandle, const OpenMesh::Vec4uc&) override
    {
    }
    void set_color(EdgeHandle, const OpenMesh::Vec3f&) override
    {
    }
    void set_color(EdgeHandle, const OpenMesh::Vec4f&) override
    {
    }
    void set_status(EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override
    {
    }
    void set_normal(FaceHandle, const OpenMesh::Vec3f&) override
    {
    }
    void set_normal(FaceHandle, const OpenMesh::Vec3d&) override
    {
    }
    void set_color(FaceHandle, const OpenMesh::Vec3uc&) override
    {
    }
    void set_color(FaceHandle, const OpenMesh::Vec4uc&) override
    {
    }
    void set_color(FaceHandle, const OpenMesh::Vec3f&) override
    {
    }
    void set_color(FaceHandle, const OpenMesh::Vec4f&) override
    {
    }
    void set_status(FaceHandle, const OpenMesh::Attributes::StatusInfo&) override
    {
    }
    void add_texture_information(int, std::string) override
    {
    }
};

// Catches what OpenMesh prints, for as long as it lives.
class Silence
{
  public:
    Silence() : cerr_buffer(std::cerr.rdbuf(&text)), clog_buffer(std::clog.rdbuf(&text))
    {
    }
    ~Silence()
    {
        std::cerr.rdbuf(cerr_buffer);
        std::clog.rdbuf(clog_buffer);
    }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;

  private:
    std::stringbuf text;
    std::streambuf* cerr_buffer;
    std::streambuf* clog_buffer;
};

// ---- The header ---------------------------------------------------------------------------------

bool is_one_of(const std::string& word, std::initializer_list<const char*> words)
{
    for (const char* candidate : words)
        if (word == candidate)
            return true;
    return false;
}

bool is_float_type(const std::string& type)
{
    return is_one_of(type, {"float", "float32", "double", "float64"});
}

bool is_integer_type(const std::string& type)
{
    return is_one_of(type, {"char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16",
                            "int", "int32", "uint", "uint32"});
}

struct Header
{
    uint64_t vertex_count = 0;
    uint64_t face_count = 0;
};

[[noreturn]] void refuse_property(const std::string& element, const std::string& property,
                                  const char* why)
{
    throw Failure{LS_ERROR_INPUT_UNSUPPORTED, "property \"" + property + "\" of element \"" +
                                                  element + "\" " + why +
                                                  "; export the mesh without it"};
}

// Reads one "property ..." line of an element up to and with the faces.
void check_property(std::istringstream& words, const std::string& element, bool is_first,
                    unsigned* axes)
{
    std::string type, name;
    words >> type;
    if (type == "list")
    {
        std::string count_type, index_type;
        words >> count_type >> index_type >> name;
        if (element != "face" || !is_one_of(name, {"vertex_index", "vertex_indices"}))
            refuse_property(element, name, "is a list other than the corners of faces");
        if (!is_first)
            refuse_property(element, name, "does not stand first");
        if (!is_one_of(count_type, {"uchar", "uint8", "uint16", "int"}))
            refuse_property(element, name, "counts in a type other than uchar, uint16 and int");
        if (!is_integer_type(index_type))
            refuse_property(element, name, "holds numbers that are no integers");
        return;
    }
    words >> name;
    if (!words || !(is_float_type(type) || is_integer_type(type)))
        throw Failure{LS_ERROR_INPUT_FORMAT,
                      "malformed property \"" + name + "\" in the header; export it again"};
    if (element == "face" && is_first)
        refuse_property(element, name, "stands before the corners");
    if (element == "vertex")
    {
        const bool is_axis = is_one_of(name, {"x", "y", "z"});
        if ((is_axis || is_one_of(name, {"nx", "ny", "nz", "u", "v", "s", "t"})) &&
            !is_float_type(type))
            refuse_property(element, name, "is of integers");
        *axes += is_axis;
    }
    if (is_one_of(name, {"red", "green", "blue", "alpha", "diffuse_red", "diffuse_green",
                         "diffuse_blue"}) &&
        is_one_of(type, {"double", "float64"}))
        refuse_property(element, name, "is of type double");
}

// Reads the header and refuses what OpenMesh's reader would misread.
Header check_header(std::istream& stream)
{
    constexpr size_t max_line = 4096;
    Header header;
    std::string element; // the one whose properties are being listed
    bool has_vertices = false;
    bool has_faces = false;
    unsigned axes = 0;
    unsigned property_count = 0; // of the element
    uint64_t line_number = 0;
    for (std::string line; std::getline(stream, line) && line.size() <= max_line;)
    {
        line_number++;
        std::istringstream words(line);
        std::string keyword;
        words >> keyword;
        if (line_number == 1)
        {
            if (keyword != "ply" && keyword != "PLY")
                throw Failure{LS_ERROR_INPUT_FORMAT,
                              "not a PLY file: it does not begin with \"ply\""};
        }
        else if (line_number == 2)
        {
            std::string form, version;
            words >> form >> version;
            if (keyword != "format" || version != "1.0" ||
                !is_one_of(form, {"ascii", "binary_little_endian", "binary_big_endian"}))
                throw Failure{LS_ERROR_INPUT_FORMAT,
                              "the second line of the PLY header is no known format line"};
        }
        else if (keyword == "element")
        {
            uint64_t count = 0;
            words >> element >> count;
            if (!words || count > MAX_VERTICES)
                throw Failure{LS_ERROR_INPUT_LIMIT,
                              "element \"" + element + "\" has no count between 0 and 2147483647"};
            property_count = 0;
            if (element == "vertex" && !has_vertices && !has_faces)
            {
                has_vertices = true;
                header.vertex_count = count;
            }
            else if (element == "face" && !has_faces && has_vertices)
            {
                has_faces = true;
                header.face_count = count;
            }
            else if (element == "vertex" || element == "face")
                throw Failure{LS_ERROR_INPUT_UNSUPPORTED,
                              "the header must list vertices once, then faces once"};
        }
        else if (keyword == "property")
        {
            if (element.empty())
                throw Failure{LS_ERROR_INPUT_FORMAT, "a property stands before any element"};
            if (!has_faces || element == "face") // what comes after the faces is never read
                check_property(words, element, property_count == 0, &axes);
            property_count++;
        }
        else if (keyword == "end_header")
        {
            if (axes != 3)
                throw Failure{LS_ERROR_INPUT_FORMAT,
                              "the vertices lack x, y and z; export the mesh again"};
            if (element == "face" && property_count == 0 && header.face_count)
                throw Failure{LS_ERROR_INPUT_FORMAT,
                              "the faces have no corners; export the mesh again"};
            return header;
        }
        else if (keyword == "obj_info")
        {
            // The reader takes the words of such a line for keywords.
            for (std::string word; words >> word;)
                if (is_one_of(word, {"element", "property", "end_header"}))
                    throw Failure{LS_ERROR_INPUT_UNSUPPORTED, "an obj_info line holds the word \"" +
                                                                  word + "\"; remove the line"};
        }
        else if (keyword != "comment" && !keyword.empty())
            throw Failure{LS_ERROR_INPUT_FORMAT,
                          "unknown keyword \"" + keyword.substr(0, 32) + "\" in the PLY header"};
    }
    throw Failure{LS_ERROR_INPUT_FORMAT, "the PLY header has no end; the file was cut short or is "
                                         "of another kind: copy or export it again"};
}

// ---- The file -----------------------------------------------------------------------------------

void read_ply(const char* path, FaceCollector& faces)
{
    std::ifstream stream(path, std::ios::in | std::ios::binary);
    if (!stream)
        throw Failure{LS_ERROR_FILE_READ, "cannot be opened"};
    stream.imbue(std::locale::classic());
    const Header header = check_header(stream);
    stream.clear();
    stream.seekg(0);
    stream.exceptions(std::ios::failbit | std::ios::badbit);

    bool is_read = false;
    try
    {
        const Silence silence;
        OpenMesh::IO::Options options;
        is_read = OpenMesh::IO::IOManager().read(stream, ".ply", faces, options);
    }
    catch (const std::ios_base::failure&)
    {
        // Told apart below, by what has been read.
    }
    if (is_read && faces.n_vertices() == header.vertex_count &&
        faces.n_faces() == header.face_count)
        return;
    std::string place = "face " + std::to_string(faces.n_faces());
    if (faces.n_faces() == 0 && faces.n_vertices() < header.vertex_count)
        place = "vertex " + std::to_string(faces.n_vertices());
    if (stream.eof())
        throw Failure{LS_ERROR_INPUT_FORMAT,
                      "the file ends near " + place + " of " + std::to_string(header.vertex_count) +
                          " vertices and " + std::to_string(header.face_count) +
                          " faces; it was cut short: copy or export it again"};
    throw Failure{LS_ERROR_INPUT_FORMAT,
                  "what stands near " + place + " is no finite number; export the mesh again"};
}

void store_mesh(LsInput* input, const FaceCollector& faces)
{
    const size_t triangle_count = faces.indices.size() / 3;
    if (triangle_count == 0)
        return;
    if (triangle_count >= LS_NONE)
        throw Failure{LS_ERROR_INPUT_LIMIT, "more than 4294967294 triangles; split the mesh"};
    LsInputMesh* mesh =
        ls_input_add_plain_mesh(input, static_cast<uint32_t>(faces.positions.size()),
                                static_cast<uint32_t>(triangle_count));
    if (!mesh)
        throw std::bad_alloc();
    for (size_t i = 0; i < faces.positions.size(); i++)
        for (size_t axis = 0; axis < 3; axis++)
            mesh->positions[3 * i + axis] = faces.positions[i][axis];
    for (size_t i = 0; i < faces.indices.size(); i++)
        mesh->indices[i] = faces.indices[i];
}

} // namespace

LsResult ls_import_openmesh(LsInput* input, const char* path, LsError* error)
{
    return run_guarded(path, error,
                       [=]
                       {
                           FaceCollector faces;
                           read_ply(path, faces);
                           store_mesh(input, faces);
                       });
}
