#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>
#include <lightcull/light.h>
#include <lightcull/span.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lightcull {

using TextureId = std::uint32_t;
using MaterialId = std::uint32_t;
using MeshId = std::uint32_t;
inline constexpr std::uint32_t kNoTexture = 0xffffffffu;

/// An image, looked up bilinearly as linear RGB and repeated. Row 0 is the top, v = 1. One of the
/// three arrays has the texels, row by row: numbers as they are, or 8 or 16 bits to a channel.
struct Texture {
    std::uint32_t width = 0, height = 0;
    std::vector<float3> texels;             ///< width * height, linear RGB
    std::vector<std::uint8_t> texels8{};    ///< width * height * channels
    std::vector<std::uint16_t> texels16{};  ///< width * height * channels
    std::uint32_t channels = 3;             ///< of texels8 and texels16: 1, which is grey, or 3
    bool is_srgb = true;  ///< texels8 and texels16 are encoded by sRGB; else they are numbers in
                          ///< [0, 1], in parts of 255 or 65535
};

enum class MaterialKind { kDiffuse, kMetallicRoughness };

/// A surface that reflects on both sides. Metallic-roughness is glTF 2.0's model (appendix B):
/// GGX with Smith masking, F0 0.04 for dielectrics. Texels multiply the factors and are at most 1.
struct Material {
    MaterialKind kind = MaterialKind::kDiffuse;
    float3 base_color{0.5f, 0.5f, 0.5f};  ///< [0, 1]
    float metallic = 0.0f;                ///< [0, 1]
    float roughness = 1.0f;  ///< perceptual roughness, [0, 1]: alpha is its square, >= 1e-3
    TextureId base_color_texture = kNoTexture;
    TextureId metallic_roughness_texture = kNoTexture;  ///< green: roughness, blue: metallic
    /// The probability with which a ray meets the surface, [0, 1]; else it goes on. What a surface
    /// emits is cut out with it.
    float opacity = 1.0f;
    TextureId opacity_texture = kNoTexture;  ///< multiplies the opacity by its red
    /// Above 0: a ray meets the surface where the opacity is at least this, and nowhere else.
    float opacity_threshold = 0.0f;
    /// Normals in the tangent frame of the texture coordinates: 2 * texel - 1, of which x, to the
    /// right of the image, and y, up, are scaled. The texture is of numbers, not of colours.
    TextureId normal_texture = kNoTexture;
    float normal_scale = 1.0f;
};

/// What the triangles of a mesh emit: radiance * face_radiance[i] * texture(u, v), each of the
/// latter two where there is one; W/(m^2 sr). The front is the side from which the corners run
/// anticlockwise.
struct Emission {
    float3 radiance{0.0f, 0.0f, 0.0f};
    Span<const float3> face_radiance;  ///< none, or one per triangle
    TextureId texture = kNoTexture;
    bool two_sided = false;
};

/// A triangle mesh to be added to a scene, which copies it.
struct Mesh {
    std::string name;                   ///< name of the mesh in messages
    Span<const float3> positions;       ///< metres
    Span<const std::uint32_t> indices;  ///< three per triangle
    Span<const float3> normals;         ///< shading normals, none or one per position; any
                                        ///< length, 0: the triangle's own
    Span<const float2> uvs;             ///< none or one per position
    Span<const float3> colors;          ///< none or one per position: linear RGB in [0, 1], which
                                        ///< multiplies the base colour
    MaterialId material = 0;
    Emission emission;
};

/// Where an instance of a mesh stands: three rows of a matrix of which the last column is the
/// translation, metres.
struct Placement {
    float rows[3][4];
};

/// A thin lens looking from origin to target; a pinhole where aperture_radius is 0. Orthographic
/// where orthographic_height is above 0: its rays are parallel, start in the plane of the origin,
/// and know neither a field of view nor a lens.
struct Camera {
    float3 origin{0.0f, 0.0f, 1.0f}, target{0.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f};
    float vertical_fov = 0.8f;         ///< radians, (0, pi)
    float aperture_radius = 0.0f;      ///< metres
    float focus_distance = 1.0f;       ///< metres
    float orthographic_height = 0.0f;  ///< metres that the image is high; 0: perspective
};

/// Radiance from infinity: scale * a latitude-longitude map, +Y up, the middle column towards -Z
/// turned by `rotation` radians about +Y. A constant is a map of one texel.
struct Environment {
    Texture map;
    float3 scale{1.0f, 1.0f, 1.0f};
    float rotation = 0.0f;
};

