// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "petzval/camera/camera.hpp"
#include "petzval/camera/model_kind.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval {

/// Requirements of a Camera on a ray model: the pupils to sample, and the map between image-space and scene rays.
///
/// An image-space ray is given by its points on the film and on the pupil plane (TwoPlanes). Calls must be const,
/// noexcept, thread-safe and free of allocations, and must write finite numbers for every ray; fates tell lost rays.
/// Wavelengths are positions, or also nm with any_wavelength; unknown wavelengths give missed_surface. Required:
///
///     pupils()      the pupils of the film points, up to upright_radius()
///     to_scene()    N image-space rays, float and double, to rays that leave the lens towards the scene
///     to_film()     N rays of the scene, given anywhere on their lines, to image-space rays
///
/// Optional members, with the default if absent:
///
///     static constexpr bool clips_at_apertures       false: a ray passes if pupils() contain it. true: only the fates
///                                                    decide, and pupils() contain all rays that pass
///     static constexpr bool linear_in_slopes         false: the model conserves etendue. true: it is linear in heights
///                                                    and slopes and conserves their area, like an ideal lens
///     static constexpr bool any_wavelength           false: samples at a wavelength in nm are lost. true: the model
///                                                    and its pupils accept wavelengths in nm
///     std::span<const double> pinhole_shifts()       empty. For a pinhole, one per wavelength: rays pass the pupil
///                                                    plane at pinhole_shift * film point
///     RayFate to_scene(TwoPlaneRay, wavelength,      a batch of one
///                      Ray<double>&)
///     RayDerivatives to_scene(TwoPlaneRayDerivatives,       central differences of to_scene()
///                             wavelength)
///                                                    wavelength: a position; with any_wavelength, a Wavelength
///     ModelKind kind()                               custom
template <class M>
concept RayModel = requires(const M& model, std::size_t count, const RayWavelengths& wavelengths, RayFate* fates,
                            const TwoPlaneRays<const float>& film_rays, const RayArrays<float>& rays,
                            const TwoPlaneRays<const double>& exact_film_rays, const RayArrays<double>& exact_rays,
                            const RayArrays<const double>& scene_rays, const TwoPlaneRays<double>& to_film) {
  { model.pupils() }
  noexcept->std::same_as<const FilmPupilTable&>;
  { model.to_scene(count, film_rays, wavelengths, rays, fates) }
  noexcept;
  { model.to_scene(count, exact_film_rays, wavelengths, exact_rays, fates) }
  noexcept;
  { model.to_film(count, scene_rays, wavelengths, to_film, fates) }
  noexcept;
};

/// Radius up to which the pupils of a model are needed (mm): distance from the axis at which the rays of the film's
/// points meet the plane of the upright film. For an upright film, Film::radius_mm().
///
/// @throws Error  if the film is no rectangle or tilted by 90 degrees or more, or if a tilted film comes near the pupil
///                plane or the pupil of a first-order model (thin: the rear principal plane)
PETZVAL_API double upright_radius(const Lens& lens, const Film& film, ModelKind model = ModelKind::custom);

/// Any RayModel, type-erased for a Camera.
///
///     struct MyModel { ... };
///     const Camera camera = camera_with(lens, film, AnyRayModel(MyModel(lens, upright_radius(lens, film))));
///
/// Immutable, cheap to copy (copies share the model), thread-safe. One virtual call per batch.
class AnyRayModel {
 public:
  /// Copies. Moves also copy, so that an AnyRayModel is never empty.
  AnyRayModel(const AnyRayModel&) = default;
  AnyRayModel& operator=(const AnyRayModel&) = default;

  template <class M>
    requires(!std::same_as<M, AnyRayModel> && RayModel<M>)
  AnyRayModel(M model) : model_(std::make_shared<const Held<M>>(std::move(model))) {}

  /// The model if it has the type M, else null.
  template <class M>
  const M* as() const noexcept {
    const auto* const held = dynamic_cast<const Held<M>*>(model_.get());
    return held ? &held->model : nullptr;
  }

  ModelKind kind() const noexcept { return model_->kind; }
  bool clips_at_apertures() const noexcept { return model_->clips_at_apertures; }
  bool linear_in_slopes() const noexcept { return model_->linear_in_slopes; }
  bool any_wavelength() const noexcept { return model_->any_wavelength; }
  std::span<const double> pinhole_shifts() const noexcept { return model_->pinhole_shifts; }
  bool pinhole() const noexcept { return !pinhole_shifts().empty(); }

