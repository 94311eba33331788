// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/widest.hpp"
#include "local_focus_steps.hpp"
#include "petzval/core/ray.hpp"

namespace petzval::camera_detail {

/// FilmPointFocus of N film points.
template <class T>
struct FilmPointFocuses {
  const T* excess;
  const T* surface;
  const T* offset;
  const T* scale;
};

constexpr std::size_t bend_block = 256;

/// Bends up to bend_block rays of one wavelength, in place.
/// @param z plane in which the rays are given
template <class T>
using BendLoop = void (*)(const FocusRules<T>& rules, const EntranceMaps<T>& maps, T dispersion, T z, std::size_t count,
                          const FilmPointFocuses<T>& points, const RayArrays<T>& rays) noexcept;

struct LocalFocusLoops {
  BendLoop<float> single;
  BendLoop<double> twice;

  template <class T>
  BendLoop<T> of() const noexcept {
    if constexpr (sizeof(T) == sizeof(float)) {
      return single;
    } else {
      return twice;
    }
  }
};

PETZVAL_WIDEST(LocalFocusLoops, local_focus_loops)

}  // namespace petzval::camera_detail
