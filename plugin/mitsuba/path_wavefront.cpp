#include "path_wavefront.h"

#include <lightcull/samplers.h>

#include <mitsuba/core/warp.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <memory>
#include <type_traits>

#include "lanes.h"
#include "light_tables.h"
#include "variants.h"

namespace mitsuba::culling {
namespace {

using ::lightcull::Receipt;
using ::lightcull::Selection;
using ::lightcull::ShadingPoint;
using ::lightcull::Span;

/// All paths that are still under way, one a lane.
template <typename Float_, typename Spectrum_>
struct Paths {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Shape)

    UInt32 lane;  ///< among all of the wavefront
    Ray3f ray;
    Spectrum throughput, result;
    Float eta;
    Mask valid;
    // Of the last vertex, for the weight of what its ray hits.
    Interaction3f last;
    Float bsdf_pdf;
    Mask weigh;
    Vector3f normal;  ///< as in ShadingPoint
    UInt32 set;
    Float weight_sum;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(Paths, lane, ray, throughput, result, eta, valid, last, bsdf_pdf, weigh, normal,
                 set, weight_sum)
};

/// A Dr.Jit array that has been evaluated, in memory. One that is a single value stands for any
/// number of it.
template <typename T>
class Column {
  public:
    template <typename Array>
    explicit Column(const Array& array) {
        auto values = std::make_shared<std::decay_t<decltype(dr::detach(array))>>(array);
        data_ = static_cast<const T*>(values->data());
        stride_ = dr::width(*values) == 1 ? 0 : 1;
        keep_ = std::move(values);
    }
    T operator[](std::size_t i) const { return data_[i * stride_]; }

  private:
    std::shared_ptr<void> keep_;
    const T* data_;
    std::size_t stride_;
};

/// The same for three columns.
class VectorColumn {
  public:
    template <typename Vector>
    explicit VectorColumn(const Vector& v) : x_(v.x()), y_(v.y()), z_(v.z()) {}
    ::lightcull::float3 operator[](std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

  private:
    Column<float> x_, y_, z_;
};

/// Dr.Jit works in packets: it reads, though it does not use, some elements after the last.
constexpr std::size_t kPadding = 64;

/// Memory as a Dr.Jit array, not copied: it must stay as it is until all that uses the array has
/// been evaluated.
template <typename Array, typename T>
Array view(std::vector<T>& values) {
    return dr::map<Array>(values.data(), values.size() - kPadding);
}

template <typename Function>
void for_each_lane(std::size_t count, const Function& function) {
    constexpr std::size_t kGrain = 4096;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) function(i);
    });
}

/// A pass of paths, bounce by bounce. A bounce is two kernels: what the rays meet, and what happens
/// there; between them the processor chooses lights. Where lights come in, and depths, roulette and
/// weights, it does what Mitsuba's `path` does.
template <typename Float, typename Spectrum>
class Wavefront {
  public:
    MI_IMPORT_TYPES(Scene, Sampler, Emitter, EmitterPtr, BSDF, BSDFPtr, Shape, ShapePtr)

    using Tables = LightTables<Float, Spectrum>;

    Wavefront(const PathSetup<Float, Spectrum>& setup, Sampler* sampler,
              const std::vector<PathSets>& sets, WavefrontMemory& memory)
        : setup_(setup),
          tables_(*setup.tables),
          sampler_(sampler),
          sets_(sets),
          memory_(memory),
          width_(sampler->wavefront_size()) {}

    std::pair<Spectrum, Mask> trace(const RayDifferential3f& camera_rays) {
        start(camera_rays);
        while (dr::width(paths_.lane) != 0 && !setup_.integrator->should_stop()) {
            intersect();
            find_hit_probs();
            if (depth_ + 1 >= setup_.max_depth) {
                paths_.result += weighted_emission();
                paths_.valid |= sees_emitter_;
                store();
                break;
            }
            choose_lights();
            shade();
            store();
            compact();
            ++depth_;
        }
        return {dr::select(valid_, result_, 0.0f), valid_};
    }

