// SPDX-License-Identifier: Apache-2.0
#include "model_table.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "camera/check_film.hpp"
#include "camera/make_model.hpp"
#include "core/text.hpp"
#include "model_timing.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval::analysis_detail {
namespace {

constexpr std::size_t points_for_rays = 384, points_for_pupils = 40;

/// z of the planes in which a scene's rays are compared.
std::vector<double> depths_of(const Lens& lens, const SceneRequirements& scene) {
  const double film_z = lens.film_z(), from_z = origin_z(lens, scene.origin);
  if (!(scene.near_mm <= scene.far_mm) || !(from_z - scene.near_mm < 0)) {
    throw Error(lens.name() + ": choose_model: near_mm = " + to_text(scene.near_mm, 6) + ", far_mm = " +
                to_text(scene.far_mm, 6) + " from the " + std::string(name(scene.origin)) + "; must be more than " +
                to_text(std::max(from_z, 0.0), 6) + " mm, in front of the lens, and as far or farther");
  }
  const double nearest = scene.near_mm + (film_z - from_z), farthest = scene.far_mm + (film_z - from_z);
  // A finite plane, with nearly the same errors as planes at infinity, where errors are angles.
  const double last = std::isinf(farthest) ? 1e4 * nearest : farthest;
  constexpr int steps = 4;
  std::vector<double> distances;
  for (int k = 0; k <= steps; ++k) {
    distances.push_back(k == 0 ? nearest : k == steps ? last : steps / ((steps - k) / nearest + k / farthest));
  }
  if (std::isinf(farthest)) distances.push_back(farthest);
  const bool telecentric = std::isinf(pupils(lens, lens.primary_wavelength()).entrance.z);
  const FocusSolution focus = solve_subject(
      lens, film_z,
      {.criterion = telecentric ? FocusCriterion::paraxial : FocusCriterion::min_rms, .origin = DistanceOrigin::film});
  if (focus && focus.distance > nearest && focus.distance < farthest) distances.push_back(focus.distance);
  std::vector<double> depths;
  for (const double distance : distances) depths.push_back(film_z - distance);
  return depths;
}

/// The lens stopped down to the aperture of the scene, the samples, and the exact measurements.
struct Setting {
  Setting(const Lens& whole, const SceneRequirements& scene, std::span<const Tolerance> tolerances, int threads)
      : lens(scene.f_number ? with_f_number(whole, *scene.f_number, whole.primary_wavelength()) : whole),
        film(scene.film),
        samples{.depths_z = depths_of(lens, scene), .film_points = points_for_rays, .threads = threads},
        exact(lens, film.radius_mm()) {
    for (const double nm : scene.wavelengths_nm)
      samples.wavelengths.push_back(lens.wavelength_index(Wavelength::nm(nm)));
    samples.wavelengths = wavelengths_of(lens, samples);
    const bool blur = std::ranges::any_of(tolerances, [](const Tolerance& t) { return t.of_blur > 0; });
    const double from_z = origin_z(lens, scene.origin);
    if (blur) samples.sharpest_between_z = {from_z - scene.near_mm, from_z - scene.far_mm};
    rays.emplace(exact, film, samples, tolerances);
    pupils.emplace(exact, film, points_for_pupils, samples);
  }

  Lens lens;
  Film film;
  ErrorSamples samples;
  camera_detail::ExactModel<double> exact;
  std::optional<RayStudy> rays;
  std::optional<PupilStudy> pupils;
};

/// The bound for lines that were not sampled.
RayStudy::Largest guarded(RayStudy::Largest largest, std::span<const Tolerance> tolerances, double guard) {
  largest.mm *= guard;
  largest.of_blur *= std::max(guard, blur_guard);
  for (std::size_t t = 0; t < tolerances.size(); ++t) {
    largest.of_tolerance[t] *= tolerances[t].of_blur > 0 ? std::max(guard, blur_guard) : guard;
  }
  return largest;
}

RayStudy::Largest chief_ray_errors(const RayStudy& rays, std::span<const Tolerance> tolerances, const Tracing& model) {
  const RayStudy chief = rays.chief_rays();
  const auto found = chief.measure(model);
  RayStudy::Largest largest{found.all.max_mm, found.all.max_of_blur, {}};
  for (const auto& maxima : found.of_tolerance) largest.of_tolerance.push_back(std::ranges::max(maxima));
  return guarded(std::move(largest), tolerances, smooth_guard);
}

double focal_length(const Lens& lens) {
  const std::size_t wavelength = lens.primary_wavelength();
  return std::abs(first_order(lens, wavelength, main_meridian(lens, wavelength)).effective_focal_length);
}

/// The wavelength that represents several: the wavelength nearest to the d line.
std::size_t central_of(const Lens& lens, const std::vector<std::size_t>& wavelengths) {
  return *std::ranges::min_element(wavelengths, {},
                                   [&](std::size_t w) { return std::abs(lens.wavelengths_nm()[w] - d_line_nm); });
}

}  // namespace

