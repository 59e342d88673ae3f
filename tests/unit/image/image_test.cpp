#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/image/image.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

namespace fs = std::filesystem;
using lightcull::float3;
using lightcull::Image;
using lightcull::PixelType;

namespace {

/// A folder that goes when the test ends.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (fs::temp_directory_path() / "lightcull-image-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        path_ = name;
    }
    ~TemporaryFolder() { fs::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::string operator/(const char* name) const { return (path_ / name).string(); }
    std::ptrdiff_t file_count() const {
        return std::distance(fs::directory_iterator(path_), fs::directory_iterator());
    }

  private:
    fs::path path_;
};

/// Sets $OCIO, or takes it away, for the life of the object.
class OcioVariable {
  public:
    explicit OcioVariable(const char* value) {
        if (const char* old = std::getenv("OCIO")) old_ = old;
        set(value);
    }
    ~OcioVariable() { set(old_.empty() ? nullptr : old_.c_str()); }
    OcioVariable(const OcioVariable&) = delete;
    OcioVariable& operator=(const OcioVariable&) = delete;

  private:
    static void set(const char* value) {
        value != nullptr ? ::setenv("OCIO", value, 1) : ::unsetenv("OCIO");
    }
    std::string old_;
};

std::string read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

Image gradient(std::uint32_t width, std::uint32_t height) {
    Image image{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i) {
        const float x = static_cast<float>(i);
        image.pixels.push_back({0.1f + x, 1e-3f * x, 1.0f / (1.0f + x)});
    }
    return image;
}

/// A grey TIFF of 2 x 2 pixels in one strip packed by PackBits, which lacks its second half.
std::string cut_tiff() {
    const auto tag = [](char id, char id_high, char value, char value_high = 0) {
        return std::string{id, id_high, 3, 0, 1, 0, 0, 0, value, value_high, 0, 0};
    };
    constexpr char kStripOffset = 8 + 2 + 9 * 12 + 4;
    return std::string("II*\0\10\0\0\0\11\0", 10) + tag(0, 1, 2) + tag(1, 1, 2) + tag(2, 1, 8) +
           tag(3, 1, 5, '\x80') + tag(6, 1, 1) + tag(17, 1, kStripOffset) + tag(21, 1, 1) +
           tag(22, 1, 2) + tag(23, 1, 4) + std::string("\0\0\0\0\0\x80", 6);
}

Image one_pixel(float3 pixel) {
    return {1, 1, {pixel}};
}

