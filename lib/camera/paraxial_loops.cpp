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

/// SectionMaps in numbers of type T.
template <class T>
struct Maps {
  T xa, xb, xc, xd, ya, yb, yc, yd;
};

// The promise that nothing overlaps lets a compiler run these loops on lanes; it takes it of parameters only.
template <class T, class MapsOf>
void fill(std::size_t count, const MapsOf& maps_of, T z, const T* __restrict film_x, const T* __restrict film_y,
          const T* __restrict pupil_x, const T* __restrict pupil_y, T* __restrict x, T* __restrict y,
          T* __restrict out_z, T* __restrict dx, T* __restrict dy, T* __restrict dz,
          RayFate* __restrict fates) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const Maps<T> maps = maps_of(i);
    const bool good = in_reach(film_x[i], film_y[i], pupil_x[i], pupil_y[i]);
    // A line that is no good becomes the axis.
    const T fx = good ? film_x[i] : T(0), fy = good ? film_y[i] : T(0);
    const T px = good ? pupil_x[i] : T(0), py = good ? pupil_y[i] : T(0);
    const T ux = maps.xc * fx + maps.xd * px, uy = maps.yc * fy + maps.yd * py;
    const T down = T(-1) / std::sqrt(T(1) + ux * ux + uy * uy);
    x[i] = maps.xa * fx + maps.xb * px;
    y[i] = maps.ya * fy + maps.yb * py;
    out_z[i] = z;
    dx[i] = ux * down;
    dy[i] = uy * down;
    dz[i] = down;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Maps<T> maps = maps_of(i);
    const bool known = (maps.xa != T(0)) | (maps.xc != T(0));  // no map of a lens is zero
    const bool good = known & in_reach(film_x[i], film_y[i], pupil_x[i], pupil_y[i]);
    fates[i] = good ? RayFate::transmitted : RayFate::missed_surface;
  }
}

template <class T>
void to_scene(std::size_t count, const ParaxialJob<T>& job, const TwoPlaneRays<const T>& lines,
              const RayArrays<T>& rays, RayFate* fates) noexcept {
  const auto run = [&](std::size_t o, std::size_t n, const auto& maps_of) {
    fill(n, maps_of, job.z, lines.film_x + o, lines.film_y + o, lines.pupil_x + o, lines.pupil_y + o, rays.x + o,
         rays.y + o, rays.z + o, rays.dx + o, rays.dy + o, rays.dz + o, fates + o);
  };
  if (!job.wavelengths.each && !job.wavelengths.each_nm) {
    Maps<T> shared{};
    if (job.shared) {
      const auto number = [](double value) { return static_cast<T>(value); };
      const auto& [mx, my] = *job.shared;
      shared = {number(mx.a), number(mx.b), number(mx.c), number(mx.d),
                number(my.a), number(my.b), number(my.c), number(my.d)};
    }
    run(0, count, [shared](std::size_t) { return shared; });
    return;
  }
  constexpr std::size_t block = lens_detail::look_up_block;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = count - begin < block ? count - begin : block;
    T m[8][block];
    lens_detail::look_up(job.maps, job.wavelengths, begin, n, m);
    run(begin, n, [&m](std::size_t i) -> Maps<T> {
      return {m[0][i], m[1][i], m[2][i], m[3][i], m[4][i], m[5][i], m[6][i], m[7][i]};
    });
  }
}

}  // namespace

extern const ParaxialLoops PETZVAL_LOOPS;
const ParaxialLoops PETZVAL_LOOPS{&to_scene<float>, &to_scene<double>};

}  // namespace petzval::inline v0::camera_detail
