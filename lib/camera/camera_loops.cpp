// SPDX-License-Identifier: Apache-2.0
// Loops over blocks of camera samples, before and after ray computation, compiled once for each instruction set. Names
// are local, and no other library is called, as in lib/core/lanes.hpp.
#include "camera_loops.hpp"

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
constexpr CameraLoopsOf<T> loops{keep_on_film<T>, start<T>,      move_all_to_front<T>, look_up<T>,
                                 weigh<T>,        to_virtual<T>, to_upright<T>,        weigh_tilted<T>};

}  // namespace

const CameraLoops PETZVAL_LOOPS{loops<float>, loops<double>, weigh_one};

}  // namespace petzval::camera_detail
