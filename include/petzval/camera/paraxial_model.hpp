// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ray_matrix.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0 {

/// The lens to first order: pinhole, thin, thin_two_disc and thick.
///
/// All four send a line of the film's space to the same ray, that of the cardinal points (the thin lens stands in both
/// principal planes at once: it folds the distance between them away). What tells them apart is the pupil:
///
///     thick           the image of the stop in its own place
///     thin            a disc as wide as the entrance pupil in the rear principal plane
///     thin_two_disc   what lies in both of two discs that move with the film point, fitted to the real pupils
///                     (symmetric difference over area, mean over a film: 0.8 % for a double Gauss f/2, 1.9 % for one
///                     of f/1.35, 1.6 % for a Tessar, 2.1 % for a fisheye of 156 degrees)
///     pinhole         the middle of the thick lens's pupil, whatever point of it is asked for
///
/// The pinhole has the weights of the thick lens: stopping a picture down to a point does not change its exposure.
/// Holes (of mirrors with one) are not seen. Rays are given where they pass the plane of the entrance pupil, or that of
/// the first vertex where the pupil is out of reach.
class ParaxialModel {
 public:
  /// film_radius: of the farthest film point, mm. Throws Error for another model, and for a lens that is afocal, has no
  /// pupils or no finite one that the model is made of, is not alike in all sections, or has its film where no pupil
  /// can be told: in the image of the stop or, for thin lenses, in the rear principal plane.
  PETZVAL_API ParaxialModel(ModelKind model, const Lens& lens, double film_radius);

  ModelKind model() const noexcept { return model_; }
  const FilmPupilTable& pupils() const noexcept { return pupils_; }
  /// Of a pinhole: its rays pass the plane of the pupil at so many times the film point's place. Empty for the others.
  std::span<const double> pinhole_shifts() const noexcept { return pinhole_shifts_; }
  /// missed_surface: numbers that are not finite (or beyond 1e12 mm) and wavelengths that were not compiled.
  template <class T>
  PETZVAL_API void to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                            const RayArrays<T>& rays, RayFate* fates) const noexcept;
  /// One line with its derivatives.
  PETZVAL_API RayDerivatives to_scene(const TwoPlaneRayDerivatives& line, std::size_t wavelength) const noexcept;
  /// The lines that to_scene makes into these rays (a pinhole's: those of the thick lens). missed_surface as there, and
  /// rays that do not run towards the lens.
  PETZVAL_API void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                           const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept;

 private:
  ModelKind model_;
  FilmPupilTable pupils_;
  double z_ = 0;  // of the plane of object space that rays are given in
  // Of each wavelength: film and pupil point of a line to place and slope of its ray, and back.
  std::vector<RayMatrix> to_scene_, to_film_;
  std::vector<double> pinhole_shifts_;
};

}  // namespace petzval::inline v0
