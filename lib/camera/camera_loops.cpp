// SPDX-License-Identifier: Apache-2.0
// Loops over blocks of camera samples, before and after ray computation, compiled once for each instruction set. Names
// are local, and no other library is called, as in lib/core/lanes.hpp.
#include "camera_loops.hpp"

#include <cmath>

#include "camera_steps.hpp"
#include "core/loop_math.hpp"
#include "lens/look_up.hpp"

namespace petzval::camera_detail {
namespace {

template <class T>
inline TwoPlaneRayOf<T> line_at(const TwoPlaneRays<const T>& lines, std::size_t i) noexcept {
  return {lines.film_x[i], lines.film_y[i], lines.pupil_x[i], lines.pupil_y[i]};
}
template <class T>
inline RayOf<T> ray_at(const RayArrays<T>& rays, std::size_t i) noexcept {
  return {{rays.x[i], rays.y[i], rays.z[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]}};
}
template <class T>
inline void put(const RayOf<T>& ray, const RayArrays<T>& rays, std::size_t i) noexcept {
  const auto& [o, d] = ray;
  rays.x[i] = o.x, rays.y[i] = o.y, rays.z[i] = o.z;
  rays.dx[i] = d.x, rays.dy[i] = d.y, rays.dz[i] = d.z;
}

template <class T>
void keep_on_film(const FilmBounds<T>& film, std::size_t count, const T* film_x, const T* film_y, T* kept_x,
                  T* kept_y) noexcept {
  const FilmBounds<T> bounds = film;
  for (std::size_t i = 0; i < count; ++i) {
    const bool kept = on_film(bounds, film_x[i], film_y[i]);
    kept_x[i] = kept ? film_x[i] : bounds.centre_x;
    kept_y[i] = kept ? film_y[i] : bounds.centre_y;
  }
}

template <class T>
void start(const TwoPlanes& space, T towards, std::size_t count, const TwoPlaneRays<const T>& lines,
           const RayArrays<T>& rays) noexcept {
  const T z = static_cast<T>(space.pupil_z), depth = static_cast<T>(space.depth());
  const TwoPlaneRays<const T> from = lines;
  const RayArrays<T> to = rays;
  // The output arrays do not overlap the input.
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    put(leaving(line_at(from, i), z, depth, towards), to, i);
  }
}

template <class T>
void move_all_to_front(T vertex_z, T curvature, std::size_t count, const RayArrays<T>& given) noexcept {
  const RayArrays<T> rays = given;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    RayOf<T> ray = ray_at(rays, i);
    move_to_front(vertex_z, curvature, ray);
    rays.x[i] = ray.origin.x, rays.y[i] = ray.origin.y, rays.z[i] = ray.origin.z;
  }
}

template <class T>
void look_up(const lens_detail::WavelengthRows<T>& rows, std::size_t count, const RayWavelengths& wavelengths,
             T* to) noexcept {
  constexpr std::size_t block = lens_detail::look_up_block;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = count - begin < block ? count - begin : block;
    T found[1][block];
    lens_detail::look_up(rows, wavelengths, begin, n, found);
    for (std::size_t i = 0; i < n; ++i) to[begin + i] = found[0][i];
  }
}

template <class T>
void weigh(const FilmBounds<T>& film, T depth, std::size_t count, const T* film_x, const T* film_y,
           const TwoPlaneRays<const T>& lines, const T* areas, const T* scale, RayFate* fates,
           const CameraRays<T>& rays) noexcept {
  const FilmBounds<T> bounds = film;
  const PupilWeight<T> of(depth);
  const T *const kept_x = lines.film_x, *const kept_y = lines.film_y;
  const T *const pupil_x = lines.pupil_x, *const pupil_y = lines.pupil_y;
  T* const weights = rays.weights;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const bool kept = on_film(bounds, film_x[i], film_y[i]);
    const RayFate fate = fate_of(fates[i], kept, scale[i] > T(0), areas[i] > T(0));
    fates[i] = fate;
    const T weight = scale[i] * of.weight(of.length2(kept_x[i], kept_y[i], pupil_x[i], pupil_y[i]), areas[i]);
    weights[i] = fate == RayFate::transmitted ? weight : T(0);
  }
  if (T* const pdf = rays.pdf_pupil) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const bool sampled = on_film(bounds, film_x[i], film_y[i]) & (areas[i] > T(0));
      pdf[i] = sampled ? of.pdf_pupil(areas[i]) : T(0);
    }
  }
  if (T* const pdf = rays.pdf_direction) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const bool sampled = on_film(bounds, film_x[i], film_y[i]) & (areas[i] > T(0));
      const T length2 = of.length2(kept_x[i], kept_y[i], pupil_x[i], pupil_y[i]);
      pdf[i] = sampled ? of.pdf_direction(length2, of.pdf_pupil(areas[i])) : T(0);
    }
  }
}

void weigh_one(const Front* front, double depth, const TwoPlaneRay& line, double area, double scale,
               CameraRay& ray) noexcept {
  if (front) move_to_front(front->vertex_z, front->curvature, ray.ray);
  const PupilWeight<double> of(depth);
  const double length2 = of.length2(line.film_x, line.film_y, line.pupil_x, line.pupil_y);
  ray.weight = scale * of.weight(length2, area);
  ray.pdf_pupil = of.pdf_pupil(area);
  ray.pdf_direction = of.pdf_direction(length2, ray.pdf_pupil);
}