/// The text of the Error that `function` throws, or "".
template <typename Function>
std::string error_of(Function&& function) {
    try {
        function();
    } catch (const lightcull::Error& error) {
        return error.what();
    }
    return {};
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("image: a float EXR comes back bit for bit, the first row at the top") {
    const TemporaryFolder folder;
    const Image image = gradient(7, 5);
    lightcull::write_exr(folder / "a.exr", image, PixelType::kFloat);
    const Image read = lightcull::read_image(folder / "a.exr");
    REQUIRE(read.width == 7);
    REQUIRE(read.height == 5);
    REQUIRE(read.pixels.size() == image.pixels.size());
    for (std::size_t i = 0; i < read.pixels.size(); ++i) {
        CHECK(read.pixels[i].x == image.pixels[i].x);
        CHECK(read.pixels[i].y == image.pixels[i].y);
        CHECK(read.pixels[i].z == image.pixels[i].z);
    }
}

TEST_CASE("image: a half EXR keeps 11 bits and clamps what halves cannot hold") {
    const TemporaryFolder folder;
    const Image image{2, 1, {{0.1f, 3.14159f, 1234.5f}, {1e9f, -1e9f, 0.0f}}};
    lightcull::write_exr(folder / "a.exr", image, PixelType::kHalf);
    const Image read = lightcull::read_image(folder / "a.exr");
    CHECK(read.pixels[0].x == doctest::Approx(0.1f).scale(0.0).epsilon(1.0 / 2048));
    CHECK(read.pixels[0].x != 0.1f);
    CHECK(read.pixels[0].y == doctest::Approx(3.14159f).scale(0.0).epsilon(1.0 / 2048));
    CHECK(read.pixels[0].z == doctest::Approx(1234.5f).scale(0.0).epsilon(1.0 / 2048));
    CHECK(read.pixels[1].x == 65504.0f);
    CHECK(read.pixels[1].y == -65504.0f);
}

TEST_CASE("image: metadata is in the file, as strings") {
    const TemporaryFolder folder;
    const std::map<std::string, std::string> metadata{{"sampler", "culled"}, {"seed", "17"}};
    lightcull::write_exr(folder / "a.exr", gradient(2, 2), PixelType::kHalf, metadata);
    lightcull::write_png(folder / "a.png", gradient(2, 2), metadata);
    // The headers of both formats are stored plainly: name, type, length, text in OpenEXR; name,
    // 0, text in PNG.
    const std::string exr = read_bytes(folder / "a.exr");
    CHECK(contains(exr, std::string("sampler\0string\0\6\0\0\0culled", 25)));
    CHECK(contains(exr, std::string("seed\0string\0\2\0\0\00017", 18)));
    const std::string png = read_bytes(folder / "a.png");
    CHECK(contains(png, std::string("tEXtsampler\0culled", 18)));
    CHECK(contains(png, std::string("tEXtseed\00017", 11)));
}

TEST_CASE("image: 8-bit values are sRGB, or data if one says so") {
    const TemporaryFolder folder;
    const Image display{3, 1, {{0.0f, 0.0f, 0.0f}, {0.5f, 0.25f, 0.02f}, {1.0f, 1.0f, 2.0f}}};
    lightcull::write_png(folder / "a.png", display);
    const Image data = lightcull::read_image(folder / "a.png", true);
    CHECK(data.pixels[1].x == doctest::Approx(128.0 / 255));
    CHECK(data.pixels[1].y == doctest::Approx(64.0 / 255));
    CHECK(data.pixels[2].z == 1.0f);
    const Image linear = lightcull::read_image(folder / "a.png");
    CHECK(linear.pixels[0].x == 0.0f);
    CHECK(linear.pixels[1].x ==
          doctest::Approx(std::pow((128.0 / 255 + 0.055) / 1.055, 2.4)).scale(0.0).epsilon(1e-4));
    CHECK(linear.pixels[1].z == doctest::Approx(5.0 / 255 / 12.92).scale(0.0).epsilon(1e-4));
    CHECK(linear.pixels[2].x == doctest::Approx(1.0));
}

TEST_CASE("image: grey becomes three channels, and alpha is ignored") {
    const TemporaryFolder folder;
    write_bytes(folder / "grey.pgm", std::string("P5\n2 1\n255\n\x33\xff", 13));
    const Image grey = lightcull::read_image(folder / "grey.pgm", true);
    CHECK(grey.pixels[0].x == doctest::Approx(0.2));
    CHECK(grey.pixels[0].y == doctest::Approx(0.2));
    CHECK(grey.pixels[0].z == doctest::Approx(0.2));
    // An uncompressed TGA of one pixel: blue 0, green 0x33, red 0xff, alpha 0x80.
    const std::string header("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\40\10", 18);
    write_bytes(folder / "alpha.tga", header + std::string("\x00\x33\xff\x80", 4));
    const Image alpha = lightcull::read_image(folder / "alpha.tga", true);
    CHECK(alpha.pixels[0].x == doctest::Approx(1.0));
    CHECK(alpha.pixels[0].y == doctest::Approx(0.2));
    CHECK(alpha.pixels[0].z == 0.0f);
}

TEST_CASE("image: what cannot be read is an error of one line with the path") {
    const TemporaryFolder folder;
    lightcull::write_exr(folder / "whole.exr", gradient(64, 64), PixelType::kFloat);
    lightcull::write_png(folder / "whole.png", gradient(64, 64));
    const std::string exr = read_bytes(folder / "whole.exr");
    const std::string png = read_bytes(folder / "whole.png");
    write_bytes(folder / "cut.exr", exr.substr(0, exr.size() / 2));
    write_bytes(folder / "cut.png", png.substr(0, png.size() / 2));
    write_bytes(folder / "cut.tif", cut_tiff());
    write_bytes(folder / "header.exr", exr.substr(0, 40));
    write_bytes(folder / "text.png", "not an image at all");
    write_bytes(folder / "empty.exr", "");
    write_bytes(folder / "huge.pgm", "P5\n2000000000 2000000000\n255\n");
    REQUIRE(::mkfifo((folder / "pipe.png").c_str(), 0600) == 0);
    write_bytes(folder / "large.pgm", "P5\n300000 300000\n255\n");
    // Newer OpenImageIO refuses the file before we do.
    CHECK(contains(error_of([&] { lightcull::read_image(folder / "large.pgm"); }), "300000"));
    for (const char* name : {"missing.exr", "cut.exr", "cut.png", "cut.tif", "header.exr",
                             "text.png", "pipe.png", "empty.exr", "huge.pgm", "large.pgm", "."}) {
        CAPTURE(name);
        const std::string path = folder / name;
        const std::string message = error_of([&] { lightcull::read_image(path); });
        INFO(message);
        CHECK(message.rfind(path + ": cannot read: ", 0) == 0);
        CHECK(message.size() > path.size() + 20);
        CHECK_FALSE(contains(message, "\n"));
    }
}

TEST_CASE("image: what cannot be written is an error with the path and leaves nothing behind") {
    const TemporaryFolder folder;
    const Image image = gradient(4, 4);
    const auto write = [&](const std::string& path) {
        return error_of([&] { lightcull::write_exr(path, image, PixelType::kHalf); });
    };
    const std::string nowhere = folder / "no/such/folder/a.exr";
    CHECK(write(nowhere) == nowhere + ": cannot write: No such file or directory");
    fs::create_directory(folder / "taken.exr");
    CHECK(contains(write(folder / "taken.exr"), "taken.exr: cannot write: it is there"));
    const std::string pipe = folder / "pipe.exr";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(contains(write(pipe), "pipe.exr: cannot write: it is there"));
    CHECK(fs::is_fifo(pipe));
    const Image lacking{4, 4, {{}, {}}};
    const std::string path = folder / "lacking.png";
    CHECK(error_of([&] { lightcull::write_png(path, lacking); }) ==
          path + ": cannot write: an image of 4 x 4 with 2 pixels");
    CHECK(folder.file_count() == 2);
}

TEST_CASE("image: a file is replaced as a whole, and no part of it stays beside it") {
    const TemporaryFolder folder;
    lightcull::write_exr(folder / "a.exr", gradient(9, 9), PixelType::kHalf);
    lightcull::write_exr(folder / "a.exr", gradient(3, 2), PixelType::kHalf);
    CHECK(lightcull::read_image(folder / "a.exr").width == 3);
    CHECK(folder.file_count() == 1);
}

TEST_CASE("image: the sRGB view is the sRGB curve") {
    const OcioVariable no_ocio(nullptr);
    const auto view = [](float3 pixel, float stops = 0.0f) {
        return lightcull::apply_view(one_pixel(pixel), "srgb", stops).pixels[0];
    };
    CHECK(view({0, 0, 0}).x == doctest::Approx(0.0).epsilon(1e-4));
    CHECK(view({1, 1, 1}).y == doctest::Approx(1.0).scale(0.0).epsilon(1e-4));
    CHECK(view({0.18f, 0.18f, 0.18f}).z == doctest::Approx(0.461356).scale(0.0).epsilon(1e-3));
    CHECK(view({0.09f, 0.09f, 0.09f}, 1.0f).z ==
          doctest::Approx(0.461356).scale(0.0).epsilon(1e-3));
    const float3 red = view({1, 0, 0});
    CHECK(red.x == doctest::Approx(1.0).scale(0.0).epsilon(1e-3));
    CHECK(red.y < 0.01f);
    CHECK(red.z < 0.01f);
}

TEST_CASE("image: the ACES view rolls highlights off and keeps grey grey") {
    const OcioVariable no_ocio(nullptr);
    const auto grey = [](float value) {
        const float3 pixel =
            lightcull::apply_view(one_pixel({value, value, value}), "aces").pixels[0];
        CHECK(pixel.x == doctest::Approx(pixel.y).scale(0.0).epsilon(2e-3));
        CHECK(pixel.y == doctest::Approx(pixel.z).scale(0.0).epsilon(2e-3));
        return pixel.y;
    };
    CHECK(grey(0.0f) == doctest::Approx(0.0).epsilon(1e-3));
    // Mid-grey is shown at about a tenth of white, 4.8 of 48 nits, which sRGB encodes as 0.349.
    CHECK(std::abs(grey(0.18f) - 0.349f) < 0.01f);
    CHECK(grey(1.0f) > grey(0.18f));
    CHECK(grey(1.0f) < 0.9f);
    CHECK(grey(100.0f) > 0.99f);
}

TEST_CASE("image: the ACES view shows colours as S. Hill's fit of ACES does") {
    const OcioVariable no_ocio(nullptr);
    const float3 sky = lightcull::apply_view(one_pixel({0.1f, 0.2f, 0.5f}), "aces").pixels[0];
    CHECK(std::abs(sky.x - 0.238f) < 0.02f);
    CHECK(std::abs(sky.y - 0.386f) < 0.02f);
    CHECK(std::abs(sky.z - 0.629f) < 0.02f);
    const float3 clay = lightcull::apply_view(one_pixel({0.5f, 0.2f, 0.1f}), "aces").pixels[0];
    CHECK(std::abs(clay.x - 0.638f) < 0.02f);
    CHECK(std::abs(clay.y - 0.394f) < 0.02f);
    CHECK(std::abs(clay.z - 0.257f) < 0.02f);
}

TEST_CASE("image: views are finite, in [0, 1], for any pixel") {
    const OcioVariable no_ocio(nullptr);
    const float inf = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const std::string& name : lightcull::view_names()) {
        CAPTURE(name);
        for (float3 pixel : {float3{inf, inf, inf}, {nan, 1, 1}, {-5, 2, 1e30f}, {-inf, 0, 0}}) {
            const float3 shown = lightcull::apply_view(one_pixel(pixel), name).pixels[0];
            for (float value : {shown.x, shown.y, shown.z}) CHECK((value >= 0 && value <= 1));
        }
    }
    CHECK(lightcull::apply_view(one_pixel({inf, inf, inf}), "srgb").pixels[0].x == 1.0f);
}

