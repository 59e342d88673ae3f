#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>
#include <lightcull/span.h>

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lightcull {

/// Linear RGB with the sRGB primaries, row 0 at the top.
struct Image {
    std::uint32_t width = 0, height = 0;  ///< pixels
    std::vector<float3> pixels;           ///< width * height, row by row
};

/// An image as a file has it, but for its alpha: one of the arrays has its rows, the first at the
/// top. 8 and 16 bits are not decoded, and of more, or of floats, the pixels are linear RGB.
struct StoredImage {
    std::uint32_t width = 0, height = 0;     ///< pixels
    std::uint32_t channels = 3;              ///< of samples8 and samples16: 1, which is grey, or 3
    std::vector<std::uint8_t> samples8{};    ///< width * height * channels
    std::vector<std::uint16_t> samples16{};  ///< width * height * channels
    std::vector<float3> pixels{};            ///< width * height
};

/// The type of a stored number. A half holds up to 65504: what lies beyond is stored as that.
enum class PixelType { kHalf, kFloat };

/// Reads any format that OpenImageIO knows. 8- and 16-bit images are taken as sRGB unless
/// `linear_data` (roughness maps and the like). Throws Error with the path and the reason.
LIGHTCULL_EXPORT Image read_image(const std::string& path, bool linear_data = false);

/// The same, with 8 and 16 bits as they are: sRGB, or numbers.
LIGHTCULL_EXPORT StoredImage read_stored_image(const std::string& path);

/// Reads a layer of an OpenEXR file of several layers or parts: the channels NAME.R, NAME.G and
/// NAME.B, whatever stands before NAME and a point. Throws Error with the path and the reason.
LIGHTCULL_EXPORT Image read_layer(const std::string& path, const std::string& name);

/// Writes an OpenEXR file, with `metadata` as string attributes. The file appears whole or not at
/// all. Throws Error with the path and the reason.
LIGHTCULL_EXPORT void write_exr(const std::string& path, const Image& image, PixelType type,
                                const std::map<std::string, std::string>& metadata = {});

/// Writes an 8-bit PNG of an image that has been through a view. The file appears whole or not at
/// all. Throws Error with the path and the reason.
LIGHTCULL_EXPORT void write_png(const std::string& path, const Image& display,
                                const std::map<std::string, std::string>& metadata = {});

/// Names of the views there are, the default first: "aces" and "srgb", or those of the
/// configuration that $OCIO names.
LIGHTCULL_EXPORT std::vector<std::string> view_names();

/// The image that a display shows of a linear one: values in [0, 1], encoded. Throws Error for an
/// unknown view, with the names there are.
LIGHTCULL_EXPORT Image apply_view(const Image& linear, std::string_view view,
                                  float exposure_stops = 0.0f);

}  // namespace lightcull
