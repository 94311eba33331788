// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "chief_ray_table.hpp"
#include "front.hpp"
#include "lens/between_wavelengths.hpp"
#include "lens_facts.hpp"
#include "local_focus.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/film.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "sample_rays.hpp"
#include "tilted_film.hpp"

namespace petzval::camera_detail {

/// The scene's side of a camera: importance.cpp and projection.cpp.
class SceneSide {
 public:
  /// radius: upright_radius() of the film; wavelengths, weights: as in FilmView.
  SceneSide(const LensFacts& facts, const Film& film, std::optional<TiltedFilm> tilted, const Front& front,
            const LocalFocus& focus, const AnyRayModel& model, double radius, const WavelengthFacts& wavelengths,
            const PupilWeights& weights);

  Importance importance(const AnyRayModel& model, const Ray<double>& ray, Wavelength wavelength,
                        double time) const noexcept;
  void importance(const AnyRayModel& model, std::size_t count, const RayArrays<const double>& rays,
                  const RayWavelengths& wavelengths, const double* times, Importance* found) const noexcept;
  ImportanceSample sample_importance(const AnyRayModel& model, const Vec3<double>& point, double u, double v,
                                     Wavelength wavelength, double time) const noexcept;
  void sample_importance(const AnyRayModel& model, std::size_t count, const Vec3<double>* points, const double* u,
                         const double* v, const RayWavelengths& wavelengths, const double* times,
                         ImportanceSample* found) const noexcept;
  ImportanceSample sample_distant(const AnyRayModel& model, const Vec3<double>& direction, double u, double v,
                                  Wavelength wavelength, double time) const noexcept;
  double pdf(const AnyRayModel& model, const Vec3<double>& point, const Vec3<double>& direction,
             Wavelength wavelength) const noexcept;
  double pdf_distant(const AnyRayModel& model, const Ray<double>& ray, Wavelength wavelength) const noexcept;
  Projection project(const AnyRayModel& model, const Vec3<double>& point, Wavelength wavelength,
                     double time) const noexcept;

 private:
  /// Chief rays, which the exact models trace whatever clips them.
  void chief_rays(const AnyRayModel& model, std::size_t count, const TwoPlaneRays<const double>& lines,
                  Wavelength wavelength, const RayArrays<double>& rays, RayFate* fates) const noexcept;

  /// What differs with the wavelength.
  struct Facts {
    double we = 0;       // 1/mm^2
    double density = 0;  // of film samples in the scene, less what depends on the ray
    double entrance_z = 0, entrance_area = 0;
  };
  /// Those of a compiled one.
  struct Compiled : Facts {
    ChiefRayTable chiefs;
  };
  /// Of a wavelength that is covered.
  Facts facts_at(Wavelength wavelength) const noexcept;
  const Compiled& nearest(Wavelength wavelength) const noexcept;

  /// The image-space ray that a scene ray becomes.
  struct Arrival {
    RayFate fate = RayFate::invalid;
    FilmPoint upright, pupil;
    double spread = 1;  // LocalFocus::Straight
  };
  /// Where an image-space ray meets the film, and the virtual point of that; of an upright film, the point itself.
  struct OnFilm {
    FilmPoint point, virtual_point;
  };
  /// Where a tilted film, or one that travels, is at a time; nothing for another one.
  std::optional<TiltedPlane> plane(double time) const noexcept;
  std::optional<OnFilm> on_film(const FilmPoint& upright, const FilmPoint& pupil,
                                const std::optional<TiltedPlane>& plane) const noexcept;
  /// A unit direction, numbers that are finite, and a wavelength that is covered.
  bool valid(const Ray<double>& ray, Wavelength wavelength) const noexcept;
  /// The fate of a ray or point that is not valid.
  RayFate refused(Wavelength wavelength) const noexcept {
    return wavelengths_.covers(wavelength) ? RayFate::invalid : RayFate::outside_spectrum;
  }
  Arrival arrive(const AnyRayModel& model, const Ray<double>& ray, Wavelength wavelength, double time) const noexcept;
  /// The importance of a ray that arrives. cosine: of its angle with the axis in the scene. upright_area: the area that
  /// its sample on an upright film stands for, or null.
  Importance arrived(const AnyRayModel& model, const Arrival& arrival, double cosine, Wavelength wavelength,
                     double time, const double* upright_area = nullptr) const noexcept;
  /// Film point, raster and fate of a ray that arrives.
  Importance met_by(const Arrival& arrival, const std::optional<OnFilm>& met) const noexcept;
  /// Weight and densities of a ray that meets the film. facing: TiltedPlane::weight(); cosine: of its angle with the
  /// axis in the scene; area: of the pupil that its film point samples, 0 where no sample is this ray.
  void weigh(Importance& result, const AnyRayModel& model, const Arrival& arrival, double facing, double cosine,
             double area, const Facts& at) const noexcept;
  /// A connection to a place in the lens from a point at a distance from it. The shadow ray ends at the front.
  ImportanceSample connection(const Vec3<double>& place, const Vec3<double>& direction, double distance,
                              double pdf) const noexcept;
  ImportanceSample through_pinhole(const AnyRayModel& model, const Vec3<double>& point, double u, double v,
                                   Wavelength wavelength, double time) const noexcept;

  Film film_;
  std::optional<TiltedFilm> tilted_;
  double upright_radius_ = 0, pdf_film_ = 0;
  TwoPlanes space_;
  Front front_;
  LocalFocus focus_;
  WavelengthFacts wavelengths_;
  PupilWeights weights_;
  FilmPupilTable pupils_;  // of the upright film
  lens_detail::CompiledWavelengths in_nm_;
  lens_detail::BetweenWavelengths<3> between_;  // etendue, place and area of the entrance pupil
  std::size_t primary_ = 0;
  std::vector<Compiled> compiled_;
  EntrancePupilTable entrance_;
  std::optional<Lens> traced_;           // of the exact models
  std::optional<FilmPupilTable> whole_;  // of a pinhole whose pupils a rim has cut: those before, of the same film
};

}  // namespace petzval::camera_detail
