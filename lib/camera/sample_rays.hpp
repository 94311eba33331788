// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "camera/ray_model.hpp"
#include "core/film_bounds.hpp"
#include "front.hpp"
#include "lens/between_wavelengths.hpp"
#include "local_focus.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "pupil_weights.hpp"
#include "tilted_film.hpp"
#include "transmission.hpp"

namespace petzval::camera_detail {

/// Data of a camera by wavelength, in addition to its model: the scale of weights, and the shift of a pinhole.
class PETZVAL_API WavelengthFacts {
 public:
  /// @param scale one value for each wavelength of the model
  /// @param nm the wavelengths; empty if only compiled wavelengths have samples
  WavelengthFacts(const RayModel& model, std::vector<double> scale, std::span<const double> nm = {});

  std::size_t count() const noexcept { return scale_.size(); }
  /// Scales of the compiled wavelengths.
  std::span<const double> scales() const noexcept { return scale_; }
  /// True if there are samples at a wavelength, given by index or in nm.
  bool covers(Wavelength wavelength) const noexcept;
  /// Factor of weights: for irradiance the squared index behind the lens; 0 if the wavelength is not covered.
  double scale(Wavelength wavelength) const noexcept {
    const std::size_t position = wavelength.index(primary_);
    return position < count() ? scale_[position] : scale_between(wavelength);
  }
  /// The scales, for loops over rays.
  template <class T>
  lens_detail::WavelengthRows<T> scale_rows() const noexcept {
    return between_scales_.rows<T>();
  }
  /// ParaxialModel::pinhole_shifts(); 0 for other models.
  double pinhole_shift(Wavelength wavelength) const noexcept;

 private:
  double scale_between(Wavelength wavelength) const noexcept;

  std::size_t primary_;
  std::vector<double> scale_, shifts_;
  lens_detail::BetweenWavelengths<1> between_scales_, between_shifts_;  // empty range without samples in nm
};

/// True if the pupils of a model decide which rays pass, and not only its apertures.
inline bool decide(const FilmPupilTable& pupils, const RayModel& model) noexcept {
  return !model.clips_at_apertures() || pupils.is_clipped();
}

/// Inputs of film sampling.
struct FilmView {
  const RayModel& model;
  const Film& film;
  /// The tilted film with the model's pupils; null for an upright film that does not travel.
  const TiltedFilm* tilted = nullptr;
  const WavelengthFacts& wavelengths;
  PupilWeights weights = {};
  Front front = {};  ///< front of the lens
  LocalFocus focus = {};
  Transmission transmission = {};
  FilmPupilTable pupils = weights.pupils().value_or(model.pupils());  ///< pupils of the upright film
  double depth = model.pupils().space().depth();
  core_detail::FilmBounds<double> bounds = core_detail::bounds_of<double>(film);

  /// True if rays of the model do not start on the front.
  bool moves_rays() const noexcept { return !(model.kind().is_exact() && front.first_surface); }
};

/// Samples N camera rays in blocks: pupil, ray, weight.
template <class T>
PETZVAL_API void sample_rays(const FilmView& view, std::size_t count, const CameraSamples<T>& samples,
                             const CameraRays<T>& rays) noexcept;
/// One ray, equal to the batch result up to rounding. pdf_film is not set.
CameraRay sample_ray(const FilmView& view, const FilmPoint& film, double u, double v, Wavelength wavelength,
                     double time) noexcept;
/// One ray with its derivatives.
CameraRayDifferential sample_differential(const FilmView& view, const FilmPoint& film, double u, double v,
                                          Wavelength wavelength, double time) noexcept;

}  // namespace petzval::camera_detail
