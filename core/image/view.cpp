#include <OpenColorIO/OpenColorIO.h>
#include <lightcull/error.h>
#include <lightcull/image/image.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace OCIO = OCIO_NAMESPACE;

namespace lightcull {
namespace {

constexpr const char* kAcesView = "aces";
constexpr const char* kSrgbView = "srgb";

/// The file that $OCIO names, or null.
const char* user_config_path() {
    const char* const path = std::getenv("OCIO");
    return path != nullptr && *path != '\0' ? path : nullptr;
}

void append_builtin(OCIO::GroupTransform& group, const char* style,
                    OCIO::TransformDirection direction = OCIO::TRANSFORM_DIR_FORWARD) {
    const auto transform = OCIO::BuiltinTransform::Create();
    transform->setStyle(style);
    transform->setDirection(direction);
    group.appendTransform(transform);
}

/// Makes a view from transforms. OpenColorIO 2.1 has no configuration of its own, but the
/// transforms that one is made of.
OCIO::ConstTransformRcPtr builtin_view(bool aces) {
    const auto group = OCIO::GroupTransform::Create();
    append_builtin(*group, "UTILITY - ACES-AP1_to_LINEAR-REC709_BFD", OCIO::TRANSFORM_DIR_INVERSE);
    if (aces) {
        append_builtin(*group, "ACEScg_to_ACES2065-1");
        append_builtin(*group, "ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0");
    } else {
        append_builtin(*group, "UTILITY - ACES-AP1_to_CIE-XYZ-D65_BFD");
    }
    append_builtin(*group, "DISPLAY - CIE-XYZ-D65_to_sRGB");
    return group;
}

/// The name by which a configuration calls linear light with the sRGB primaries: those of the ACES
/// configurations of OpenColorIO (first and second generation) and of Blender's.
std::string linear_srgb_space(const OCIO::Config& config) {
    for (const char* name : {"lin_rec709_srgb", "lin_rec709", "lin_srgb", "Utility - Linear - sRGB",
                             "Linear Rec.709", "Linear BT.709", "Linear sRGB", "Linear"}) {
        if (const auto space = config.getColorSpace(name)) return space->getName();
    }
    throw Error(
        "the OpenColorIO configuration has no colour space lin_rec709 (linear, with the "
        "sRGB primaries)");
}

std::vector<std::string> views_of(const OCIO::Config& config) {
    const char* const display = config.getDefaultDisplay();
    std::vector<std::string> names{config.getDefaultView(display)};
    for (int i = 0; i < config.getNumViews(display); ++i) {
        const std::string name = config.getView(display, i);
        if (name != names.front()) names.push_back(name);
    }
    return names;
}

OCIO::ConstTransformRcPtr config_view(const OCIO::Config& config, const std::string& view) {
    const auto transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(linear_srgb_space(config).c_str());
    transform->setDisplay(config.getDefaultDisplay());
    transform->setView(view.c_str());
    return transform;
}

std::vector<std::string> names_in(const OCIO::ConstConfigRcPtr& user_config) {
    if (user_config) return views_of(*user_config);
    return {kAcesView, kSrgbView};
}

/// The configuration that $OCIO names; null where it is not set.
OCIO::ConstConfigRcPtr read_user_config() {
    return user_config_path() != nullptr ? OCIO::Config::CreateFromEnv() : nullptr;
}

void check_view(const std::string& view, const std::vector<std::string>& names) {
    if (std::find(names.begin(), names.end(), view) != names.end()) return;
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    throw Error("there is no view '" + view + "'; there are: " + list);
}

OCIO::ConstCPUProcessorRcPtr make_processor(const std::string& view) {
    const auto user_config = read_user_config();
    check_view(view, names_in(user_config));
    const auto config = user_config ? user_config : OCIO::Config::CreateRaw();
    const auto transform =
        user_config ? config_view(*user_config, view) : builtin_view(view == kAcesView);
    return config->getProcessor(transform)->getDefaultCPUProcessor();
}

/// Runs a function that may throw OpenColorIO's exceptions, and makes them ours.
template <typename Function>
auto translate_errors(Function&& function) {
    try {
        return function();
    } catch (const OCIO::Exception& error) {
        const char* const path = user_config_path();
        throw Error(path != nullptr ? std::string("$OCIO, ") + path + ": " + error.what()
                                    : std::string("OpenColorIO: ") + error.what());
    }
}

/// The value within limits, or 0 for no number: transforms make nonsense of what is not finite.
float finite(float value) {
    constexpr float kLimit = 1e6f;
    return std::isnan(value) ? 0.0f : std::clamp(value, -kLimit, kLimit);
}

float3 expose(const float3& pixel, float scale) {
    return {finite(pixel.x * scale), finite(pixel.y * scale), finite(pixel.z * scale)};
}

float3 clamp_to_display(const float3& pixel) {
    return {std::clamp(pixel.x, 0.0f, 1.0f), std::clamp(pixel.y, 0.0f, 1.0f),
            std::clamp(pixel.z, 0.0f, 1.0f)};
}

}  // namespace

std::vector<std::string> view_names() {
    return translate_errors([] { return names_in(read_user_config()); });
}

Image apply_view(const Image& linear, std::string_view view, float exposure_stops) {
    if (linear.pixels.size() != std::size_t{linear.width} * linear.height) {
        throw Error("view: an image of " + std::to_string(linear.width) + " x " +
                    std::to_string(linear.height) + " with " +
                    std::to_string(linear.pixels.size()) + " pixels");
    }
    if (!std::isfinite(exposure_stops)) throw Error("exposure is not finite");
    const auto processor = translate_errors([&] { return make_processor(std::string(view)); });
    Image display = linear;
    const float scale = std::exp2(exposure_stops);
    for (float3& pixel : display.pixels) pixel = expose(pixel, scale);
    if (display.pixels.empty()) return display;
    OCIO::PackedImageDesc description(display.pixels.data(), static_cast<long>(linear.width),
                                      static_cast<long>(linear.height), 3);
    processor->apply(description);
    for (float3& pixel : display.pixels) pixel = clamp_to_display(pixel);
    return display;
}

}  // namespace lightcull
