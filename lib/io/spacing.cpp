// SPDX-License-Identifier: Apache-2.0
#include "spacing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lens/data.hpp"
#include "lens/edges.hpp"
#include "lens/equator.hpp"
#include "petzval/io/lint.hpp"

namespace petzval::io_detail {

namespace {

/// The least spacing between two surfaces of a lens.
std::optional<Spacing> spacing_of(const Lens& lens, std::size_t surface, std::size_t next) {
  const LensSurface& front = lens.surfaces()[surface];
  const LensSurface& rear = lens.surfaces()[next];
  // Compiled apertures end where surfaces meet; apertures of the prescription may be larger.
  const double front_rim = lens.data().rims[surface], rear_rim = lens.data().rims[next];
  const double distance = rear.vertex_z - front.vertex_z;
  const double from = std::max(front.obscuration_semi_diameter, rear.obscuration_semi_diameter);
  // Slightly below the equator: rounding must not lead to heights at which the sag is undefined.
  const double equator = std::min(lens_detail::equator(front), lens_detail::equator(rear)) * (1 - 1e-15);
  const double to = std::min({front_rim, rear_rim, equator});
  // Behind a mirror light runs backwards, and the next surface lies at smaller z.
  const double direction = lens.light_direction(surface + 1);
  if (!std::isfinite(front_rim) || !std::isfinite(rear_rim)) {
    if (front.mirror && direction * distance < 0) return Spacing{direction * distance, 0};
    return {};
  }
  if (to < from) return {};

  // Cylindrical surfaces along x and y differ most along an axis or at 45 degrees.
  constexpr std::array<std::array<double, 2>, 3> azimuths{{{0, 1}, {1, 0}, {0.7071067811865476, 0.7071067811865476}}};
  const std::size_t azimuth_count = lens.rotationally_symmetric() ? 1 : azimuths.size();
  // The slopes of two spheres differ with the same sign at all heights, so the least spacing lies at an end.
  const auto sphere = [](const LensSurface& s) { return s.conic == 0 && s.aspheric.empty(); };
  const int samples = sphere(front) && sphere(rear) ? 1 : 200;
  Spacing least{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t azimuth = 0; azimuth < azimuth_count; ++azimuth) {
    for (int i = 0; i <= samples; ++i) {
      const double height = from + (to - from) * i / samples;
      const double x = azimuths[azimuth][0] * height, y = azimuths[azimuth][1] * height;
      const double width = direction * (distance + lens_detail::sag_of(rear, x, y) - lens_detail::sag_of(front, x, y));
      if (width < least.width) least = {width, height};
    }
  }
  return least;
}

}  // namespace

std::optional<Spacing> least_spacing(const Lens& lens, std::size_t surface) {
  const auto changes = [&](std::size_t i) {
    return lens_detail::changes_rays(lens.surfaces(), lens.data().indices.values, i);
  };
  std::optional<Spacing> least;
  if (!changes(surface) && lens.stop() != surface) return least;
  for (std::size_t next = surface + 1; next < lens.surface_count(); ++next) {
    if (!changes(next) && (lens.stop() != next || !changes(surface))) continue;
    const std::optional<Spacing> spacing = spacing_of(lens, surface, next);
    if (spacing && (!least || spacing->width < least->width)) least = spacing;
    if (changes(next)) break;
  }
  return least;
}

}  // namespace petzval::io_detail

namespace petzval {

std::vector<std::optional<double>> edge_thicknesses(const Lens& lens) {
  const auto surfaces = lens.surfaces();
  std::vector<std::optional<double>> result(surfaces.size());
  for (std::size_t i = 0; i + 1 < surfaces.size(); ++i) {
    const LensSurface &front = surfaces[i], &rear = surfaces[i + 1];
    if (front.curved_in != Section::both || rear.curved_in != Section::both) continue;
    // Compiled apertures end where surfaces meet, and would hide a negative edge.
    const double height = std::max(lens.data().rims[i], lens.data().rims[i + 1]);
    if (!std::isfinite(height)) continue;
    const double thickness =
        rear.vertex_z - front.vertex_z + lens_detail::sag_of(rear, 0, height) - lens_detail::sag_of(front, 0, height);
    // Not finite beyond the end of a surface.
    if (std::isfinite(thickness)) result[i] = lens.light_direction(i + 1) * thickness;
  }
  return result;
}

}  // namespace petzval
