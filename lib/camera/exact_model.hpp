// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "camera/ray_model.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::trace_detail {
class LensLight;
}

namespace petzval::camera_detail {

/// The lens itself: traces rays through every surface in R, float or double, for samples and rays of either type.
template <class R>
class ExactModel {
 public:
  static constexpr bool clips_at_apertures = true;
  static constexpr bool any_wavelength = true;

  /// @throws Error  as FilmPupilTable::enclosing()
  ExactModel(const Lens& lens, double film_radius, int threads = 1)
      : ExactModel(lens, FilmPupilTable::enclosing(lens, film_radius, threads)) {}
  ExactModel(const Lens& lens, FilmPupilTable enclosing)
      : lens_(lens), pupils_(std::move(enclosing)), towards_(towards_scene(lens_, pupils_.space())) {}

  ModelKind kind() const noexcept { return sizeof(R) == 4 ? ModelKind::exact_float : ModelKind::exact_double; }
  const FilmPupilTable& pupils() const noexcept { return pupils_; }
  /// @param light          null: no transmittances
  /// @param transmittances the part of the light that each ray keeps
  template <class T>
  void to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                const RayArrays<T>& rays, RayFate* fates, const trace_detail::LensLight* light = nullptr,
                T* transmittances = nullptr) const noexcept;
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
               const TwoPlaneRays<double>& lines, RayFate* fates, const trace_detail::LensLight* light = nullptr,
               double* transmittances = nullptr) const noexcept;

  RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray,
                   const trace_detail::LensLight* light = nullptr, double* transmittance = nullptr) const noexcept;
  /// One ray with its derivatives, in double.
  RayDerivatives to_scene(const TwoPlaneRayDerivatives& line, Wavelength wavelength) const noexcept;

  const Lens& lens() const noexcept { return lens_; }

 private:
  Lens lens_;
  FilmPupilTable pupils_;
  double towards_;
};

}  // namespace petzval::camera_detail
