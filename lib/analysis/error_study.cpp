// SPDX-License-Identifier: Apache-2.0
#include "error_study.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"

namespace petzval::analysis_detail {
namespace {

constexpr std::size_t block = 8;  // film points per task of a thread

/// Largest extent of the hits in 16 directions: the diameter within 0.5 %.
double diameter(const PointRays& rays, const SceneView& view) {
  constexpr int directions = 16;
  static const auto units = [] {
    std::array<std::array<double, 2>, directions> result;
    for (int k = 0; k < directions; ++k) {
      const double angle = std::numbers::pi * k / directions;
      result[k] = {std::cos(angle), std::sin(angle)};
    }
    return result;
  }();
  std::array<double, directions> least, most;
  least.fill(std::numeric_limits<double>::infinity());
  most.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < lines_per_point; ++i) {
    if (!rays.passes[i]) continue;
    const Vec2<double> position = view.position(rays.rays[i]);
    for (int k = 0; k < directions; ++k) {
      const double along = position.x * units[k][0] + position.y * units[k][1];
      least[k] = along < least[k] ? along : least[k];
      most[k] = along > most[k] ? along : most[k];
    }
  }
  double largest = 0;
  for (int k = 0; k < directions; ++k) largest = std::max(largest, most[k] - least[k]);
  return largest;
}

/// Computes RMS and 99th percentile. Reorders the errors.
void summarise(std::vector<double>& errors, double pixel_mm, RayErrors& result) {
  if (!errors.empty()) {
    const double sum =
        std::transform_reduce(errors.begin(), errors.end(), 0.0, std::plus(), [](double e) { return e * e; });
    result.rms_mm = std::sqrt(sum / static_cast<double>(errors.size()));
    const auto position = errors.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), position, errors.end());
    result.p99_mm = *position;
  }
  result.rms_px = result.rms_mm / pixel_mm;
  result.p99_px = result.p99_mm / pixel_mm;
  result.max_px = result.max_mm / pixel_mm;
}

}  // namespace

std::vector<std::size_t> wavelengths_of(const Lens& lens, const ErrorSamples& samples) {
  std::vector<std::size_t> result;
  for (const std::size_t w : samples.wavelengths) {
    if (std::ranges::find(result, w) == result.end()) result.push_back(w);
  }
  if (result.empty()) {
    result.resize(lens.wavelengths_nm().size());
    std::iota(result.begin(), result.end(), std::size_t{0});
  }
  for (const std::size_t w : result) {
    if (w < lens.wavelengths_nm().size()) continue;
    throw Error(lens.name() + ": model error: wavelength index = " + std::to_string(w) + "; must be one of the " +
                std::to_string(lens.wavelengths_nm().size()) + " compiled wavelengths");
  }
  return result;
}

/// The errors of one film point and wavelength.
struct RayStudy::Errors {
  double mm = 0, of_blur = 0;
  std::size_t rays = 0;
  std::vector<double> of_tolerance, even;
};

RayStudy::RayStudy(const camera_detail::ExactModel<double>& exact, const Film& film, const ErrorSamples& samples,
                   std::span<const Tolerance> tolerances)
    : exact_(&exact),
      film_(film),
      samples_(samples),
      tolerances_(tolerances.begin(), tolerances.end()),
      wavelengths_(wavelengths_of(exact.lens(), samples)) {
  const Lens& lens = exact.lens();
  constexpr std::size_t most_points = std::size_t{1} << 20;
  if (samples.film_points < 1 || samples.film_points > most_points) {
    throw Error(lens.name() + ": model error: film_points = " + std::to_string(samples.film_points) +
                "; must be 1 to " + std::to_string(most_points));
  }
  if (samples.depths_z.empty()) throw Error(lens.name() + ": model error: no depths; must be at least one");
  for (const double z : samples.depths_z) {
    if (z < 0) continue;
    throw Error(lens.name() + ": model error: depth z = " + to_text(z) + " mm; must be below 0 (in front of the lens)");
  }
  if (const auto& range = samples.sharpest_between_z; range && !(range->at(0) < 0 && range->at(1) < 0)) {
    throw Error(lens.name() + ": model error: sharpest_between_z = " + to_text(range->at(0)) + ", " +
                to_text(range->at(1)) + " mm; both must be below 0 (in front of the lens)");
  }
  const ChiefRays chief_rays(lens, exact.pupils().space());
  const Tracing trace = tracing(exact);
  for (const std::size_t wavelength : wavelengths_) {
    std::vector<Point>& points = points_.emplace_back();
    const double lit = lit_radius(exact, film, wavelength);
    for (std::size_t k = 0; k < samples.film_points; ++k) {
      const FilmPoint at = error_film_point(film, k, samples.seed, lit);
      if (exact.pupils().area(at, wavelength) > 0) points.push_back({k, PointLines(at)});
    }
    parallel_for(points.size(), block, samples.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Point& point = points[k];
        const FilmPoint at = point.lines.film;
        point.lines = error_lines(at, exact, wavelength, seed_of(point, 0));
        trace(point.lines, wavelength, point.exact);
        point.chief = chief_rays.through(at, exact.pupils().middle(at, wavelength), wavelength);
        look(point);
      }
    });
    const bool light = std::ranges::any_of(
        points, [](const Point& p) { return std::ranges::any_of(p.exact.passes, std::identity()); });
    if (!light)
      throw Error(lens.name() + ": model error: no ray from the film passes the lens; light must reach the film");
  }
}

