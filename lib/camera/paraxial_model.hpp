// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "camera/ray_model.hpp"
#include "lens/between_wavelengths.hpp"
#include "lens_facts.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/core/config.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::camera_detail {

/// Maps from film and pupil point to position and slope in a plane, or back, in the sections along x and y; both are
/// equal for a lens of revolution.
struct SectionMaps {
  RayMatrix x, y;

  std::array<double, 8> numbers() const noexcept { return {x.a, x.b, x.c, x.d, y.a, y.b, y.c, y.d}; }
};

/// Image of the stop in the pupil plane as seen by a model; two discs use the image of the thick lens.
struct IrisImages {
  TwoPlanes space;
  Iris iris;                       ///< inverted if its image is inverted
  std::vector<PupilImage> images;  ///< by wavelength
};
/// @throws Error  if the film lies in the image of the stop or, for a thin lens, in the rear principal plane
IrisImages iris_images(ModelKind model, const LensFacts& facts);

template <class T>
struct ParaxialJob;

/// First-order models of a lens: pinhole, thin, thin_two_disc and thick.
///
/// All four map an image-space ray to the same ray of the scene, focused where exact rays of the film centre are
/// sharpest (best_focus.hpp) unless paraxial_focus(). They differ in the pupil:
///
///     thick           the image of the stop
///     thin            the entrance pupil, placed in the rear principal plane
///     thin_two_disc   the intersection of two discs fitted to the real pupils
///     pinhole         the centre of the thick lens's pupil for every sample, with the weights of the thick lens
///
/// The size of the pupils gives the film centre the irradiance of the exact lens; two discs give every film point its
/// exact irradiance. The iris of a lens with blades is mapped to the pupil as an image; two discs are clipped by the
/// iris. Rays are given in the plane of the first vertex.
///
/// Limitations: central obscurations are ignored. Lenses with cylinders have no pinhole and no two discs.
class PETZVAL_API ParaxialModel final : public RayModel {
 public:
  /// @param film_radius distance of the farthest film point from the axis, mm
  /// @param rim clips the pupils
  /// @throws Error  if the model is not of first order; if the lens is afocal, has no pupils or no finite pupil that
  ///                the model needs; for a pinhole or two discs if it has cylinders; if the film lies in the image of
  ///                the stop or, for thin lenses, in the rear principal plane; and as FilmPupilTable::clipped_by_rim()
  ParaxialModel(ModelKind model, const LensFacts& facts, double film_radius, const std::optional<PupilRim>& rim = {},
                bool paraxial_focus = false);

  const ParaxialModel* first_order() const noexcept override { return this; }
  /// Along x and along y: true if the pupil is an inverted image of the stop. False for two discs.
  std::array<bool, 2> stop_upside_down() const noexcept { return stop_upside_down_; }
  /// Maps from film and pupil points to position and slope in the plane z(), by wavelength.
  std::span<const SectionMaps> maps() const noexcept { return to_scene_; }
  /// Maps at any wavelength; nullopt if the wavelength is not covered.
  std::optional<SectionMaps> maps(Wavelength wavelength) const noexcept;
  double z() const noexcept { return z_; }
  bool paraxial_focus() const noexcept { return paraxial_focus_; }  ///< CameraOptions::paraxial_focus
  /// One for each wavelength: rays of a pinhole pass the pupil plane at the shift times the film point. Empty unless
  /// this is the pinhole.
  std::span<const double> pinhole_shifts() const noexcept { return pinhole_shifts_; }
  /// The fate is missed_surface if numbers are not finite or beyond 1e12 mm, if rays are beyond 1e18, or if the lens
  /// does not cover the wavelength.
  void to_scene(std::size_t count, const TwoPlaneRays<const float>& lines, const RayWavelengths& wavelengths,
                const RayArrays<float>& rays, RayFate* fates, const trace_detail::LensLight* = nullptr,
                float* = nullptr) const noexcept override;
  void to_scene(std::size_t count, const TwoPlaneRays<const double>& lines, const RayWavelengths& wavelengths,
                const RayArrays<double>& rays, RayFate* fates, const trace_detail::LensLight* = nullptr,
                double* = nullptr) const noexcept override;
  RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray,
                   const trace_detail::LensLight* = nullptr, double* = nullptr) const noexcept override;
  RayOf<kernel::Dual> to_scene(const TwoPlaneRayOf<kernel::Dual>& line, Wavelength wavelength,
                               RayFate& fate) const noexcept override;
  /// Inverse of to_scene(); for the pinhole, inverse of the thick lens. The fate is missed_surface also for rays that
  /// do not travel towards the lens.
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
               const TwoPlaneRays<double>& lines, RayFate* fates, const trace_detail::LensLight* = nullptr,
               double* = nullptr) const noexcept override;

 private:
  /// Maps to the scene, and to the film; for a pinhole the latter is the map of the thick lens. null if the wavelength
  /// is not covered.
  /// @param own buffer for maps at a wavelength in nm
  const SectionMaps* map_at(Wavelength wavelength, SectionMaps& own) const noexcept;
  const SectionMaps* inverse_at(Wavelength wavelength, SectionMaps& own) const noexcept;

  template <class T>
  ParaxialJob<T> job(const RayWavelengths& wavelengths, SectionMaps& own) const noexcept;

  std::size_t primary_;
  double z_ = 0;  // plane of the first vertex, in which rays are given
  bool paraxial_focus_;
  double reach_ = 0;  // largest sum of absolute coordinates of a line
  bool equal_sections_;
  std::array<bool, 2> stop_upside_down_{};
  std::vector<SectionMaps> to_scene_, to_film_;                 // by wavelength
  lens_detail::BetweenWavelengths<8> between_, of_thick_lens_;  // maps to the scene of this model; of the thick lens
  std::vector<double> pinhole_shifts_;
};

}  // namespace petzval::camera_detail
