// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "iris/iris_shape.hpp"
#include "iris_images_loops.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"

namespace petzval::inline v0::pupil_table_detail {

/// Pupils in closed form: the images of an iris, one for each wavelength, that move with the film point.
///
/// On a tilted film the ray of a virtual film point V (FilmTilt) through q meets the upright film in V - (slope . V) q,
/// which sees q in the image with its centre at shift times that. Solved for q, that is the upright film's image of V
/// scaled about the origin by part = 1 / (1 + shift slope . V).
class IrisImages {
 public:
  IrisImages(const Iris& iris, std::span<const PupilDisc> images, double film_radius, std::size_t primary);

  /// Those of a tilted film, by virtual film points; for images of an upright one.
  IrisImages tilted(const FilmTilt& tilt) const;

  PupilSample sample(const FilmPoint& film, double u, double v, std::size_t wavelength) const noexcept;
  double area(const FilmPoint& film, std::size_t wavelength) const noexcept;
  Vec2<double> middle(const FilmPoint& film, std::size_t wavelength) const noexcept;
  bool contains(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept;
  FilmPupilTable::Derivatives derivatives(const FilmPoint& film, double u, double v,
                                          std::size_t wavelength) const noexcept;

  template <class T>
  void sample(std::size_t count, const T* film_x, const T* film_y, const T* u, const T* v,
              const RayWavelengths& wavelengths, T* x, T* y, T* areas) const noexcept;
  template <class T>
  void contains(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                std::uint8_t* within) const noexcept;

 private:
  template <class R>
  struct Columns {
    std::vector<R> shift, radius, area;  // by wavelength
  };
  template <class R>
  static void put(Columns<R>& columns, const PupilDisc& image, double area) {
    columns.shift.push_back(static_cast<R>(image.shift));
    columns.radius.push_back(static_cast<R>(image.radius));
    columns.area.push_back(static_cast<R>(area));
  }
  /// The image that a film point sees; area 0: none.
  struct Image {
    double shift = 0, radius = 0, area = 0;
  };
  Image image(const FilmPoint& film, std::size_t wavelength) const noexcept;
  template <class R>
  IrisImageTable<R> table() const noexcept;

  iris_detail::IrisShape shape_;
  double film_radius_ = 0, slope_x_ = 0, slope_y_ = 0;
  std::size_t primary_ = 0;
  Columns<float> single_;
  Columns<double> twice_;
};

}  // namespace petzval::inline v0::pupil_table_detail
