// SPDX-License-Identifier: Apache-2.0
#include "exact_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "camera_loops.hpp"
#include "core/meet_plane.hpp"
#include "dual_rays.hpp"
#include "petzval/trace/trace.hpp"
#include "trace/lens_light.hpp"
#include "trace/trace_differential.hpp"

namespace petzval::camera_detail {
namespace {

constexpr std::size_t block = 256;

/// Memory for a block of rays.
template <class R>
struct Block {
  alignas(64) std::array<std::array<R, block>, 6> v;
  std::array<R, block> transmittances;

  RayArrays<R> arrays() noexcept {
    return {v[0].data(), v[1].data(), v[2].data(), v[3].data(), v[4].data(), v[5].data()};
  }
};

/// Traces rays in place; fewer than 8 rays one by one, which is faster than filling a block.
template <class R>
void trace_in_place(const Lens& lens, Travel travel, std::size_t count, const RayArrays<R>& rays,
                    const RayWavelengths& wavelengths, RayFate* fates, const trace_detail::LensLight* light,
                    R* transmittances) noexcept {
  constexpr std::size_t min_batch_size = 8;
  if (count >= min_batch_size) {
    const RayArrays<const R> in{rays.x, rays.y, rays.z, rays.dx, rays.dy, rays.dz};
    const BatchOptions options{.travel = travel, .wavelengths = wavelengths};
    return light ? trace_detail::trace_light<R>(lens, *light, count, in, rays, fates, transmittances, options)
                 : trace<R>(lens, count, in, rays, fates, nullptr, options);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Ray<R> ray{{rays.x[i], rays.y[i], rays.z[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]}};
    const TraceOptions options{.travel = travel, .wavelength = wavelengths.at(i)};
    const auto end = light ? trace_detail::trace_light<R>(lens, *light, ray, transmittances[i], options)
                           : trace<R>(lens, ray, options);
    fates[i] = end.fate;
    if (!end.transmitted()) continue;
    const auto& [o, d] = end.ray;
    rays.x[i] = o.x, rays.y[i] = o.y, rays.z[i] = o.z;
    rays.dx[i] = d.x, rays.dy[i] = d.y, rays.dz[i] = d.z;
  }
}

}  // namespace

template <class R>
template <class T>
void ExactModel<R>::trace_lines(std::size_t count, const TwoPlaneRays<const T>& lines,
                                const RayWavelengths& wavelengths, const RayArrays<T>& rays, RayFate* fates,
                                const trace_detail::LensLight* light, T* transmittances) const noexcept {
  const R towards = static_cast<R>(towards_);
  const auto& loops = camera_loops().of<R>();
  if constexpr (std::is_same_v<R, T>) {
    loops.start(pupils().space(), towards, count, lines, rays);
    trace_in_place<R>(lens_, Travel::to_scene, count, rays, wavelengths, fates, light, transmittances);
  } else {
    Block<R> own;
    std::array<std::array<R, block>, 4> line;
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t n = std::min(block, count - begin);
      const T* const from[] = {lines.film_x, lines.film_y, lines.pupil_x, lines.pupil_y};
      for (std::size_t k = 0; k < 4; ++k) {
        std::transform(from[k] + begin, from[k] + begin + n, line[k].begin(), [](T x) { return static_cast<R>(x); });
      }
      loops.start(pupils().space(), towards, n, {line[0].data(), line[1].data(), line[2].data(), line[3].data()},
                  own.arrays());
      trace_in_place<R>(lens_, Travel::to_scene, n, own.arrays(), wavelengths.from(begin), fates + begin, light,
                        own.transmittances.data());
      if (light) std::copy_n(own.transmittances.begin(), n, transmittances + begin);
      T* const to[] = {rays.x, rays.y, rays.z, rays.dx, rays.dy, rays.dz};
      for (std::size_t k = 0; k < 6; ++k) {
        std::transform(own.v[k].begin(), own.v[k].begin() + n, to[k] + begin, [](R x) { return static_cast<T>(x); });
      }
    }
  }
}

template <class R>
void ExactModel<R>::to_scene(std::size_t count, const TwoPlaneRays<const float>& lines,
                             const RayWavelengths& wavelengths, const RayArrays<float>& rays, RayFate* fates,
                             const trace_detail::LensLight* light, float* transmittances) const noexcept {
  trace_lines(count, lines, wavelengths, rays, fates, light, transmittances);
}

