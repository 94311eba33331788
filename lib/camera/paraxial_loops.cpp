// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set: see petzval_loops in cmake/module.cmake.
#include "paraxial_loops.hpp"

#include <cmath>
#include <cstdint>

namespace petzval::inline v0::camera_detail {
namespace {

/// Numbers of a line up to here give finite rays, in float too.
constexpr double reach = 1e12;

template <class T>
bool in_reach(T fx, T fy, T px, T py) noexcept {
  return std::abs(fx) + std::abs(fy) + std::abs(px) + std::abs(py) <= static_cast<T>(reach);
}

// The promise that nothing overlaps lets a compiler run these loops on lanes; it takes it of parameters only.
template <class T, class MapOf, class Known>
void fill(std::size_t count, const MapOf& map_of, const Known& known, T z, const T* __restrict film_x,
          const T* __restrict film_y, const T* __restrict pupil_x, const T* __restrict pupil_y, T* __restrict x,
          T* __restrict y, T* __restrict out_z, T* __restrict dx, T* __restrict dy, T* __restrict dz,
          RayFate* __restrict fates) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [along_x, along_y] = map_of(i);
    const auto number = [](double value) { return static_cast<T>(value); };
    const bool good = in_reach(film_x[i], film_y[i], pupil_x[i], pupil_y[i]);
    // A line that is no good becomes the axis.
    const T fx = good ? film_x[i] : T(0), fy = good ? film_y[i] : T(0);
    const T px = good ? pupil_x[i] : T(0), py = good ? pupil_y[i] : T(0);
    const T ux = number(along_x.c) * fx + number(along_x.d) * px, uy = number(along_y.c) * fy + number(along_y.d) * py;
    const T down = T(-1) / std::sqrt(T(1) + ux * ux + uy * uy);
    x[i] = number(along_x.a) * fx + number(along_x.b) * px;
    y[i] = number(along_y.a) * fy + number(along_y.b) * py;
    out_z[i] = z;
    dx[i] = ux * down;
    dy[i] = uy * down;
    dz[i] = down;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const bool good = known(i) && in_reach(film_x[i], film_y[i], pupil_x[i], pupil_y[i]);
    fates[i] = good ? RayFate::transmitted : RayFate::missed_surface;
  }
}

template <class T>
void to_scene(std::size_t count, const ParaxialJob& job, const TwoPlaneRays<const T>& lines, const RayArrays<T>& rays,
              RayFate* fates) noexcept {
  const auto run = [&](const auto& map_of, const auto& known) {
    fill(count, map_of, known, static_cast<T>(job.z), lines.film_x, lines.film_y, lines.pupil_x, lines.pupil_y, rays.x,
         rays.y, rays.z, rays.dx, rays.dy, rays.dz, fates);
  };
  const std::uint16_t* each = job.wavelengths.each;
  if (each) {
    const auto known = [&](std::size_t i) { return each[i] < job.known; };
    run([&](std::size_t i) -> const SectionMaps& { return job.maps[known(i) ? each[i] : 0]; }, known);
  } else {
    const std::size_t all = job.wavelengths.all.position(job.primary);
    const bool known = all < job.known;
    run([map = job.maps[known ? all : 0]](std::size_t) -> const SectionMaps& { return map; },
        [known](std::size_t) { return known; });
  }
}

}  // namespace

extern const ParaxialLoops PETZVAL_LOOPS;
const ParaxialLoops PETZVAL_LOOPS{&to_scene<float>, &to_scene<double>};

}  // namespace petzval::inline v0::camera_detail
