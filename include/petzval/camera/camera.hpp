// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "petzval/camera/bokeh_controls.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/expressive_lens.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/camera/model_kind.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

class AnyRayModel;
class Lens;

/// The unit of a camera's weights.
enum class Normalisation : std::uint8_t {
  irradiance,  ///< irradiance of the film for a scene of radiance 1, with natural darkening and f-number
  /// Irradiance over that on the axis at the primary wavelength, where a uniform scene of radiance 1 gives 1 (as the
  /// shutter opens). The other wavelengths have the same scale: what the lens makes brighter at one than at another,
  /// its tint, stays.
  unity_on_axis,
  /// Each wavelength over its own irradiance on the axis: a white scene is white there, and the tint of the lens is
  /// lost.
  unity_at_each_wavelength,
};

struct CameraOptions {
  ModelKind model = ModelKind::exact_float;
  Normalisation normalisation = Normalisation::irradiance;
  /// Of the set-up, 1 or more: they share the compiled wavelengths of exact models, polynomials and tilted films. The
  /// camera does not depend on them.
  int threads = 1;
  BokehControls bokeh{};  ///< the defaults change nothing
  /// Of first-order models: what is in focus at each place of the film, in place of the film's own focus, where a point
  /// of it fixes a distance. Connections sample the pupil of the least extent everywhere: where others are stopped down
  /// by s stops, one in 2^s is of use.
  std::optional<FocalSurface> focal_surface = {};
  ExpressiveLens expressive{};  ///< of first-order models
  /// Samples, rays and connections at a wavelength in nm beyond the compiled range see the lens at the end of the
  /// range. Otherwise they are lost as RayFate::outside_spectrum.
  bool clamp_wavelengths = false;
};

/// A film behind a focused lens, seen through a ray model: what a renderer holds.
///
///     Lens lens = with_focus(with_f_number(compile(prescription), 2.8), 3000, {.origin = DistanceOrigin::film});
///     Camera camera(lens, {.width_mm = 36, .height_mm = 24, .columns = 1920, .rows = 1280});
///     CameraRay r = camera.sample({.film = camera.film().point(column, row), .pupil_u = u, .pupil_v = v});
///     if (r) pixel += r.weight * radiance(r.ray);
///
/// The picture is sharpest 3 m from the film, whatever the model: first-order models are focused where exact rays of
/// the film's centre are sharpest.
///
/// Any size of film is taken; lint(lens, film) finds one that the image circle of the lens does not fit.
///
/// Rays of every model start on the front of the lens, and shadow rays of connections end there: on the sphere through
/// the vertex and the rim of the first surface, which is that surface where it is spherical or plane. Where other
/// surfaces stand before the first one, as with some mirrors, or it is a cylinder, the front is the plane across the
/// axis before all of them. A line that misses the sphere starts in the plane that touches it at the vertex.
///
/// A pull of focus while the shutter is open is a film that travels (Film::travel_mm): each sample has its time, and
/// the ray is that of the film's place then, without interpolation. First-order models keep the focus and the size of
/// the pupil that they are given as the shutter opens: after a pull from 3 m to infinity of a 100 mm lens their
/// exposure is 1 to 4 % off. Such a film costs what a tilted one does; pinhole, thin and thick, which tilt for nothing,
/// are set up as an exact camera is.
///
/// A sample has a wavelength of its own: a position among the compiled ones, or any between them in nm
/// (Wavelength::nm(), RayWavelengths::each_nm), so that hero wavelengths need no camera per bin. Beyond the compiled
/// range it has weight 0 and the fate outside_spectrum: compile the lens for the whole range of the renderer (pbrt and
/// Mitsuba: 360 to 830 nm, with CompileOptions::clamp_wavelengths, as glasses are known less far), or set
/// CameraOptions::clamp_wavelengths. Set-up grows with the
/// compiled ones only. A ray meets the film of 36 mm where that of a camera compiled for its wavelength does, in pixels
/// of 1920: exact models within 1e-4, whatever wavelengths were compiled; polynomials of degree 7 and first-order ones
/// within 0.03 (lenses faster than f/1.4: 0.08) from eight even ones over 400 to 700 nm, and within pixels from three
/// (tests/camera/any_wavelength_test.cpp). The light of polynomials and two discs steps in the middles between compiled
/// wavelengths, by 1 % or less (FilmPupilTable). Film and scene hold the same light at every wavelength. A renderer's
/// own models take nm where they say so (RayModel).
///
/// A first-order model may have a focus of its own at each place of the film (CameraOptions::focal_surface) and the
/// aberrations of an ExpressiveLens. Film samples keep their weights and densities: a picture keeps its exposure. Rays
/// of the scene spread otherwise, and their importance with them, so that film and scene hold the same light. Of a
/// tilted film the surface decides what is in focus, and the tilt the perspective.
///
/// Immutable, cheap to copy, shared freely between threads. Calls neither allocate nor draw random numbers nor loop
/// until a ray passes: a lost sample has weight 0 and a fate. Only the first call that concerns rays from the scene
/// (importance and projection) makes the tables for those, while other threads that want them wait; it throws
/// std::bad_alloc where there is no memory for them, and the next call tries again. Lens frame, mm; host_frame.hpp has
/// the frames of hosts.
class PETZVAL_API Camera {
 public:
  /// Copies. Moves copy too, so that no Camera is ever empty.
  Camera(const Camera&) = default;
  Camera& operator=(const Camera&) = default;

