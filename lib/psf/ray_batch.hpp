// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/trace/batch.hpp"

namespace petzval::detail {

/// Rays as a structure of arrays, traced in place.
class RayBatch {
 public:
  explicit RayBatch(std::size_t capacity) : values_(6 * capacity), fates_(capacity), capacity_(capacity) {}

  std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }

  /// Within the capacity.
  void push(const Ray<double>& ray) noexcept {
    double* v = values_.data() + size_++;
    v[0] = ray.origin.x, v[capacity_] = ray.origin.y, v[2 * capacity_] = ray.origin.z;
    v[3 * capacity_] = ray.direction.x, v[4 * capacity_] = ray.direction.y, v[5 * capacity_] = ray.direction.z;
  }

  void trace(const Lens& lens, std::size_t wavelength) noexcept {
    double* v = values_.data();
    const std::size_t n = capacity_;
    petzval::trace(lens, size_, RayArrays<const double>{v, v + n, v + 2 * n, v + 3 * n, v + 4 * n, v + 5 * n},
                   RayArrays<double>{v, v + n, v + 2 * n, v + 3 * n, v + 4 * n, v + 5 * n}, fates_.data(), nullptr,
                   {.wavelength = wavelength});
  }

  bool transmitted(std::size_t i) const noexcept { return fates_[i] == RayFate::transmitted; }
  Ray<double> operator[](std::size_t i) const noexcept {
    const double* v = values_.data() + i;
    return {{v[0], v[capacity_], v[2 * capacity_]}, {v[3 * capacity_], v[4 * capacity_], v[5 * capacity_]}};
  }

 private:
  std::vector<double> values_;  // x, y, z, dx, dy, dz: capacity of each
  std::vector<RayFate> fates_;
  std::size_t capacity_, size_ = 0;
};

}  // namespace petzval::detail
