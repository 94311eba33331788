// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "iris/iris_sample.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval::inline v0::pupil_table_detail {

/// IrisImages in numbers of type R, borrowed.
template <class R>
struct IrisImageTable {
  iris_detail::IrisTriangles<R> iris;
  const R *shift = nullptr, *radius = nullptr, *area = nullptr;  ///< by wavelength
  std::size_t wavelengths = 0, primary = 0;
  R film_radius = 0, slope_x = 0, slope_y = 0;
};

/// Loops over samples, for float or double.
template <class R>
struct IrisImageLoopsOf {
  void (*sample)(const IrisImageTable<R>&, std::size_t, const R* film_x, const R* film_y, const R* u, const R* v,
                 const RayWavelengths&, R* x, R* y, R* areas) noexcept;
  void (*contains)(const IrisImageTable<R>&, std::size_t, const TwoPlaneRays<const R>&, const RayWavelengths&,
                   std::uint8_t* within) noexcept;
};
struct IrisImageLoops {
  IrisImageLoopsOf<float> single;
  IrisImageLoopsOf<double> twice;

  template <class R>
  const IrisImageLoopsOf<R>& of() const noexcept {
    if constexpr (sizeof(R) == sizeof(float)) {
      return single;
    } else {
      return twice;
    }
  }
};

PETZVAL_WIDEST(IrisImageLoops, iris_images)

}  // namespace petzval::inline v0::pupil_table_detail