  /// The lens has its film where film.z_mm says, as with_film() would. A film that is tilted or travels takes four to
  /// six times as long to set up (7 ms rather than 1.3 for a double Gauss); fits of tilts need no camera. Throws
  /// Error for a film without area or pixels, one that is not behind the last surface, is tilted into the lens or comes
  /// near to the plane of the pupil, and where the model cannot be built: a lens without a pupil, a pinhole or two
  /// discs of a lens with cylinders.
  Camera(const Lens& lens, const Film& film, const CameraOptions& options = {});
  /// With a model that was built before: a renderer's own, or polynomials read from a file (ray_model.hpp). Throws
  /// Error also for a model of other wavelengths, of another place of the film, or whose pupils or polynomials reach
  /// less far than upright_radius(), and for lens_elements, lens_ratio and rate_of_change, which its pupils cannot
  /// follow.
  Camera(const Lens& lens, const Film& film, const AnyRayModel& model,
         Normalisation normalisation = Normalisation::irradiance, const BokehControls& bokeh = {});

  /// With the film's place.
  const Lens& lens() const noexcept;
  const Film& film() const noexcept;
  ModelKind model() const noexcept;
  Normalisation normalisation() const noexcept;

  /// One ray; it agrees with that of a batch within rounding. The densities of a pinhole's rays are those of the thick
  /// lens's pupil. Fates of invalid samples: outside_film for a film point that is outside the film or not finite,
  /// outside_spectrum for a wavelength that the lens does not cover, vignetted for a pupil without area and pupil
  /// samples that are not finite. Pupil samples outside the unit square count as its edge.
  CameraRay sample(const CameraSample& sample) const noexcept;
  /// N rays, float or double, in the precision of the model.
  template <class T>
  void sample(std::size_t count, const CameraSamples<T>& samples, const CameraRays<T>& rays) const noexcept;

  /// One ray with its exact derivatives.
  CameraRayDifferential sample_differential(const CameraSample& sample) const noexcept;
  /// N rays with their derivatives by raster position, 0 for a lost ray: the values of single calls, which it makes.
  template <class T>
  void sample_differentials(std::size_t count, const CameraSamples<T>& samples, const CameraRays<T>& rays,
                            const RayArrays<T>& by_raster_x, const RayArrays<T>& by_raster_y) const noexcept;

  /// The importance of a ray from the scene, given anywhere on its line, in its direction towards the lens. 0 for a
  /// pinhole, which no ray meets by chance; so is pdf_importance(). Only connections meet it.
  /// time: as in CameraSample, here and below.
  Importance importance(const Ray<double>& ray, Wavelength wavelength = {}, double time = 0) const;
  /// The same for N rays, faster than one by one: within rounding. times: N, or null.
  void importance(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                  Importance* found, const double* times = nullptr) const;
  /// Samples a connection from a scene point (lens frame, mm) to the part of the entrance pupil that it sees.
  ImportanceSample sample_importance(const Vec3<double>& point, double u, double v, Wavelength wavelength = {},
                                     double time = 0) const;
  /// The same for N points, faster than one by one: within rounding. times: N, or null.
  void sample_importance(std::size_t count, const Vec3<double>* points, const double* u, const double* v,
                         const RayWavelengths& wavelengths, ImportanceSample* found,
                         const double* times = nullptr) const;
  /// A connection with light from infinity, of a sun or an environment, in a direction of travel (unit, towards the
  /// lens): the pdf is that of the ray's place in a plane across it, 1/mm^2, and the distance is infinite. The mean of
  /// E We / pdf is the film's mean irradiance by light of the irradiance E across that direction.
  ImportanceSample sample_distant_importance(const Vec3<double>& direction, double u, double v,
                                             Wavelength wavelength = {}, double time = 0) const;
  /// The density with which sample_importance() gives a direction at a point, 1/sr; the same at all times. 0 for what
  /// is invalid as a ray (Importance::fate).
  double pdf_importance(const Vec3<double>& point, const Vec3<double>& direction, Wavelength wavelength = {}) const;
  /// The same for sample_distant_importance(): of a ray with its direction of travel, given anywhere on its line, among
  /// those of its direction, 1/mm^2 across it.
  double pdf_distant_importance(const Ray<double>& ray, Wavelength wavelength = {}) const;

  /// The camera's film side as plain numbers, for hosts that sample on another processor: CameraTables
  /// (camera_tables.hpp) has the layout. Throws Error for a film that is tilted or travels, for weights of the
  /// pupil, a focal surface or an expressive lens, and for a renderer's own model.
  std::vector<float> tables() const;

  /// Where the camera sees a scene point: the film point and raster position of its chief ray. not_visible also for a
  /// wavelength outside the compiled range.
  Projection project(const Vec3<double>& point, Wavelength wavelength = {}, double time = 0) const;

  /// Of the focal surface and the film offsets, on a grid of 96 x 64 places of the film as the shutter opens, which may
  /// miss folds that are narrower; 0 without them. From 1 on rays of several film points coincide. Film samples stay
  /// what they are; importance, connections and projections know one of these film points, and where it turns the rays
  /// over none, so that light tracing lacks light: trace paths from the film.
  FocalSteepness focal_steepness() const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval
