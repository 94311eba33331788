// SPDX-License-Identifier: Apache-2.0
#include "best_focus.hpp"

#include <array>
#include <cmath>

#include "core/meet_plane.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil/pupil_nodes.hpp"

namespace petzval::camera_detail {

StopMaps stop_maps(const LensFacts& facts, std::size_t wavelength, const TwoPlanes& space, Meridian section) {
  const Lens& lens = facts.lens();
  const std::size_t stop = facts.pupils(wavelength).stop, last = lens.surface_count();
  const double n_front = signed_index(lens, 0, wavelength), n_behind = signed_index(lens, last, wavelength);
  const RayMatrix lens_map = ray_matrix(lens, 0, last, wavelength, section).on_slopes(n_front, n_behind);
  const RayMatrix from_stop =
      ray_matrix(lens, stop, last, wavelength, section).on_slopes(signed_index(lens, stop, wavelength), n_behind);
  // Heights are taken in the stop itself, so that a pupil at infinity needs no special case.
  const RayMatrix behind_lens = line_at(space, lens.surfaces().back().vertex_z);
  return {behind_lens.then(from_stop.inverse()), from_stop.then(lens_map.inverse())};
}

/// A plane of the scene corresponds to a slope v per height in the stop, for the first-order rays from its axial point.
/// Exact rays, continued to the stop to first order, meet the stop at heights y with slopes u. Seen from the entrance
/// pupil, their distances from the axial point are proportional to u - v y. The sum of squares is minimal for v = sum(u
/// y) / sum(y y).
double best_focus_power(const LensFacts& facts, std::size_t wavelength, const StopMaps& maps, Meridian section) {
  const Lens& lens = facts.lens();
  const bool cylinders = has_cylinders(lens);
  // For a lens of revolution one meridian suffices.
  const PupilBoundary boundary = lens.rotationally_symmetric() ? exit_pupil_boundary(lens, {}, wavelength, 1)
                                                               : exit_pupil_boundary(lens, {}, wavelength);
  const RayMatrix to_stop = maps.to_front.inverse();
  const double front_z = lens.surfaces().front().vertex_z;
  double uy = 0, yy = 0;
  pupil_detail::for_each_node<32>(boundary, [&](const Vec2<double>& p, double area, double weight) {
    const Ray<double> start = boundary.plane.ray(p.x, p.y);
    const auto end = trace(lens, start, {.travel = Travel::to_scene, .wavelength = wavelength});
    if (!end.transmitted()) return;
    const auto line = core_detail::slope_ray(end.ray, front_z);
    const double light = area * weight * std::pow(start.direction.z, 4);
    for (const Meridian along : {Meridian::x, Meridian::y}) {
      if (cylinders && along != section) continue;
      const auto [height, slope] =
          along == Meridian::x ? std::array{line.x, line.slope_x} : std::array{line.y, line.slope_y};
      const double in_stop = to_stop.a * height + to_stop.b * slope;
      uy += light * in_stop * (to_stop.c * height + to_stop.d * slope);
      yy += light * in_stop * in_stop;
    }
  });
  const double power = uy / yy - maps.from_film.d / maps.from_film.b;
  return std::isfinite(power) ? power : 0;
}

}  // namespace petzval::camera_detail