  private:
    void start(const RayDifferential3f& camera_rays) {
        result_ = dr::zeros<Spectrum>(width_);
        valid_ = dr::full<Mask>(false, width_);
        paths_ = dr::zeros<Paths<Float, Spectrum>>(width_);
        paths_.lane = dr::arange<UInt32>(width_);
        paths_.ray = Ray3f(camera_rays);
        paths_.throughput = dr::full<Spectrum>(1.0f, width_);
        paths_.eta = dr::full<Float>(1.0f, width_);
        paths_.bsdf_pdf = dr::full<Float>(1.0f, width_);
        paths_.valid =
            dr::full<Mask>(!setup_.hide_emitters && setup_.scene->environment() != nullptr, width_);
        // As later bounces have it, so that they need no other kernel.
        dr::make_opaque(result_, valid_, paths_);
    }

    /// First kernel: what the rays meet, and all that choosing lights takes.
    void intersect() {
        const Scene* scene = setup_.scene;
        hit_ = scene->ray_intersect_preliminary(paths_.ray, depth_ == 0, false, 0, 0, true);
        if (setup_.hide_emitters && depth_ == 0) skip_emitters();
        SurfaceInteraction3f si = hit_.compute_surface_interaction(paths_.ray, +RayFlags::All);
        hits_surface_ = si.is_valid();
        find_emission(si);
        BSDFPtr bsdf = si.bsdf(paths_.ray);
        const UInt32 flags = bsdf->flags();
        smooth_ = hits_surface_ && has_flag(flags, BSDFFlags::Smooth);
        position_ = si.p;
        const Mask both_sides = (flags & kSmoothTransmission) != 0u;
        normal_ = dr::select(both_sides, Vector3f(0.0f),
                             Vector3f(dr::mulsign(si.sh_frame.n, Frame3f::cos_theta(si.wi))));
        random_ = draw_1();
        dr::schedule(hit_, hits_surface_, smooth_, position_, normal_, random_, emission_,
                     emission_pdf_, hit_light_, asks_, sees_emitter_);
        sampler_->schedule_state();
        dr::eval();
        dr::sync_thread();
    }

    void skip_emitters() {
        const Mask skip = hit_.is_valid() && hit_.shape->emitter() != nullptr;
        const SurfaceInteraction3f si =
            hit_.compute_surface_interaction(paths_.ray, +RayFlags::Minimal, skip);
        dr::masked(hit_, skip) = setup_.integrator->skip_area_emitters(
            setup_.scene, si.spawn_ray(paths_.ray.d), true, skip);
    }

    /// Of what the rays have hit, or of the environment; not weighted yet, since for that the
    /// probability of the light is missing.
    void find_emission(const SurfaceInteraction3f& si) {
        const EmitterPtr emitter = si.emitter(setup_.scene);
        const Mask there = emitter != nullptr && paths_.bsdf_pdf > 0.0f;
        sees_emitter_ = there && !setup_.hide_emitters;
        emission_ = dr::select(there, paths_.throughput * emitter->eval(si, there), 0.0f);
        const DirectionSample3f ds(setup_.scene, si, paths_.last);
        const Mask weigh = there && paths_.weigh;
        const auto entry = tables_.find(emitter, weigh);
        const Mask triangle = weigh && entry.kind == Tables::kTriangles;
        const Mask whole = weigh && entry.kind == Tables::kWhole;
        const Mask unplaced = weigh && entry.kind == Tables::kUnplaced;
        hit_light_ = entry.first_light + dr::select(triangle, si.prim_index, 0u);
        asks_ = triangle || whole;
        emission_pdf_ = dr::select(unplaced, entry.prob, 1.0f) *
                        emitter->pdf_direction(paths_.last, ds, whole || unplaced);
        if (tables_.has_triangles()) {
            dr::masked(emission_pdf_, triangle) =
                triangle_pdf(hit_light_, si.n, ds.d, ds.dist, triangle);
        }
        dr::masked(emission_pdf_, !(asks_ || unplaced)) = 0.0f;
    }

    /// Solid angle density of a point sampled uniformly on a triangle.
    Float triangle_pdf(const UInt32& light, const Normal3f& normal, const Vector3f& direction,
                       const Float& distance, const Mask& active) const {
        return dr::square(distance) /
               (tables_.area(light, active) * dr::abs(dr::dot(normal, direction)));
    }

    /// On the processor: the probabilities that the lights that were hit had at the last vertex.
    void find_hit_probs() {
        const std::size_t count = dr::width(paths_.lane);
        std::vector<float>& probs = memory_.hit_probs;
        probs.assign(count + kPadding, 1.0f);
        const Column<bool> asks(asks_);
        const VectorColumn position(paths_.last.p), normal(paths_.normal);
        const Column<std::uint32_t> set(paths_.set), light(hit_light_);
        const Column<float> weight_sum(paths_.weight_sum);
        for_each_lane(count, [&](std::size_t i) {
            if (!asks[i]) return;
            ShadingPoint point;
            point.position = position[i];
            point.normal = normal[i];
            point.set = set[i];
            probs[i] = setup_.selector->prob(point, Receipt{weight_sum[i], set[i]}, light[i]);
        });
        hit_prob_ = view<Float>(probs);
    }

