// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/camera/bokeh.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// A ray model of a lens. Models are ordered from the cheapest to the most accurate.
///
/// Accuracy: on the axis, all models have the exposure of the exact lens within 0.5 %. Over the declared field,
/// thin_two_disc and polynomials have it within 2 % (tests/camera/exposure_test.cpp).
///
/// Limitations: if a central obscuration divides the pupil, as in catadioptrics beyond their field, the exposure of
/// models that are not exact may be off by a factor. Beyond the declared field,
/// polynomials of lenses with cylinders are up to 20 % too dark. First-order models of lenses faster than f/0.36 are up
/// to 5 % too bright; for lenses faster than f/0.31 they are useless.
class ModelKind {
 public:
  enum class Family : std::uint8_t { pinhole, thin, thin_two_disc, thick, polynomial, exact_float, exact_double };

  /// First order; every ray passes the centre of the pupil.
  static const ModelKind pinhole;
  /// First order; a disc in the principal plane. Irradiance follows cos^4, so that the blur disc of an axial point is
  /// darker at its rim than at its centre: by 10 % at f/2 and 33 % at f/1.1. (LensRays::thin has uniform discs.)
  static const ModelKind thin;
  /// First order; the pupil is the overlap of two discs that move apart with the field, fitted to the real pupils of
  /// the film points. Irradiance falls off as with the real lens. Limitations: see fit_two_discs().
  static const ModelKind thin_two_disc;
  /// First order; cardinal points and paraxial pupils.
  static const ModelKind thick;
  /// Rays as polynomials of film and pupil point, of degree 3, 5, 7, 9 or 11. A Camera throws Error for other degrees.
  static constexpr ModelKind polynomial(int degree) noexcept;
  /// Rays traced through every surface, in float or double.
  static const ModelKind exact_float, exact_double;

  constexpr ModelKind() noexcept = default;
  constexpr Family family() const noexcept { return family_; }
  constexpr int degree() const noexcept { return degree_; }  ///< of a polynomial; 0 for other models
  constexpr bool is_first_order() const noexcept { return family_ <= Family::thick; }
  constexpr bool is_polynomial() const noexcept { return family_ == Family::polynomial; }
  constexpr bool is_exact() const noexcept { return family_ >= Family::exact_float; }
  friend constexpr auto operator<=>(const ModelKind&, const ModelKind&) noexcept = default;

 private:
  constexpr explicit ModelKind(Family family, int degree = 0) noexcept : family_(family), degree_(degree) {}

  Family family_ = Family::exact_float;
  int degree_ = 0;
};

inline constexpr ModelKind ModelKind::pinhole{Family::pinhole};
inline constexpr ModelKind ModelKind::thin{Family::thin};
inline constexpr ModelKind ModelKind::thin_two_disc{Family::thin_two_disc};
inline constexpr ModelKind ModelKind::thick{Family::thick};
inline constexpr ModelKind ModelKind::exact_float{Family::exact_float};
inline constexpr ModelKind ModelKind::exact_double{Family::exact_double};
constexpr ModelKind ModelKind::polynomial(int degree) noexcept { return ModelKind(Family::polynomial, degree); }

/// "pinhole", "thin", "thin_two_disc", "thick", "polynomial_3", ..., "exact_float" or "exact_double"; "unknown" for
/// polynomials of another degree.
PETZVAL_API std::string_view name(ModelKind model) noexcept;
/// The built-in model with a name; nullopt if there is no such model.
PETZVAL_API std::optional<ModelKind> model_named(std::string_view name) noexcept;
/// The built-in models, in the order above.
PETZVAL_API std::span<const ModelKind> models() noexcept;

class Lens;

/// Unit of the weights of a camera.
enum class Normalisation : std::uint8_t {
  irradiance,  ///< irradiance of the film for a scene of radiance 1, with natural vignetting and f-number
  /// Irradiance divided by the irradiance on the axis at the primary wavelength, as the shutter opens: a uniform scene
  /// of radiance 1 gives 1 on the axis. All wavelengths have the same scale, so that the tint of the lens stays.
  unity_on_axis,
  /// Irradiance of each wavelength divided by its own irradiance on the axis: a white scene is white there, and the
  /// tint of the lens is lost.
  unity_at_each_wavelength,
};

