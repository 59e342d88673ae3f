#pragma once

#include <mitsuba/core/logger.h>
#include <mitsuba/core/progress.h>

#include <cstdint>
#include <mutex>

namespace mitsuba::culling {

/// A bar on the screen, where Mitsuba's log level asks for one. Any number of threads may step it.
class ProgressBar {
  public:
    explicit ProgressBar(std::uint64_t steps) : steps_(static_cast<float>(steps)) {
        if (Thread::logger() && Info >= Thread::logger()->log_level()) {
            reporter_ = new ProgressReporter("Rendering");
        }
    }
    void step() {
        if (!reporter_) return;
        const std::lock_guard<std::mutex> lock(mutex_);
        reporter_->update(static_cast<float>(++done_) / steps_);
    }

  private:
    std::mutex mutex_;
    ref<ProgressReporter> reporter_;
    float steps_;
    std::uint64_t done_ = 0;
};

}  // namespace mitsuba::culling
