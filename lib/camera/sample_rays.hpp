// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/film_bounds.hpp"
#include "front.hpp"
#include "lens/between_wavelengths.hpp"
#include "local_focus.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "pupil_weights.hpp"
#include "tilted_film.hpp"

namespace petzval::camera_detail {

/// What a camera knows of each wavelength beside its model: the scale of weights, and of a pinhole its shift.
class PETZVAL_API WavelengthFacts {
 public:
  /// scale: one for each wavelength. nm: the wavelengths; none where there are no samples between them.
  WavelengthFacts(const AnyRayModel& model, std::vector<double> scale, std::span<const double> nm = {});

  std::size_t count() const noexcept { return scale_.size(); }
  /// Of the compiled wavelengths.
  std::span<const double> scales() const noexcept { return scale_; }
  /// Whether there are samples at a wavelength, a position or nm.
  bool covers(Wavelength wavelength) const noexcept;
  /// What weights are multiplied with: the square of the index behind the lens for irradiance; 0 for a wavelength that
  /// is not covered.
  double scale(Wavelength wavelength) const noexcept {
    const std::size_t position = wavelength.position(primary_);
    return position < count() ? scale_[position] : scale_between(wavelength);
  }
  /// The scales, for loops over rays.
  template <class T>
  lens_detail::WavelengthRows<T> scale_rows() const noexcept {
    return between_scales_.rows<T>();
  }
  /// AnyRayModel::pinhole_shifts(); 0 for other models.
  double pinhole_shift(Wavelength wavelength) const noexcept;

 private:
  double scale_between(Wavelength wavelength) const noexcept;

  std::size_t primary_;
  std::vector<double> scale_, shifts_;
  lens_detail::BetweenWavelengths<1> between_scales_, between_shifts_;  // cover nothing without samples in nm
};

/// Whether a model's pupils decide which rays pass, and not its apertures alone.
inline bool decide(const FilmPupilTable& pupils, const AnyRayModel& model) noexcept {
  return !model.clips_at_apertures() || pupils.cut();
}

/// What samples of a film are drawn from.
struct FilmView {
  const AnyRayModel& model;
  const Film& film;
  /// Of the same film, with the model's pupils; null for an upright one that stays.
  const TiltedFilm* tilted = nullptr;
  const WavelengthFacts& wavelengths;
  PupilWeights weights = {};
  Front front = {};  ///< of the lens
  LocalFocus focus = {};
  FilmPupilTable pupils = weights.pupils().value_or(model.pupils());  ///< of the upright film
  double depth = model.pupils().space().depth();
  core_detail::FilmBounds<double> bounds = core_detail::bounds_of<double>(film);

  /// Rays of the model start elsewhere.
  bool moves_rays() const noexcept {
    const bool exact = model.kind() == ModelKind::exact_float || model.kind() == ModelKind::exact_double;
    return !(exact && front.first_surface);
  }
};

/// Samples N camera rays, block by block: pupil, ray, weight.
template <class T>
PETZVAL_API void sample_rays(const FilmView& view, std::size_t count, const CameraSamples<T>& samples,
                             const CameraRays<T>& rays) noexcept;
/// One ray, within rounding that of a batch. pdf_film is left out.
CameraRay sample_ray(const FilmView& view, const FilmPoint& film, double u, double v, Wavelength wavelength,
                     double time) noexcept;
/// The same with its derivatives.
CameraRayDifferential sample_differential(const FilmView& view, const FilmPoint& film, double u, double v,
                                          Wavelength wavelength, double time) noexcept;

}  // namespace petzval::camera_detail