/// Options of a Camera.
struct CameraOptions {
  ModelKind model = ModelKind::exact_float;
  Normalisation normalisation = Normalisation::irradiance;
  /// Threads for the set-up, at least 1. They share the compiled wavelengths of exact models, polynomials and tilted
  /// films; the camera is the same for every number of threads.
  int threads = 1;
  BokehControls bokeh{};  ///< the defaults change nothing
  /// First-order models only: distance in focus and depth of field for each film point. The film keeps its own focus if
  /// no focal point fixes a distance. Connections sample the pupil of the smallest extent for all film points: at a
  /// film point stopped down by s stops more, one connection in 2^s passes.
  std::optional<FocalSurface> focal_surface = {};
  ExpressiveLens expressive{};  ///< aberrations; first-order models only
  /// First-order models only. true: sharp at the paraxial image, as for thin_elements(), whose exact rays have
  /// aberrations. false: sharp where the exact rays of the film's centre are sharpest.
  bool paraxial_focus = false;
  /// true: weights and importance include the light that the surfaces reflect and the glasses absorb, as
  /// transmittance() of a ray, with the coatings of the lens (LensSurface::coating). false: all light passes, at no
  /// cost. model_error() and choose_model() state what is then left out. Camera::transmission_error() states the error.
  bool transmission = false;
  /// true: wavelengths in nm outside the compiled range are clamped to the range, for samples, rays and connections.
  /// false: they are lost as RayFate::outside_spectrum.
  bool clamp_wavelengths = false;
  /// true: the tables of importance, connections and projection are built in the constructor, on `threads`.
  /// false: they are built at their first use, on the thread of the caller.
  bool importance_tables = false;
};

/// A focused lens and its film, seen through a ray model: generates the rays of a renderer. Lens frame, mm.
///
///     Lens lens = with_focus(with_f_number(compile(prescription), 2.8), 3000, {.origin = DistanceOrigin::film});
///     Camera camera(lens, {.width_mm = 36, .height_mm = 24, .columns = 1920, .rows = 1280});
///     CameraRay r = camera.sample({.film = camera.film().point(column, row), .pupil_u = u, .pupil_v = v});
///     if (r) pixel += r.weight * radiance(r.ray);
///
/// Immutable, cheap to copy, thread-safe. Calls do not allocate, draw random numbers or loop until a ray passes: a lost
/// sample has weight 0 and a fate. Only the first call of importance or projection builds tables, while other threads
/// wait; it may throw std::bad_alloc, and the next call tries again.
///
/// Rays start on the front of the lens, and shadow rays end there: the sphere through the vertex and the rim of the
/// first surface. A line that misses the sphere starts in the tangent plane at the vertex. If another surface, such as
/// a mirror, stands in front of the first one, or the first one is a cylinder, the front is a plane perpendicular to
/// the axis before all surfaces.
class PETZVAL_API Camera {
 public:
  /// Copies. Moves also copy, so that a Camera is never empty.
  Camera(const Camera&) = default;
  Camera& operator=(const Camera&) = default;

  /// Sets up a camera with a built-in model.
  ///
  /// First-order models are focused where the exact rays of the film's centre are sharpest, unless
  /// CameraOptions::paraxial_focus is set. A film that is tilted or
  /// travels takes four to six times as long to set up (7 ms instead of 1.3 ms for a double Gauss).
  ///
  /// @param lens     the lens; its film moves to film.z_mm, as with with_film()
  /// @param film     the film; it may be larger than the image circle (lint() reports that)
  /// @param options  model, unit of the weights and other settings
  /// @throws Error   if the film has no area or no pixels, is not behind the last surface, is tilted into the lens or
  ///                 comes near the pupil plane; if the lens has no pupil; if a lens for pinhole or thin_two_disc has
  ///                 cylinders
  ///
  /// Limitations: if the film travels, first-order models keep the focus and the pupil size of the position at which
  /// the shutter opens. After a pull from 3 m to infinity with a 100 mm lens the exposure is off by 1 to 4 %.
  Camera(const Lens& lens, const Film& film, const CameraOptions& options = {});

  /// @name Settings
  /// @{

  /// The lens with its film at the position of the camera's film.
  const Lens& lens() const noexcept;
  const Film& film() const noexcept;
  ModelKind model() const noexcept;
  Normalisation normalisation() const noexcept;

  /// @}
  /// @name Sampling from the film
  /// @{

