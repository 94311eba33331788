// SPDX-License-Identifier: Apache-2.0
// Media at a step for a bundle of rays: for one compiled wavelength, for a compiled wavelength per ray, or for any
// wavelengths. Included like core/lanes.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "bundle.hpp"

namespace petzval::trace_detail {
namespace {

/// Media at a step for a batch with one wavelength.
template <class R>
struct SharedMedia {
  const kernel::RefractionConstants<R>* bend;

  PETZVAL_INLINE Lanes<R> cn2(int) const noexcept { return bend->cn2; }
  PETZVAL_INLINE Lanes<R> k(int) const noexcept { return bend->k; }
  PETZVAL_INLINE Lanes<R> per_n2(int) const noexcept { return bend->per_n2; }
};

/// Media for a compiled wavelength per ray; constants come from rows with one value per wavelength.
template <class R>
class MediaByRay {
  using V = Lanes<R>;
  using Indices = typename Native<R>::Bits;

 public:
  /// Media at a step.
  struct Step {
    const R* rows;
    std::size_t count, length;
    const Indices* indices;

    PETZVAL_INLINE V cn2(int i) const noexcept { return look_up(rows, count, indices[i]); }
    PETZVAL_INLINE V k(int i) const noexcept { return look_up(rows + length, count, indices[i]); }
    PETZVAL_INLINE V per_n2(int i) const noexcept { return look_up(rows + 2 * length, count, indices[i]); }
  };

  /// @param wavelengths indices of wavelengths, one for each ray
  /// @param count number of compiled wavelengths
  PETZVAL_INLINE MediaByRay(const kernel::SurfaceSequence<R>& sequence, const std::uint16_t* wavelengths,
                            std::size_t count) noexcept
      : sequence_(sequence), count_(count), length_(kernel::row_length<R>(count)) {
    // Numbers of 32 bits, as wide as float, vectorise best.
    const auto compiled = static_cast<std::int32_t>(count <= 0xffff ? count : 0x10000);
    typename Native<R>::Bit indices[Bundle<R>::rays];
    for (int l = 0; l < Bundle<R>::rays; ++l) {
      const std::int32_t index = wavelengths[l];
      indices[l] = index < compiled ? index : 0;
      unless_known_[l] = index < compiled ? R(0) : std::numeric_limits<R>::quiet_NaN();
    }
    __builtin_memcpy(indices_, indices, sizeof indices);
  }

  /// Indices in front of the first step and one over the indices behind the last step. They are NaN, and the ray is
  /// lost, if the wavelength was not compiled.
  PETZVAL_INLINE void indices(R* first, R* per_last) const noexcept {
    for (int i = 0; i < Bundle<R>::vectors; ++i) {
      const int o = i * V::width;
      store(first + o, look_up(sequence_.n_first, count_, indices_[i]) + load(unless_known_ + o));
      store(per_last + o, V(look_up(sequence_.per_n_last, count_, indices_[i])));
    }
  }

  PETZVAL_INLINE Step at(std::size_t j) const noexcept {
    return {sequence_.bend_rows + 3 * j * length_, count_, length_, indices_};
  }
  /// Looks up a number of a row for the rays of vector i.
  PETZVAL_INLINE V in_row(const R* row, int i) const noexcept { return look_up(row, count_, indices_[i]); }

 private:
  const kernel::SurfaceSequence<R>& sequence_;
  std::size_t count_, length_;
  Indices indices_[Bundle<R>::vectors];
  R unless_known_[Bundle<R>::rays];
};

/// Media for any wavelengths, step by step: squared indices from their polynomials.
template <class R>
class SpectralMedia {
  using V = Lanes<R>;

 public:
  /// Media at a step.
  struct Step {
    R curvature;
    const V *front, *behind;

    PETZVAL_INLINE V cn2(int i) const noexcept { return V(curvature) * front[i]; }
    PETZVAL_INLINE V k(int i) const noexcept { return behind[i] - front[i]; }
    PETZVAL_INLINE V per_n2(int i) const noexcept { return V(R(1)) / front[i]; }
  };

  /// @param nm wavelengths, one for each ray
  PETZVAL_INLINE SpectralMedia(const kernel::SurfaceSequence<R>& sequence, const R* nm) noexcept : sequence_(sequence) {
    const auto& coordinate = sequence.coordinate;
    for (int i = 0; i < vectors; ++i) {
      const V own = load(nm + i * V::width);
      const V t = V(coordinate.scale) / own - V(coordinate.offset);
      at_[i] = select(t < V(R(1)), select(t > V(R(-1)), t, V(R(-1))), V(R(1)));
      at2_[i] = at_[i] * at_[i];
      at4_[i] = at2_[i] * at2_[i];
      covered_[i] = (own >= V(coordinate.shortest)) & (own <= V(coordinate.longest));
    }
    fill(0);
  }

  /// Indices in front of the first step and one over the indices behind the last step. They are NaN, and the ray is
  /// lost, if the lens does not cover the wavelength.
  PETZVAL_INLINE void indices(std::size_t steps, R* first, R* per_last) const noexcept {
    for (int i = 0; i < vectors; ++i) {
      const auto index = [&](std::size_t medium) { return sqrt(square(sequence_.media[medium], i)); };
      store(first + i * V::width, select(covered_[i], index(0), V(std::numeric_limits<R>::quiet_NaN())));
      store(per_last + i * V::width, V(R(1)) / index(steps));
    }
  }

  /// Call it for each step in turn.
  PETZVAL_INLINE Step at(std::size_t j) noexcept {
    fill(j + 1);
    return {sequence_.steps[j].curvature, squares_[j % 2], squares_[(j + 1) % 2]};
  }

 private:
  static constexpr int vectors = Bundle<R>::vectors;

  PETZVAL_INLINE V square(const kernel::SquaredIndex<R>& medium, int i) const noexcept {
    return medium.constant ? V(medium.by_power[0]) : medium.at(at_[i], at2_[i], at4_[i]);
  }
  PETZVAL_INLINE void fill(std::size_t medium) noexcept {
    PETZVAL_UNROLL
    for (int i = 0; i < vectors; ++i) squares_[medium % 2][i] = square(sequence_.media[medium], i);
  }

  const kernel::SurfaceSequence<R>& sequence_;
  V at_[vectors], at2_[vectors], at4_[vectors];  // powers of the argument of the polynomials
  Mask<R> covered_[vectors];
  V squares_[2][vectors];  // in front of a step and behind it, alternating
};

}  // namespace
}  // namespace petzval::trace_detail
