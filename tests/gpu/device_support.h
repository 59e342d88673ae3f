#pragma once

#include <lightcull/error.h>
#include <lightcull/gpu/vulkan_sampler.h>
#include <lightcull/samplers.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "unit/test_lights.h"

namespace lightcull::testing {

inline std::unique_ptr<LightSampler> culled() {
    return make_sampler("culled:sets=4", mixed_lights(500, 75));
}

/// Sets a variable of the environment for as long as this lives.
class Environment {
  public:
    Environment(const char* name, const std::string& value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = std::make_unique<std::string>(before);
        setenv(name, value.c_str(), 1);
    }
    Environment(Environment&&) = delete;
    ~Environment() {
        if (before_ != nullptr) {
            setenv(name_, before_->c_str(), 1);
        } else {
            unsetenv(name_);
        }
    }

  private:
    const char* name_;
    std::unique_ptr<std::string> before_;
};

/// While it lives, samplers are made with faulty_layer/, and without two other layers: that of
/// validation, for which what could not be submitted is under way for ever, and Mesa's, which
/// breaks where there is no device.
struct FaultyLayer {
    Environment path{"VK_ADD_LAYER_PATH", LIGHTCULL_LAYERS};
    Environment instance{"VK_INSTANCE_LAYERS", "VK_LAYER_LIGHTCULL_faulty"};
    Environment no_other{"NODEVICE_SELECT", "1"};
};

/// While it lives, a call fails, but not the first `after` times.
struct Fault : Environment {
    explicit Fault(const std::string& call_and_value, int after = 0)
        : Environment("LIGHTCULL_FAULT", call_and_value + std::to_string(after)) {}
};

/// The message of what the action throws; empty if it throws nothing.
template <typename Action>
std::string error_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// The lights that a batch of points gets.
inline std::vector<std::uint32_t> chosen_by(const LightSampler& sampler) {
    const auto points = mixed_points(1'000, 76, sampler.set_count());
    const std::vector<float> u(points.size(), 0.3f);
    std::vector<Selection> selections(points.size());
    sampler.select(points, u, selections);
    std::vector<std::uint32_t> lights(selections.size());
    for (std::size_t i = 0; i < lights.size(); ++i) lights[i] = selections[i].light;
    return lights;
}

}  // namespace lightcull::testing