  /// Samples one ray from the film to the scene; equal to the batch result up to rounding.
  ///
  /// A lost sample has the fate outside_film if the film point is outside the film or not finite, outside_spectrum if
  /// the lens does not cover the wavelength, and vignetted if the pupil has no area or the pupil sample is not finite.
  /// Pupil samples outside the unit square are clamped. A pinhole reports the densities of the thick lens's pupil.
  ///
  /// Accuracy: film positions at a wavelength between compiled ones are compared with a camera compiled for it, in
  /// pixels of 36 mm / 1920 (tests/camera/any_wavelength_test.cpp). Exact models are within 1e-4 if
  /// Lens::index_error() is below 1e-6. First-order models and polynomials of degree 7 are within 0.03 (lenses faster
  /// than f/1.4: 0.08) with eight equally spaced wavelengths over 400 to 700 nm, and within a few pixels with three.
  /// The weights of polynomials and thin_two_disc have steps of up to 1 % midway between compiled wavelengths.
  CameraRay sample(const CameraSample& sample) const noexcept;
  /// Samples N rays, float or double, in the precision of the model.
  template <class T>
  void sample(std::size_t count, const CameraSamples<T>& samples, const CameraRays<T>& rays) const noexcept;

  /// @}
  /// @name Differentials
  /// @{

  /// Samples one ray with its exact derivatives.
  CameraRayDifferential sample_differential(const CameraSample& sample) const noexcept;
  /// Samples N rays with their derivatives by raster position; 0 for a lost ray. Calls sample_differential() N times.
  template <class T>
  void sample_differentials(std::size_t count, const CameraSamples<T>& samples, const CameraRays<T>& rays,
                            const RayArrays<T>& by_raster_x, const RayArrays<T>& by_raster_y) const noexcept;

  /// @}
  /// @name Several wavelengths of one path
  /// @{

  /// Samples a ray at the first wavelength, the hero, and evaluates this ray at all wavelengths.
  ///
  /// The weights combine the densities of all wavelengths by the balance heuristic. This requires that each wavelength
  /// could have been the hero with the same set: for example equal steps through the spectrum, wrapped at its ends.
  /// Film positions differ by the lateral colour, so each wavelength adds weight * radiance at its own raster position.
  /// A pinhole has no densities: all wavelengths have the weight and the position of the hero. Takes one sample() and
  /// one importance() for each wavelength.
  ///
  /// @param sample  film point, pupil sample and time; its wavelength is not used
  /// @param nm      wavelengths, the hero first
  /// @param found   one result for each wavelength
  /// @return        the ray of the hero
  CameraRay sample_path(const CameraSample& sample, std::span<const double> nm, PathWavelength* found) const;

  /// @}
  /// @name Importance and connections from the scene
  /// @{

  /// Importance of a ray from the scene.
  ///
  /// The ray has its origin anywhere on its line and its direction of travel towards the lens. time, also in the calls
  /// below, is as in CameraSample. A pinhole has importance 0 and pdf_importance() 0: only connections find a pinhole.
  Importance importance(const Ray<double>& ray, Wavelength wavelength = {}, double time = 0) const;
  /// Importance of N rays; faster than single calls and equal up to rounding. times: N values, or null for 0.
  void importance(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                  Importance* found, const double* times = nullptr) const;
  /// Samples a connection from a scene point to the part of the entrance pupil that the point sees.
  ///
  /// point: lens frame, mm. u, v: in the unit square.
  ImportanceSample sample_importance(const Vec3<double>& point, double u, double v, Wavelength wavelength = {},
                                     double time = 0) const;
  /// Samples N connections; faster than single calls and equal up to rounding. times: N values, or null for 0.
  void sample_importance(std::size_t count, const Vec3<double>* points, const double* u, const double* v,
                         const RayWavelengths& wavelengths, ImportanceSample* found,
                         const double* times = nullptr) const;
  /// Samples a connection with light from infinity: the sun or an environment.
  ///
  /// The mean of E We / pdf is the mean irradiance of the film for light of irradiance E perpendicular to the
  /// direction.
  ///
  /// direction: unit direction of travel, towards the lens. In the result, the distance is infinite and pdf is the
  /// density of the ray's position in a plane perpendicular to the direction (1/mm^2).
  ImportanceSample sample_distant_importance(const Vec3<double>& direction, double u, double v,
                                             Wavelength wavelength = {}, double time = 0) const;
  /// Density with which sample_importance() samples a direction at a point (1/sr); equal at all times. 0 if the ray is
  /// invalid (Importance::fate).
  double pdf_importance(const Vec3<double>& point, const Vec3<double>& direction, Wavelength wavelength = {}) const;
  /// Density with which sample_distant_importance() samples a ray among all rays of its direction, in a plane
  /// perpendicular to it (1/mm^2). ray: any point of the line, and the direction of travel.
  double pdf_distant_importance(const Ray<double>& ray, Wavelength wavelength = {}) const;

