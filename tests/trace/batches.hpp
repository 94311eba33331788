// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/instruction_set.hpp"
#include "core/low_discrepancy.hpp"
#include "lenses.hpp"
#include "petzval/trace/trace.hpp"

/// Batches of rays for tests.
namespace testing_batches {

using petzval::Arithmetic;
using petzval::BatchOptions;
using petzval::Lens;
using petzval::Ray;
using petzval::RayArrays;
using petzval::RayFate;
using petzval::Travel;

/// Options for both arithmetics, each repeated for every instruction set of this machine.
///
///     for (const BatchOptions& options : every_batch(travel)) ...   // runs on the instruction set of the iteration
///
/// An iterator limits the batches of the thread to its instruction set; the destructor removes the limit.
class EveryBatch {
 public:
  explicit EveryBatch(Travel travel) {
    for (const Arithmetic arithmetic : {Arithmetic::fast, Arithmetic::reproducible}) {
      for (const auto set : petzval::instruction_sets()) {
        options_.push_back({.travel = travel, .arithmetic = arithmetic});
        sets_.push_back(set);
      }
    }
  }
  EveryBatch(const EveryBatch&) = delete;
  EveryBatch& operator=(const EveryBatch&) = delete;
  ~EveryBatch() { petzval::limit_batches(petzval::InstructionSet::avx512); }

  class Iterator {
   public:
    Iterator(const EveryBatch& all, std::size_t position) : all_(&all), position_(position) {}
    const BatchOptions& operator*() const {
      petzval::limit_batches(all_->sets_[position_]);
      return all_->options_[position_];
    }
    Iterator& operator++() {
      ++position_;
      return *this;
    }
    bool operator==(const Iterator&) const = default;

   private:
    const EveryBatch* all_;
    std::size_t position_;
  };
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }

  std::size_t size() const { return options_.size(); }
  const BatchOptions& operator[](std::size_t position) const { return options_[position]; }

 private:
  std::vector<BatchOptions> options_;
  std::vector<petzval::InstructionSet> sets_;
};
inline EveryBatch every_batch(Travel travel = Travel::to_film) { return EveryBatch(travel); }

inline std::string text(const BatchOptions& o) {
  return std::string(name(o.arithmetic)) + " " + std::string(name(petzval::batch_instruction_set())) +
         (o.travel == Travel::to_film ? " to_film" : " to_scene");
}

/// Lenses that together have spheres, planes, conics, cylinders, aspheres, one or two mirrors, central obscurations,
/// many surfaces, steep surfaces, and water behind the last surface.
inline const std::vector<testing_lenses::Sample>& telling() {
  static const std::vector<testing_lenses::Sample> samples = [] {
    std::vector<testing_lenses::Sample> result;
    for (const char* id :
         {"double_gauss_100mm_f2.0", "petzval_100mm_f1.6", "fisheye_6.3mm_f2.8", "modern_58mm_f0.95",
          "phone_5.6mm_f3.5", "anamorphic_60mm_2x", "cylinder_3.9mm", "catadioptric_corrector_25mm_f1.25",
          "catadioptric_mangin_1000mm_f7.5", "mirror_ritchey_chretien_57.6m_f24", "mirror_newton_200mm_f8",
          "zoom_14-30mm_f4:wide", "analytic_plano_hyperbolic_100mm", "eye_gullstrand_le_grand"}) {
      result.push_back(testing_lenses::load(id));
    }
    return result;
  }();
  return samples;
}

