// SPDX-License-Identifier: Apache-2.0
#include "pupil_study.hpp"

#include <algorithm>
#include <cmath>

#include "core/low_discrepancy.hpp"
#include "error_study.hpp"
#include "petzval/core/parallel.hpp"

namespace petzval::analysis_detail {
namespace {

constexpr std::size_t blocks = 64;  // of lines, per pupil

/// Calls use(block, lines, areas) for blocks of lines through a pupil, with the area that each line represents.
template <class Use>
void for_lines(const ModelPupils& pupils, const FilmPoint& film, std::size_t wavelength,
               const core_detail::Kronecker<2>& even, Use use) {
  const FilmPoint of = pupils.of.value_or(film);
  std::array<double, lines_per_point> film_x, film_y, u, v, areas;
  film_x.fill(of.x), film_y.fill(of.y);
  PointLines lines(film);
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t i = 0; i < lines_per_point; ++i) {
      const auto [at_u, at_v] = even(b * lines_per_point + i);
      u[i] = at_u, v[i] = at_v;
    }
    pupils.map.sample(lines_per_point, film_x.data(), film_y.data(), u.data(), v.data(), {.all = wavelength}, u.data(),
                      v.data(), areas.data());
    for (std::size_t i = 0; i < lines_per_point; ++i) lines.put(i, u[i], v[i]);
    use(b, lines, areas);
  }
}

constexpr double total = blocks * lines_per_point;

core_detail::Kronecker<2> uniform_points(const ErrorSamples& samples, std::size_t index) noexcept {
  return core_detail::Kronecker<2>((std::uint64_t{samples.seed} << 32 | index) + 0x5bd1e995);
}

}  // namespace

ModelPupils pupils_of(const RayModel& model) {
  return {model.pupils(), tracing_within(model), tracing(model), model.pinhole(), {}};
}

/// Contribution of a line to the irradiance of its film point, per area of the pupil: cos^4 / depth^2.
double PupilStudy::weight(const PointLines& lines, std::size_t line) const noexcept {
  const double x = lines.pupil_x[line] - lines.film.x, y = lines.pupil_y[line] - lines.film.y;
  const double squared = x * x + y * y + depth_ * depth_;
  return depth_ * depth_ / (squared * squared);
}

PupilStudy::PupilStudy(const camera_detail::ExactModel<double>& exact, const Film& film, std::size_t film_points,
                       const ErrorSamples& samples)
    : samples_(samples),
      exact_(pupils_of(exact)),
      depth_(exact.pupils().space().depth()),
      wavelengths_(wavelengths_of(exact.lens(), samples)) {
  for (const std::size_t wavelength : wavelengths_) {
    std::vector<Point>& points = points_.emplace_back();
    for (const FilmPoint& at :
         pupil_film_points(exact.lens(), film, film_points, samples.seed, lit_radius(exact, film, wavelength))) {
      points.push_back({points.size(), at});
    }
    parallel_for(points.size(), 1, samples.threads, [&](std::size_t begin, std::size_t) {
      Point& point = points[begin];
      PointRays rays;
      const auto even = uniform_points(samples_, point.index);
      for_lines(exact_, point.film, wavelength, even, [&](std::size_t, const PointLines& lines, const auto& areas) {
        exact_.tracing(lines, wavelength, rays);
        point.passes.push_back(rays.passes);
        for (std::size_t i = 0; i < lines_per_point; ++i) {
          if (!rays.passes[i]) continue;
          point.area += areas[i] / total;
          point.irradiance += areas[i] * weight(lines, i) / total;
        }
      });
    });
    const double brightest = std::ranges::max(points, {}, &Point::irradiance).irradiance;
    std::erase_if(points, [&](const Point& p) { return !(p.irradiance > darkest * brightest); });
  }
}

PupilStudy::Errors PupilStudy::errors_of(const Point& point, const ModelPupils& model, std::size_t wavelength) const {
  const core_detail::Kronecker<2> even = uniform_points(samples_, point.index);
  PointRays exact, rays;
  double differing = 0, irradiance = 0;  // differing: area of the lines that pass one of lens and model
  for_lines(exact_, point.film, wavelength, even, [&](std::size_t b, const PointLines& lines, const auto& areas) {
    model.tracing(lines, wavelength, rays);
    for (std::size_t i = 0; i < lines_per_point; ++i) differing += point.passes[b][i] && !rays.passes[i] ? areas[i] : 0;
  });
  for_lines(model, point.film, wavelength, even, [&](std::size_t, const PointLines& lines, const auto& areas) {
    exact_.tracing(lines, wavelength, exact);
    model.within(lines, wavelength, rays);
    for (std::size_t i = 0; i < lines_per_point; ++i) {
      if (!rays.passes[i]) continue;
      differing += exact.passes[i] ? 0 : areas[i];
      irradiance += areas[i] * weight(lines, i);
    }
  });
  return {model.point ? 1 : differing / (total * point.area), std::abs(irradiance / (total * point.irradiance) - 1)};
}

PupilStudy::Measurement PupilStudy::measure(const ModelPupils& model) const {
  Measurement found;
  for (std::size_t w = 0; w < points_.size(); ++w) {
    const std::vector<Point>& points = points_[w];
    std::vector<Errors> errors(points.size());
    parallel_for(points.size(), 1, samples_.threads, [&](std::size_t begin, std::size_t) {
      errors[begin] = errors_of(points[begin], model, wavelengths_[w]);
    });
    for (const Errors& e : errors) {
      found.shape = std::max(found.shape, e.shape);
      found.exposure = std::max(found.exposure, e.exposure);
    }
  }
  // Sampling errors matter most if few samples determine the result.
  const double unsure = std::sqrt((found.shape + 16 / total) / total);
  found.shape_bound = model.point ? found.shape : found.shape * smooth_guard + unsure;
  found.exposure_bound = found.exposure * smooth_guard + unsure;
  return found;
}

}  // namespace petzval::analysis_detail
