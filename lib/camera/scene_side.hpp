// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "chief_lines.hpp"
#include "petzval/camera/any_model.hpp"
#include "petzval/camera/film.hpp"
#include "petzval/camera/importance.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/entrance_map.hpp"

namespace petzval::detail {

/// What a camera knows of the scene's side, beside its model: importance.cpp and projection.cpp.
class SceneSide {
 public:
  /// scale: of weights, one for each wavelength, as for sample_rays().
  SceneSide(const Lens& lens, const Film& film, const AnyModel& model, std::span<const double> scale);

  Importance importance(const AnyModel& model, const Ray<double>& ray, std::size_t wavelength) const noexcept;
  ImportanceSample sample_importance(const AnyModel& model, const Vec3<double>& point, double u, double v,
                                     std::size_t wavelength) const noexcept;
  double pdf(const AnyModel& model, const Vec3<double>& point, const Vec3<double>& direction,
             std::size_t wavelength) const noexcept;
  Projection project(const AnyModel& model, const Vec3<double>& point, std::size_t wavelength) const noexcept;

 private:
  struct Wavelength {
    double we = 0;       // 1/mm^2
    double density = 0;  // of film samples in the scene, less what depends on the ray
    double entrance_z = 0, entrance_area = 0;
    ChiefLines chiefs;
  };
  /// A ray's line behind the lens.
  struct Arrival {
    RayFate fate = RayFate::missed_surface;
    FilmPoint film, pupil;
  };
  Arrival arrive(const AnyModel& model, const Ray<double>& ray, std::size_t wavelength) const noexcept;
  /// cosine: of the ray's angle with the axis, in the scene.
  Importance weighed(const AnyModel& model, const Arrival& arrival, double cosine,
                     std::size_t wavelength) const noexcept;
  ImportanceSample through_pinhole(const AnyModel& model, const Vec3<double>& point, double u, double v,
                                   std::size_t wavelength) const noexcept;

  Film film_;
  FilmSpace space_;
  std::vector<Wavelength> wavelengths_;
  EntranceMap entrance_;
};

}  // namespace petzval::detail
