// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "iris/iris_shape.hpp"
#include "iris_image_kernel.hpp"
#include "lens/between_wavelengths.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace petzval::pupil_table_detail {

/// Pupils in closed form: images of an iris, by wavelength, that move with the film point.
///
/// On a tilted film, the ray of a virtual film point V (FilmTilt) through q meets the upright film at V - (slope . V)
/// q. The image for this point is centred at shift (V - (slope . V) q). Solved for q, the image is the upright image of
/// V scaled about the origin, in each section, by 1 / (1 + shift slope . V).
class IrisImages {
 public:
  IrisImages(const Iris& iris, std::span<const PupilImage> images, double film_radius, std::size_t primary,
             const lens_detail::CompiledWavelengths& wavelengths);

  /// Pupils of a tilted film by virtual film point. Call it for images of an upright film.
  IrisImages tilted(const FilmTilt& tilt) const;

  bool round() const noexcept { return shape_.round(); }
  const Iris& iris() const noexcept { return shape_.iris(); }
  /// The disc of a wavelength, for a lens of revolution.
  PupilDisc disc(std::size_t wavelength) const noexcept {
    return {images_[wavelength].shift_y, images_[wavelength].radius_y};
  }
  /// Images of the unclipped stop, which contain these images.
  IrisImages with_round_stop() const;
  /// True if discs stay discs, so that rotations about the axis change nothing. For round irises.
  bool of_revolution() const noexcept { return equal_sections_; }

  PupilSample sample(const FilmPoint& film, double u, double v, Wavelength wavelength) const noexcept;
  double area(const FilmPoint& film, Wavelength wavelength) const noexcept;
  /// Area of the image of the unclipped stop.
  double area_of_stop(const FilmPoint& film, Wavelength wavelength) const noexcept;
  Vec2<double> middle(const FilmPoint& film, Wavelength wavelength) const noexcept;
  double sample_area(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept;
  Vec2<double> position(const FilmPoint& film, double x, double y, Wavelength wavelength) const noexcept;
  /// Derivatives of a sample of these pupils.
  FilmPupilTable::Derivatives derivatives(const FilmPoint& film, const PupilSample& sample,
                                          Wavelength wavelength) const noexcept;

  /// @param all the common wavelength of all rays
  template <class R>
  IrisImageTable<R> table(Wavelength all) const noexcept;

 private:
  using Image = ImageSections<double>;
  /// The image for a film point; area 0 if there is no image.
  Image image(const FilmPoint& film, Wavelength wavelength) const noexcept;
  /// The image at a wavelength, seen from the axis.
  Image image(Wavelength wavelength) const noexcept;
  /// The table without wavelengths.
  template <class R>
  IrisImageTable<R> seen() const noexcept;

  iris_detail::IrisShape shape_;
  double film_radius_ = 0, slope_x_ = 0, slope_y_ = 0;
  std::size_t primary_ = 0;
  bool equal_sections_ = true;
  std::vector<Image> images_;                   // by wavelength
  lens_detail::BetweenWavelengths<4> between_;  // shift and radius along x, along y
};

}  // namespace petzval::pupil_table_detail
