// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "camera/ray_model.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval {

/// A model of fitted polynomials, with pupils of the same area as the real pupils.
class PolynomialModel final : public RayModel {
 public:
  PolynomialModel(RayPolynomial polynomial, FilmPupilTable equal_area)
      : RayModel(ModelKind::polynomial(polynomial.degree()), std::move(equal_area)),
        polynomial_(std::move(polynomial)) {}

  const RayPolynomial* polynomial() const noexcept override { return &polynomial_; }
  void to_scene(std::size_t count, const TwoPlaneRays<const float>& lines, const RayWavelengths& wavelengths,
                const RayArrays<float>& rays, RayFate* fates, const trace_detail::LensLight*,
                float*) const noexcept override {
    polynomial_.to_scene(count, lines, wavelengths.resolved(pupils().primary_wavelength()), rays, fates);
  }
  void to_scene(std::size_t count, const TwoPlaneRays<const double>& lines, const RayWavelengths& wavelengths,
                const RayArrays<double>& rays, RayFate* fates, const trace_detail::LensLight*,
                double*) const noexcept override {
    polynomial_.to_scene(count, lines, wavelengths.resolved(pupils().primary_wavelength()), rays, fates);
  }
  RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray, const trace_detail::LensLight*,
                   double*) const noexcept override {
    return polynomial_.to_scene(line, wavelength, ray);
  }
  RayOf<kernel::Dual> to_scene(const TwoPlaneRayOf<kernel::Dual>& line, Wavelength wavelength,
                               RayFate& fate) const noexcept override {
    return polynomial_.to_scene(line, wavelength, fate);
  }
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
               const TwoPlaneRays<double>& lines, RayFate* fates, const trace_detail::LensLight*,
               double*) const noexcept override {
    polynomial_.to_film(count, rays, wavelengths.resolved(pupils().primary_wavelength()), lines, fates);
  }

 private:
  RayPolynomial polynomial_;
};

}  // namespace petzval
