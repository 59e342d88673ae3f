#include <lightcull/checked_sampler.h>
#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <algorithm>
#include <cassert>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lights/c_api/c_error.h"
#include "lights/c_api/c_layout.h"
#include "lights/c_api/c_light.h"

namespace lightcull {
namespace {

SamplerContext context_of(const lightcull_context* from) {
    SamplerContext context;
    if (from == nullptr) return context;
    if (from->size != sizeof(lightcull_context)) {
        throw Error("context: size is " + std::to_string(from->size) + ", wanted " +
                    std::to_string(sizeof(lightcull_context)) + ", sizeof(lightcull_context)");
    }
    if (from->calibration_point_count > 0) {
        check_not_null(from->calibration_points, "context: calibration_points");
    }
    context.calibration_points = {to_cpp(from->calibration_points), from->calibration_point_count};
    context.points_per_pass = from->points_per_pass;
    return context;
}

/// Parses a description, and throws Error for a sampler that needs more of a host than the C
/// interface has.
SamplerSpec parse_sampler_of_c(const char* description) {
    check_not_null(description, "description");
    const SamplerSpec spec = parse_sampler(description);
    const auto* paper = std::get_if<PaperOptions>(&spec);
    if (paper != nullptr && paper->range_at_vertex) {
        throw Error("sampler '" + std::string(description) +
                    "': test=vertex, the default, is for C++ hosts; wanted test=light, as in "
                    "paper:test=light");
    }
    return spec;
}

std::unique_ptr<LightSampler> make(const char* description, const lightcull_light* lights,
                                   std::size_t count, const lightcull_context* context) {
    const SamplerSpec spec = parse_sampler_of_c(description);
    const SamplerContext cpp_context = context_of(context);
    return make_sampler(spec, to_cpp(lights, count), cpp_context);
}

/// Sets *made to a handle, or to NULL with an error. `make` gives a pointer that owns.
template <typename Handle, typename Make>
lightcull_error create(Handle** made, const char* name, const Make& make) noexcept {
    return guarded([&] {
        check_not_null(made, name);
        *made = nullptr;
        *made = make();
    });
}

}  // namespace
}  // namespace lightcull

using namespace lightcull;

lightcull_error lightcull_sampler_create(const char* description, const lightcull_light* lights,
                                         size_t count, const lightcull_context* context,
                                         lightcull_sampler** sampler) {
    return create(sampler, "sampler",
                  [&] { return to_c(make(description, lights, count, context).release()); });
}

lightcull_error lightcull_checked_sampler_create(const char* description,
                                                 const lightcull_light* lights, size_t count,
                                                 const lightcull_context* context,
                                                 lightcull_fault_handler on_fault, void* user_data,
                                                 lightcull_sampler** sampler) {
    return create(sampler, "sampler", [&] {
        FaultHandler handler;
        if (on_fault != nullptr) {
            handler = [=](const std::string& fault) { on_fault(fault.c_str(), user_data); };
        }
        return to_c(make_checked_sampler(make(description, lights, count, context), count,
                                         std::move(handler))
                        .release());
    });
}

void lightcull_sampler_destroy(lightcull_sampler* sampler) {
    delete to_cpp(sampler);
}

lightcull_error lightcull_sampler_begin_pass(lightcull_sampler* sampler, uint64_t number) {
    return guarded([&] {
        check_not_null(sampler, "sampler");
        to_cpp(sampler)->begin_pass(number);
    });
}

lightcull_error lightcull_sampler_update(lightcull_sampler* sampler, const lightcull_light* lights,
                                         size_t count, float max_growth, lightcull_update* update) {
    return guarded([&] {
        check_not_null(sampler, "sampler");
        if (update != nullptr && update->size != sizeof(lightcull_update)) {
            throw Error("update: size is " + std::to_string(update->size) + ", wanted " +
                        std::to_string(sizeof(lightcull_update)) + ", sizeof(lightcull_update)");
        }
        const LightUpdate done = to_cpp(sampler)->update(to_cpp(lights, count), max_growth);
        if (update == nullptr) return;
        update->rebuilt = done.rebuilt ? 1 : 0;
        update->growth = done.growth;
    });
}

const lightcull_pass* lightcull_sampler_current_pass(const lightcull_sampler* sampler) {
    return to_c(static_cast<const LightSelector*>(to_cpp(sampler)));
}

lightcull_error lightcull_pass_create(const lightcull_sampler* sampler, uint64_t number,
                                      lightcull_pass** pass) {
    return create(pass, "pass", [&] {
        check_not_null(sampler, "sampler");
        // Passes are immutable; only lightcull_pass_destroy() takes one that is not const.
        return const_cast<lightcull_pass*>(to_c(to_cpp(sampler)->pass(number).release()));
    });
}

void lightcull_pass_destroy(lightcull_pass* pass) {
    delete to_cpp(pass);
}

lightcull_error lightcull_sampler_learned(const lightcull_sampler* sampler, uint8_t* bytes,
                                          size_t* size) {
    return guarded([&] {
        check_not_null(sampler, "sampler");
        check_not_null(size, "size");
        const std::vector<std::uint8_t> learned = to_cpp(sampler)->learned();
        const std::size_t room = std::exchange(*size, learned.size());
        if (room < learned.size()) return;
        if (!learned.empty()) check_not_null(bytes, "bytes");
        std::copy(learned.begin(), learned.end(), bytes);
    });
}

lightcull_error lightcull_sampler_restore_learned(lightcull_sampler* sampler, const uint8_t* bytes,
                                                  size_t size) {
    return guarded([&] {
        check_not_null(sampler, "sampler");
        if (size > 0) check_not_null(bytes, "bytes");
        to_cpp(sampler)->restore_learned({bytes, size});
    });
}

void lightcull_sampler_drop_reports(lightcull_sampler* sampler) {
    to_cpp(sampler)->drop_reports();
}

int lightcull_wants_reports(const lightcull_pass* pass) {
    return to_cpp(pass)->wants_reports() ? 1 : 0;
}

void lightcull_report(const lightcull_pass* pass, const lightcull_outcome* outcomes, size_t count) {
    to_cpp(pass)->report({to_cpp(outcomes), count});
}

uint32_t lightcull_set_count(const lightcull_pass* pass) {
    return to_cpp(pass)->set_count();
}

int lightcull_needs_receipt(const lightcull_pass* pass) {
    return to_cpp(pass)->needs_receipt() ? 1 : 0;
}

void lightcull_select(const lightcull_pass* pass, const lightcull_shading_point* point, float u,
                      lightcull_selection* selection) {
    *to_cpp(selection) = to_cpp(pass)->select(*to_cpp(point), u);
}

lightcull_error lightcull_select_many(const lightcull_pass* pass,
                                      const lightcull_shading_point* points, const float* u,
                                      size_t count, lightcull_selection* selections) {
    // The one Error of that call is that memory lacks.
    return guarded(
        [&] {
            to_cpp(pass)->select({to_cpp(points), count}, {u, count}, {to_cpp(selections), count});
        },
        LIGHTCULL_OUT_OF_MEMORY);
}

float lightcull_prob(const lightcull_pass* pass, const lightcull_shading_point* point,
                     const lightcull_receipt* receipt, uint32_t light) {
    assert(receipt != nullptr || !to_cpp(pass)->needs_receipt());
    return to_cpp(pass)->prob(*to_cpp(point), receipt != nullptr ? *to_cpp(receipt) : Receipt{},
                              light);
}
