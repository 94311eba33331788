// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "camera/ray_model.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval {

/// A RayModel of fitted polynomials, for example from a file, with pupils of the same area as the real pupils.
///
///     const Camera camera = camera_with(lens, film, AnyRayModel(PolynomialModel(
///         read_ray_polynomial(path), FilmPupilTable::equal_area(lens, upright_radius(lens, film)))));
class PolynomialModel {
 public:
  static constexpr bool any_wavelength = true;

  PolynomialModel(RayPolynomial polynomial, FilmPupilTable equal_area)
      : polynomial_(std::move(polynomial)), pupils_(std::move(equal_area)) {}

  PETZVAL_API ModelKind kind() const noexcept;
  const FilmPupilTable& pupils() const noexcept { return pupils_; }
  const RayPolynomial& polynomial() const noexcept { return polynomial_; }
  template <class T>
  void to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                const RayArrays<T>& rays, RayFate* fates) const noexcept {
    polynomial_.to_scene<T>(count, lines, wavelengths.resolved(pupils_.primary_wavelength()), rays, fates);
  }
  /// One ray.
  RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray) const noexcept {
    return polynomial_.to_scene(line, wavelength, ray);
  }
  /// One ray with its derivatives.
  RayDerivatives to_scene(const TwoPlaneRayDerivatives& line, Wavelength wavelength) const noexcept {
    return polynomial_.to_scene(line, wavelength);
  }
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
               const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept {
    polynomial_.to_film(count, rays, wavelengths.resolved(pupils_.primary_wavelength()), lines, fates);
  }

 private:
  RayPolynomial polynomial_;
  FilmPupilTable pupils_;
};

}  // namespace petzval
