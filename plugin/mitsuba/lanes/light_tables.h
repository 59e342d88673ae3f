#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "lanes/cut_tables.h"
#include "scene/scene_lights.h"

namespace mitsuba::culling {

/// The lights of a scene as Dr.Jit arrays, which the kernels of a wavefront read.
template <typename Float, typename Spectrum>
class LightTables {
  public:
    MI_IMPORT_TYPES(Scene, Emitter, EmitterPtr, Shape, ShapePtr)

    /// The ways in which an emitter is sampled: not at all, by triangles that are lights, as the
    /// one light that it is, or by its weight.
    static constexpr std::uint32_t kOnlyHit = 0, kTriangles = 1, kWhole = 2, kUnplaced = 3;

    /// What the tables know of the emitters of all lanes.
    struct Entry {
        UInt32 kind;
        UInt32 first_light;
        Float prob;  ///< of an unplaced emitter, else 0
    };

    LightTables(const Scene* scene, const SceneLights<Float, Spectrum>& lights);

    Entry find(const EmitterPtr& emitter, const Mask& active) const {
        const UInt32 id = dr::reinterpret_array<UInt32>(emitter);
        const auto entry = dr::gather<dr::Array<UInt32, kEntryWords>>(entries_, id, active);
        return {entry[0], entry[1], dr::reinterpret_array<Float>(entry[2])};
    }

    bool has_triangles() const { return has_triangles_; }
    bool has_wholes() const { return has_wholes_; }
    bool has_unplaced() const { return unplaced_count_ != 0; }
    bool has_several_unplaced() const { return unplaced_count_ > 1; }

    /// Chooses one of the unplaced emitters, of which there must be some, by a number in [0, 1);
    /// returns it and its probability.
    std::pair<EmitterPtr, Float> unplaced(const Float& random) const {
        UInt32 place(0);
        if (unplaced_count_ > 1) {
            place = dr::binary_search<UInt32>(0, unplaced_count_ - 1, [&](const UInt32& i) {
                return dr::gather<Float>(unplaced_sums_, i) <= random;
            });
        }
        return {dr::gather<EmitterPtr>(unplaced_, place),
                dr::gather<Float>(unplaced_probs_, place)};
    }

    /// The emitter that each light belongs to.
    EmitterPtr emitter(const UInt32& light, const Mask& active) const {
        return dr::gather<EmitterPtr>(emitters_, light, active);
    }
    /// The index of each light's triangle in its mesh; kNoTriangle for a light that is none.
    UInt32 triangle(const UInt32& light, const Mask& active) const {
        return dr::gather<UInt32>(triangles_, light, active);
    }
    /// One of the three corners of the triangle that each light is, or is a part of.
    Point3f corner(std::uint32_t which, const UInt32& light, const Mask& active) const {
        return dr::gather<Point3f>(corners_[which], light, active);
    }
    /// Draws a place on each light that is a triangle, or a part of one.
    typename CutTables<Float>::Place draw_place(const UInt32& light, const Float& piece_1,
                                                const Float& piece_2, const Point2f& random,
                                                const Mask& active) const {
        if (cuts_.has_parts()) return cuts_.draw(light, piece_1, piece_2, random, active);
        return {warp::square_to_uniform_triangle(random),
                dr::rcp(dr::gather<Float>(areas_, light, active))};
    }
    /// The light that a place of a triangle belongs to, and the density with which it is drawn on
    /// that. `light` is the triangle's, or its first part's.
    typename CutTables<Float>::Found find_place(const UInt32& light, const Point2f& uv,
                                                const Mask& active) const {
        if (cuts_.has_parts()) return cuts_.find(light, uv, active);
        return {light, dr::rcp(dr::gather<Float>(areas_, light, active))};
    }
    /// Whether draw_place() takes numbers to choose pieces by.
    bool has_pieces() const { return cuts_.has_choice(); }

    static constexpr std::uint32_t kNoTriangle = 0xffffffffu;

  private:
    void load_sources(const Scene* scene, const SceneLights<Float, Spectrum>& lights);
    void load_triangles(const SceneLights<Float, Spectrum>& lights);
    void load_unplaced(const SceneLights<Float, Spectrum>& lights);