std::uint64_t RayStudy::seed_of(const Point& point, std::uint64_t look) const noexcept {
  return (std::uint64_t{samples_.seed} << 32) + (look << 24) + point.index;
}

RayStudy::Largest RayStudy::largest(const Measurement& found, const Tracing& model) const {
  constexpr std::size_t worst_count = 8, repetitions = 16;
  Largest result{found.all.max_mm, found.all.max_of_blur, {}};
  std::vector<bool> looked_at(samples_.film_points);
  const auto look_at_worst = [&](const std::vector<double>& maxima) {
    std::vector<std::size_t> order(maxima.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(worst_count, order.size()));
    std::partial_sort(order.begin(), end, order.end(),
                      [&](std::size_t a, std::size_t b) { return maxima[a] > maxima[b]; });
    for (auto k = order.begin(); k != end; ++k) looked_at[*k] = true;
    return std::ranges::max(maxima);
  };
  look_at_worst(found.mm);
  look_at_worst(found.of_blur);
  for (const auto& maxima : found.of_tolerance) result.of_tolerance.push_back(look_at_worst(maxima));

  const Tracing trace = tracing(*exact_);
  for (std::size_t w = 0; w < points_.size(); ++w) {
    std::vector<const Point*> points;
    for (const Point& point : points_[w]) {
      if (looked_at[point.index]) points.push_back(&point);
    }
    std::vector<Errors> errors(points.size() * repetitions);
    parallel_for(errors.size(), block, samples_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Point point = *points[k / repetitions];
        point.lines = error_lines(point.lines.film, *exact_, wavelengths_[w], seed_of(point, 1 + k % repetitions));
        trace(point.lines, wavelengths_[w], point.exact);
        errors[k] = errors_of(point, model, wavelengths_[w]);
      }
    });
    for (const Errors& e : errors) {
      result.mm = std::max(result.mm, e.mm);
      result.of_blur = std::max(result.of_blur, e.of_blur);
      for (std::size_t t = 0; t < tolerances_.size(); ++t) {
        result.of_tolerance[t] = std::max(result.of_tolerance[t], e.of_tolerance[t]);
      }
    }
  }
  return result;
}

RayStudy RayStudy::chief_rays() const {
  RayStudy result = *this;
  for (std::vector<Point>& points : result.points_) {
    for (Point& point : points) {
      point.exact.passes.fill(false);
      point.exact.passes[0] = point.chief.found;
      point.exact.rays[0] = point.chief.ray;
      point.lines.put(0, point.chief.pupil[0], point.chief.pupil[1]);
    }
  }
  return result;
}