    /// On the processor: a light for every vertex that can use one.
    void choose_lights() {
        const std::size_t count = dr::width(paths_.lane);
        auto& [users, points, u, selections, lights, sets, hit_probs, probs, mis_probs,
               weight_sums] = memory_;
        users.clear();
        if (!setup_.lights->lights().empty()) {
            const Column<bool> smooth(smooth_);
            for (std::uint32_t i = 0; i < count; ++i) {
                if (smooth[i]) users.push_back(i);
            }
        }
        points.resize(users.size());
        u.resize(users.size());
        selections.resize(users.size());
        gather_points();
        setup_.selector->select(points, u, selections);
        store_selections(count);
        light_ = view<UInt32>(lights);
        prob_ = view<Float>(probs);
        mis_prob_ = view<Float>(mis_probs);
        weight_sum_ = view<Float>(weight_sums);
        set_ = view<UInt32>(sets);
    }

    void gather_points() {
        const VectorColumn position(position_), normal(normal_);
        const Column<std::uint32_t> lane(paths_.lane);
        const Column<float> random(random_);
        for_each_lane(memory_.users.size(), [&](std::size_t k) {
            const std::uint32_t i = memory_.users[k];
            ShadingPoint& point = memory_.points[k];
            point.position = position[i];
            point.normal = normal[i];
            point.set = set_of(lane[i]);
            memory_.random[k] = random[i];
        });
    }

    std::uint32_t set_of(std::uint32_t lane) const {
        if (depth_ == 0) return sets_[lane].camera;
        return ::lightcull::set_of_packet(sets_[lane].packet + depth_,
                                          setup_.selector->set_count());
    }

    void store_selections(std::size_t count) {
        memory_.lights.assign(count + kPadding, 0);
        memory_.sets.assign(count + kPadding, 0);
        memory_.probs.assign(count + kPadding, 0.0f);
        memory_.mis_probs.assign(count + kPadding, 0.0f);
        memory_.weight_sums.assign(count + kPadding, 0.0f);
        const bool proxy = setup_.selector->prob_is_proxy();
        for_each_lane(memory_.users.size(), [&](std::size_t k) {
            const std::uint32_t i = memory_.users[k];
            const Selection& chosen = memory_.selections[k];
            memory_.lights[i] = chosen.light;
            memory_.probs[i] = memory_.mis_probs[i] = chosen.prob;
            if (proxy && chosen.prob > 0.0f) {
                memory_.mis_probs[i] =
                    setup_.selector->prob(memory_.points[k], chosen.receipt, chosen.light);
            }
            memory_.weight_sums[i] = chosen.receipt.weight_sum;
            memory_.sets[i] = chosen.receipt.key;
        });
    }

    Spectrum weighted_emission() const {
        const Float weight = mis_weight(paths_.bsdf_pdf, hit_prob_ * emission_pdf_);
        return emission_ * dr::select(paths_.weigh, weight, 1.0f);
    }

    /// Second kernel: emission, light from the chosen lights, and the next rays.
    void shade() {
        paths_.result += weighted_emission();
        paths_.valid |= sees_emitter_ && !hits_surface_;
        SurfaceInteraction3f si = hit_.compute_surface_interaction(paths_.ray, +RayFlags::All);
        scatter(si);
        dr::schedule(paths_, going_on_);
        sampler_->schedule_state();
        dr::eval();
    }

    /// A point on a light, or a direction to it.
    struct LightSample {
        Point3f p;
        Vector3f direction;
        Spectrum weight;  ///< radiance by the density of the sample
        Float pdf;        ///< to weigh it with
        Mask delta, active;

        // NOLINTNEXTLINE(performance-noexcept-move-constructor)
        DRJIT_STRUCT(LightSample, p, direction, weight, pdf, delta, active)
    };

