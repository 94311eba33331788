// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "core/dual.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval {

class RayPolynomial;
namespace camera_detail {
class ParaxialModel;
}
namespace trace_detail {
class LensLight;
}

/// What a Camera needs of a model of the lens: the pupils to sample, and the map between image-space and scene rays.
///
/// An image-space ray is given by its points on the film and on the pupil plane (TwoPlanes). Immutable and thread-safe.
/// The functions do not allocate and write finite numbers for every ray; fates tell lost rays. Wavelengths are
/// positions or nm; unknown wavelengths give missed_surface. One virtual call per batch.
///
/// With `light`, exact models write to `transmittances` the part of the light that each ray keeps; other models ignore
/// both.
class PETZVAL_API RayModel {
 public:
  virtual ~RayModel() = default;

  ModelKind kind() const noexcept { return kind_; }
  /// The pupils of the film points, up to upright_radius().
  const FilmPupilTable& pupils() const noexcept { return pupils_; }
  /// True: the fates decide which rays pass, and pupils() contain all of them. False: a ray passes if pupils() contain
  /// it.
  bool clips_at_apertures() const noexcept { return kind_.is_exact(); }
  /// True: the model is linear in heights and slopes and conserves their area, like an ideal lens. False: it conserves
  /// etendue.
  bool linear_in_slopes() const noexcept { return kind_.is_first_order(); }
  bool pinhole() const noexcept { return kind_ == ModelKind::pinhole; }
  /// The model as a first-order model or as polynomials, for parts that depend on its coefficients; else null.
  virtual const camera_detail::ParaxialModel* first_order() const noexcept { return nullptr; }
  virtual const RayPolynomial* polynomial() const noexcept { return nullptr; }

  /// N image-space rays to rays that leave the lens towards the scene.
  virtual void to_scene(std::size_t count, const TwoPlaneRays<const float>& lines, const RayWavelengths& wavelengths,
                        const RayArrays<float>& rays, RayFate* fates, const trace_detail::LensLight* light = nullptr,
                        float* transmittances = nullptr) const noexcept = 0;
  virtual void to_scene(std::size_t count, const TwoPlaneRays<const double>& lines, const RayWavelengths& wavelengths,
                        const RayArrays<double>& rays, RayFate* fates, const trace_detail::LensLight* light = nullptr,
                        double* transmittances = nullptr) const noexcept = 0;
  virtual RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray,
                           const trace_detail::LensLight* light = nullptr,
                           double* transmittance = nullptr) const noexcept = 0;
  /// One ray with its derivatives.
  virtual RayOf<kernel::Dual> to_scene(const TwoPlaneRayOf<kernel::Dual>& line, Wavelength wavelength,
                                       RayFate& fate) const noexcept = 0;
  /// N rays of the scene, given anywhere on their lines, to image-space rays.
  virtual void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                       const TwoPlaneRays<double>& lines, RayFate* fates,
                       const trace_detail::LensLight* light = nullptr,
                       double* transmittances = nullptr) const noexcept = 0;

 protected:
  RayModel(ModelKind kind, FilmPupilTable pupils) : kind_(kind), pupils_(std::move(pupils)) {}
  RayModel(const RayModel&) = default;
  RayModel& operator=(const RayModel&) = default;

 private:
  ModelKind kind_;
  FilmPupilTable pupils_;
};

/// Radius up to which the pupils of a model are needed (mm): distance from the axis at which the rays of the film's
/// points meet the plane of the upright film. For an upright film, Film::radius_mm().
///
/// @throws Error  if the film is no rectangle or tilted by 90 degrees or more, or if a tilted film comes near the pupil
///                plane or the pupil of a first-order model (thin: the rear principal plane)
PETZVAL_API double upright_radius(const Lens& lens, const Film& film, ModelKind model = ModelKind::exact_double);

}  // namespace petzval
