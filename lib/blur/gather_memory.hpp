// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "gather_loops.hpp"
#include "highlights.hpp"
#include "layer_data.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "ray_table.hpp"

namespace petzval {

/// Work memory of the threads of gather(), kept between pictures.
struct BlurredImage::Memory {
  struct OfThread {
    std::vector<float> corners[4], scratch, window;
    blur_detail::TileSums sums[3], covered;
  };

  /// The memory of one thread while it works.
  class Loan {
   public:
    explicit Loan(Memory& memory) : memory_(memory) {
      const std::lock_guard guard(memory_.mutex_);
      if (memory_.free_.empty()) {
        memory_.free_.reserve(memory_.lent_ + 1);  // reserved for all loans, because the destructor must not allocate
        memory_.free_.push_back(std::make_unique<OfThread>());
      }
      mine_ = std::move(memory_.free_.back());
      memory_.free_.pop_back();
      ++memory_.lent_;
    }
    ~Loan() {
      const std::lock_guard guard(memory_.mutex_);
      memory_.free_.push_back(std::move(mine_));
      --memory_.lent_;
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    OfThread& operator*() const noexcept { return *mine_; }

   private:
    Memory& memory_;
    std::unique_ptr<OfThread> mine_;
  };

  /// The highlights of layers, found again only if layers, rays or options differ from the last call.
  std::shared_ptr<const blur_detail::Highlights> highlights(const LayerSet& layers, const LensRays& rays,
                                                            const GatherOptions& options, int overscan) {
    const auto& data = LayerAccess::data(layers);
    const std::lock_guard guard(mutex_);
    if (highlights_ && filling_ == data.filling && above_ == options.highlights_above &&
        &RayAccess::data(*rays_) == &RayAccess::data(rays)) {
      return highlights_;
    }
    highlights_.reset();
    auto found = std::make_shared<const blur_detail::Highlights>(data, rays, options, overscan);
    rays_ = rays, filling_ = data.filling, above_ = options.highlights_above;
    return highlights_ = std::move(found);
  }

 private:
  std::mutex mutex_;
  std::shared_ptr<const blur_detail::Highlights> highlights_;
  std::optional<LensRays> rays_;  ///< rays, layers (filling_) and option (above_) with which highlights_ were found
  std::uint64_t filling_ = 0;
  double above_ = 0;
  std::vector<std::unique_ptr<OfThread>> free_;
  std::size_t lent_ = 0;
};

}  // namespace petzval
