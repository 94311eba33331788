// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lens/between_wavelengths.hpp"
#include "lens_facts.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::camera_detail {

/// Film and pupil point to place and slope in a plane, or back, in the sections along x and y. Of a lens of revolution
/// both are alike.
struct SectionMaps {
  RayMatrix x, y;

  std::array<double, 8> numbers() const noexcept { return {x.a, x.b, x.c, x.d, y.a, y.b, y.c, y.d}; }
};

/// The image of the stop in the plane of the pupil as a model sees it; two discs see that of the thick lens.
struct IrisImages {
  TwoPlanes space;
  Iris iris;                       ///< upside down where its image is
  std::vector<PupilImage> images;  ///< at each wavelength
};
/// Throws Error for a film in the image of the stop or, for a thin lens, in the rear principal plane.
IrisImages iris_images(ModelKind model, const LensFacts& facts);

/// The lens to first order: pinhole, thin, thin_two_disc and thick.
///
/// All four map an image-space ray to the same ray of the scene, by the cardinal points (the thin lens stands in both
/// principal planes at once: the distance between them is left out) and by a weak thin lens in the stop, which moves
/// the focus to where exact rays of the film's centre are sharpest (best_focus.hpp): a picture is sharp at the same
/// distance in every model. They differ in the pupil:
///
///     thick           where the image of the stop lies
///     thin            where the entrance pupil lies if it stands in the rear principal plane
///     thin_two_disc   the intersection of two discs that move with the film point, fitted to the real pupils
///                     (symmetric difference over area, mean over a film: 0.8 % for a double Gauss f/2, 1.9 % for one
///                     of f/1.35, 1.6 % for a Tessar, 2.1 % for a fisheye of 156 degrees)
///     pinhole         the centre of the thick lens's pupil, for every pupil sample
///
/// Pupils are as large as lets the film's centre have the light of the exact lens; two discs let every film point have
/// it. A lens that is dark on the axis is dark everywhere to the others.
///
/// A lens with cylinders has cardinal points, focus and image of the stop of its own in each section; it has no centre
/// of projection, and so neither pinhole nor two discs.
///
/// An iris with blades is seen as its image; two discs, which are fitted to the round stop, keep what the real iris
/// leaves of them. The pinhole has the weights of the thick lens: a
/// picture keeps its exposure when it is stopped down to a point. Central obscurations are ignored. Rays are given
/// in the plane of the first vertex.
class ParaxialModel {
 public:
  static constexpr bool linear_in_slopes = true;
  static constexpr bool any_wavelength = true;

  /// film_radius: of the farthest film point, mm. Throws Error for another model, for a lens that is afocal, has no
  /// pupils or no finite one that the model needs, for a pinhole or two discs of one with cylinders, and for a film in
  /// the image of the stop or, for thin lenses, in the rear principal plane. rim: cuts the pupils, as
  /// FilmPupilTable::cut_by_rim() does, and throws.
  PETZVAL_API ParaxialModel(ModelKind model, const LensFacts& facts, double film_radius,
                            const std::optional<PupilRim>& rim = {});

  ModelKind kind() const noexcept { return kind_; }
  bool two_discs() const noexcept { return kind_ == ModelKind::thin_two_disc; }
  /// Whether the pupil is an image of the stop that is upside down, along x and along y; not for two discs.
  std::array<bool, 2> stop_upside_down() const noexcept { return stop_upside_down_; }
  const FilmPupilTable& pupils() const noexcept { return pupils_; }
  /// From film and pupil points to place and slope in the plane z(), one for each wavelength.
  std::span<const SectionMaps> maps() const noexcept { return to_scene_; }
  /// Those at any wavelength; nothing for one that is not covered.
  std::optional<SectionMaps> maps(Wavelength wavelength) const noexcept;
  double z() const noexcept { return z_; }
  /// As in RayModel; empty unless this is the pinhole.
  std::span<const double> pinhole_shifts() const noexcept { return pinhole_shifts_; }
  /// missed_surface: numbers that are not finite, or beyond 1e12 mm, or whose rays are beyond 1e18, and wavelengths
  /// that the lens does not cover.
  template <class T>
  PETZVAL_API void to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                            const RayArrays<T>& rays, RayFate* fates) const noexcept;
  /// One ray.
  PETZVAL_API RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray) const noexcept;
  /// One ray with its derivatives.
  PETZVAL_API RayDerivatives to_scene(const TwoPlaneRayDerivatives& line, Wavelength wavelength) const noexcept;
  /// The inverse of to_scene(); for the pinhole, that of the thick lens. missed_surface also for rays that do not run
  /// towards the lens.
  PETZVAL_API void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                           const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept;

 private:
  /// The maps to the scene and to the film, which is that of the thick lens for a pinhole; null for a wavelength that
  /// is not covered. own: room for those of a wavelength in nm.
  const SectionMaps* map_at(Wavelength wavelength, SectionMaps& own) const noexcept;
  const SectionMaps* inverse_at(Wavelength wavelength, SectionMaps& own) const noexcept;

  ModelKind kind_;
  FilmPupilTable pupils_;
  std::size_t primary_;
  double z_ = 0;      // of the first vertex, where rays are given
  double reach_ = 0;  // of the numbers of a line, in all
  bool sections_alike_;
  std::array<bool, 2> stop_upside_down_{};
  std::vector<SectionMaps> to_scene_, to_film_;                 // of each wavelength
  lens_detail::BetweenWavelengths<8> between_, of_thick_lens_;  // to the scene, of this model and of the thick lens
  std::vector<double> pinhole_shifts_;
};

}  // namespace petzval::camera_detail
