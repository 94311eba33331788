// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "camera_data.hpp"
#include "check_film.hpp"
#include "core/low_discrepancy.hpp"
#include "make_model.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

using camera_detail::FilmView;
using camera_detail::LensFacts;
using camera_detail::TiltedFilm;

/// Mean weight on the axis. Every sample has a different v. With the few values of v of a grid, the mean would change
/// in steps as the edge of the pupil crosses one of them.
double on_axis(const FilmView& view, std::size_t wavelength) {
  constexpr std::size_t count = 4096;
  const std::vector<double> zero(count, 0);
  std::vector<double> u, v;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [at_u, at_v] = core_detail::fibonacci_point(i, count);
    u.push_back(at_u), v.push_back(at_v);
  }
  std::array<std::vector<double>, 7> out;
  for (auto& values : out) values.resize(count);
  const auto at = [&](std::size_t k) { return out[k].data(); };
  camera_detail::sample_rays<double>(view, count, {zero.data(), zero.data(), u.data(), v.data(), {.all = wavelength}},
                                     {{at(0), at(1), at(2), at(3), at(4), at(5)}, at(6)});
  double sum = 0;
  for (const double weight : out[6]) sum += weight;
  return sum / count;
}

std::vector<double> scales(const Lens& lens, const Film& film, const RayModel& model,
                           const camera_detail::PupilWeights& weights, const camera_detail::Transmission& transmission,
                           Normalisation normalisation) {
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  std::vector<double> result;
  for (std::size_t w = 0; w < wavelengths; ++w) {
    const double index = lens.index(lens.surface_count(), w);
    result.push_back(index * index);
  }
  if (normalisation == Normalisation::irradiance) return result;

  // The film is small and centred on the axis, because a shifted film may not contain the axis.
  constexpr double film_scale = 1. / 1024;
  Film about = film;
  about.width_mm *= film_scale, about.height_mm *= film_scale;
  about.shift_x_mm = about.shift_y_mm = about.margin_mm = about.travel_mm = 0;
  std::optional<TiltedFilm> tilted;
  if (film.tilted()) tilted.emplace(about, model.pupils());  // at the time when the shutter opens
  const camera_detail::WavelengthFacts own(model, result);
  const FilmView view{model, about, tilted ? &*tilted : nullptr, own, weights, {}, {}, transmission};
  const auto light = [&](std::size_t wavelength) {
    const double axis = on_axis(view, wavelength);
    if (axis > 0) return axis;
    throw Error(lens.name() + ": camera: the axis is dark; must be lit for weights that are unity on the axis");
  };
  if (normalisation == Normalisation::unity_on_axis) {
    const double axis = light(lens.primary_wavelength());
    for (double& scale : result) scale /= axis;
    return result;
  }
  if (normalisation != Normalisation::unity_at_each_wavelength) {
    throw Error(lens.name() + ": camera: normalisation = " + std::to_string(static_cast<int>(normalisation)) +
                "; must be irradiance, unity_on_axis or unity_at_each_wavelength");
  }
  std::vector<double> each;
  for (std::size_t w = 0; w < wavelengths; ++w) each.push_back(result[w] / light(w));
  return each;
}

/// The wavelengths in nm if samples may lie between them, else an empty span.
std::span<const double> nm_of(const Lens& lens) {
  return std::isfinite(lens.index_error()) ? lens.wavelengths_nm() : std::span<const double>();
}

}  // namespace

Camera::Data::Data(const LensFacts& facts, const Film& placed, std::shared_ptr<const RayModel> made, double radius,
                   const CameraOptions& options)
    : lens(facts.lens()),
      film(placed),
      model_(std::move(made)),
      model(*model_),
      tilted(camera_detail::tilted_or_moving(placed)
                 ? std::optional(TiltedFilm(placed, model.pupils(), options.threads))
                 : std::nullopt),
      weights(lens, model, options.bokeh),
      transmission(options.transmission ? camera_detail::Transmission(lens, model) : camera_detail::Transmission()),
      wavelengths(model, scales(lens, film, model, weights, transmission, options.normalisation), nm_of(lens)),
      front(camera_detail::front_of(lens)),
      focus(facts, placed, model_, options.focal_surface, options.expressive),
      normalisation(options.normalisation),
      pdf_film(1 / film.area_mm2()),
      facts_(facts),
      radius_(radius),
      primary_(lens.primary_wavelength()),
      clamp_(options.clamp_wavelengths),
      shortest_nm_(std::ranges::min(lens.wavelengths_nm())),
      longest_nm_(std::ranges::max(lens.wavelengths_nm())),
      view_{model, film, tilted ? &*tilted : nullptr, wavelengths, weights, front, focus, transmission} {
  if (options.importance_tables) scene(options.threads);
}

Camera::Camera(const Lens& lens, const Film& film, const CameraOptions& options) {
  const int blades = options.bokeh.blades;
  const auto [placed_lens, placed_film] =
      camera_detail::placed(blades == 0 ? lens : with_iris(lens, {.blades = blades}), film);
  camera_detail::check_film(placed_lens, placed_film);
  const LensFacts facts(placed_lens);
  const double radius = camera_detail::upright_radius(facts, placed_film, options.model);
  const BokehControls& bokeh = options.bokeh;
  const double half = std::max(film.width_mm, film.height_mm) / 2;
  const auto rim =
      bokeh.vignettes() ? std::optional(PupilRim{bokeh.lens_ratio, bokeh.rate_of_change / half}) : std::nullopt;
  data_ = std::make_shared<const Data>(
      facts, placed_film,
      camera_detail::make_model(options.model, facts, radius, options.threads, rim, options.paraxial_focus), radius,
      options);
}

