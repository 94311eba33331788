// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "iris/iris_sample.hpp"
#include "lens/wavelength_rows.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::pupil_table_detail {

/// A PupilImage in numbers of type R; area 0 if there is no image.
template <class R>
struct ImageSections {
  R shift_x = 0, shift_y = 0, radius_x = 0, radius_y = 0, area = 0;
};

// Local names: compiled for several instruction sets, which the linker must not mix.
namespace {

/// The image for a virtual point of a tilted film.
/// @param excess slope . virtual point
template <class R>
inline ImageSections<R> on_tilted(const ImageSections<R>& image, R excess) noexcept {
  const R x = R(1) / (R(1) + image.shift_x * excess), y = R(1) / (R(1) + image.shift_y * excess);
  return {x * image.shift_x, y * image.shift_y, x * image.radius_x, y * image.radius_y, x * y * image.area};
}

}  // namespace

/// An iris, its images and the film, in numbers of type R, borrowed.
template <class R>
struct SeenIris {
  iris_detail::IrisSectors<R> iris;
  R film_radius = 0, slope_x = 0, slope_y = 0;
};

/// IrisImages in numbers of type R, borrowed.
template <class R>
struct IrisImageTable : SeenIris<R> {
  lens_detail::WavelengthRows<R> images{};  ///< shift and radius along x, then along y
  bool equal_sections = false;              ///< true if both sections are equal
  ImageSections<R> image{};                 ///< at the common wavelength of all rays
  R area = 0;                               ///< area of the iris
};

/// Loops over samples, for float or double.
template <class R>
struct IrisImageLoopsOf {
  void (*sample)(const IrisImageTable<R>&, std::size_t, const R* film_x, const R* film_y, const R* u, const R* v,
                 const RayWavelengths&, R* x, R* y, R* areas) noexcept;
  /// Pupil areas that samples at given positions represent; 0 outside the image.
  void (*sample_areas)(const IrisImageTable<R>&, std::size_t, const TwoPlaneRays<const R>&, const RayWavelengths&,
                       R* areas) noexcept;
};
struct IrisImageLoops {
  IrisImageLoopsOf<float> single;
  IrisImageLoopsOf<double> twice;
  PupilSample (*one)(const SeenIris<double>&, const ImageSections<double>&, double film_x, double film_y, double u,
                     double v) noexcept;

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

}  // namespace petzval::pupil_table_detail
