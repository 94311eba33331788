// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/camera.hpp"

#include <array>

#include "camera_data.hpp"
#include "check_film.hpp"
#include "core/low_discrepancy.hpp"
#include "petzval/camera/sample_rays.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"
#include "tilted_pinhole.hpp"

namespace petzval::inline v0 {
namespace {

/// A model that somebody else built has to be one of this lens and film, as far as can be told.
void check_model(const Lens& lens, const Film& film, ModelKind kind, const FilmPupilTable& pupils) {
  if (!lens.iris().round() && kind < ModelKind::exact_float) {
    throw Error(lens.name() + ": camera: " + std::string(name(kind)) +
                " does not see the edges of the iris, wanted an exact model");
  }
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  if (pupils.wavelengths() != wavelengths) {
    throw Error(lens.name() + ": camera: the model is one for " + std::to_string(pupils.wavelengths()) +
                " wavelengths, wanted the lens's " + std::to_string(wavelengths));
  }
  constexpr double near = 1e-6;  // mm
  if (!(std::abs(pupils.space().film_z - lens.film_z()) <= near)) {
    throw Error(lens.name() + ": camera: the model has its film at z = " + number(pupils.space().film_z) +
                " mm, wanted the lens's, " + number(lens.film_z()) + " mm");
  }
  constexpr double rounding = 1e-9;
  const double radius = upright_radius(lens, film, kind);
  if (!(radius <= pupils.film_radius() * (1 + rounding))) {
    throw Error(lens.name() + ": camera: the model is one for film points up to " + number(pupils.film_radius()) +
                " mm from the axis, wanted " + number(radius) + " mm or more");
  }
}

/// One sample by the batch call, of an upright or a tilted film.
CameraRay one(const auto& model, const auto& film, const double* scale, const CameraSample& s) noexcept {
  CameraRay out;
  auto& [o, d] = out.ray;
  const auto wavelength = RayWavelengths{.all = s.wavelength};
  sample_rays<std::decay_t<decltype(model)>, double>(
      model, film, scale, 1, {&s.film.x, &s.film.y, &s.pupil_u, &s.pupil_v, wavelength},
      {{&o.x, &o.y, &o.z, &d.x, &d.y, &d.z}, &out.weight, &out.fate, &out.pdf_pupil, &out.pdf_direction});
  return out;
}

/// Mean weight on the axis, by samples each of which has a v of its own: a grid has so few that the pupil's edge, which
/// passes between two of them all around, would decide by steps.
double on_axis(const auto& model, const auto& film, std::size_t wavelength) {
  constexpr std::size_t count = 4096;
  const std::vector<double> unit(wavelength + 1, 1);
  const std::vector<double> zero(count, 0);
  std::vector<double> u, v;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [at_u, at_v] = core_detail::fibonacci_point(i, count);
    u.push_back(at_u), v.push_back(at_v);
  }
  std::array<std::vector<double>, 7> out;
  for (auto& values : out) values.resize(count);
  const auto at = [&](std::size_t k) { return out[k].data(); };
  sample_rays<std::decay_t<decltype(model)>, double>(
      model, film, unit.data(), count, {zero.data(), zero.data(), u.data(), v.data(), {.all = wavelength}},
      {{at(0), at(1), at(2), at(3), at(4), at(5)}, at(6)});
  double sum = 0;
  for (const double weight : out[6]) sum += weight;
  return sum / count;
}

std::vector<double> scales(const Lens& lens, const Film& film, const AnyModel& model, Normalisation normalisation) {
  std::vector<double> result;
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  if (normalisation == Normalisation::irradiance) {
    for (std::size_t w = 0; w < wavelengths; ++w) {
      const double index = lens.index(lens.surface_count(), w);
      result.push_back(index * index);
    }
    return result;
  }
  // A film of its own, for shifted ones are beside the axis: small, for no more than its middle matters.
  constexpr double part = 1. / 1024;
  const Film about{.width_mm = part * film.width_mm,
                   .height_mm = part * film.height_mm,
                   .tilt_rad = film.tilt_rad,
                   .swing_rad = film.swing_rad};
  std::optional<TiltedFilm> tilted;
  if (film.tilted()) tilted.emplace(about, film_pupil_table_of(model));
  for (std::size_t w = 0; w < wavelengths; ++w) {
    const double axis =
        std::visit([&](const auto& m) { return tilted ? on_axis(m, *tilted, w) : on_axis(m, about, w); }, model);
    if (!(axis > 0)) {
      throw Error(lens.name() + ": camera: the axis is dark, wanted light there for weights that are unity on it");
    }
    result.push_back(1 / axis);
  }
  return result;
}

}  // namespace