/// Random numbers from integer operations (splitmix64), equal on every machine.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}

  std::uint64_t operator()() {
    using namespace petzval::core_detail;
    return mixed(std::exchange(state_, state_ + splitmix_step));
  }
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>((*this)() >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

template <class T>
Ray<T> through(const petzval::Vec3<double>& target, const petzval::Vec3<double>& along, double back) {
  const double length = std::sqrt(along.x * along.x + along.y * along.y + along.z * along.z);
  const petzval::Vec3<double> d{along.x / length, along.y / length, along.z / length};
  return {{static_cast<T>(target.x - back * d.x), static_cast<T>(target.y - back * d.y),
           static_cast<T>(target.z - back * d.z)},
          {static_cast<T>(d.x), static_cast<T>(d.y), static_cast<T>(d.z)}};
}

/// Rays from film or scene towards a lens. Many pass, some end at every kind of edge, and every eighth is steep or runs
/// against the light. Equal on every machine.
template <class T>
std::vector<Ray<T>> rays_for(const testing_lenses::Sample& sample, Travel travel, std::size_t count,
                             std::uint64_t seed = 1) {
  const Lens& lens = sample.lens;
  const bool to_film = travel == Travel::to_film;
  const auto& met = to_film ? lens.surfaces().front() : lens.surfaces().back();
  const bool mirrors =
      std::any_of(lens.surfaces().begin(), lens.surfaces().end(), [](const auto& s) { return s.mirror; });
  const double slope = mirrors ? 0.02 : 0.6, film = mirrors ? 0.05 : 0.4;
  const double before = lens.film_z() - met.vertex_z;
  const double ahead = to_film       ? sample.size
                       : before == 0 ? -sample.size
                                     : -before;  // distance to the plane at which a ray starts or ends
  Numbers random(seed);
  std::vector<Ray<T>> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const double wide = 1.0 / (1 << i % 7), reach = 1.05 * wide * std::min(met.semi_diameter, sample.size);
    const petzval::Vec3<double> target{reach * random(-1, 1), reach * random(-1, 1), met.vertex_z};
    const double u = random(-1, 1), v = random(-1, 1), w = random(-0.2, 1), back = sample.size * random(0.1, 2);
    petzval::Vec3<double> along{slope * wide * u, slope * wide * v, 1};
    if (!to_film) along = {target.x - film * wide * sample.size * u, target.y - film * wide * sample.size * v, ahead};
    if (i % 8 == 7) along = {2 * u, 2 * v, ahead < 0 ? -w : w};
    rays.push_back(through<T>(target, along, back));
  }
  return rays;
}

/// Rays as arrays that start `shift` elements into their memory, between guard elements.
template <class T>
class Arrays {
 public:
  static constexpr std::size_t guard = 67;
  static constexpr T untouched = T(-77.25);

  explicit Arrays(std::size_t count, std::size_t shift = 0) : count_(count), start_(guard + shift) {
    for (auto& column : columns_) column.assign(count + start_ + guard, untouched);
  }
  explicit Arrays(const std::vector<Ray<T>>& rays, std::size_t shift = 0) : Arrays(rays.size(), shift) {
    for (std::size_t i = 0; i < rays.size(); ++i) set(i, rays[i]);
  }

  void set(std::size_t i, const Ray<T>& ray) {
    for (int k = 0; k < 3; ++k) {
      columns_[static_cast<std::size_t>(k)][start_ + i] = ray.origin[k];
      columns_[static_cast<std::size_t>(k + 3)][start_ + i] = ray.direction[k];
    }
  }
  Ray<T> operator[](std::size_t i) const {
    const auto at = [&](std::size_t k) { return columns_[k][start_ + i]; };
    return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
  }
  RayArrays<T> out() { return {column(0), column(1), column(2), column(3), column(4), column(5)}; }
  RayArrays<const T> in() const { return {column(0), column(1), column(2), column(3), column(4), column(5)}; }

  bool guards_hold() const {
    for (const auto& column : columns_) {
      for (std::size_t i = 0; i < column.size(); ++i) {
        if ((i < start_ || i >= start_ + count_) && column[i] != untouched) return false;
      }
    }
    return true;
  }

 private:
  T* column(std::size_t k) { return columns_[k].data() + start_; }
  const T* column(std::size_t k) const { return columns_[k].data() + start_; }

  std::size_t count_, start_;
  std::array<std::vector<T>, 6> columns_;
};

/// The result of a batch.
template <class T>
struct Answer {
  Arrays<T> rays;
  std::vector<RayFate> fates;
  std::vector<int> surfaces;
};

template <class T>
Answer<T> traced(const Lens& lens, const std::vector<Ray<T>>& rays, const BatchOptions& options) {
  const Arrays<T> in(rays);
  Answer<T> answer{Arrays<T>(rays.size()), std::vector<RayFate>(rays.size()), std::vector<int>(rays.size(), -7)};
  petzval::trace<T>(lens, rays.size(), in.in(), answer.rays.out(), answer.fates.data(), answer.surfaces.data(),
                    options);
  return answer;
}

template <class T>
auto bits(T x) {
  return std::bit_cast<std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>(x);
}

template <class T>
bool same_bits(const Ray<T>& a, const Ray<T>& b) {
  for (int k = 0; k < 3; ++k) {
    if (bits(a.origin[k]) != bits(b.origin[k]) || bits(a.direction[k]) != bits(b.direction[k])) return false;
  }
  return true;
}

template <class T>
bool same_bits(const Answer<T>& a, std::size_t i, const Answer<T>& b, std::size_t j) {
  return a.fates[i] == b.fates[j] && a.surfaces[i] == b.surfaces[j] && same_bits(a.rays[i], b.rays[j]);
}

template <class T>
bool finite(const Ray<T>& r) {
  bool all = true;
  for (int k = 0; k < 3; ++k) all = all && std::isfinite(r.origin[k]) && std::isfinite(r.direction[k]);
  return all;
}

}  // namespace testing_batches
