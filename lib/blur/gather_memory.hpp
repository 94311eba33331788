// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "gather_loops.hpp"
#include "petzval/blur/lens_rays.hpp"

namespace petzval {

/// Work memory of the threads of gather(), kept between pictures.
struct BlurredImage::Memory {
  struct OfThread {
    std::vector<float> corners[4], scratch, window;
    blur_detail::TileSums sums[3];
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

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<OfThread>> free_;
  std::size_t lent_ = 0;
};

}  // namespace petzval
