#include "own_samplers.h"

#include <lightcull/error.h>
#include <lightcull/lightcull.h>

#include <dlfcn.h>

#include <cstdint>
#include <type_traits>
#include <vector>

namespace lightcull::python {
namespace {

static_assert(sizeof(lightcull_shading_point) == sizeof(ShadingPoint));
static_assert(sizeof(lightcull_selection) == sizeof(Selection));
static_assert(sizeof(lightcull_receipt) == sizeof(Receipt));
static_assert(sizeof(lightcull_outcome) == sizeof(LightOutcome));

/// The number of points that it is told to calibrate on, as our own samplers are.
constexpr std::uint32_t kCalibrationPoints = 128;

const lightcull_shading_point* to_c(const ShadingPoint* points) noexcept {
    return reinterpret_cast<const lightcull_shading_point*>(points);
}

std::vector<lightcull_light> lights_of(const Scene& scene) {
    std::vector<lightcull_light> lights;
    for (const Light& light : scene.lights()) {
        lightcull_light c = LIGHTCULL_LIGHT_INIT;
        const auto copy = [](const float3& from, float* to) {
            to[0] = from.x;
            to[1] = from.y;
            to[2] = from.z;
        };
        copy(light.center, c.center);
        c.radius = light.radius;
        copy(light.axis, c.axis);
        c.cos_theta_o = light.cos_theta_o;
        c.cos_theta_e = light.cos_theta_e;
        c.intensity = light.intensity;
        c.two_sided = light.two_sided ? 1 : 0;
        c.lobe_alpha = light.lobe_alpha;
        c.directional = light.directional ? 1 : 0;
        lights.push_back(c);
    }
    return lights;
}

/// The functions of a shared object, which stays loaded.
struct Functions {
    decltype(&lightcull_last_error) last_error;
    decltype(&lightcull_sampler_create) create;
    decltype(&lightcull_sampler_destroy) destroy;
    decltype(&lightcull_sampler_begin_pass) begin_pass;
    decltype(&lightcull_sampler_current_pass) current_pass;
    decltype(&lightcull_set_count) set_count;
    decltype(&lightcull_needs_receipt) needs_receipt;
    decltype(&lightcull_select_many) select_many;
    decltype(&lightcull_prob) prob;
    // These two may be missing.
    decltype(&lightcull_wants_reports) wants_reports;
    decltype(&lightcull_report) report;

    explicit Functions(const std::string& path) {
        void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (handle == nullptr) throw Error("sampler: cannot be loaded: " + std::string(dlerror()));
        const auto find_if_there = [&](const char* name, auto& function) {
            function = reinterpret_cast<std::decay_t<decltype(function)>>(dlsym(handle, name));
        };
        const auto find = [&](const char* name, auto& function) {
            find_if_there(name, function);
            if (function == nullptr) throw Error(path + ": has no function " + name);
        };
        find("lightcull_last_error", last_error);
        find("lightcull_sampler_create", create);
        find("lightcull_sampler_destroy", destroy);
        find("lightcull_sampler_begin_pass", begin_pass);
        find("lightcull_sampler_current_pass", current_pass);
        find("lightcull_set_count", set_count);
        find("lightcull_needs_receipt", needs_receipt);
        find("lightcull_select_many", select_many);
        find("lightcull_prob", prob);
        find_if_there("lightcull_wants_reports", wants_reports);
        find_if_there("lightcull_report", report);
    }
};

class ForeignSampler final : public LightSampler {
  public:
    ForeignSampler(const SamplerLibrary& library, const Scene& scene,
                   const RenderSettings& settings)
        : path_(library.path), call_(library.path) {
        const std::vector<ShadingPoint> seen = camera_points(scene, settings, kCalibrationPoints);
        const std::vector<lightcull_light> lights = lights_of(scene);
        const lightcull_context context{sizeof(lightcull_context), settings.width * settings.height,
                                        to_c(seen.data()), seen.size()};
        check(call_.create(library.description.c_str(), lights.data(), lights.size(), &context,
                           &sampler_));
        pass_ = call_.current_pass(sampler_);
    }
    ~ForeignSampler() override { call_.destroy(sampler_); }
    ForeignSampler(const ForeignSampler&) = delete;
    ForeignSampler& operator=(const ForeignSampler&) = delete;

    void begin_pass(std::uint64_t pass) override { check(call_.begin_pass(sampler_, pass)); }

    std::unique_ptr<const LightSelector> pass(std::uint64_t) const override {
        throw Error(path_ + ": its passes are not asked for as objects of their own");
    }

    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        check(call_.select_many(pass_, to_c(points.data()), u.data(), points.size(),
                                reinterpret_cast<lightcull_selection*>(selections.data())));
    }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        Selection selection;
        const lightcull_error error = call_.select_many(
            pass_, to_c(&point), &u, 1, reinterpret_cast<lightcull_selection*>(&selection));
        return error == LIGHTCULL_OK ? selection : Selection{};
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        return call_.prob(pass_, to_c(&point), reinterpret_cast<const lightcull_receipt*>(&receipt),
                          light);
    }

    std::uint32_t set_count() const noexcept override { return call_.set_count(pass_); }
    bool needs_receipt() const noexcept override { return call_.needs_receipt(pass_) != 0; }

    bool wants_reports() const noexcept override {
        return call_.report != nullptr && call_.wants_reports != nullptr &&
               call_.wants_reports(pass_) != 0;
    }
    void report(Span<const LightOutcome> outcomes) const noexcept override {
        call_.report(pass_, reinterpret_cast<const lightcull_outcome*>(outcomes.data()),
                     outcomes.size());
    }

  private:
    void check(lightcull_error error) const {
        if (error != LIGHTCULL_OK) throw Error(path_ + ": " + call_.last_error());
    }

    std::string path_;
    Functions call_;
    lightcull_sampler* sampler_ = nullptr;
    const lightcull_pass* pass_ = nullptr;
};

}  // namespace

std::unique_ptr<LightSampler> sampler_of_library(const SamplerLibrary& library, const Scene& scene,
                                                 const RenderSettings& settings) {
    return std::make_unique<ForeignSampler>(library, scene, settings);
}

}  // namespace lightcull::python
