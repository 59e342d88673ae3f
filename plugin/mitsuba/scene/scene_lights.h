#pragma once

#include <lightcull/light.h>

#include <mitsuba/render/scene.h>

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "scene/cut_triangles.h"
#include "scene/triangle_places.h"

namespace mitsuba::culling {

/// The lights of a Mitsuba scene as lightcull's samplers know them, and the way back from a light
/// to the emitter that it is, or is part of.
///
/// A triangle of an emitting mesh is a light, or several, where it is long or its emission uneven;
/// a shape of any other kind, a point, a spot and a directional emitter are one light each, but for
/// rectangles that are cut, which become triangles. Emitters without bounds or a place
/// (environments), and points that the probe did not see emit, are no lights: they are `unplaced`,
/// and chosen by their sampling weight alone. An emitter of sampling weight 0 is neither: as in
/// Mitsuba, it is only ever hit.
template <typename Float, typename Spectrum>
class SceneLights {
  public:
    MI_IMPORT_TYPES(Scene, Emitter, Shape, Mesh)

    /// An emitter that has lights.
    struct Source {
        const Emitter* emitter = nullptr;
        const Mesh* mesh = nullptr;  ///< its triangles are the lights; null: it is one light
        std::uint32_t first = 0;     ///< index of its first light; those of triangles follow each
                                     ///< other, and further parts of triangles come last of all
        std::uint32_t count = 0;     ///< number of its lights, but for further parts of triangles
    };
    /// An emitter that is chosen by its weight.
    struct Unplaced {
        const Emitter* emitter = nullptr;
        float prob = 0.0f;  ///< of being chosen among the unplaced, [0, 1]
    };
    /// The triangle that a light is, or is a part of.
    struct Triangle {
        std::uint32_t index = 0;                 ///< index in the mesh
        ::lightcull::TriangleCorners corners{};  ///< metres, in the order that the mesh has them in
    };

    /// Asks each emitter of the scene. Throws for one whose bounds or radiance are not finite, and
    /// names its shape.
    explicit SceneLights(const Scene* scene);

    const std::vector<::lightcull::Light>& lights() const { return lights_; }
    /// The number of lights that there would be if no triangle were cut.
    std::size_t uncut_count() const { return uncut_count_; }
    /// By light; for a light that is no triangle they mean nothing.
    const std::vector<Triangle>& triangles() const { return triangles_; }
    const TrianglePlaces& places() const { return places_; }
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
                   const Triangle& triangle = {}, float area = 0.0f);
    void close_source(const Emitter* emitter, const Mesh* mesh, std::size_t first);

    // Cutting triangles.
    using Candidate = CutCandidate<Float, Spectrum>;
    void cut(const Scene* scene);
    std::vector<Candidate> candidates(double least_flux) const;
    void open_rectangle(Candidate* halves);
    void take_parts(std::vector<Candidate>& candidates, ::lightcull::TriangleCuts cuts);

    ScalarPoint3f middle_;  // of the scene's bounds
    std::vector<::lightcull::Light> lights_;
    std::size_t uncut_count_ = 0;
    std::vector<Triangle> triangles_;
    TrianglePlaces places_;
    std::vector<std::uint32_t> source_of_;
    std::vector<Source> sources_;
    std::vector<Unplaced> unplaced_;
    std::unordered_map<const Emitter*, std::uint32_t> index_;
};

}  // namespace mitsuba::culling