Camera::Camera(const Lens& given_lens, const Film& given_film, const CameraOptions& options) {
  const auto [lens, film] = camera_detail::placed(given_lens, given_film);
  camera_detail::check_film(lens, film);
  AnyModel model = make_model(options.model, lens, upright_radius(lens, film, options.model));
  *this = Camera(lens, film, std::move(model), options.normalisation);
}

Camera::Camera(const Lens& given_lens, const Film& given_film, AnyModel model, Normalisation normalisation) {
  const auto [lens, film] = camera_detail::placed(given_lens, given_film);
  camera_detail::check_film(lens, film);
  const FilmPupilTable& pupils = film_pupil_table_of(model);
  check_model(lens, film, kind_of(model), pupils);
  std::optional<TiltedFilm> tilted;
  if (film.tilted()) tilted.emplace(film, pupils);
  std::vector<double> scale = scales(lens, film, model, normalisation);
  camera_detail::SceneSide scene(lens, film, std::move(tilted), model, scale);
  data_ = std::make_shared<const Data>(Data{lens, film, std::move(model), std::move(scale), std::move(scene)});
}

const Lens& Camera::lens() const noexcept { return data_->lens; }
const Film& Camera::film() const noexcept { return data_->film; }
ModelKind Camera::model() const noexcept { return kind_of(data_->model); }
const FilmPupilTable& Camera::pupils() const noexcept { return film_pupil_table_of(data_->model); }

const TiltedFilm* Camera::tilted_film() const noexcept { return data_->scene.tilted(); }

CameraRay Camera::sample(const CameraSample& sample) const noexcept {
  const Data& data = *data_;
  CameraRay ray = std::visit(
      [&](const auto& m) {
        const TiltedFilm* tilted = data.scene.tilted();
        return tilted ? one(m, *tilted, data.scale.data(), sample) : one(m, data.film, data.scale.data(), sample);
      },
      data.model);
  ray.pdf_film = data.film.contains(sample.film) ? 1 / data.film.area_mm2() : 0;
  return ray;
}

template <class T>
void Camera::sample(std::size_t count, const CameraSamples<T>& samples, const CameraRays<T>& rays) const noexcept {
  const Data& data = *data_;
  std::visit(
      [&](const auto& m) {
        if (const TiltedFilm* tilted = data.scene.tilted()) {
          sample_rays(m, *tilted, data.scale.data(), count, samples, rays);
        } else {
          sample_rays(m, data.film, data.scale.data(), count, samples, rays);
        }
      },
      data.model);
}

CameraRayDifferential Camera::sample_differential(const CameraSample& s) const noexcept {
  CameraRayDifferential result{sample(s)};
  if (!result.sample) return result;
  const std::size_t wavelength = lens().position(s.wavelength);
  const auto upright = [&]() -> TwoPlaneRayDerivatives {
    const PupilSample at = pupils().sample(s.film, s.pupil_u, s.pupil_v, wavelength);
    const auto [by_x, by_y] = pupils().derivatives(s.film, s.pupil_u, s.pupil_v, wavelength);
    return {{s.film.x, s.film.y, at.x, at.y}, {1, 0, by_x[0], by_x[1]}, {0, 1, by_y[0], by_y[1]}};
  };
  const auto* first_order = std::get_if<ParaxialModel>(&data_->model);
  const bool pinhole = first_order && !first_order->pinhole_shifts().empty();
  const TiltedFilm* tilted = data_->scene.tilted();
  const TwoPlaneRayDerivatives line =
      !tilted   ? upright()
      : pinhole ? camera_detail::pinhole_line(*tilted, s.film, first_order->pinhole_shifts()[wavelength])
                : tilted->line(s.film, s.pupil_u, s.pupil_v, wavelength);
  const auto moved = std::visit([&](const auto& m) { return m.to_scene(line, wavelength); }, data_->model);
  result.by_film_x = moved.by_u;
  result.by_film_y = moved.by_v;
  return result;
}

template PETZVAL_API void Camera::sample(std::size_t, const CameraSamples<float>&,
                                         const CameraRays<float>&) const noexcept;
template PETZVAL_API void Camera::sample(std::size_t, const CameraSamples<double>&,
                                         const CameraRays<double>&) const noexcept;

}  // namespace petzval::inline v0
