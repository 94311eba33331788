// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set; see petzval_loops in cmake/module.cmake.
#include "paraxial_loops.hpp"

#include <cmath>
#include <cstdint>

#include "camera_steps.hpp"
#include "lens/look_up.hpp"

namespace petzval::camera_detail {
namespace {

template <class T>
inline bool in_reach(T reach, T fx, T fy, T px, T py) noexcept {
  return std::abs(fx) + std::abs(fy) + std::abs(px) + std::abs(py) <= reach;
}

/// SectionMaps in numbers of type T.
template <class T>
struct Map {
  T a, b, c, d;
};
template <class T>
struct Maps {
  Map<T> x, y;
};

template <class T>
inline Maps<T> maps_in(const SectionMaps& maps) noexcept {
  const auto map = [](const RayMatrix& of) -> Map<T> {
    return {static_cast<T>(of.a), static_cast<T>(of.b), static_cast<T>(of.c), static_cast<T>(of.d)};
  };
  return {map(maps.x), map(maps.y)};
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
    const auto [o, d] = mapped(maps, z, TwoPlaneRayOf<T>{fx, fy, px, py});
    x[i] = o.x, y[i] = o.y, out_z[i] = o.z;
    dx[i] = d.x, dy[i] = d.y, dz[i] = d.z;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Maps<T> maps = maps_of(i);
    const bool known = (maps.x.a != T(0)) | (maps.x.c != T(0));  // a map of a lens is never zero
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
        return {{m[0][i], m[1][i], m[2][i], m[3][i]}, {m[0][i], m[1][i], m[2][i], m[3][i]}};
      });
    } else {
      lens_detail::look_up(job.maps, job.wavelengths, begin, n, m);
      run(begin, n, [&m](std::size_t i) -> Maps<T> {
        return {{m[0][i], m[1][i], m[2][i], m[3][i]}, {m[4][i], m[5][i], m[6][i], m[7][i]}};
      });
    }
  }
}

RayFate one_to_scene(const SectionMaps* maps, double z, double reach, const TwoPlaneRay& line,
                     Ray<double>& ray) noexcept {
  auto& [o, d] = ray;
  o.x = 0, o.y = 0, o.z = z, d.x = 0, d.y = 0, d.z = -1;
  if (!maps || !in_reach(reach, line.film_x, line.film_y, line.pupil_x, line.pupil_y)) return RayFate::missed_surface;
  const RayOf<double> found = mapped(*maps, z, line);
  o.x = found.origin.x, o.y = found.origin.y;
  d.x = found.direction.x, d.y = found.direction.y, d.z = found.direction.z;
  return RayFate::transmitted;
}

}  // namespace

extern const ParaxialLoops PETZVAL_LOOPS;
const ParaxialLoops PETZVAL_LOOPS{&to_scene<float>, &to_scene<double>, &one_to_scene};

}  // namespace petzval::camera_detail