    LightSample sample_chosen(const SurfaceInteraction3f& si) {
        if (setup_.lights->lights().empty()) return dr::zeros<LightSample>();
        const Point2f random = draw_2();
        const Mask chosen = prob_ > 0.0f;
        const EmitterPtr emitter = tables_.emitter(light_, chosen);
        const UInt32 triangle = tables_.triangle(light_, chosen);
        const Mask is_triangle = triangle != Tables::kNoTriangle;
        auto sample = dr::zeros<LightSample>();
        if (tables_.has_triangles()) {
            sample = sample_triangle(si, emitter, triangle, random, chosen && is_triangle);
        }
        if (!tables_.has_wholes()) return sample;
        const Mask active = chosen && !is_triangle;
        const LightSample whole = sample_whole(si, emitter, random, prob_, mis_prob_, active);
        return tables_.has_triangles() ? dr::select(active, whole, sample) : whole;
    }

    LightSample sample_triangle(const SurfaceInteraction3f& si, const EmitterPtr& emitter,
                                const UInt32& triangle, const Point2f& random,
                                const Mask& active) const {
        const Point2f uv = warp::square_to_uniform_triangle(random);
        LightSample sample;
        sample.p = tables_.corner(0, light_, active) * (1.0f - uv.x() - uv.y()) +
                   tables_.corner(1, light_, active) * uv.x() +
                   tables_.corner(2, light_, active) * uv.y();
        const Vector3f way = sample.p - si.p;
        const Float distance = dr::norm(way);
        sample.direction = way / distance;

        auto hit = dr::zeros<PreliminaryIntersection3f>();
        hit.t = distance;
        hit.prim_uv = uv;
        hit.prim_index = triangle;
        hit.shape = dr::select(active, emitter->shape(), dr::zeros<ShapePtr>());
        Ray3f ray = paths_.ray;
        ray.o = si.p;
        ray.d = sample.direction;
        const SurfaceInteraction3f at =
            hit.compute_surface_interaction(ray, +RayFlags::All, active);
        const Float pdf = triangle_pdf(light_, at.n, sample.direction, distance, active);
        sample.active = active && dr::isfinite(pdf);
        sample.weight = emitter->eval(at, sample.active) / (prob_ * pdf);
        sample.pdf = mis_prob_ * pdf;
        sample.delta = false;
        return sample;
    }

    /// Of an emitter that Mitsuba samples.
    LightSample sample_whole(const SurfaceInteraction3f& si, const EmitterPtr& emitter,
                             const Point2f& random, const Float& select_prob, const Float& mis_prob,
                             const Mask& active) const {
        const auto [ds, weight] = emitter->sample_direction(si, random, active);
        LightSample sample;
        sample.p = ds.p;
        sample.direction = ds.d;
        sample.weight = weight / select_prob;
        sample.pdf = mis_prob * ds.pdf;
        sample.delta = ds.delta;
        sample.active = active && ds.pdf > 0.0f;
        return sample;
    }

    /// One of the emitters without a place, for every vertex that can use one.
    LightSample sample_unplaced(const SurfaceInteraction3f& si) {
        const auto& unplaced = setup_.lights->unplaced();
        Float u = draw_1();
        EmitterPtr emitter = dr::opaque<EmitterPtr>(unplaced.back().emitter);
        Float prob = unplaced.back().prob, below = 0.0f;
        Mask found = false;
        for (const auto& entry : unplaced) {
            below += entry.prob;
            const Mask here = !found && u < below;
            dr::masked(emitter, here) = dr::opaque<EmitterPtr>(entry.emitter);
            dr::masked(prob, here) = entry.prob;
            found |= here;
        }
        return sample_whole(si, emitter, draw_2(), prob, prob, smooth_);
    }

    /// Direct light at the vertex, and where the path goes from there.
    void scatter(SurfaceInteraction3f& si) {
        const BSDFPtr bsdf = si.bsdf(paths_.ray);
        const BSDFContext context;
        if (!setup_.lights->unplaced().empty()) {
            const LightSample sample = sample_unplaced(si);
            const auto [value, pdf] =
                bsdf->eval_pdf(context, si, si.to_local(sample.direction), sample.active);
            add_if_visible(si, sample, value, pdf);
        }
        const LightSample chosen = sample_chosen(si);
        const Float random_1 = draw_1();
        const Point2f random_2 = draw_2();
        const auto [value, pdf, next, weight] = bsdf->eval_pdf_sample(
            context, si, si.to_local(chosen.direction), random_1, random_2, hits_surface_);
        add_if_visible(si, chosen, value, pdf);
        advance(si, next, weight);
    }

