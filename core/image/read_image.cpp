#include <OpenImageIO/color.h>
#include <OpenImageIO/imageio.h>
#include <lightcull/error.h>
#include <lightcull/image/image.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace lightcull {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
    // OpenImageIO's messages can have several lines and end in one; ours have one.
    const std::string line = reason.substr(0, reason.find('\n'));
    throw Error(path + ": cannot read: " + (line.empty() ? "not an image" : line));
}

std::unique_ptr<OIIO::ImageInput> open_image(const std::string& path) {
    OIIO::ImageSpec config;
    // Colours are read as they are stored, not multiplied by alpha, which is ignored.
    config.attribute("oiio:UnassociatedAlpha", 1);
    auto input = OIIO::ImageInput::open(path, &config);
    if (!input) fail(path, OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.deep) fail(path, "deep images are not supported");
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1) fail(path, "not a flat image");
    return input;
}

/// Samples as RGB: grey of one or two channels (the second is alpha), or the first three of more.
std::vector<float3> to_rgb(std::size_t channels, const std::vector<float>& samples) {
    std::vector<float3> pixels(samples.size() / channels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const float* const sample = samples.data() + i * channels;
        pixels[i] = channels < 3 ? float3{sample[0], sample[0], sample[0]}
                                 : float3{sample[0], sample[1], sample[2]};
    }
    return pixels;
}

/// The bytes that this machine has free; as many as can be where it does not say.
std::size_t free_memory() {
    std::ifstream file("/proc/meminfo");
    std::string name, rest;
    std::size_t kilobytes = 0;
    while (file >> name >> kilobytes && std::getline(file, rest)) {
        if (name == "MemAvailable:") return kilobytes * 1024;
    }
    return std::numeric_limits<std::size_t>::max();
}

/// Throws Error for an image larger than free memory. A header may promise more than memory holds,
/// and the system would give it until it is used.
void check_size(const std::string& path, const OIIO::ImageSpec& spec) {
    const double sample_bytes = sizeof(float) * static_cast<double>(spec.nchannels);
    const double needed =
        static_cast<double>(spec.image_pixels()) * (sample_bytes + sizeof(float3));
    if (needed <= static_cast<double>(free_memory())) return;
    fail(path, "its " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                   " pixels do not fit into memory");
}

/// Reads so many channels of all pixels.
template <typename T>
std::vector<T> read_samples(const std::string& path, OIIO::ImageInput& input, int channels,
                            OIIO::TypeDesc type) {
    std::vector<T> samples(input.spec().image_pixels() * static_cast<std::size_t>(channels));
    const bool read = input.read_image(0, 0, 0, channels, type, samples.data());
    // Truncated JPEG and TIFF files are "read", with a message and pixels made up.
    if (!read || input.has_error()) fail(path, input.geterror());
    return samples;
}

StoredImage read_opened(const std::string& path, OIIO::ImageInput& input) {
    const OIIO::ImageSpec spec = input.spec();
    check_size(path, spec);
    StoredImage image;
    image.width = static_cast<std::uint32_t>(spec.width);
    image.height = static_cast<std::uint32_t>(spec.height);
    const int channels = spec.nchannels < 3 ? 1 : 3;
    image.channels = static_cast<std::uint32_t>(channels);
    if (spec.format == OIIO::TypeDesc::UINT8) {
        image.samples8 = read_samples<std::uint8_t>(path, input, channels, OIIO::TypeDesc::UINT8);
    } else if (spec.format == OIIO::TypeDesc::UINT16) {
        image.samples16 =
            read_samples<std::uint16_t>(path, input, channels, OIIO::TypeDesc::UINT16);
    } else {
        image.pixels = to_rgb(image.channels,
                              read_samples<float>(path, input, channels, OIIO::TypeDesc::FLOAT));
    }
    return image;
}

/// Samples in parts of the largest value that their type holds.
template <typename T>
std::vector<float> to_floats(const std::vector<T>& samples) {
    std::vector<float> floats;
    floats.reserve(samples.size());
    for (const T sample : samples) {
        floats.push_back(static_cast<float>(sample) / std::numeric_limits<T>::max());
    }
    return floats;
}

/// The channel of a layer; -1 if there is none.
int channel_of(const OIIO::ImageSpec& spec, const std::string& layer, char color) {
    const std::string wanted = layer + '.' + color;
    for (int i = 0; i < spec.nchannels; ++i) {
        const std::string name = "." + spec.channelnames[static_cast<std::size_t>(i)];
        if (name.size() > wanted.size() &&
            name.compare(name.size() - wanted.size() - 1, std::string::npos, "." + wanted) == 0) {
            return i;
        }
    }
    return -1;
}

Image read_layer_opened(const std::string& path, OIIO::ImageInput& input, const std::string& name) {
    for (int part = 0; input.seek_subimage(part, 0); ++part) {
        const OIIO::ImageSpec spec = input.spec();
        const int channels[] = {channel_of(spec, name, 'R'), channel_of(spec, name, 'G'),
                                channel_of(spec, name, 'B')};
        if (*std::min_element(std::begin(channels), std::end(channels)) < 0) continue;
        check_size(path, spec);
        const auto stride = static_cast<std::size_t>(spec.nchannels);
        std::vector<float> samples(spec.image_pixels() * stride);
        if (!input.read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, samples.data())) {
            fail(path, input.geterror());
        }
        Image image{
            static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height), {}};
        for (std::size_t i = 0; i < samples.size(); i += stride) {
            const auto sample = [&](int c) {
                return samples[i + static_cast<std::size_t>(channels[c])];
            };
            image.pixels.push_back({sample(0), sample(1), sample(2)});
        }
        return image;
    }
    fail(path, "there is no layer " + name);
}

/// Calls read(), which opens and reads the file, if it is one.
template <typename Read>
auto read_file(const std::string& path, const Read& read) {
    if (path.find('\0') != std::string::npos) {
        fail(path.substr(0, path.find('\0')) + "\\0...", "no name of a file");
    }
    if (path.empty()) fail("''", "no name of a file");
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    // A device or a pipe may never end.
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
        fail(path, "not a file");
    }
    try {
        return read(*open_image(path));
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {  // a header that promises more than memory holds
        fail(path, error.what());
    }
}

}  // namespace

StoredImage read_stored_image(const std::string& path) {
    return read_file(path, [&](OIIO::ImageInput& input) { return read_opened(path, input); });
}

Image read_image(const std::string& path, bool linear_data) {
    StoredImage stored = read_stored_image(path);
    Image image{stored.width, stored.height, std::move(stored.pixels)};
    if (!image.pixels.empty()) return image;
    image.pixels = to_rgb(stored.channels, stored.samples16.empty() ? to_floats(stored.samples8)
                                                                    : to_floats(stored.samples16));
    if (linear_data) return image;
    for (float3& pixel : image.pixels) {
        pixel = {OIIO::sRGB_to_linear(pixel.x), OIIO::sRGB_to_linear(pixel.y),
                 OIIO::sRGB_to_linear(pixel.z)};
    }
    return image;
}

Image read_layer(const std::string& path, const std::string& name) {
    return read_file(path,
                     [&](OIIO::ImageInput& input) { return read_layer_opened(path, input, name); });
}

}  // namespace lightcull
