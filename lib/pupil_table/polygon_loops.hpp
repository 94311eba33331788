// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "lens/wavelength_rows.hpp"
#include "petzval/lens/wavelength.hpp"
#include "polygon_grid.hpp"

namespace petzval::pupil_table_detail {

/// Samples of a grid for N rays.
template <int dimensions, class R>
struct SampleLoopsOf {
  void (*sample)(const PolygonGrid<dimensions, R>&, std::size_t, const R* film_x, const R* film_y, const R* u,
                 const R* v, const RayWavelengths&, R* x, R* y, R* areas) noexcept;
  /// Pupil areas that samples at given positions represent; 0 if there is no such sample.
  void (*areas)(const PolygonGrid<dimensions, R>&, std::size_t, const R* film_x, const R* film_y, const R* x,
                const R* y, const RayWavelengths&, R* areas) noexcept;
};
template <int dimensions>
struct SampleLoops {
  SampleLoopsOf<dimensions, float> single;
  SampleLoopsOf<dimensions, double> twice;
  /// One sample.
  void (*one)(const PolygonGrid<dimensions, double>&, double film_x, double film_y, double u, double v,
              std::int32_t wavelength, double& x, double& y, double& area) noexcept;

  template <class R>
  const SampleLoopsOf<dimensions, R>& of() const noexcept {
    if constexpr (sizeof(R) == sizeof(float)) {
      return single;
    } else {
      return twice;
    }
  }
};

/// Loops of grids with one dimension, for each instruction set.
struct PolarLoops {
  SampleLoops<1> samples;
  void (*find_nearest)(const lens_detail::NearestPosition&, std::size_t, const float* nm,
                       std::uint16_t* positions) noexcept;
};
PETZVAL_WIDEST(PolarLoops, polar_loops)

/// Loops that gain less than 15 % from wider registers: grids with two dimensions, and searches.
extern const SampleLoops<2> quadrant_samples;
template <int dimensions>
const SampleLoops<dimensions>& sample_loops() noexcept {
  if constexpr (dimensions == 1) {
    return polar_loops().samples;
  } else {
    return quadrant_samples;
  }
}

template <int dimensions, class R>
struct PlainLoopsOf {
  void (*stop_points)(const PolygonGrid<dimensions, R>&, std::size_t, const R* film_x, const R* film_y, const R* x,
                      const R* y, const RayWavelengths&, R* stop_x, R* stop_y) noexcept;
};
template <int dimensions>
struct PlainLoops {
  PlainLoopsOf<dimensions, float> single;
  PlainLoopsOf<dimensions, double> twice;
  /// areas() of one ray.
  double (*area_of_one)(const PolygonGrid<dimensions, double>&, double film_x, double film_y, double x, double y,
                        std::int32_t wavelength) noexcept;

  template <class R>
  const PlainLoopsOf<dimensions, R>& of() const noexcept {
    if constexpr (sizeof(R) == sizeof(float)) {
      return single;
    } else {
      return twice;
    }
  }
};
extern const PlainLoops<1> plain_polar_loops;
extern const PlainLoops<2> plain_quadrant_loops;

}  // namespace petzval::pupil_table_detail
