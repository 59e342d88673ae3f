#include "arrays.h"
#include "module.h"

#include <lightcull/error.h>

#include <pybind11/stl.h>

#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include <cstdint>
#include <istream>
#include <map>
#include <streambuf>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

/// Wavefront OBJ by tinyobjloader. Materials are not its business here: it sees their numbers.

namespace lightcull::python {
namespace {

/// Gives materials, which have numbers for names, those numbers.
class Numbered : public tinyobj::MaterialReader {
  public:
    explicit Numbered(int count) : count_(count) {}

    bool operator()(const std::string&, std::vector<tinyobj::material_t>*,
                    std::map<std::string, int>* ids, std::string*, std::string*) override {
        for (int i = 0; i < count_; ++i) ids->emplace(std::to_string(i), i);
        return true;
    }

  private:
    int count_;
};

/// A text after a first line that makes tinyobjloader ask for materials.
class WithLibrary : public std::streambuf {
  public:
    explicit WithLibrary(std::string_view text) : text_(text) { read(kLibrary); }

  protected:
    int_type underflow() override {
        if (text_.empty()) return traits_type::eof();
        read(std::exchange(text_, {}));
        return traits_type::to_int_type(*gptr());
    }

  private:
    void read(std::string_view text) {
        char* const first = const_cast<char*>(text.data());  // which is what setg() takes
        setg(first, first, first + text.size());
    }

    static constexpr std::string_view kLibrary = "mtllib names\n";
    std::string_view text_;
};

/// The triangles of one material that all have, or have not, normals and texture coordinates.
struct Part {
    struct Corner {
        int position, normal, uv;
        bool operator==(const Corner& other) const {
            return position == other.position && normal == other.normal && uv == other.uv;
        }
    };
    struct Hash {
        std::size_t operator()(const Corner& c) const {
            const auto wide = [](int i) { return static_cast<std::uint64_t>(i); };
            const std::uint64_t mixed = (wide(c.position) * 0x9e3779b97f4a7c15u) ^
                                        (wide(c.normal) * 0xbf58476d1ce4e5b9u) ^
                                        (wide(c.uv) * 0x94d049bb133111ebu);
            return static_cast<std::size_t>(mixed ^ (mixed >> 31));
        }
    };

    std::unordered_map<Corner, std::uint32_t, Hash> known;
    std::vector<Corner> corners;
    std::vector<std::uint32_t> indices;

    void add(const Corner& corner) {
        const auto next = static_cast<std::uint32_t>(corners.size());
        const auto [place, is_new] = known.try_emplace(corner, next);
        if (is_new) corners.push_back(corner);
        indices.push_back(place->second);
    }
};

/// Material, has normals, has texture coordinates.
using Key = std::tuple<int, bool, bool>;

bool is_within(int index, std::size_t values, std::size_t each) {
    return index >= 0 && static_cast<std::size_t>(index) < values / each;
}

std::map<Key, Part> parts_of(const tinyobj::attrib_t& attributes,
                             const std::vector<tinyobj::shape_t>& shapes) {
    std::map<Key, Part> parts;
    for (const tinyobj::shape_t& shape : shapes) {
        const tinyobj::mesh_t& mesh = shape.mesh;
        for (std::size_t face = 0; face < mesh.indices.size() / 3; ++face) {
            Part::Corner corners[3];
            bool has_normals = true, has_uvs = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const tinyobj::index_t& i = mesh.indices[3 * face + k];
                if (!is_within(i.vertex_index, attributes.vertices.size(), 3)) {
                    throw Error("a face has a vertex that is not there");
                }
                has_normals =
                    has_normals && is_within(i.normal_index, attributes.normals.size(), 3);
                has_uvs = has_uvs && is_within(i.texcoord_index, attributes.texcoords.size(), 2);
                corners[k] = {i.vertex_index, i.normal_index, i.texcoord_index};
            }
            Part& part = parts[{mesh.material_ids[face], has_normals, has_uvs}];
            for (Part::Corner& c : corners) {
                part.add({c.position, has_normals ? c.normal : 0, has_uvs ? c.uv : 0});
            }
        }
    }
    return parts;
}

template <typename Index>
py::object gathered(const Part& part, const std::vector<float>& values, py::ssize_t columns,
                    const Index& index) {
    py::object array =
        new_array(py::make_tuple(part.corners.size(), columns), numpy_dtype(py::str("float32")));
    float* out = elements<float>(array).data();
    for (const Part::Corner& corner : part.corners) {
        const auto first = static_cast<py::ssize_t>(index(corner)) * columns;
        for (py::ssize_t k = 0; k < columns; ++k) {
            *out++ = values[static_cast<std::size_t>(first + k)];
        }
    }
    return array;
}

py::dict to_dict(const Key& key, const Part& part, const tinyobj::attrib_t& attributes) {
    const auto [material, has_normals, has_uvs] = key;
    const auto position = [](const Part::Corner& c) { return c.position; };
    py::dict mesh;
    mesh["material"] = material;
    mesh["positions"] = gathered(part, attributes.vertices, 3, position);
    mesh["normals"] = py::none();
    mesh["uvs"] = py::none();
    mesh["colors"] = py::none();
    if (has_normals) {
        mesh["normals"] =
            gathered(part, attributes.normals, 3, [](const Part::Corner& c) { return c.normal; });
    }
    if (has_uvs) {
        mesh["uvs"] =
            gathered(part, attributes.texcoords, 2, [](const Part::Corner& c) { return c.uv; });
    }
    if (attributes.colors.size() == attributes.vertices.size()) {
        mesh["colors"] = gathered(part, attributes.colors, 3, position);
    }
    py::object indices =
        new_array(py::make_tuple(part.indices.size() / 3, 3), numpy_dtype(py::str("uint32")));
    std::copy(part.indices.begin(), part.indices.end(), elements<std::uint32_t>(indices).begin());
    mesh["indices"] = indices;
    return mesh;
}

py::list read_obj(const py::bytes& text, int material_count) {
    const std::string_view view = text;
    tinyobj::attrib_t attributes;
    std::map<Key, Part> parts;
    {
        const py::gil_scoped_release release;
        WithLibrary buffer(view);
        std::istream stream(&buffer);
        std::vector<tinyobj::shape_t> shapes;
        std::vector<tinyobj::material_t> none;
        Numbered materials(material_count);
        std::string warning, error;
        constexpr bool kTriangulate = true, kWhiteWhereNoColors = false;
        if (!tinyobj::LoadObj(&attributes, &shapes, &none, &warning, &error, &stream, &materials,
                              kTriangulate, kWhiteWhereNoColors)) {
            throw Error(error.substr(0, error.find('\n')));
        }
        if (warning.find("out of bounds") != std::string::npos) {
            throw Error(warning.substr(0, warning.find('\n')));
        }
        parts = parts_of(attributes, shapes);
    }
    py::list meshes;
    for (const auto& [key, part] : parts) meshes.append(to_dict(key, part, attributes));
    return meshes;
}

}  // namespace

void bind_obj(py::module_& module) {
    module.def("read_obj", &read_obj);
}

}  // namespace lightcull::python
