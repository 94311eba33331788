// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "camera/ray_model.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::camera_detail {

/// The lens itself: traces rays through every surface in R, float or double, for samples and rays of either type.
template <class R>
class ExactModel final : public RayModel {
 public:
  /// @throws Error  as FilmPupilTable::enclosing()
  ExactModel(const Lens& lens, double film_radius, int threads = 1)
      : ExactModel(lens, FilmPupilTable::enclosing(lens, film_radius, threads)) {}
  ExactModel(const Lens& lens, FilmPupilTable enclosing)
      : RayModel(sizeof(R) == 4 ? ModelKind::exact_float : ModelKind::exact_double, std::move(enclosing)),
        lens_(lens),
        towards_(towards_scene(lens_, pupils().space())) {}

  void to_scene(std::size_t count, const TwoPlaneRays<const float>& lines, const RayWavelengths& wavelengths,
                const RayArrays<float>& rays, RayFate* fates, const trace_detail::LensLight* light = nullptr,
                float* transmittances = nullptr) const noexcept override;
  void to_scene(std::size_t count, const TwoPlaneRays<const double>& lines, const RayWavelengths& wavelengths,
                const RayArrays<double>& rays, RayFate* fates, const trace_detail::LensLight* light = nullptr,
                double* transmittances = nullptr) const noexcept override;
  RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray,
                   const trace_detail::LensLight* light = nullptr,
                   double* transmittance = nullptr) const noexcept override;
  /// One ray with its derivatives, in double.
  RayOf<kernel::Dual> to_scene(const TwoPlaneRayOf<kernel::Dual>& line, Wavelength wavelength,
                               RayFate& fate) const noexcept override;
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
               const TwoPlaneRays<double>& lines, RayFate* fates, const trace_detail::LensLight* light = nullptr,
               double* transmittances = nullptr) const noexcept override;

  const Lens& lens() const noexcept { return lens_; }

 private:
  template <class T>
  void trace_lines(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                   const RayArrays<T>& rays, RayFate* fates, const trace_detail::LensLight* light,
                   T* transmittances) const noexcept;

  Lens lens_;
  double towards_;
};

extern template class PETZVAL_API ExactModel<float>;
extern template class PETZVAL_API ExactModel<double>;

}  // namespace petzval::camera_detail