template <class R>
void ExactModel<R>::to_scene(std::size_t count, const TwoPlaneRays<const double>& lines,
                             const RayWavelengths& wavelengths, const RayArrays<double>& rays, RayFate* fates,
                             const trace_detail::LensLight* light, double* transmittances) const noexcept {
  trace_lines(count, lines, wavelengths, rays, fates, light, transmittances);
}

template <class R>
RayFate ExactModel<R>::to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray,
                                const trace_detail::LensLight* light, double* transmittance) const noexcept {
  const auto number = [](double value) { return static_cast<R>(value); };
  const TwoPlanes& space = pupils().space();
  const auto [o, d] =
      leaving(TwoPlaneRayOf<R>{number(line.film_x), number(line.film_y), number(line.pupil_x), number(line.pupil_y)},
              number(space.pupil_z), number(space.depth()), number(towards_));
  const Ray<R> start{{o.x, o.y, o.z}, {d.x, d.y, d.z}};
  const TraceOptions options{.travel = Travel::to_scene, .wavelength = wavelength};
  R left = 1;
  const auto end =
      light ? trace_detail::trace_light<R>(lens_, *light, start, left, options) : trace<R>(lens_, start, options);
  if (light) *transmittance = left;
  const Ray<R>& last = end.transmitted() ? end.ray : start;
  ray = {Vec3<double>(last.origin), Vec3<double>(last.direction)};
  return end.fate;
}

template <class R>
RayOf<kernel::Dual> ExactModel<R>::to_scene(const TwoPlaneRayOf<kernel::Dual>& line, Wavelength wavelength,
                                            RayFate& fate) const noexcept {
  const TwoPlanes& space = pupils().space();
  const RayOf<kernel::Dual> ray = leaving(line, space.pupil_z, space.depth(), towards_);
  // Traces the ray and its derivatives together.
  Ray<R> by_u = ray_of<R>(ray, by_first), by_v = ray_of<R>(ray, by_second);
  const auto end = trace_detail::trace_differential<R>(lens_, ray_of<R>(ray, value_only), by_u, by_v,
                                                       {.travel = Travel::to_scene, .wavelength = wavelength});
  fate = end.fate;
  return end.transmitted() ? dual_ray(end.ray, by_u, by_v) : ray;
}

template <class R>
void ExactModel<R>::to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                            const TwoPlaneRays<double>& lines, RayFate* fates, const trace_detail::LensLight* light,
                            double* transmittances) const noexcept {
  const TwoPlanes& space = pupils().space();
  Block<R> own;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    // The nearest point of the line to the first vertex, computed before rounding to R.
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3<double> o{rays.x[begin + i], rays.y[begin + i], rays.z[begin + i]};
      const Vec3<double> d{rays.dx[begin + i], rays.dy[begin + i], rays.dz[begin + i]};
      const double t = -(o.x * d.x + o.y * d.y + o.z * d.z);
      own.v[0][i] = static_cast<R>(o.x + t * d.x);
      own.v[1][i] = static_cast<R>(o.y + t * d.y);
      own.v[2][i] = static_cast<R>(o.z + t * d.z);
      own.v[3][i] = static_cast<R>(d.x), own.v[4][i] = static_cast<R>(d.y), own.v[5][i] = static_cast<R>(d.z);
    }
    trace_in_place<R>(lens_, Travel::to_film, n, own.arrays(), wavelengths.from(begin), fates + begin, light,
                      own.transmittances.data());
    if (light) std::copy_n(own.transmittances.begin(), n, transmittances + begin);
    for (std::size_t i = 0; i < n; ++i) {
      const Ray<double> ray{{own.v[0][i], own.v[1][i], own.v[2][i]}, {own.v[3][i], own.v[4][i], own.v[5][i]}};
      const auto line = core_detail::slope_ray(ray);
      const auto on_film = line.moved(space.film_z - ray.origin.z), in_pupil = line.moved(space.pupil_z - ray.origin.z);
      RayFate& fate = fates[begin + i];
      const bool met = std::isfinite(on_film.x + on_film.y + in_pupil.x + in_pupil.y);
      if (fate == RayFate::transmitted && !met) fate = RayFate::missed_surface;
      const bool arrives = fate == RayFate::transmitted;
      lines.film_x[begin + i] = arrives ? on_film.x : 0;
      lines.film_y[begin + i] = arrives ? on_film.y : 0;
      lines.pupil_x[begin + i] = arrives ? in_pupil.x : 0;
      lines.pupil_y[begin + i] = arrives ? in_pupil.y : 0;
    }
  }
}

template class ExactModel<float>;
template class ExactModel<double>;

}  // namespace petzval::camera_detail
