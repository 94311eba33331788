// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "camera/ray_model.hpp"
#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::camera_detail {

/// The part of the light that the rays of a camera keep on their way through the lens. Exact models find it surface by
/// surface while they trace; for other models it is a polynomial of film and pupil position, fitted to exact rays.
/// Immutable, cheap to copy.
class PETZVAL_API Transmission {
 public:
  /// Not modelled: all light passes.
  Transmission() = default;
  /// @param radius largest distance of a film point from the axis, mm
  /// @throws Error  if a compiled wavelength is outside a table of reflectances
  Transmission(const Lens& lens, const RayModel& model, double radius);

  explicit operator bool() const noexcept { return data_ != nullptr; }
  /// Largest error, relative to all light; 0 if not modelled.
  double error() const noexcept;

  /// As the function of the model with the same name, for an exact model with the transmittances of its rays. Another
  /// model gets 1 here, and its transmittances from of_lines().
  template <class T>
  void to_scene(const RayModel& model, std::size_t count, const TwoPlaneRays<const T>& lines,
                const RayWavelengths& wavelengths, const RayArrays<T>& rays, RayFate* fates,
                T* transmittances) const noexcept;
  RayFate to_scene(const RayModel& model, const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray,
                   double& transmittance) const noexcept;
  void to_film(const RayModel& model, std::size_t count, const RayArrays<const double>& rays,
               const RayWavelengths& wavelengths, const TwoPlaneRays<double>& lines, RayFate* fates,
               double* transmittances) const noexcept;

  /// Multiplies `transmittances` by the transmittances of image-space rays; does nothing for an exact model.
  template <class T>
  void of_lines(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                T* transmittances) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval::camera_detail