/// The memory that a scene keeps, bytes.
struct SceneMemory {
    std::size_t data = 0;  ///< all that was added, and the lights
    std::size_t bvh = 0;   ///< Embree's tree, of which there is none before commit()
};

/// What Scene::refit() did.
struct SceneRefit {
    bool rebuilt = false;  ///< Embree's tree was built anew
    float growth = 1.0f;   ///< how loose the triangles that lay together had become before that,
                           ///< relative to when the tree was last built: 1 is as tight
};

struct SceneData;

/// Geometry, materials, emitters and a camera. Fill it, commit() it, then share it between any
/// number of renderers and threads. Every add_ and set_ checks what it is given and throws Error,
/// having changed nothing.
class LIGHTCULL_EXPORT Scene {
  public:
    Scene();
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    TextureId add_texture(Texture texture);
    MaterialId add_material(const Material& material);
    MeshId add_mesh(const Mesh& mesh);
    /// Adds a mesh that is nowhere yet, and takes its memory once however often it is placed. It
    /// must not emit: lights are where they are.
    MeshId add_shared_mesh(const Mesh& mesh);
    /// Places a shared mesh, mirrored or not. Its normals stay square to it.
    void add_instance(MeshId mesh, const Placement& placement);
    /// Adds a point that emits `intensity` (W/sr, RGB) in all directions.
    void add_point_light(float3 position, float3 intensity);
    /// Adds a point that emits `intensity` in full up to `inner` from direction, then down to
    /// nothing at `outer` (radians) as the square of a ramp in the cosine, which is glTF's
    /// KHR_lights_punctual.
    void add_spot_light(float3 position, float3 direction, float3 intensity, float inner,
                        float outer);
    /// Adds a sun: parallel light from infinity that goes into `direction`, and gives `irradiance`
    /// (W/m^2, RGB) to a surface that faces it.
    void add_directional_light(float3 direction, float3 irradiance);
    void set_environment(Environment environment);
    void set_camera(const Camera& camera);

    /// Builds what rendering needs (Embree's tree, the lights). Nothing can be added after it; what
    /// there is can be moved.
    void commit();

    /// Moves the corners of a mesh, emissive or not: as many positions, metres, as it has. Shared
    /// ones stay.
    /// `normals`, of a mesh that has shading normals: as many, or none to leave them as they are.
    void set_mesh_positions(MeshId mesh, Span<const float3> positions,
                            Span<const float3> normals = {});
    /// Moves the points and spots: one position (metres) each, in the order in which they were
    /// added.
    void set_light_positions(Span<const float3> positions);
    /// Turns the spots and directional lights: one direction each, of any length but 0, in the
    /// order in which they were added.
    void set_light_directions(Span<const float3> directions);
    /// Fits what commit() built to all that was moved since, in a fraction of the time: the lights,
    /// and Embree's tree, which keeps its topology. Call it before anything is rendered again, then
    /// Renderer::restart(); no renderer may be at work from the first set_ to here. The tree is
    /// built anew the first time, as one that can be fitted (tracing takes a little longer in it),
    /// and where it has grown looser than `max_growth`. Triangles stay cut as they are: where a
    /// lamp comes to hang right above a floor, a scene that is built there may have less noise.
    /// Runs in the caller's TBB arena.
    SceneRefit refit(float max_growth = 2.0f);

    /// The lights that samplers choose from, in the order in which they were added: every triangle
    /// whose radiance * face_radiance is not black, point, spot and directional light; the
    /// environment is not among them. After these, since commit(), come further parts of triangles
    /// that are cut: those that are long beside their distance to what they light, or whose texture
    /// is uneven.
    Span<const Light> lights() const noexcept;
    /// The number of lights without those further parts.
    std::size_t emitter_count() const noexcept;
    /// The number of triangles, those of an instance counted where it stands.
    std::size_t triangle_count() const noexcept;
    bool has_environment() const noexcept;
    const Camera& camera() const noexcept;
    SceneMemory memory_size() const noexcept;

  private:
    friend const SceneData& data_of(const Scene& scene) noexcept;
    friend SceneData& data_of(Scene& scene) noexcept;

    std::unique_ptr<SceneData> data_;
};

}  // namespace lightcull
