#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <lightcull/error.h>
#include <lightcull/image/image.h>
#include <lightcull/image/whole_file.h>

#include <cstddef>
#include <memory>

namespace lightcull {
namespace {

using Metadata = std::map<std::string, std::string>;

void check(const std::string& path, const Image& image) {
    const std::size_t count = std::size_t{image.width} * image.height;
    if (count == 0 || image.pixels.size() != count) {
        throw Error(path + ": cannot write: an image of " + std::to_string(image.width) + " x " +
                    std::to_string(image.height) + " with " + std::to_string(image.pixels.size()) +
                    " pixels");
    }
}

OIIO::ImageSpec make_spec(const Image& image, OIIO::TypeDesc::BASETYPE type,
                          const Metadata& metadata) {
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3, type);
    for (const auto& [name, value] : metadata) spec.attribute(name, value);
    return spec;
}

/// Encodes an image in memory, so that what reaches the disk is in our hands.
void write(const std::string& path, const char* format, const OIIO::ImageSpec& spec,
           const std::vector<float3>& pixels) {
    OIIO::Filesystem::IOVecOutput bytes;
    const auto output = OIIO::ImageOutput::create(format);
    if (!output) throw Error(path + ": cannot write: " + OIIO::geterror());
    const bool done = output->set_ioproxy(&bytes) && output->open(path, spec) &&
                      output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) && output->close();
    if (!done) throw Error(path + ": cannot write: " + output->geterror());
    write_whole_file(path, {bytes.buffer().data(), bytes.buffer().size()});
}

/// The value, within what a half holds. Beyond it a half would be infinite, and so would every mean
/// taken over it.
float clamp_to_half(float value) {
    constexpr float kHalfMax = 65504.0f;
    return value > kHalfMax ? kHalfMax : value < -kHalfMax ? -kHalfMax : value;
}

}  // namespace

void write_exr(const std::string& path, const Image& image, PixelType type,
               const Metadata& metadata) {
    check(path, image);
    if (type == PixelType::kFloat) {
        write(path, "openexr", make_spec(image, OIIO::TypeDesc::FLOAT, metadata), image.pixels);
        return;
    }
    std::vector<float3> pixels(image.pixels);
    for (float3& pixel : pixels) {
        pixel = {clamp_to_half(pixel.x), clamp_to_half(pixel.y), clamp_to_half(pixel.z)};
    }
    write(path, "openexr", make_spec(image, OIIO::TypeDesc::HALF, metadata), pixels);
}

void write_png(const std::string& path, const Image& display, const Metadata& metadata) {
    check(path, display);
    write(path, "png", make_spec(display, OIIO::TypeDesc::UINT8, metadata), display.pixels);
}

}  // namespace lightcull
