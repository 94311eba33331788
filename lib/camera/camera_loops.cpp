// SPDX-License-Identifier: Apache-2.0
// What a camera does to blocks of samples before and after their rays are found, compiled once for each instruction
// set. Names are local, and no other library is called, as in lib/trace/lanes.hpp.
#include "camera_loops.hpp"

namespace petzval::inline v0::camera_detail {
namespace {

inline float root(float x) noexcept { return __builtin_sqrtf(x); }
inline double root(double x) noexcept { return __builtin_sqrt(x); }

/// False for what is not a number.
template <class T>
inline bool on_film(const FilmBounds<T>& film, T x, T y) noexcept {
  const T dx = x - film.centre_x, dy = y - film.centre_y;
  return (dx <= film.half_width) & (-dx <= film.half_width) & (dy <= film.half_height) & (-dy <= film.half_height);
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
  const T depth2 = depth * depth;
  const auto [film_x, film_y, pupil_x, pupil_y] = lines;
  const auto [ox, oy, oz, dx, dy, dz] = rays;
  // Rays lie where nothing else does.
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const T x = pupil_x[i] - film_x[i], y = pupil_y[i] - film_y[i];
    const T per_length = towards / root(x * x + y * y + depth2);
    ox[i] = pupil_x[i];
    oy[i] = pupil_y[i];
    oz[i] = z;
    dx[i] = x * per_length;
    dy[i] = y * per_length;
    dz[i] = depth * per_length;
  }
}

template <class T>
void weigh(const FilmBounds<T>& film, T depth, std::size_t count, const T* film_x, const T* film_y,
           const TwoPlaneRays<const T>& lines, const T* areas, const T* scale, RayFate* fates,
           const CameraRays<T>& rays) noexcept {
  const FilmBounds<T> bounds = film;
  const T depth2 = depth * depth, along = depth < T(0) ? -depth : depth;
  const T *const kept_x = lines.film_x, *const kept_y = lines.film_y;
  const T *const pupil_x = lines.pupil_x, *const pupil_y = lines.pupil_y;
  T* const weights = rays.weights;
  const auto solid = [&](std::size_t i) {
    const T x = pupil_x[i] - kept_x[i], y = pupil_y[i] - kept_y[i];
    return x * x + y * y + depth2;
  };
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const bool kept = on_film(bounds, film_x[i], film_y[i]), wanted = scale[i] > T(0), seen = areas[i] > T(0);
    RayFate fate = fates[i];
    fate = seen ? fate : RayFate::vignetted;
    fate = wanted ? fate : RayFate::invalid;
    fate = kept ? fate : RayFate::outside_film;
    fates[i] = fate;
    // cos / pdf_direction, pdf_direction = pdf_pupil length^3 / depth.
    const T length2 = solid(i), part = depth2 / length2;
    weights[i] = fate == RayFate::transmitted ? scale[i] * areas[i] * part * part / depth2 : T(0);
  }
  if (T* const pdf = rays.pdf_pupil) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const bool sampled = on_film(bounds, film_x[i], film_y[i]) & (areas[i] > T(0));
      pdf[i] = sampled ? T(1) / areas[i] : T(0);
    }
  }
  if (T* const pdf = rays.pdf_direction) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const T length2 = solid(i);
      const bool sampled = on_film(bounds, film_x[i], film_y[i]) & (areas[i] > T(0));
      pdf[i] = sampled ? length2 * root(length2) / (along * areas[i]) : T(0);
    }
  }
}

template <class T>
void to_virtual(const TiltedBounds<T>& tilted, std::size_t count, const T* film_x, const T* film_y, T* virtual_x,
                T* virtual_y) noexcept {
  const TiltedBounds<T> b = tilted;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const T x = film_x[i], y = film_y[i];
    const T per_distance = T(1) / (T(1) + (b.depth_by_x * x + b.depth_by_y * y));
    virtual_x[i] = (b.x_by_x * x + b.x_by_y * y) * per_distance;
    virtual_y[i] = b.y_by_y * y * per_distance;
  }
}

template <class T>
void to_upright(const TiltedBounds<T>& tilted, std::size_t count, const T* virtual_x, const T* virtual_y,
                const T* pupil_x, const T* pupil_y, T* film_x, T* film_y) noexcept {
  const TiltedBounds<T> b = tilted;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const T tilt = b.slope_x * virtual_x[i] + b.slope_y * virtual_y[i];
    film_x[i] = virtual_x[i] - tilt * pupil_x[i];
    film_y[i] = virtual_y[i] - tilt * pupil_y[i];
  }
}

template <class T>
void weigh_tilted(const TiltedBounds<T>& tilted, std::size_t count, const T* virtual_x, const T* virtual_y,
                  const T* pupil_x, const T* pupil_y, RayFate* fates, const CameraRays<T>& rays) noexcept {
  const TiltedBounds<T> b = tilted;
  T* const weights = rays.weights;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const T near = T(1) + (b.slope_x * virtual_x[i] + b.slope_y * virtual_y[i]);
    const T front = T(1) - (b.slope_x * pupil_x[i] + b.slope_y * pupil_y[i]);
    const bool in_front = front > T(0);
    weights[i] = in_front ? weights[i] * (b.cosine * front * near * near * near) : T(0);
    const bool behind = !in_front & (fates[i] == RayFate::transmitted);
    fates[i] = behind ? RayFate::vignetted : fates[i];
  }
  if (T* const pdf = rays.pdf_direction) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const T near = T(1) + (b.slope_x * virtual_x[i] + b.slope_y * virtual_y[i]);
      pdf[i] /= near * near;
    }
  }
}

template <class T>
constexpr CameraLoopsOf<T> loops{keep_on_film<T>, start<T>, weigh<T>, to_virtual<T>, to_upright<T>, weigh_tilted<T>};

}  // namespace

const CameraLoops PETZVAL_LOOPS{loops<float>, loops<double>};

}  // namespace petzval::inline v0::camera_detail
