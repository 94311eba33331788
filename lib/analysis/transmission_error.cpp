// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "camera/check_film.hpp"
#include "camera/exact_model.hpp"
#include "core/low_discrepancy.hpp"
#include "petzval/analysis/choose_model.hpp"
#include "trace/lens_light.hpp"

namespace petzval {
namespace {

/// Mean transmittance over the pupil of a film point; 0 if no ray passes.
double light_at(const camera_detail::ExactModel<double>& exact, const trace_detail::LensLight& light,
                const FilmPoint& film, std::size_t wavelength) {
  constexpr std::size_t rays = 256;
  double sum = 0;
  int passed = 0;
  for (std::size_t k = 0; k < rays; ++k) {
    const auto [u, v] = core_detail::fibonacci_point(k, rays);
    const PupilSample at = exact.pupils().sample(film, u, v, wavelength);
    Ray<double> ray;
    double left = 0;
    const TwoPlaneRay line{film.x, film.y, at.x, at.y};
    if (!(at.area > 0) || exact.to_scene(line, wavelength, ray, &light, &left) != RayFate::transmitted) continue;
    sum += left, ++passed;
  }
  return passed > 0 ? sum / passed : 0;
}

}  // namespace

TransmissionError transmission_error(const Lens& lens, const Film& film) {
  const auto [placed_lens, placed_film] = camera_detail::placed(lens, film);
  camera_detail::check_upright_film(placed_lens, placed_film);
  const double radius = placed_film.radius_mm();
  const camera_detail::ExactModel<double> exact(placed_lens, radius);
  const trace_detail::LensLight light(placed_lens);
  const std::size_t primary = lens.primary_wavelength();
  TransmissionError result;
  const double axis = light_at(exact, light, {}, primary);
  if (!(axis > 0)) return result;
  result.exposure = 1 / axis - 1;
  const auto widen = [&](double& widest, double value) {
    if (value > 0) widest = std::max(widest, std::abs(value / axis - 1));
  };
  for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
    widen(result.colour, light_at(exact, light, {}, w));
  }
  for (const double part : {0.3, 0.5, 0.7, 0.85, 1.0}) {
    for (const auto& [x, y] : {std::array{0.0, 1.0}, std::array{1.0, 0.0}}) {
      widen(result.field, light_at(exact, light, {part * radius * x, part * radius * y}, primary));
    }
  }
  return result;
}

}  // namespace petzval
