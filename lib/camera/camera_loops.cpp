// SPDX-License-Identifier: Apache-2.0
// Loops over blocks of camera samples, before and after ray computation, compiled once for each instruction set. Names
// are local, and no other library is called, as in lib/core/lanes.hpp.
#include "camera_loops.hpp"

#include "camera_steps.hpp"
#include "core/loop_math.hpp"
#include "distance_to_front.hpp"
#include "lens/look_up.hpp"

namespace petzval::camera_detail {
namespace {

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
  const T depth2 = depth * depth;
  const auto [film_x, film_y, pupil_x, pupil_y] = lines;
  const auto [ox, oy, oz, dx, dy, dz] = rays;
  // The output arrays do not overlap the input.
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const T x = pupil_x[i] - film_x[i], y = pupil_y[i] - film_y[i];
    const T per_length = towards / core_detail::square_root(x * x + y * y + depth2);
    ox[i] = pupil_x[i];
    oy[i] = pupil_y[i];
    oz[i] = z;
    dx[i] = x * per_length;
    dy[i] = y * per_length;
    dz[i] = depth * per_length;
  }
}

template <class T>
inline void move_to_front(T vertex_z, T curvature, std::size_t count, const RayArrays<T>& rays) noexcept {
  const auto [ox, oy, oz, dx, dy, dz] = rays;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const T distance = distance_to_front(curvature, ox[i], oy[i], oz[i] - vertex_z, dx[i], dy[i], dz[i]);
    ox[i] += distance * dx[i];
    oy[i] += distance * dy[i];
    oz[i] += distance * dz[i];
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
  if (front) {
    auto& [o, d] = ray.ray;
    move_to_front(front->vertex_z, front->curvature, 1, RayArrays<double>{&o.x, &o.y, &o.z, &d.x, &d.y, &d.z});
  }
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
    const auto [x, y] = upright_of(excess[i], virtual_x[i], virtual_y[i], pupil_x[i], pupil_y[i]);
    film_x[i] = x, film_y[i] = y;
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
constexpr CameraLoopsOf<T> loops{keep_on_film<T>, start<T>,      move_to_front<T>, look_up<T>,
                                 weigh<T>,        to_virtual<T>, to_upright<T>,    weigh_tilted<T>};

}  // namespace

const CameraLoops PETZVAL_LOOPS{loops<float>, loops<double>, weigh_one};

}  // namespace petzval::camera_detail