    void add_if_visible(const SurfaceInteraction3f& si, const LightSample& sample,
                        const Spectrum& bsdf_value, const Float& bsdf_pdf) {
        const Spectrum light = paths_.throughput * bsdf_value * sample.weight *
                               dr::select(sample.delta, 1.0f, mis_weight(sample.pdf, bsdf_pdf));
        Mask active = sample.active && smooth_ && dr::any(light != 0.0f);
        active &= !setup_.scene->ray_test(si.spawn_ray_to(sample.p), active);
        dr::masked(paths_.result, active) += light;
    }

    void advance(const SurfaceInteraction3f& si, const BSDFSample3f& next, const Spectrum& weight) {
        paths_.ray = si.spawn_ray(si.to_world(next.wo));
        paths_.throughput *= weight;
        paths_.eta *= next.eta;
        paths_.valid |= hits_surface_ && !has_flag(next.sampled_type, BSDFFlags::Null);
        paths_.last = Interaction3f(si);
        paths_.bsdf_pdf = next.pdf;
        paths_.weigh = smooth_ && !has_flag(next.sampled_type, BSDFFlags::Delta);
        paths_.normal = normal_;
        paths_.set = set_;
        paths_.weight_sum = weight_sum_;

        const Float largest = dr::max(paths_.throughput);
        going_on_ = hits_surface_ && largest > 0.0f;
        const Float random = draw_1();
        if (depth_ + 1 < setup_.rr_depth) return;
        const Float survival = dr::minimum(largest * dr::square(paths_.eta), 0.95f);
        going_on_ &= random < survival;
        paths_.throughput *= dr::rcp(survival);
    }

    /// What the paths have brought, in the lanes of the whole wavefront.
    void store() {
        dr::scatter(result_, paths_.result, paths_.lane);
        dr::scatter(valid_, paths_.valid, paths_.lane);
    }

    /// Leaves out the paths that have ended.
    void compact() {
        const UInt32 left = dr::compress(going_on_);
        paths_ = dr::gather<Paths<Float, Spectrum>>(paths_, left);
        dr::eval(paths_, result_, valid_);
    }

    Float draw_1() { return of_lanes(sampler_->next_1d()); }
    Point2f draw_2() { return of_lanes(sampler_->next_2d()); }

    /// The random numbers of all lanes, for those that are left.
    template <typename Random>
    Random of_lanes(const Random& all) const {
        if (dr::width(paths_.lane) == width_) return all;
        Random drawn = all;
        dr::eval(drawn);
        return dr::gather<Random>(drawn, paths_.lane);
    }

    const PathSetup<Float, Spectrum>& setup_;
    const Tables& tables_;
    Sampler* sampler_;
    const std::vector<PathSets>& sets_;
    WavefrontMemory& memory_;
    std::uint32_t width_;
    std::uint32_t depth_ = 0;
    Spectrum result_;
    Mask valid_;
    Paths<Float, Spectrum> paths_;
    // Of this bounce.
    PreliminaryIntersection3f hit_;
    Mask hits_surface_, smooth_, sees_emitter_, asks_, going_on_;
    Point3f position_;
    Vector3f normal_;
    Float random_;
    Spectrum emission_;
    Float emission_pdf_, hit_prob_;
    UInt32 hit_light_, light_, set_;
    Float prob_, mis_prob_, weight_sum_;
};

}  // namespace

template <typename Float, typename Spectrum>
std::pair<Spectrum, dr::mask_t<Float>> trace_wavefront(
    const PathSetup<Float, Spectrum>& setup, Sampler<Float, Spectrum>* sampler,
    const RayDifferential<Point<Float, 3>, Spectrum>& rays, const std::vector<PathSets>& sets,
    WavefrontMemory& memory) {
    const dr::suspend_grad<Float> no_derivatives;
    return Wavefront<Float, Spectrum>(setup, sampler, sets, memory).trace(rays);
}

// NOLINTBEGIN(bugprone-macro-parentheses)
#define INSTANTIATE(Float, Spectrum)                                                     \
    template std::pair<Spectrum, dr::mask_t<Float>> trace_wavefront<Float, Spectrum>(    \
        const PathSetup<Float, Spectrum>&, Sampler<Float, Spectrum>*,                    \
        const RayDifferential<Point<Float, 3>, Spectrum>&, const std::vector<PathSets>&, \
        WavefrontMemory&);
LIGHTCULL_LLVM_VARIANTS(INSTANTIATE)
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace mitsuba::culling