TEST_CASE("image: an unknown view is an error with the names there are") {
    const OcioVariable no_ocio(nullptr);
    CHECK(lightcull::view_names() == std::vector<std::string>{"aces", "srgb"});
    CHECK(error_of([] { lightcull::apply_view(one_pixel({}), "filmic"); }) ==
          "there is no view 'filmic'; there are: aces, srgb");
}

TEST_CASE("image: a view of nothing is nothing, and of a broken image an error") {
    const OcioVariable no_ocio(nullptr);
    CHECK(lightcull::apply_view({}, "srgb").pixels.empty());
    CHECK(error_of([] {
              lightcull::apply_view({4, 4, {{}, {}}}, "srgb");
          }) == "view: an image of 4 x 4 with 2 pixels");
    for (const float stops : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
        CHECK(error_of([&] { lightcull::apply_view(one_pixel({}), "srgb", stops); }) ==
              "exposure is not finite");
    }
}

TEST_CASE("image: $OCIO brings the views of its default display") {
    const TemporaryFolder folder;
    // `half` shows half of what is there, in a display space with a gamma of 2.
    write_bytes(folder / "config.ocio",
                "ocio_profile_version: 2\n"
                "roles: {scene_linear: lin_srgb, default: lin_srgb}\n"
                "file_rules:\n  - !<Rule> {name: Default, colorspace: default}\n"
                "displays:\n  screen:\n"
                "    - !<View> {name: full, colorspace: gamma}\n"
                "    - !<View> {name: half, colorspace: gamma, looks: halve}\n"
                "looks:\n  - !<Look> {name: halve, process_space: lin_srgb, transform:"
                " !<MatrixTransform> {matrix: [.5,0,0,0, 0,.5,0,0, 0,0,.5,0, 0,0,0,1]}}\n"
                "colorspaces:\n  - !<ColorSpace> {name: lin_srgb}\n"
                "  - !<ColorSpace> {name: gamma, from_scene_reference:"
                " !<ExponentTransform> {value: 2, direction: inverse}}\n");
    const std::string path = folder / "config.ocio";
    const OcioVariable ocio(path.c_str());
    CHECK(lightcull::view_names() == std::vector<std::string>{"full", "half"});
    const Image image = one_pixel({0.5f, 0.25f, 0.0f});
    const float3 full = lightcull::apply_view(image, "full").pixels[0];
    CHECK(full.x == doctest::Approx(std::sqrt(0.5)).scale(0.0).epsilon(1e-4));
    CHECK(full.y == doctest::Approx(0.5).scale(0.0).epsilon(1e-4));
    CHECK(lightcull::apply_view(image, "half").pixels[0].x ==
          doctest::Approx(0.5).scale(0.0).epsilon(1e-4));
    CHECK(contains(error_of([&] { lightcull::apply_view(image, "aces"); }), "full, half"));
}

TEST_CASE("image: a broken $OCIO is an error that names it") {
    const TemporaryFolder folder;
    const std::string path = folder / "missing.ocio";
    const OcioVariable ocio(path.c_str());
    const std::string message = error_of([] { lightcull::view_names(); });
    CHECK(contains(message, "$OCIO"));
    CHECK(contains(message, path));
}
