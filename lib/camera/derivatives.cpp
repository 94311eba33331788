// SPDX-License-Identifier: Apache-2.0
// Rays with derivatives with respect to two parameters: each model evaluated with dual numbers.

#include <cmath>

#include "core/dual.hpp"
#include "core/kernel_vec.hpp"
#include "exact_model.hpp"
#include "paraxial_model.hpp"
#include "trace/trace_differential.hpp"

namespace petzval::camera_detail {
namespace {

using kernel::Dual;
using Vec = kernel::Vec<Dual>;

struct Line {
  Dual film_x, film_y, pupil_x, pupil_y;
};

Line line_of(const TwoPlaneRayDerivatives& d) noexcept {
  const auto jet = [&](double TwoPlaneRay::*component) {
    Dual x(d.line.*component);
    x.v[0] = d.by_u.*component;
    x.v[1] = d.by_v.*component;
    return x;
  };
  return {jet(&TwoPlaneRay::film_x), jet(&TwoPlaneRay::film_y), jet(&TwoPlaneRay::pupil_x), jet(&TwoPlaneRay::pupil_y)};
}

RayDerivatives derivatives_of(const Vec& origin, const Vec& direction) noexcept {
  const auto component = [](const Vec& v, int k) { return Vec3<double>(v.x.v[k], v.y.v[k], v.z.v[k]); };
  const auto value = [](const Vec& v) { return Vec3<double>(v.x.a, v.y.a, v.z.a); };
  return {RayFate::transmitted,
          {value(origin), value(direction)},
          {component(origin, 0), component(direction, 0)},
          {component(origin, 1), component(direction, 1)}};
}

}  // namespace

template <class R>
RayDerivatives ExactModel<R>::to_scene(const TwoPlaneRayDerivatives& line, Wavelength wavelength) const noexcept {
  const TwoPlanes& space = pupils().space();
  const auto [film_x, film_y, pupil_x, pupil_y] = line_of(line);
  const double depth = space.depth();
  const Dual x = pupil_x - film_x, y = pupil_y - film_y;
  const Dual per_length = towards_ / sqrt(x * x + y * y + depth * depth);
  RayDerivatives result =
      derivatives_of({pupil_x, pupil_y, Dual(space.pupil_z)}, {x * per_length, y * per_length, depth * per_length});
  // Traces the ray and its derivatives together.
  const auto given = [](const Ray<double>& r) { return Ray<R>{Vec3<R>(r.origin), Vec3<R>(r.direction)}; };
  const auto found = [](const Ray<R>& r) { return Ray<double>{Vec3<double>(r.origin), Vec3<double>(r.direction)}; };
  Ray<R> by_u = given(result.by_u), by_v = given(result.by_v);
  const auto end = trace_detail::trace_differential<R>(lens_, given(result.ray), by_u, by_v,
                                                       {.travel = Travel::to_scene, .wavelength = wavelength});
  result.fate = end.fate;
  if (end.transmitted()) return {end.fate, found(end.ray), found(by_u), found(by_v)};
  result.by_u = result.by_v = {{0, 0, 0}, {0, 0, 0}};
  return result;
}

template PETZVAL_API RayDerivatives ExactModel<float>::to_scene(const TwoPlaneRayDerivatives&,
                                                                Wavelength) const noexcept;
template PETZVAL_API RayDerivatives ExactModel<double>::to_scene(const TwoPlaneRayDerivatives&,
                                                                 Wavelength) const noexcept;

RayDerivatives ParaxialModel::to_scene(const TwoPlaneRayDerivatives& line, Wavelength wavelength) const noexcept {
  SectionMaps own;
  const SectionMaps* const map = map_at(wavelength, own);
  if (!map) return {RayFate::missed_surface};
  const auto [film_x, film_y, pupil_x, pupil_y] = line_of(line);
  const auto& [mx, my] = *map;
  const Dual slope_x = mx.c * film_x + mx.d * pupil_x, slope_y = my.c * film_y + my.d * pupil_y;
  const Dual down = -1.0 / sqrt(slope_x * slope_x + slope_y * slope_y + 1.0);
  return derivatives_of({mx.a * film_x + mx.b * pupil_x, my.a * film_y + my.b * pupil_y, Dual(z_)},
                        {slope_x * down, slope_y * down, down});
}

}  // namespace petzval::camera_detail