    // By the emitter's place in Dr.Jit's registry: the words of Entry, and one more.
    static constexpr std::size_t kEntryWords = 4;
    UInt32 entries_;
    // These are indexed by light.
    EmitterPtr emitters_;
    UInt32 triangles_;
    Float corners_[3], areas_;
    CutTables<Float> cuts_;
    bool has_triangles_ = false, has_wholes_ = false;
    // These are indexed by the place among the unplaced; sums are of the probabilities up to it.
    std::uint32_t unplaced_count_ = 0;
    EmitterPtr unplaced_;
    Float unplaced_probs_, unplaced_sums_;
};

template <typename Float, typename Spectrum>
LightTables<Float, Spectrum>::LightTables(const Scene* scene,
                                          const SceneLights<Float, Spectrum>& lights) {
    load_sources(scene, lights);
    if (!lights.lights().empty()) load_triangles(lights);
    if (!lights.unplaced().empty()) load_unplaced(lights);
}

template <typename Float, typename Spectrum>
void LightTables<Float, Spectrum>::load_sources(const Scene* scene,
                                                const SceneLights<Float, Spectrum>& lights) {
    std::uint32_t ids = 1;
    for (const auto& emitter : scene->emitters()) {
        ids = std::max(ids, jit_registry_id(emitter.get()) + 1);
    }
    std::vector<std::uint32_t> entries(kEntryWords * ids, 0);
    const auto set = [&](const Emitter* emitter, std::uint32_t kind, std::uint32_t first_light,
                         float prob) {
        std::uint32_t* const entry = &entries[kEntryWords * jit_registry_id(emitter)];
        entry[0] = kind;
        entry[1] = first_light;
        std::memcpy(&entry[2], &prob, sizeof prob);
    };
    for (const auto& source : lights.sources()) {
        set(source.emitter, source.mesh ? kTriangles : kWhole, source.first, 0.0f);
        (source.mesh ? has_triangles_ : has_wholes_) = true;
    }
    for (const auto& unplaced : lights.unplaced())
        set(unplaced.emitter, kUnplaced, 0, unplaced.prob);
    entries_ = dr::load<UInt32>(entries.data(), entries.size());
    dr::sync_thread();  // the vector must live until it is copied
}

template <typename Float, typename Spectrum>
void LightTables<Float, Spectrum>::load_triangles(const SceneLights<Float, Spectrum>& lights) {
    const std::size_t count = lights.lights().size();
    std::vector<const Emitter*> emitters(count);
    std::vector<std::uint32_t> triangles(count, kNoTriangle);
    std::vector<float> corners[3], areas;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto& source = lights.source_of(i);
        emitters[i] = source.emitter;
        if (source.mesh && i >= source.first) triangles[i] = lights.triangles()[i].index;
        const auto& [a, b, c] = lights.triangles()[i].corners;
        corners[0].insert(corners[0].end(), {a.x, a.y, a.z});
        corners[1].insert(corners[1].end(), {b.x, b.y, b.z});
        corners[2].insert(corners[2].end(), {c.x, c.y, c.z});
        areas.push_back(lights.places().area(i));
    }
    emitters_ = dr::load<EmitterPtr>(emitters.data(), count);
    triangles_ = dr::load<UInt32>(triangles.data(), count);
    for (int k = 0; k < 3; ++k) corners_[k] = dr::load<Float>(corners[k].data(), corners[k].size());
    areas_ = dr::load<Float>(areas.data(), areas.size());
    cuts_ = CutTables<Float>(lights.places(), static_cast<std::uint32_t>(count));
    dr::sync_thread();  // the vectors must live until they are copied
}

template <typename Float, typename Spectrum>
void LightTables<Float, Spectrum>::load_unplaced(const SceneLights<Float, Spectrum>& lights) {
    std::vector<const Emitter*> emitters;
    std::vector<float> probs, sums;
    float sum = 0.0f;
    for (const auto& [emitter, prob] : lights.unplaced()) {
        emitters.push_back(emitter);
        probs.push_back(prob);
        sums.push_back(sum += prob);
    }
    unplaced_count_ = static_cast<std::uint32_t>(emitters.size());
    unplaced_ = dr::load<EmitterPtr>(emitters.data(), emitters.size());
    unplaced_probs_ = dr::load<Float>(probs.data(), probs.size());
    unplaced_sums_ = dr::load<Float>(sums.data(), sums.size());
    dr::sync_thread();  // the vectors must live until they are copied
}

}  // namespace mitsuba::culling
