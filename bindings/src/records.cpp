#include "records.h"

#include "arrays.h"

#include <lightcull/light.h>
#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>

#include <cstddef>

namespace lightcull::python {
namespace {

/// A structured dtype that grows field by field.
class Record {
  public:
    Record& floats(const char* name, std::size_t offset) { return field(name, "f4", offset); }
    Record& ids(const char* name, std::size_t offset) { return field(name, "u4", offset); }
    Record& bools(const char* name, std::size_t offset) { return field(name, "?", offset); }
    Record& float3s(const char* name, std::size_t offset) { return field(name, "3f4", offset); }

    py::object dtype(std::size_t size) const {
        py::dict description;
        description["names"] = names_;
        description["formats"] = formats_;
        description["offsets"] = offsets_;
        description["itemsize"] = size;
        return numpy_dtype(description);
    }

  private:
    Record& field(const char* name, const char* format, std::size_t offset) {
        names_.append(name);
        formats_.append(format);
        offsets_.append(offset);
        return *this;
    }

    py::list names_, formats_, offsets_;
};

}  // namespace

py::object light_dtype() {
    return Record()
        .float3s("center", offsetof(Light, center))
        .floats("radius", offsetof(Light, radius))
        .float3s("axis", offsetof(Light, axis))
        .floats("cos_theta_o", offsetof(Light, cos_theta_o))
        .floats("cos_theta_e", offsetof(Light, cos_theta_e))
        .floats("intensity", offsetof(Light, intensity))
        .bools("two_sided", offsetof(Light, two_sided))
        .floats("lobe_alpha", offsetof(Light, lobe_alpha))
        .bools("directional", offsetof(Light, directional))
        .dtype(sizeof(Light));
}

py::object lobe_dtype() {
    return Record()
        .float3s("axis", offsetof(GlossyLobe, axis))
        .floats("alpha", offsetof(GlossyLobe, alpha))
        .floats("peak", offsetof(GlossyLobe, peak))
        .dtype(sizeof(GlossyLobe));
}

py::object selection_dtype() {
    return Record()
        .ids("light", offsetof(Selection, light))
        .floats("prob", offsetof(Selection, prob))
        .floats("mis_prob", offsetof(Selection, mis_prob))
        .floats("weight_sum", offsetof(Selection, receipt) + offsetof(Receipt, weight_sum))
        .ids("key", offsetof(Selection, receipt) + offsetof(Receipt, key))
        .dtype(sizeof(Selection));
}

py::object counts_dtype() {
    return Record()
        .ids("nodes_visited", offsetof(SelectionCounts, nodes_visited))
        .ids("lights_tested", offsetof(SelectionCounts, lights_tested))
        .ids("accepted", offsetof(SelectionCounts, accepted))
        .dtype(sizeof(SelectionCounts));
}

}  // namespace lightcull::python
