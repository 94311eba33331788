// SPDX-License-Identifier: Apache-2.0
// Pupils in closed form: functions over a scalar. Names are local: compiled for several instruction sets, which the
// linker must not mix.
#pragma once

#include "iris/iris_sample.hpp"
#include "lens/wavelength_rows.hpp"
#include "pupil_table/pupil_kernel.hpp"

namespace petzval::pupil_table_detail {

/// A PupilImage in numbers of type V; area 0 if there is no image.
template <class V>
struct ImageSections {
  V shift_x{}, shift_y{}, radius_x{}, radius_y{}, area{};
};

/// IrisImages in numbers of type R, borrowed.
template <class R>
struct IrisImageTable {
  using Number = R;
  iris_detail::IrisSectors<R> iris;
  R film_radius = 0, slope_x = 0, slope_y = 0;
  lens_detail::WavelengthRows<R> images{};  ///< shift and radius along x, then along y
  bool equal_sections = false;              ///< true if both sections are equal
  ImageSections<R> image{};                 ///< at the common wavelength of all rays
  R area = 0;                               ///< area of the iris
};

namespace {

/// The image for a virtual point of a tilted film; area 0 outside the film.
/// @param sound mask of the points that may have an image
template <class V, class R>
PETZVAL_INLINE ImageSections<V> image_at(const IrisImageTable<R>& table, const ImageSections<V>& image, const V& film_x,
                                         const V& film_y, const Mask<V>& sound) noexcept {
  const Mask<V> known = sound & (film_x * film_x + film_y * film_y <= V(table.film_radius * table.film_radius));
  const V excess = select(known, V(V(table.slope_x) * film_x + V(table.slope_y) * film_y), V(0));
  const V x = V(1) / (V(1) + image.shift_x * excess), y = V(1) / (V(1) + image.shift_y * excess);
  return {x * image.shift_x, y * image.shift_y, x * image.radius_x, y * image.radius_y,
          select(known, V(x * y * image.area), V(0))};
}

template <class V, class R>
PETZVAL_INLINE PupilPoint<V> in_image(const IrisImageTable<R>& table, const ImageSections<V>& of_wavelength,
                                      const V& film_x, const V& film_y, const V& u, const V& v) noexcept {
  const Mask<V> sound = all_finite(film_x, film_y, u, v);
  const ImageSections<V> image = image_at(table, of_wavelength, film_x, film_y, sound);
  const auto p = iris_detail::iris_point<V>(table.iris, clamped(u), clamped(v));
  const Mask<V> lit = image.area > V(0);
  return {select(lit, V(image.shift_x * film_x + image.radius_x * p.x), V(0)),
          select(lit, V(image.shift_y * film_y + image.radius_y * p.y), V(0)), image.area};
}

/// Pupil area that a sample at a position represents; 0 outside the image.
template <class V, class R>
PETZVAL_INLINE V area_in_image(const IrisImageTable<R>& table, const ImageSections<V>& of_wavelength, const V& film_x,
                               const V& film_y, const V& pupil_x, const V& pupil_y) noexcept {
  const Mask<V> sound = all_finite(film_x, film_y, pupil_x, pupil_y);
  const ImageSections<V> image = image_at(table, of_wavelength, film_x, film_y, sound);
  const V x = (pupil_x - image.shift_x * film_x) / image.radius_x;
  const V y = (pupil_y - image.shift_y * film_y) / image.radius_y;
  Mask<V> inside = x * x + y * y <= V(iris_detail::rim_squared<R>);
  for (std::size_t k = 0; k < table.iris.count; ++k) inside = inside & iris_detail::within_edge(table.iris, k, x, y);
  return select(inside, image.area, V(0));
}

}  // namespace
}  // namespace petzval::pupil_table_detail
