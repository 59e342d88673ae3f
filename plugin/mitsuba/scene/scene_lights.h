#pragma once

#include <lightcull/light.h>

#include <mitsuba/render/scene.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace mitsuba::culling {

/// The lights of a Mitsuba scene as lightcull's samplers know them, and the way back from a light
/// to the emitter that it is, or is part of.
///
/// A triangle of an emitting mesh is a light; a shape of any other kind, a point, a spot and a
/// directional emitter are one light each. Emitters without bounds or a place (environments), and
/// points that the probe did not see emit, are no lights: they are `unplaced`, and chosen by their
/// sampling weight alone. An emitter of sampling weight 0 is neither: as in Mitsuba, it is only
/// ever hit.
template <typename Float, typename Spectrum>
class SceneLights {
  public:
    MI_IMPORT_TYPES(Scene, Emitter, Shape, Mesh)

    /// An emitter that has lights.
    struct Source {
        const Emitter* emitter = nullptr;
        const Mesh* mesh = nullptr;  ///< its triangles are the lights; null: it is one light
        std::uint32_t first = 0;     ///< index of its first light
        std::uint32_t count = 0;     ///< number of its lights, which follow each other
    };
    /// An emitter that is chosen by its weight.
    struct Unplaced {
        const Emitter* emitter = nullptr;
        float prob = 0.0f;  ///< of being chosen among the unplaced, [0, 1]
    };
    /// The corners of a light that is a triangle (metres, in the order that the mesh has them in),
    /// and its area; all 0 for any other light.
    struct Triangle {
        ::lightcull::float3 a, b, c;
        float area = 0.0f;
    };

    /// Asks each emitter of the scene. Throws for one whose bounds or radiance are not finite, and
    /// names its shape.
    explicit SceneLights(const Scene* scene);

    const std::vector<::lightcull::Light>& lights() const { return lights_; }
    const std::vector<Triangle>& triangles() const { return triangles_; }
    const std::vector<Source>& sources() const { return sources_; }
    const std::vector<Unplaced>& unplaced() const { return unplaced_; }

    /// The source that a light belongs to.
    const Source& source_of(std::uint32_t light) const { return sources_[source_of_[light]]; }

    /// The source that an emitter is; null if it has no lights.
    const Source* find(const Emitter* emitter) const {
        const auto found = index_.find(emitter);
        return found == index_.end() ? nullptr : &sources_[found->second];
    }
    /// The probability of an emitter to be chosen among the unplaced; 0 if it is not one of them.
    float unplaced_prob(const Emitter* emitter) const;

  private:
    void add(const Emitter* emitter);
    void add_mesh(const Emitter* emitter, const Mesh* mesh);
    void add_shape(const Emitter* emitter);
    void add_point(const Emitter* emitter);
    void add_directional(const Emitter* emitter);
    void add_unplaced(const Emitter* emitter);
    void add_light(const Emitter* emitter, const ::lightcull::Light& light,
                   const Triangle& triangle);
    void close_source(const Emitter* emitter, const Mesh* mesh, std::size_t first);

    ScalarPoint3f middle_;  // of the scene's bounds
    std::vector<::lightcull::Light> lights_;
    std::vector<Triangle> triangles_;
    std::vector<std::uint32_t> source_of_;
    std::vector<Source> sources_;
    std::vector<Unplaced> unplaced_;
    std::unordered_map<const Emitter*, std::uint32_t> index_;
};

}  // namespace mitsuba::culling