  /// @}
  /// @name Queries
  /// @{

  /// Projects a scene point: film point and raster position of its chief ray. no_ray if the wavelength is outside
  /// the compiled range.
  Projection project(const Vec3<double>& point, Wavelength wavelength = {}, double time = 0) const;

  /// Largest error of the transmittances in the weights, relative to all light; 0 without CameraOptions::transmission.
  ///
  /// Exact models find the transmittance surface by surface: the error is that of polynomials in the angle of
  /// incidence. Other models use a polynomial in film and pupil position, fitted to exact rays; the error is the
  /// largest at rays that the fit does not use. Rays that the lens does not pass may differ more.
  double transmission_error() const noexcept;

  /// Largest steepness of the focal surface and the film offsets over the film; 0 without them.
  ///
  /// The steepness at a film point is the relative decrease of the distance between rays of neighbouring film points
  /// through the rim of the pupil. Below 1, every ray of the scene has one film point.
  ///
  /// Evaluated at 96 x 64 film points as the shutter opens; narrower folds may be missed.
  ///
  /// Limitations: for a steepness of 1 or more, rays of several film points coincide. Film samples stay correct.
  /// Importance, connections and projections find only one of these film points, or no film point if the surface
  /// inverts the order of the rays, so that light tracing is too dark: trace paths from the film.
  ///
  /// @param film_point  receives the film point, unless null
  double focal_steepness(FilmPoint* film_point = nullptr) const noexcept;

  /// @}

 private:
  friend struct CameraAccess;
  struct Data;
  explicit Camera(std::shared_ptr<const Data> data) noexcept;
  std::shared_ptr<const Data> data_;
};

/// The table of a camera for petzval/petzval_camera.h: one array of floats, in the layout of lib/docs/camera_table.md.
///
/// @param camera  a camera with exact rays or polynomials, an upright film and a pupil without weights
/// @throws Error  if the film is tilted or travels, if the camera has weights of the pupil, a focal surface or an
///                expressive lens, if it has transmission, or if the model is of first order
///
/// Limitations: tables of polynomials have only the compiled wavelengths.
PETZVAL_API std::vector<float> camera_table(const Camera& camera);

/// Renderers whose camera frames are known.
enum class Host : std::uint8_t { pbrt, mitsuba, cycles, arnold, appleseed };

/// Converts between the lens frame in mm and a host's camera frame in its unit of length.
///
/// A point (x, y, z) of the lens frame becomes (x, y, -z) for pbrt and Cycles (left-handed, +x right, +y up, view along
/// +z), and (-x, y, -z) for Mitsuba (right-handed, +x left, +y up, view along +z). Arnold and appleseed look along -z,
/// like the lens frame. Default units per mm: 0.001 for metres (pbrt, Mitsuba, Cycles, appleseed), 0.1 for centimetres
/// (Arnold).
class PETZVAL_API HostFrame {
 public:
  /// @throws Error  if the origin is an entrance pupil at infinity, or units_per_mm is not from 1e-15 to 1e15
  HostFrame(Host host, const Lens& lens, DistanceOrigin origin);
  HostFrame(Host host, const Lens& lens, DistanceOrigin origin, double units_per_mm);

  double units_per_mm() const noexcept { return units_per_mm_; }
  Vec3<double> point_to_host(const Vec3<double>& lens_mm) const noexcept;
  Vec3<double> point_to_lens(const Vec3<double>& host) const noexcept;
  Vec3<double> direction_to_host(const Vec3<double>& lens) const noexcept;
  Vec3<double> direction_to_lens(const Vec3<double>& host) const noexcept;
  Ray<double> to_host(const Ray<double>& lens) const noexcept;
  Ray<double> to_lens(const Ray<double>& host) const noexcept;

 private:
  Vec3<double> signs_{1, 1, 1};
  double origin_z_ = 0, units_per_mm_ = 1;
};

}  // namespace petzval
