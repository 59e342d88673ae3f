#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

/// Takes any lights and any points: set-up refuses them with Error, or what is chosen makes sense.

namespace {

using namespace lightcull;

/// Takes values off the front of the input; 0 once it is used up.
class Input {
  public:
    Input(const unsigned char* data, std::size_t size) : data_(data), size_(size) {}

    template <typename T>
    T take() {
        T value{};
        const std::size_t count = size_ < sizeof value ? size_ : sizeof value;
        std::memcpy(&value, data_, count);
        data_ += count;
        size_ -= count;
        return value;
    }
    float3 take3() {
        const float x = take<float>(), y = take<float>(), z = take<float>();
        return {x, y, z};
    }
    bool empty() const { return size_ == 0; }

  private:
    const unsigned char* data_;
    std::size_t size_;
};

void require(bool condition, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "not so: %s\n", what);
    std::abort();
}

constexpr const char* kDescriptions[] = {"uniform",
                                         "power",
                                         "exhaustive",
                                         "light_bvh",
                                         "light_bvh:importance=means",
                                         "clamped",
                                         "culled:sets=4",
                                         "culled:error_bound=0.01:sets=16",
                                         "paper",
                                         "paper:list=0:error_bound=auto"};

Light take_light(Input& input) {
    Light light;
    switch (input.take<unsigned char>() % 5) {
        case 0: {
            const float3 a = input.take3(), b = input.take3(), c = input.take3();
            const float radiance = input.take<float>();
            return triangle_light(a, b, c, radiance, input.take<unsigned char>() % 2 == 1);
        }
        case 1: {
            const float3 position = input.take3();
            return point_light(position, input.take<float>());
        }
        case 2: {
            const float3 position = input.take3(), direction = input.take3();
            const float intensity = input.take<float>(), inner = input.take<float>();
            return spot_light(position, direction, intensity, inner, input.take<float>());
        }
        case 3: {
            const float3 low = input.take3(), high = input.take3(), axis = input.take3();
            const float theta_o = input.take<float>(), theta_e = input.take<float>();
            return bounded_light(low, high, axis, theta_o, theta_e, false, input.take<float>());
        }
        default:
            light.center = input.take3();
            light.radius = input.take<float>();
            light.axis = input.take3();
            light.cos_theta_o = input.take<float>();
            light.cos_theta_e = input.take<float>();
            light.intensity = input.take<float>();
            light.directional = input.take<unsigned char>() % 2 == 1;
            return light;
    }
}

bool is_finite(float3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A point as select() wants it.
ShadingPoint take_point(Input& input, std::uint32_t set_count) {
    ShadingPoint point;
    const float3 position = input.take3(), normal = input.take3();
    if (is_finite(position)) point.position = position;
    const double length = std::hypot(static_cast<double>(normal.x), static_cast<double>(normal.y),
                                     static_cast<double>(normal.z));
    if (length > 0.0 && std::isfinite(length)) {
        point.normal = {static_cast<float>(normal.x / length),
                        static_cast<float>(normal.y / length),
                        static_cast<float>(normal.z / length)};
    }
    point.set = input.take<unsigned char>() % set_count;
    return point;
}

void check(const LightSampler& sampler, const ShadingPoint& point, const Selection& chosen,
           std::size_t light_count) {
    require(chosen.prob >= 0.0f && chosen.prob <= 1.0001f, "prob is in [0, 1]");
    require(std::isfinite(chosen.receipt.weight_sum), "weight_sum is finite");
    if (chosen.prob == 0.0f) return;
    require(chosen.light < light_count, "the light is one of them");
    require(sampler.prob(point, chosen.receipt, chosen.light) == chosen.mis_prob,
            "prob() is that of select()");
}

void run(Input& input) {
    const char* const description =
        kDescriptions[input.take<unsigned char>() % (sizeof kDescriptions / sizeof *kDescriptions)];
    std::vector<Light> lights(input.take<unsigned char>() % 20);
    for (Light& light : lights) light = take_light(input);
    const auto sampler = make_sampler(description, lights);
    sampler->begin_pass(input.take<std::uint64_t>());

    std::vector<ShadingPoint> points;
    while (!input.empty() && points.size() < 40) {
        points.push_back(take_point(input, sampler->set_count()));
    }
    std::vector<float> u(points.size());
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = 0.999f * static_cast<float>(i % 7) / 7.0f;
    std::vector<Selection> chosen(points.size());
    sampler->select(points, u, chosen);
    for (std::size_t i = 0; i < points.size(); ++i) {
        check(*sampler, points[i], chosen[i], lights.size());
        const Selection single = sampler->select(points[i], u[i]);
        require(single.prob == chosen[i].prob, "a batch is as single points");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    Input input(data, size);
    try {
        run(input);
    } catch (const Error& error) {
        require(std::string(error.what()).find('\n') == std::string::npos, "an error is one line");
    }
    return 0;
}