void RayStudy::look(Point& point) const {
  const auto add = [&](double z) {
    point.views.push_back(point.chief.view(z));
    point.blur.push_back(diameter(point.exact, point.views.back()));
  };
  for (const double z : samples_.depths_z) add(z);
  if (!samples_.sharpest_between_z) return;

  // A spot has one waist: sample the complete range, equally spaced in 1/distance, then refine around the minimum.
  const double film_z = exact_->pupils().space().film_z;
  const auto& [z0, z1] = *samples_.sharpest_between_z;
  double from = 1 / (film_z - z0), to = 1 / (film_z - z1);
  const auto z_of = [&](double t) { return film_z - 1 / t; };
  double best = from, least = std::numeric_limits<double>::infinity();
  for (int round = 0, steps = 12; round < 5; ++round, steps = 6) {
    const double first = from, step = (to - from) / steps;
    for (int k = 0; k <= steps; ++k) {
      const double t = k == steps ? to : first + k * step;
      const double blur = diameter(point.exact, point.chief.view(z_of(t)));
      if (blur < least) least = blur, best = t;
    }
    const double low = std::min(first, to), high = std::max(first, to);
    from = std::clamp(best - std::abs(step), low, high);
    to = std::clamp(best + std::abs(step), low, high);
  }
  add(z_of(best));
}

RayStudy::Errors RayStudy::errors_of(const Point& point, const Tracing& model, std::size_t wavelength) const {
  PointRays rays;
  model(point.lines, wavelength, rays);
  Errors found;
  found.of_tolerance.resize(tolerances_.size());
  // If no line passes both the model and the lens, the model is compared along the lines of the lens. Otherwise the
  // worst models would have no errors.
  bool common = false;
  for (std::size_t i = 0; i < lines_per_point; ++i) common = common || (point.exact.passes[i] && rays.passes[i]);
  const auto& counts = common ? rays.passes : rays.reaches;
  for (std::size_t i = 0; i < lines_per_point; ++i) {
    if (!point.exact.passes[i] || !counts[i]) continue;
    ++found.rays;
    for (std::size_t d = 0; d < point.blur.size(); ++d) {
      const double error = point.views[d].distance(point.exact.rays[i], rays.rays[i]);
      if (d < samples_.depths_z.size() && i < uniform_lines && is_uniform(point.index)) found.even.push_back(error);
      if (error == 0) continue;  // avoids 0 / 0 if there is no blur
      found.mm = std::max(found.mm, error);
      found.of_blur = std::max(found.of_blur, error / point.blur[d]);
      for (std::size_t t = 0; t < tolerances_.size(); ++t) {
        const double allowed = std::max(tolerances_[t].mm, tolerances_[t].of_blur * point.blur[d]);
        found.of_tolerance[t] = std::max(found.of_tolerance[t], error / allowed);
      }
    }
  }
  return found;
}

RayStudy::Measurement RayStudy::measure(const Tracing& model) const {
  const std::size_t film_points = samples_.film_points;
  Measurement found{{}, {}, std::vector<double>(film_points), std::vector<double>(film_points), {}};
  found.of_tolerance.assign(tolerances_.size(), std::vector<double>(film_points));
  std::vector<double> all_uniform;
  for (std::size_t w = 0; w < points_.size(); ++w) {
    const std::vector<Point>& points = points_[w];
    std::vector<Errors> errors(points.size());
    parallel_for(points.size(), block, samples_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) errors[k] = errors_of(points[k], model, wavelengths_[w]);
    });

    RayErrors& here = found.wavelength.emplace_back();
    std::vector<double> even;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::size_t at = points[k].index;
      found.mm[at] = std::max(found.mm[at], errors[k].mm);
      found.of_blur[at] = std::max(found.of_blur[at], errors[k].of_blur);
      for (std::size_t t = 0; t < tolerances_.size(); ++t) {
        found.of_tolerance[t][at] = std::max(found.of_tolerance[t][at], errors[k].of_tolerance[t]);
      }
      here.max_mm = std::max(here.max_mm, errors[k].mm);
      here.max_of_blur = std::max(here.max_of_blur, errors[k].of_blur);
      here.rays += errors[k].rays;
      even.insert(even.end(), errors[k].even.begin(), errors[k].even.end());
    }
    summarise(even, film_.pixel_mm(), here);
    all_uniform.insert(all_uniform.end(), even.begin(), even.end());
    found.all.max_mm = std::max(found.all.max_mm, here.max_mm);
    found.all.max_of_blur = std::max(found.all.max_of_blur, here.max_of_blur);
    found.all.rays += here.rays;
  }
  summarise(all_uniform, film_.pixel_mm(), found.all);
  return found;
}

}  // namespace petzval::analysis_detail
