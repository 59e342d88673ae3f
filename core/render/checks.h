#pragma once

#include <lightcull/float3.h>
#include <lightcull/render/scene.h>
#include <lightcull/span.h>

#include <cstddef>
#include <string>
#include <string_view>

/// Checks of what is added to a scene. Each throws Error with one line that begins with `what`.

namespace lightcull::check {

[[noreturn]] void fail(std::string_view what, const std::string& why);

void finite(std::string_view what, float value);
void finite(std::string_view what, float2 value);
void finite(std::string_view what, float3 value);
/// True if `value` is finite, and no farther out than what Embree and squared distances bear.
bool is_position(float3 value) noexcept;
void position(std::string_view what, float3 value);
void positions(std::string_view what, Span<const float3> values);
/// Checks a colour or an intensity: finite and >= 0.
void radiometric(std::string_view what, float3 value);
void in_unit_range(std::string_view what, float value);
/// Checks an index `i` into `count` things called `kind`.
void index(std::string_view what, std::size_t i, std::size_t count, std::string_view kind);

/// Checks that floats hold the area of a triangle that emits, number `i` of a mesh, if it has one:
/// else its light would be lost.
void emissive_area(std::string_view mesh, std::size_t i, float3 a, float3 b, float3 c);
void texture(std::string_view what, const Texture& texture);
void camera(const Camera& camera);

/// The text "field[i]".
std::string element(std::string_view field, std::size_t i);

}  // namespace lightcull::check