Camera::Camera(std::shared_ptr<const Data> data) noexcept : data_(std::move(data)) {}

const Lens& Camera::lens() const noexcept { return data_->lens; }
const Film& Camera::film() const noexcept { return data_->film; }
ModelKind Camera::model() const noexcept { return data_->model.kind(); }
Normalisation Camera::normalisation() const noexcept { return data_->normalisation; }

double Camera::transmission_error() const noexcept { return data_->transmission.error(); }

double Camera::focal_steepness(FilmPoint* film_point) const noexcept {
  if (!data_->focus) return {};
  return data_->focus.steepness(data_->tilted ? std::optional(data_->tilted->plane(0)) : std::nullopt, film_point);
}

CameraRay Camera::sample(const CameraSample& s) const noexcept {
  const Data& data = *data_;
  CameraRay ray =
      camera_detail::sample_ray(data.view(), s.film, s.pupil_u, s.pupil_v, data.resolved(s.wavelength), s.time);
  ray.pdf_film = ray.fate != RayFate::outside_film ? data.pdf_film : 0;
  return ray;
}

template <class T>
void Camera::sample(std::size_t count, const CameraSamples<T>& samples, const CameraRays<T>& rays) const noexcept {
  data_->in_range(count, samples.wavelengths, [&](std::size_t begin, std::size_t n, const RayWavelengths& own) {
    CameraSamples<T> block_samples = samples.from(begin);
    block_samples.wavelengths = own;
    camera_detail::sample_rays(data_->view(), n, block_samples, rays.from(begin));
  });
}

CameraRayDifferential Camera::sample_differential(const CameraSample& s) const noexcept {
  const Data& data = *data_;
  CameraRayDifferential result = camera_detail::sample_differential(data.view(), s.film, s.pupil_u, s.pupil_v,
                                                                    data.resolved(s.wavelength), s.time);
  result.sample.pdf_film = result.sample.fate != RayFate::outside_film ? data.pdf_film : 0;
  return result;
}

template <class T>
void Camera::sample_differentials(std::size_t count, const CameraSamples<T>& samples, const CameraRays<T>& rays,
                                  const RayArrays<T>& by_raster_x, const RayArrays<T>& by_raster_y) const noexcept {
  const auto put = [](const Ray<double>& ray, const RayArrays<T>& to, std::size_t i) {
    to.x[i] = static_cast<T>(ray.origin.x), to.dx[i] = static_cast<T>(ray.direction.x);
    to.y[i] = static_cast<T>(ray.origin.y), to.dy[i] = static_cast<T>(ray.direction.y);
    to.z[i] = static_cast<T>(ray.origin.z), to.dz[i] = static_cast<T>(ray.direction.z);
  };
  for (std::size_t i = 0; i < count; ++i) {
    const auto one = sample_differential({.film = {samples.film_x[i], samples.film_y[i]},
                                          .pupil_u = samples.pupil_u[i],
                                          .pupil_v = samples.pupil_v[i],
                                          .wavelength = samples.wavelengths.at(i),
                                          .time = samples.times ? samples.times[i] : 0});
    put(one.sample.ray, rays.rays, i);
    rays.weights[i] = static_cast<T>(one.sample.weight);
    if (rays.fates) rays.fates[i] = one.sample.fate;
    if (rays.pdf_pupil) rays.pdf_pupil[i] = static_cast<T>(one.sample.pdf_pupil);
    if (rays.pdf_direction) rays.pdf_direction[i] = static_cast<T>(one.sample.pdf_direction);
    const auto [by_x, by_y] = by_raster(one, film());
    put(by_x, by_raster_x, i);
    put(by_y, by_raster_y, i);
  }
}

std::array<Ray<double>, 2> by_raster(const CameraRayDifferential& ray, const Film& film) noexcept {
  const auto times = [](const Ray<double>& by, double mm) { return Ray<double>{by.origin * mm, by.direction * mm}; };
  return {times(ray.by_film_x, -film.width_mm / film.columns), times(ray.by_film_y, film.height_mm / film.rows)};
}

template PETZVAL_API void Camera::sample_differentials(std::size_t, const CameraSamples<float>&,
                                                       const CameraRays<float>&, const RayArrays<float>&,
                                                       const RayArrays<float>&) const noexcept;
template PETZVAL_API void Camera::sample_differentials(std::size_t, const CameraSamples<double>&,
                                                       const CameraRays<double>&, const RayArrays<double>&,
                                                       const RayArrays<double>&) const noexcept;
template PETZVAL_API void Camera::sample(std::size_t, const CameraSamples<float>&,
                                         const CameraRays<float>&) const noexcept;
template PETZVAL_API void Camera::sample(std::size_t, const CameraSamples<double>&,
                                         const CameraRays<double>&) const noexcept;

}  // namespace petzval
