// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set; see petzval_loops in cmake/module.cmake.
#include "paraxial_loops.hpp"

#include <cmath>
#include <cstdint>

#include "lens/look_up.hpp"

namespace petzval::camera_detail {
namespace {

template <class T>
inline bool in_reach(T reach, T fx, T fy, T px, T py) noexcept {
  return std::abs(fx) + std::abs(fy) + std::abs(px) + std::abs(py) <= reach;
}

/// SectionMaps in numbers of type T.
template <class T>
struct Maps {
  T xa, xb, xc, xd, ya, yb, yc, yd;
};

template <class T>
inline Maps<T> maps_in(const SectionMaps& maps) noexcept {
  const auto number = [](double value) { return static_cast<T>(value); };
  const auto& [mx, my] = maps;
  return {number(mx.a), number(mx.b), number(mx.c), number(mx.d),
          number(my.a), number(my.b), number(my.c), number(my.d)};
}

/// A ray of the scene, in the plane of the maps.
template <class T>
struct Mapped {
  T x, y, dx, dy, dz;
};

template <class T>
inline Mapped<T> mapped(const Maps<T>& maps, T film_x, T film_y, T pupil_x, T pupil_y) noexcept {
  const T ux = maps.xc * film_x + maps.xd * pupil_x, uy = maps.yc * film_y + maps.yd * pupil_y;
  const T down = T(-1) / std::sqrt(T(1) + ux * ux + uy * uy);
  return {maps.xa * film_x + maps.xb * pupil_x, maps.ya * film_y + maps.yb * pupil_y, ux * down, uy * down, down};
}

// With __restrict compilers vectorize these loops; they honour it on parameters only.
template <class T, class MapsOf>
void fill(std::size_t count, const MapsOf& maps_of, T z, T reach, const T* __restrict film_x,
          const T* __restrict film_y, const T* __restrict pupil_x, const T* __restrict pupil_y, T* __restrict x,
          T* __restrict y, T* __restrict out_z, T* __restrict dx, T* __restrict dy, T* __restrict dz,
          RayFate* __restrict fates) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const Maps<T> maps = maps_of(i);
    const bool good = in_reach(reach, film_x[i], film_y[i], pupil_x[i], pupil_y[i]);
    // An invalid line is replaced by the axis.
    const T fx = good ? film_x[i] : T(0), fy = good ? film_y[i] : T(0);
    const T px = good ? pupil_x[i] : T(0), py = good ? pupil_y[i] : T(0);
    const Mapped<T> ray = mapped(maps, fx, fy, px, py);
    x[i] = ray.x;
    y[i] = ray.y;
    out_z[i] = z;
    dx[i] = ray.dx;
    dy[i] = ray.dy;
    dz[i] = ray.dz;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Maps<T> maps = maps_of(i);
    const bool known = (maps.xa != T(0)) | (maps.xc != T(0));  // a map of a lens is never zero
    const bool good = known & in_reach(reach, film_x[i], film_y[i], pupil_x[i], pupil_y[i]);
    fates[i] = good ? RayFate::transmitted : RayFate::missed_surface;
  }
}

template <class T>
void to_scene(std::size_t count, const ParaxialJob<T>& job, const TwoPlaneRays<const T>& lines,
              const RayArrays<T>& rays, RayFate* fates) noexcept {
  const auto run = [&](std::size_t o, std::size_t n, const auto& maps_of) {
    fill(n, maps_of, job.z, job.reach, lines.film_x + o, lines.film_y + o, lines.pupil_x + o, lines.pupil_y + o,
         rays.x + o, rays.y + o, rays.z + o, rays.dx + o, rays.dy + o, rays.dz + o, fates + o);
  };
  if (job.wavelengths.shared()) {
    run(0, count, [shared = job.shared ? maps_in<T>(*job.shared) : Maps<T>{}](std::size_t) { return shared; });
    return;
  }
  constexpr std::size_t block = lens_detail::look_up_block;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = count - begin < block ? count - begin : block;
    T m[8][block];
    if (job.equal_sections) {
      lens_detail::look_up(job.maps, job.wavelengths, begin, n, m, 4);
      run(begin, n, [&m](std::size_t i) -> Maps<T> {
        return {m[0][i], m[1][i], m[2][i], m[3][i], m[0][i], m[1][i], m[2][i], m[3][i]};
      });
    } else {
      lens_detail::look_up(job.maps, job.wavelengths, begin, n, m);
      run(begin, n, [&m](std::size_t i) -> Maps<T> {
        return {m[0][i], m[1][i], m[2][i], m[3][i], m[4][i], m[5][i], m[6][i], m[7][i]};
      });
    }
  }
}

RayFate one_to_scene(const SectionMaps* maps, double z, double reach, const TwoPlaneRay& line,
                     Ray<double>& ray) noexcept {
  auto& [o, d] = ray;
  o.x = 0, o.y = 0, o.z = z, d.x = 0, d.y = 0, d.z = -1;
  if (!maps || !in_reach(reach, line.film_x, line.film_y, line.pupil_x, line.pupil_y)) return RayFate::missed_surface;
  const auto found = mapped(maps_in<double>(*maps), line.film_x, line.film_y, line.pupil_x, line.pupil_y);
  o.x = found.x, o.y = found.y, d.x = found.dx, d.y = found.dy, d.z = found.dz;
  return RayFate::transmitted;
}

}  // namespace

extern const ParaxialLoops PETZVAL_LOOPS;
const ParaxialLoops PETZVAL_LOOPS{&to_scene<float>, &to_scene<double>, &one_to_scene};

}  // namespace petzval::camera_detail