  const FilmPupilTable& pupils() const noexcept { return *model_->pupils; }
  template <class T>
  void to_scene(std::size_t count, const TwoPlaneRays<const T>& film_rays, const RayWavelengths& wavelengths,
                const RayArrays<T>& rays, RayFate* fates) const noexcept {
    model_->to_scene(count, film_rays, wavelengths, rays, fates);
  }
  RayFate to_scene(const TwoPlaneRay& film_ray, Wavelength wavelength, Ray<double>& ray) const noexcept {
    return model_->to_scene(film_ray, wavelength, ray);
  }
  RayDerivatives to_scene(const TwoPlaneRayDerivatives& film_ray, Wavelength wavelength) const noexcept {
    return model_->to_scene(film_ray, wavelength);
  }
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
               const TwoPlaneRays<double>& film_rays, RayFate* fates) const noexcept {
    model_->to_film(count, rays, wavelengths, film_rays, fates);
  }

 private:
  struct Interface {
    ModelKind kind = ModelKind::custom;
    bool clips_at_apertures = false, linear_in_slopes = false, any_wavelength = false;
    const FilmPupilTable* pupils = nullptr;  ///< owned by the model
    std::span<const double> pinhole_shifts;

    virtual ~Interface() = default;
    virtual void to_scene(std::size_t, const TwoPlaneRays<const float>&, const RayWavelengths&, const RayArrays<float>&,
                          RayFate*) const noexcept = 0;
    virtual void to_scene(std::size_t, const TwoPlaneRays<const double>&, const RayWavelengths&,
                          const RayArrays<double>&, RayFate*) const noexcept = 0;
    virtual void to_film(std::size_t, const RayArrays<const double>&, const RayWavelengths&,
                         const TwoPlaneRays<double>&, RayFate*) const noexcept = 0;
    virtual RayFate to_scene(const TwoPlaneRay&, Wavelength, Ray<double>&) const noexcept = 0;
    virtual RayDerivatives to_scene(const TwoPlaneRayDerivatives&, Wavelength) const noexcept = 0;

    std::size_t position(Wavelength wavelength) const noexcept {
      return wavelength.position(pupils->primary_wavelength());
    }
    /// Defaults for models without the optional members.
    PETZVAL_API RayFate batch_of_one(const TwoPlaneRay&, Wavelength, Ray<double>&) const noexcept;
    PETZVAL_API RayDerivatives differences(const TwoPlaneRayDerivatives&, Wavelength) const noexcept;
  };

  template <class M>
  struct Held final : Interface {
    M model;

    explicit Held(M held) : model(std::move(held)) {
      this->pupils = &std::as_const(model).pupils();
      if constexpr (requires { model.kind(); }) this->kind = model.kind();
      if constexpr (requires { model.pinhole_shifts(); }) this->pinhole_shifts = model.pinhole_shifts();
      if constexpr (requires { M::clips_at_apertures; }) this->clips_at_apertures = M::clips_at_apertures;
      if constexpr (requires { M::linear_in_slopes; }) this->linear_in_slopes = M::linear_in_slopes;
      if constexpr (requires { M::any_wavelength; }) this->any_wavelength = M::any_wavelength;
    }
    void to_scene(std::size_t count, const TwoPlaneRays<const float>& film_rays, const RayWavelengths& wavelengths,
                  const RayArrays<float>& rays, RayFate* fates) const noexcept override {
      model.to_scene(count, film_rays, wavelengths, rays, fates);
    }
    void to_scene(std::size_t count, const TwoPlaneRays<const double>& film_rays, const RayWavelengths& wavelengths,
                  const RayArrays<double>& rays, RayFate* fates) const noexcept override {
      model.to_scene(count, film_rays, wavelengths, rays, fates);
    }
    void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                 const TwoPlaneRays<double>& film_rays, RayFate* fates) const noexcept override {
      model.to_film(count, rays, wavelengths, film_rays, fates);
    }
    RayFate to_scene(const TwoPlaneRay& film_ray, Wavelength wavelength, Ray<double>& ray) const noexcept override {
      if constexpr (requires {
                      { model.to_scene(film_ray, wavelength, ray) } -> std::same_as<RayFate>;
                    }) {
        return model.to_scene(film_ray, wavelength, ray);
      } else if constexpr (requires {
                             { model.to_scene(film_ray, std::size_t{}, ray) } -> std::same_as<RayFate>;
                           }) {
        return model.to_scene(film_ray, this->position(wavelength), ray);
      } else {
        return this->batch_of_one(film_ray, wavelength, ray);
      }
    }
    RayDerivatives to_scene(const TwoPlaneRayDerivatives& film_ray, Wavelength wavelength) const noexcept override {
      if constexpr (requires {
                      { model.to_scene(film_ray, wavelength) } -> std::same_as<RayDerivatives>;
                    }) {
        return model.to_scene(film_ray, wavelength);
      } else if constexpr (requires {
                             { model.to_scene(film_ray, std::size_t{}) } -> std::same_as<RayDerivatives>;
                           }) {
        return model.to_scene(film_ray, this->position(wavelength));
      } else {
        return this->differences(film_ray, wavelength);
      }
    }
  };

  std::shared_ptr<const Interface> model_;
};

/// A camera with a given model: a model of the caller, or polynomials from a file.
///
/// @throws Error  if the constructor of Camera does; if the model has other wavelengths or another film position; if
/// its
///                pupils or polynomials end within upright_radius(); if the number of blades, lens_ratio or
///                rate_of_change differ from the default, because the pupils of a given model cannot follow them
PETZVAL_API Camera camera_with(const Lens& lens, const Film& film, const AnyRayModel& model,
                               Normalisation normalisation = Normalisation::irradiance,
                               const BokehControls& bokeh = {});

}  // namespace petzval
