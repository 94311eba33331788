// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "chief_lines.hpp"
#include "petzval/camera/any_model.hpp"
#include "petzval/camera/importance.hpp"
#include "petzval/camera/tilted_film.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil_table/entrance_pupil_table.hpp"

namespace petzval::inline v0::camera_detail {

/// What a camera knows of the scene's side, beside its model: importance.cpp and projection.cpp.
class SceneSide {
 public:
  /// scale: of weights, one for each wavelength, as for sample_rays().
  SceneSide(const Lens& lens, const Film& film, std::optional<TiltedFilm> tilted, const AnyModel& model,
            std::span<const double> scale);

  /// Null for an upright film.
  const TiltedFilm* tilted() const noexcept { return tilted_ ? &*tilted_ : nullptr; }

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
  /// A ray's line behind the lens, by its point of the upright film.
  struct Arrival {
    RayFate fate = RayFate::missed_surface;
    FilmPoint upright, pupil;
  };
  /// Where a line meets the film, and by which point the film's pupils are told: its key, or the point itself.
  struct OnFilm {
    FilmPoint point, key;
  };
  std::optional<OnFilm> on_film(const FilmPoint& upright, const FilmPoint& pupil) const noexcept;
  Arrival arrive(const AnyModel& model, const Ray<double>& ray, std::size_t wavelength) const noexcept;
  /// Where a ray that arrives meets the film, and whether it does.
  Importance met_by(const Arrival& arrival, const std::optional<OnFilm>& met) const noexcept;
  /// Weight and densities of a ray that does. cosine: of its angle with the axis, in the scene; area: of the pupil that
  /// samples of its film point have, 0 where none of them is the ray.
  void weigh(Importance& result, const AnyModel& model, const Arrival& arrival, const FilmPoint& key, double cosine,
             double area, std::size_t wavelength) const noexcept;
  ImportanceSample through_pinhole(const AnyModel& model, const Vec3<double>& point, double u, double v,
                                   std::size_t wavelength) const noexcept;

  Film film_;
  std::optional<TiltedFilm> tilted_;
  double upright_radius_ = 0;
  TwoPlanes space_;
  std::vector<Wavelength> wavelengths_;
  EntrancePupilTable entrance_;
};

}  // namespace petzval::inline v0::camera_detail