ModelTable model_table(const Lens& given, const SceneRequirements& scene, std::span<const Tolerance> tolerances,
                       int threads) {
  const auto [whole, placed_film] = camera_detail::placed(given, scene.film);
  camera_detail::check_upright_film(whole, placed_film);
  const Setting setting(whole, scene, tolerances, threads);
  const Film& film = setting.film;
  const double rounding = std::numeric_limits<float>::epsilon() * focal_length(setting.lens);
  ModelTable table;
  table.without_transmission = transmission_error(setting.lens, film);
  std::vector<std::shared_ptr<const RayModel>> all;
  for (const ModelKind model : models()) {
    ModelCandidate& candidate = table.models.emplace_back();
    candidate.model = model;
    candidate.cost = cost(model, setting.lens);
    std::vector<double>& of_tolerance = table.of_tolerance.emplace_back();
    std::shared_ptr<const RayModel> built;
    const auto start = std::chrono::steady_clock::now();
    try {
      built = camera_detail::make_model(model, setting.lens, film.radius_mm());
    } catch (const Error& error) {
      candidate.available = false;
      candidate.remark = error.what();
      continue;
    }
    candidate.setup_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

    const Tracing traced = tracing(*built);
    const auto found = setting.rays->measure(traced);
    const auto rays = guarded(setting.rays->largest(found, traced), tolerances,
                              model == ModelKind::exact_float ? noise_guard : smooth_guard);
    const auto pupils = setting.pupils->measure(pupils_of(*built));
    candidate.error = {found.all, found.wavelength, pupils.shape, pupils.exposure, table.without_transmission};
    // Rounding in float adds noise to the smooth errors.
    candidate.bound_px = (rays.mm + (model == ModelKind::exact_double ? 0 : rounding)) / film.pixel_mm();
    candidate.bound_of_blur = rays.of_blur;
    // The exact model is the reference: its errors are 0 without uncertainty.
    candidate.bound_exposure = model == ModelKind::exact_double ? 0 : pupils.exposure_bound;
    candidate.bound_pupil_shape = model == ModelKind::exact_double ? 0 : pupils.shape_bound;
    of_tolerance = rays.of_tolerance;
    all.push_back(built);
    if (model == ModelKind::thick) table.no_distortion = chief_ray_errors(*setting.rays, tolerances, traced);
  }
  const std::vector<double> times = time_rays(all, film);
  for (std::size_t k = 0, next = 0; k < table.models.size(); ++k) {
    if (table.models[k].available) table.models[k].ns_per_ray = times[next++];
  }

  const ModelPupils pupils = pupils_of(setting.exact);
  const std::vector<std::size_t>& wavelengths = setting.samples.wavelengths;
  const std::size_t central = central_of(setting.lens, wavelengths);
  table.pixel_mm = film.pixel_mm();
  table.wavelengths = wavelengths.size();
  table.central_nm = setting.lens.wavelengths_nm()[central];
  if (wavelengths.size() > 1) {
    const Tracing one = [&](const PointLines& lines, std::size_t, PointRays& rays) {
      pupils.tracing(lines, central, rays);
    };
    table.one_wavelength = guarded(setting.rays->largest(setting.rays->measure(one), one), tolerances, smooth_guard);
  }
  // Every film point uses the pupil of the film centre.
  const FilmPoint middle{film.shift_x_mm, film.shift_y_mm};
  const Tracing from_middle = [&](const PointLines& lines, std::size_t w, PointRays& rays) {
    PointLines moved(middle);
    for (std::size_t i = 0; i < lines_per_point; ++i) moved.put(i, lines.pupil_x[i], lines.pupil_y[i]);
    pupils.tracing(moved, w, rays);
  };
  const ModelPupils constant{pupils.map, from_middle, from_middle, false, middle};
  table.constant_pupil_shape = setting.pupils->measure(constant).shape_bound;
  return table;
}

}  // namespace petzval::analysis_detail
