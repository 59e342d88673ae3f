#include "gpu/device_sampler.h"

#include <lightcull/error.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "gpu/bytes.h"
#include "gpu/shaders.h"
#include "lights/ranges/sphere_tree_walk.h"

// The records that shaders read; gpu/shaders/records.glsl has the same layouts.
static_assert(sizeof(lightcull::ShadingPoint) == 52);

namespace lightcull {
namespace {

/// The number of points that are handed over together: enough to keep a large GPU busy.
constexpr std::size_t kBatch = std::size_t{1} << 17;
static_assert(kBatch / shaders::kPaperWorkgroup < 65'536);  // any device takes so many workgroups
constexpr std::size_t kBytesPerPoint =
    sizeof(ShadingPoint) + sizeof(float) + sizeof(shaders::Selected);

/// The constants of a walk: first whether the node found first is read next, and how many words a
/// walk keeps (walk.glsl).
std::vector<std::uint32_t> constants_of(const Chooser& chooser, const SphereTree& tree,
                                        std::uint32_t levels) {
    std::vector<std::uint32_t> constants;
    if (TreeWalk::is_first_in_first_out(tree)) {
        constants = {VK_TRUE, static_cast<std::uint32_t>((tree.nodes.size() + 31) / 32)};
    } else {
        constants = {VK_FALSE, levels * (SphereNode::kWidth - 1) + 1};
    }
    constants.insert(constants.end(), chooser.constants.begin(), chooser.constants.end());
    return constants;
}

double checked_timeout(const VulkanOptions& options) {
    constexpr double kMost = 1e6;
    if (options.timeout_seconds > 0.0 && options.timeout_seconds <= kMost) {
        return options.timeout_seconds;
    }
    throw Error("timeout_seconds is " + std::to_string(options.timeout_seconds) +
                ", wanted above 0, to 1e6");
}

std::uint32_t checked_workgroup(const Device& device, const Chooser& chooser) {
    device.check_shared_memory(chooser.shared_memory);
    return chooser.workgroup;
}

void copy(const vk::raii::CommandBuffer& commands, vk::Buffer from, std::size_t from_offset,
          vk::Buffer to, std::size_t to_offset, std::size_t bytes) {
    commands.copyBuffer(from, to, vk::BufferCopy(from_offset, to_offset, bytes));
}

}  // namespace

void DeviceSampler::End::operator()(DeviceSampler* sampler) const noexcept {
    if (sampler->device_.is_idle_within(sampler->timeout_seconds_)) delete sampler;
}

DeviceSampler::Handle DeviceSampler::make(const Frame& frame, const RangeTree& tree,
                                          const Chooser& chooser, const VulkanOptions& options) {
    const BreadthFirst breadth_first(tree.tree());
    Handle sampler(new DeviceSampler(frame, tree, chooser, breadth_first, options));
    sampler->upload(tree, chooser, breadth_first);
    return sampler;
}

DeviceSampler::DeviceSampler(const Frame& frame, const RangeTree& tree, const Chooser& chooser,
                             const BreadthFirst& breadth_first, const VulkanOptions& options) try
    : device_(options.device),
      frame_(frame),
      reach_(tree.ranges().reach()),
      timeout_seconds_(checked_timeout(options)),
      set_count_(tree.ranges().set_count()),
      node_count_(static_cast<std::uint32_t>(tree.tree().nodes.size())),
      level_count_(static_cast<std::uint32_t>(breadth_first.levels.size() - 1)),
      workgroup_(checked_workgroup(device_, chooser)),
      nodes_(device_, "sphere nodes", bytes_of(tree.tree().nodes).size()),
      order_(device_, "the order of nodes", bytes_of(breadth_first.entries).size()),
      levels_(device_, "the levels of nodes", bytes_of(breadth_first.levels).size()),
      centers_(device_, "the centres of nodes", bytes_of(tree.tree().centers).size()),
      records_(device_, "ranged lights", bytes_of(tree.tree().records).size()),
      turns_(device_, "the turns of sets", bytes_of(tree.ranges().turns()).size()),
      leaves_(device_, "the tree's leaves", chooser.leaves.size()),
      lights_(device_, "what is below the leaves", chooser.lights.size()),
      radii_(device_, "radii", tree.tree().slot_count() * set_count_ * sizeof(float)),
      around_(device_, "radii of nodes", std::size_t{node_count_} * set_count_ * sizeof(float)),
      points_(device_, "points", kBatch * sizeof(ShadingPoint)),
      u_(device_, "random numbers", kBatch * sizeof(float)),
      selections_(device_, "selections", kBatch * sizeof(shaders::Selected)),
      refit_(device_, shaders::refit(),
             {&nodes_, &order_, &radii_, &centers_, &records_, &levels_, &turns_, &around_},
             sizeof(shaders::RefitJob), {}),
      select_(device_, chooser.code,
              {&nodes_, &order_, &radii_, &leaves_, &lights_, &points_, &u_, &selections_},
              sizeof(shaders::SelectJob), constants_of(chooser, tree.tree(), level_count_)),
      staging_(device_, kBatch * kBytesPerPoint) {
} catch (const vk::Error&) {
    rethrow_as_error("Vulkan");
}

void DeviceSampler::upload(const RangeTree& tree, const Chooser& chooser,
                           const BreadthFirst& breadth_first) {
    write(nodes_, bytes_of(tree.tree().nodes));
    write(order_, bytes_of(breadth_first.entries));
    write(levels_, bytes_of(breadth_first.levels));
    write(centers_, bytes_of(tree.tree().centers));
    write(records_, bytes_of(tree.tree().records));
    write(turns_, bytes_of(tree.ranges().turns()));
    write(leaves_, chooser.leaves);
    write(lights_, chooser.lights);
}

void DeviceSampler::write(const Buffer& buffer, Span<const std::byte> bytes) {
    for (std::size_t at = 0; at < bytes.size(); at += staging_.size()) {
        const std::size_t part = std::min(bytes.size() - at, staging_.size());
        std::memcpy(staging_.data(), bytes.data() + at, part);
        device_.run(timeout_seconds_, [&](const vk::raii::CommandBuffer& commands) {
            copy(commands, staging_.get(), 0, buffer.get(), at, part);
            barrier(commands);
        });
    }
}

void DeviceSampler::read(const Buffer& buffer, Span<std::byte> bytes) {
    for (std::size_t at = 0; at < bytes.size(); at += staging_.size()) {
        const std::size_t part = std::min(bytes.size() - at, staging_.size());
        device_.run(timeout_seconds_, [&](const vk::raii::CommandBuffer& commands) {
            copy(commands, buffer.get(), at, staging_.get(), 0, part);
            barrier(commands);
        });
        std::memcpy(bytes.data() + at, staging_.data(), part);
    }
}

void DeviceSampler::refit(const RandomRanges& ranges) {
    device_.run(timeout_seconds_, [&](const vk::raii::CommandBuffer& commands) {
        const shaders::RefitJob job{reach_, ranges.key_low(), ranges.key_high(), node_count_,
                                    level_count_};
        refit_.dispatch(commands, job, set_count_);
        barrier(commands);
    });
}

void DeviceSampler::select(Span<const ShadingPoint> points, Span<const float> u,
                           Span<Selection> selections) {
    for (std::size_t begin = 0; begin < points.size(); begin += kBatch) {
        const std::size_t count = std::min(points.size() - begin, kBatch);
        select_some({points.data() + begin, count}, {u.data() + begin, count},
                    {selections.data() + begin, count});
    }
}

void DeviceSampler::select_some(Span<const ShadingPoint> points, Span<const float> u,
                                Span<Selection> selections) {
    const std::size_t count = points.size(), points_size = count * sizeof(ShadingPoint),
                      u_size = count * sizeof(float), u_at = points_size,
                      selections_at = u_at + u_size,
                      selections_size = count * sizeof(shaders::Selected);
    std::memcpy(staging_.data(), points.data(), points_size);
    std::memcpy(staging_.data() + u_at, u.data(), u_size);
    device_.run(timeout_seconds_, [&](const vk::raii::CommandBuffer& commands) {
        copy(commands, staging_.get(), 0, points_.get(), 0, points_size);
        copy(commands, staging_.get(), u_at, u_.get(), 0, u_size);
        barrier(commands);
        const auto point_count = static_cast<std::uint32_t>(count);
        const shaders::SelectJob job{frame_.origin, frame_.inv_scale, reach_, point_count,
                                     node_count_};
        select_.dispatch(commands, job, (point_count + workgroup_ - 1) / workgroup_);
        barrier(commands);
        copy(commands, selections_.get(), 0, staging_.get(), selections_at, selections_size);
        barrier(commands);
    });
    for (std::size_t i = 0; i < count; ++i) {
        shaders::Selected s;
        std::memcpy(&s, staging_.data() + selections_at + i * sizeof s, sizeof s);
        selections[i] = {s.light, s.prob, s.prob, {s.weight_sum, s.key}};
    }
}

std::vector<float> DeviceSampler::radii() {
    std::vector<float> result(radii_.size() / sizeof(float));
    read(radii_, {reinterpret_cast<std::byte*>(result.data()), radii_.size()});
    return result;
}

std::size_t DeviceSampler::memory_size() const noexcept {
    std::size_t size = staging_.size();
    for (const Buffer* buffer :
         {&nodes_, &order_, &levels_, &centers_, &records_, &turns_, &leaves_, &lights_, &radii_,
          &around_, &points_, &u_, &selections_}) {
        size += buffer->size();
    }
    return size;
}

}  // namespace lightcull
