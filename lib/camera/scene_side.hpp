// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "camera/ray_model.hpp"
#include "chief_ray_table.hpp"
#include "front.hpp"
#include "lens/between_wavelengths.hpp"
#include "lens_facts.hpp"
#include "local_focus.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/core/film.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "sample_rays.hpp"
#include "tilted_film.hpp"

namespace petzval::camera_detail {

/// Importance and projection of a camera, implemented in importance.cpp and projection.cpp.
class SceneSide {
 public:
  /// @param radius upright_radius() of the film
  /// @param wavelengths, weights, transmission as in FilmView
  SceneSide(const LensFacts& facts, const Film& film, std::optional<TiltedFilm> tilted, const Front& front,
            const LocalFocus& focus, const RayModel& model, double radius, const WavelengthFacts& wavelengths,
            const PupilWeights& weights, const Transmission& transmission, int threads);

  void importance(const RayModel& model, std::size_t count, const RayArrays<const double>& rays,
                  const RayWavelengths& wavelengths, const double* times, Importance* found) const noexcept;
  void sample_importance(const RayModel& model, std::size_t count, const Vec3<double>* points, const double* u,
                         const double* v, const RayWavelengths& wavelengths, const double* times,
                         ImportanceSample* found) const noexcept;
  ImportanceSample sample_distant(const RayModel& model, const Vec3<double>& direction, double u, double v,
                                  Wavelength wavelength, double time) const noexcept;
  double pdf(const RayModel& model, const Vec3<double>& point, const Vec3<double>& direction,
             Wavelength wavelength) const noexcept;
  double pdf_distant(const RayModel& model, const Ray<double>& ray, Wavelength wavelength) const noexcept;
  Projection project(const RayModel& model, const Vec3<double>& point, Wavelength wavelength,
                     double time) const noexcept;

  /// Data that depend on the wavelength.
  struct Facts {
    double we = 0;       // 1/mm^2
    double density = 0;  // density of film samples in the scene, without the factors of the ray
    double entrance_z = 0, entrance_area = 0;
  };
  /// @param wavelength must be covered
  Facts facts_at(Wavelength wavelength) const noexcept;
  const EntrancePupilTable& entrance() const noexcept { return entrance_; }

 private:
  /// Chief rays. The exact models trace them through all apertures, without clipping.
  void chief_rays(const RayModel& model, std::size_t count, const TwoPlaneRays<const double>& lines,
                  Wavelength wavelength, const RayArrays<double>& rays, RayFate* fates) const noexcept;

  /// Data of a compiled wavelength.
  struct Compiled : Facts {
    ChiefRayTable chiefs;
  };
  const Compiled& nearest(Wavelength wavelength) const noexcept;

  /// Up to `block` scene rays at the film.
  template <std::size_t block>
  struct Arrivals {
    using Column = std::array<double, block>;
    Column upright_x, upright_y, pupil_x, pupil_y;  // image-space rays
    Column met_x, met_y, virtual_x, virtual_y;      // film points, virtual points; equal for an upright film
    Column transmittance;                           // of exact rays
    Column facing, spread, cosine;  // TiltedPlane::weight(), LocalFocus::Straight::spread, cos of the angle to the axis
    std::array<RayFate, block> fates;

    bool lit(std::size_t i) const noexcept { return fates[i] == RayFate::transmitted; }
    TwoPlaneRays<double> lines() noexcept {
      return {upright_x.data(), upright_y.data(), pupil_x.data(), pupil_y.data()};
    }
    TwoPlaneRays<const double> upright_lines() const noexcept {
      return {upright_x.data(), upright_y.data(), pupil_x.data(), pupil_y.data()};
    }
    TwoPlaneRays<const double> virtual_lines() const noexcept {
      return {virtual_x.data(), virtual_y.data(), pupil_x.data(), pupil_y.data()};
    }
  };
  /// Plane of a tilted or moving film at a given time; nullopt for a fixed upright film.
  std::optional<TiltedPlane> plane(double time) const noexcept;
  /// Intersection of an image-space ray with the film plane, and the virtual point of this film point; both are equal
  /// for an upright film. nullopt if there is no intersection.
  struct OnFilm {
    FilmPoint point, virtual_point;
  };
  static std::optional<OnFilm> meet_film(const TwoPlaneRay& ray, const std::optional<TiltedPlane>& plane) noexcept;
  /// True if the origin is finite, the direction has unit length and the wavelength is covered.
  bool valid(const Ray<double>& ray, Wavelength wavelength) const noexcept;
  /// Fate of an invalid ray or point.
  RayFate refused(Wavelength wavelength) const noexcept {
    return wavelengths_.covers(wavelength) ? RayFate::invalid : RayFate::outside_spectrum;
  }
  /// The stages of a sample: rays to the film, weights and densities, and connections from points.
  /// @param count at most `block`
  /// @param areas areas of the sampled pupils, one for each ray; 0 if no film sample has this ray
  template <std::size_t block>
  void arrive(const RayModel& model, std::size_t count, const RayArrays<const double>& rays,
              const RayWavelengths& wavelengths, const double* times, Arrivals<block>& found) const noexcept;
  template <std::size_t block>
  void weigh(const RayModel& model, std::size_t count, const RayWavelengths& wavelengths,
             const Arrivals<block>& arrivals, const double* areas, Importance* found) const noexcept;
  template <std::size_t block>
  void importance_block(const RayModel& model, std::size_t count, const RayArrays<const double>& rays,
                        const RayWavelengths& wavelengths, const double* times, Importance* found) const noexcept;
  template <std::size_t block>
  void connect(const RayModel& model, std::size_t count, const Vec3<double>* points, const double* u, const double* v,
               const RayWavelengths& wavelengths, const double* times, ImportanceSample* found) const noexcept;
  /// Connection from a scene point to the position `position` in the lens, at a distance. The shadow ray ends at the
  /// front.
  ImportanceSample connection(const Vec3<double>& position, const Vec3<double>& direction, double distance,
                              double pdf) const noexcept;
  ImportanceSample through_pinhole(const RayModel& model, const Vec3<double>& point, double u, double v,
                                   Wavelength wavelength, double time) const noexcept;

  Film film_;
  std::optional<TiltedFilm> tilted_;
  double upright_radius_ = 0, pdf_film_ = 0;
  core_detail::FilmBounds<double> bounds_;
  TwoPlanes space_;
  Front front_;
  LocalFocus focus_;
  WavelengthFacts wavelengths_;
  PupilWeights weights_;
  Transmission transmission_;
  FilmPupilTable pupils_;  // of the upright film
  lens_detail::CompiledWavelengths in_nm_;
  lens_detail::BetweenWavelengths<3> between_;  // etendue, entrance_z, entrance_area
  std::size_t primary_ = 0;
  std::vector<Compiled> compiled_;
  EntrancePupilTable entrance_;
  std::optional<Lens> traced_;               // for exact models
  std::optional<FilmPupilTable> unclipped_;  // unclipped pupils of a pinhole with rims, same film
};

}  // namespace petzval::camera_detail