/// A fixed film, and a moving film at one time.
template <class T>
struct StillPlane : TiltedBounds<T> {
  static constexpr T travel = 0;
};
template <class T>
struct MovingPlane : TiltedBounds<T> {
  T travel;
};

/// Calls body(plane_of); plane_of(i) is the film plane of sample i.
template <class T, class Body>
inline void with_planes(const TiltedBounds<T>& tilted, const Body& body) noexcept {
  if (const T* const times = tilted.times) {
    const auto limited = [](T t) { return core_detail::clamped(t); };
    body([bounds = tilted, times, limited](std::size_t i) {
      return MovingPlane<T>{bounds, bounds.whole_travel * limited(times[i])};
    });
  } else {
    body([plane = StillPlane<T>{tilted}](std::size_t) { return plane; });
  }
}

template <class T>
void to_virtual(const TiltedBounds<T>& tilted, std::size_t count, const T* film_x, const T* film_y, T* virtual_x,
                T* virtual_y, T* excess) noexcept {
  with_planes(tilted, [&](const auto& plane_of) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const auto [x, y] = virtual_of(plane_of(i), film_x[i], film_y[i]);
      virtual_x[i] = x, virtual_y[i] = y, excess[i] = distance_excess(plane_of(i), x, y);
    }
  });
}

template <class T>
void to_upright(std::size_t count, const T* excess, const T* virtual_x, const T* virtual_y, const T* pupil_x,
                const T* pupil_y, T* film_x, T* film_y) noexcept {
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const TwoPlaneRayOf<T> line = upright_of(excess[i], virtual_x[i], virtual_y[i], pupil_x[i], pupil_y[i]);
    film_x[i] = line.film_x, film_y[i] = line.film_y;
  }
}

template <class T>
void weigh_tilted(const TiltedBounds<T>& tilted, std::size_t count, const T* excess, const T* pupil_x, const T* pupil_y,
                  RayFate* fates, const CameraRays<T>& rays) noexcept {
  T* const weights = rays.weights;
  with_planes(tilted, [&](const auto& plane_of) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const T facing = facing_of(plane_of(i), excess[i], pupil_x[i], pupil_y[i]);
      const bool in_front = facing > T(0);
      weights[i] = in_front ? weights[i] * facing : T(0);
      const bool behind = !in_front & (fates[i] == RayFate::transmitted);
      fates[i] = behind ? RayFate::vignetted : fates[i];
    }
  });
  if (T* const pdf = rays.pdf_direction) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) pdf[i] /= (T(1) + excess[i]) * (T(1) + excess[i]);
  }
}

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

template <class T>
void bend(const FocusRules<T>& given, const EntranceMaps<T>& given_maps, T dispersion, T z, std::size_t count,
          const FilmPointFocuses<T>& points, const RayArrays<T>& rays) noexcept {
  const FocusRules<T> rules = given;
  const EntranceMaps<T> maps = given_maps;
  const auto [excess, surface, offset, scale] = points;
  const auto [ox, oy, oz, dx, dy, dz] = rays;
  T radius[bend_block], by_radius[bend_block];
  if (rules.spline.knots > 0) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const FilmPointFocus<T> point{excess[i], surface[i], offset[i], scale[i]};
      const auto ray = at_entrance(maps, z, RayOf<T>{{ox[i], oy[i], z}, {dx[i], dy[i], dz[i]}});
      radius[i] = within_knots(rules.spline, radius_of(maps, point, ray));
      by_radius[i] = beyond_one_at_first(rules.spline, radius[i]);
    }
    for (std::size_t j = 0; j + 1 < rules.spline.knots; ++j) {
      for (std::size_t i = 0; i < count; ++i) by_radius[i] += of_knot(rules.spline, j, radius[i]);
    }
    for (std::size_t i = 0; i < count; ++i) by_radius[i] *= rules.power;
  } else {
    for (std::size_t i = 0; i < count; ++i) by_radius[i] = T(0);
  }
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPointFocus<T> point{excess[i], surface[i], offset[i], scale[i]};
    RayOf<T> ray{{ox[i], oy[i], z}, {dx[i], dy[i], dz[i]}};
    bend_ray(rules, maps, dispersion, z, point, by_radius[i], ray);
    ox[i] = ray.origin.x, oy[i] = ray.origin.y, oz[i] = ray.origin.z;
    dx[i] = ray.direction.x, dy[i] = ray.direction.y, dz[i] = ray.direction.z;
  }
}

template <class T>
constexpr CameraLoopsOf<T> loops{keep_on_film<T>, start<T>,      move_all_to_front<T>, look_up<T>,  weigh<T>,
                                 to_virtual<T>,   to_upright<T>, weigh_tilted<T>,      to_scene<T>, bend<T>};

}  // namespace

const CameraLoops PETZVAL_LOOPS{loops<float>, loops<double>, weigh_one, one_to_scene};

}  // namespace petzval::camera_detail
