// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/spot.hpp"

#include <algorithm>
#include <cmath>

#include "film.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace {

/// for_each calls its argument with every point, always in the same order.
template <class ForEach>
SpotSize size_of(std::size_t count, ForEach&& for_each) noexcept {
  SpotSize size;
  if (count == 0) return size;
  const auto n = static_cast<double>(count);
  double& cx = size.centroid[0];
  double& cy = size.centroid[1];
  for_each([&](double x, double y) { cx += x, cy += y; });
  cx /= n, cy /= n;
  // Once more about the first mean: its rounding grows with the number of points, and shows in a spot far off the axis.
  double dx = 0, dy = 0;
  for_each([&](double x, double y) { dx += x - cx, dy += y - cy; });
  cx += dx / n, cy += dy / n;

  double sum = 0, largest = 0;
  for_each([&](double x, double y) {
    const double squared = (x - cx) * (x - cx) + (y - cy) * (y - cy);
    sum += squared;
    largest = std::max(largest, squared);
  });
  size.rms_radius = std::sqrt(sum / n);
  size.max_radius = std::sqrt(largest);
  return size;
}

}  // namespace

SpotSize spot_size(std::span<const double> x, std::span<const double> y) noexcept {
  return size_of(x.size(), [&](auto&& point) {
    for (std::size_t i = 0; i < x.size(); ++i) point(x[i], y[i]);
  });
}

SpotSize spot_size(std::span<const FilmHits> sets) noexcept {
  std::size_t count = 0;
  for (const FilmHits& hits : sets) count += hits.x.size();
  return size_of(count, [&](auto&& point) {
    for (const FilmHits& hits : sets) {
      for (std::size_t i = 0; i < hits.x.size(); ++i) point(hits.x[i], hits.y[i]);
    }
  });
}

std::vector<Spot> spot_diagram(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                               std::uint32_t samples) {
  const detail::Film film(lens);
  std::vector<Spot> spots;
  for (const double field : fields_rad) {
    const ScenePoint point{field, subject_z};
    for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
      Spot spot;
      spot.point = point;
      spot.wavelength = w;
      spot.hits = trace_bundle(lens, PupilSampler(pupil_outline(lens, point, w)), samples);
      spot.size = spot_size(spot.hits.x, spot.hits.y);
      spot.relative_illumination = relative_illumination(lens, point, w);
      const AimedRay chief = chief_ray(lens, point, w);
      const auto hit = chief && chief.end.transmitted() ? film.meet(chief.end.ray) : std::nullopt;
      if (hit) spot.chief_ray_height = (*hit)[1];
      spots.push_back(std::move(spot));
    }
  }
  return spots;
}

}  // namespace petzval
