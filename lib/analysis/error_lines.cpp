// SPDX-License-Identifier: Apache-2.0
#include "error_lines.hpp"

#include <algorithm>
#include <cmath>

#include "core/bisect.hpp"
#include "core/low_discrepancy.hpp"

namespace petzval::analysis_detail {
namespace {

using core_detail::Kronecker;

/// Maps [0, 1] to [-1, 1], denser at both ends.
double to_the_ends(double t) noexcept {
  const double a = 2 * t - 1, inner = 1 - std::abs(a);
  return std::copysign(1 - inner * inner * inner, a);
}

/// The nearest float that is not farther from 0, so that rounding moves no corner outside the radius of the film.
double towards_zero(double x) noexcept {
  const float f = static_cast<float>(x);
  return std::abs(static_cast<double>(f)) > std::abs(x) ? std::nextafter(f, 0.0f) : f;
}

}  // namespace

double lit_radius(const camera_detail::ExactModel<double>& exact, const Film& film, std::size_t wavelength) {
  const double farthest = film.radius_mm();
  if (!exact.lens().rotationally_symmetric()) return farthest;
  const FilmPupilTable& pupils = exact.pupils();
  const double depth2 = pupils.space().depth() * pupils.space().depth();
  const auto irradiance = [&](double r) {
    const double across = pupils.middle({0, r}, wavelength)[1] - r, cosine2 = depth2 / (across * across + depth2);
    return pupils.area({0, r}, wavelength) * cosine2 * cosine2;
  };
  constexpr int steps = 256;
  double brightest = 0;
  for (int i = 0; i <= steps; ++i) brightest = std::max(brightest, irradiance(farthest * i / steps));
  const auto lit = [&](double r) { return irradiance(r) > darkest * brightest; };
  for (int i = steps; i >= 0; --i) {
    const double r = farthest * i / steps;
    if (lit(r)) return i == steps ? farthest : core_detail::last_with(r, farthest * (i + 1) / steps, lit);
  }
  return farthest;
}

FilmPoint error_film_point(const Film& film, std::size_t index, std::uint32_t seed, double lit_radius) noexcept {
  const std::size_t kind = index % 8, turn = index / 8;
  auto [x, y] = Kronecker<2>(2ull * seed + (is_uniform(index) ? 0 : 1))(index / 2);
  if (is_uniform(index)) {
    x = 2 * x - 1, y = 2 * y - 1;
  } else if (kind == 1) {
    x = turn % 2 == 0 ? -1 : 1, y = turn / 2 % 2 == 0 ? -1 : 1;
  } else if (kind == 3) {
    (turn % 2 == 0 ? x : y) = turn / 2 % 2 == 0 ? 0 : 1;
    x = 2 * x - 1, y = 2 * y - 1;
  } else {
    x = to_the_ends(x), y = to_the_ends(y);
  }
  const double film_x = film.shift_x_mm + x * film.width_mm / 2, film_y = film.shift_y_mm + y * film.height_mm / 2;
  const double r = std::hypot(film_x, film_y), dark_width = film.radius_mm() - lit_radius;
  const double fraction = r > lit_radius ? lit_radius / r * std::sqrt((r - lit_radius) / dark_width) : 1;
  return {towards_zero(fraction * film_x), towards_zero(fraction * film_y)};
}

std::vector<FilmPoint> pupil_film_points(const Lens& lens, const Film& film, std::size_t count, std::uint32_t seed,
                                         double lit_radius) {
  std::vector<FilmPoint> points;
  if (!lens.rotationally_symmetric()) {
    for (std::size_t k = 0; k < count; ++k) points.push_back(error_film_point(film, k, seed, lit_radius));
    return points;
  }
  const auto nearest = [](double centre, double half) { return std::clamp(0.0, centre - half, centre + half); };
  const auto farthest = [](double centre, double half) { return centre + std::copysign(half, centre); };
  const double near_x = nearest(film.shift_x_mm, film.width_mm / 2),
               near_y = nearest(film.shift_y_mm, film.height_mm / 2),
               corner_x = farthest(film.shift_x_mm, film.width_mm / 2),
               corner_y = farthest(film.shift_y_mm, film.height_mm / 2);
  const double corner = std::hypot(corner_x, corner_y), fraction = std::min(lit_radius / corner, 1.0);
  const double far_x = fraction * corner_x, far_y = fraction * corner_y;
  const Kronecker<2> chance(2ull * seed);
  for (std::size_t k = 0; k < count; ++k) {
    const bool end = k == 0 || k + 1 == count;
    const double step = static_cast<double>(k) + (end ? 0 : chance(k)[0] - 0.5);
    const double even = step / static_cast<double>(std::max<std::size_t>(count - 1, 1));
    // Pupils shrink fast near the edge of the lit area of the film.
    const double t = fraction < 1 ? 1 - (1 - even) * (1 - even) * (1 - even) : even;
    points.push_back({towards_zero(near_x + t * (far_x - near_x)), towards_zero(near_y + t * (far_y - near_y))});
  }
  return points;
}

PointLines::PointLines(const FilmPoint& point) noexcept : film(point) {
  film_x.fill(point.x), film_y.fill(point.y);
  film_x_float.fill(static_cast<float>(point.x)), film_y_float.fill(static_cast<float>(point.y));
  pupil_x.fill(0), pupil_y.fill(0);
  pupil_x_float.fill(0), pupil_y_float.fill(0);
}

void PointLines::put(std::size_t line, double x, double y) noexcept {
  pupil_x[line] = pupil_x_float[line] = static_cast<float>(x);
  pupil_y[line] = pupil_y_float[line] = static_cast<float>(y);
}

PointLines error_lines(const FilmPoint& film, const camera_detail::ExactModel<double>& exact, std::size_t wavelength,
                       std::uint64_t seed) noexcept {
  constexpr std::size_t count = lines_per_point - uniform_lines;
  static_assert(count == uniform_lines);
  PointLines lines(film);
  std::array<double, count> u, v, x, y, areas;
  const auto put = [&](std::size_t first) {
    exact.pupils().sample(count, lines.film_x.data(), lines.film_y.data(), u.data(), v.data(), {.all = wavelength},
                          x.data(), y.data(), areas.data());
    for (std::size_t i = 0; i < count; ++i) lines.put(first + i, x[i], y[i]);
  };
  const Kronecker<2> even(2 * seed), rims(2 * seed + 1);
  for (std::size_t i = 0; i < count; ++i) {
    const auto point = even(i);
    u[i] = point[0], v[i] = point[1];
  }
  put(0);

  // The pupils of the table are slightly larger than the pupils of the lens. Bisection between the middle and the rim
  // of the table's pupil finds the rim of the lens's pupil; every fourth line searches the rim of a central
  // obscuration.
  std::array<double, count> passing, beyond, chance;
  passing.fill(0.5);
  for (std::size_t i = 0; i < count; ++i) {
    const auto point = rims(i);
    u[i] = point[0], chance[i] = point[1];
    v[i] = beyond[i] = i % 4 == 3 ? 0 : 1;
  }
  std::array<double, 6 * count> storage;
  const RayArrays<double> rays{&storage[0],         &storage[count],     &storage[2 * count],
                               &storage[3 * count], &storage[4 * count], &storage[5 * count]};
  std::array<RayFate, count> fates;
  for (int step = 0; step < 10; ++step) {
    put(uniform_lines);
    exact.to_scene(count, lines.lines().from(uniform_lines), {.all = wavelength}, rays, fates.data());
    for (std::size_t i = 0; i < count; ++i) {
      (fates[i] == RayFate::transmitted ? passing : beyond)[i] = v[i];
      v[i] = (passing[i] + beyond[i]) / 2;
    }
  }
  // Use positions at the rim or, at random, slightly inside, because the pupil of a model may be slightly smaller.
  for (std::size_t i = 0; i < count; ++i) {
    v[i] = passing[i] + 0.05 * chance[i] * chance[i] * chance[i] * (0.5 - passing[i]);
  }
  put(uniform_lines);
  return lines;
}

namespace {

template <class T>
void trace_lines(const RayModel& model, bool own_pupil, const TwoPlaneRays<const T>& lines, const FilmPoint& film,
                 std::size_t wavelength, PointRays& out) {
  constexpr std::size_t count = lines_per_point;
  alignas(64) std::array<T, 6 * count> storage;
  const RayArrays<T> rays{&storage[0],         &storage[count],     &storage[2 * count],
                          &storage[3 * count], &storage[4 * count], &storage[5 * count]};
  std::array<RayFate, count> fates;
  model.to_scene(count, lines, {.all = wavelength}, rays, fates.data());
  for (std::size_t i = 0; i < count; ++i) {
    out.rays[i] = {{rays.x[i], rays.y[i], rays.z[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]}};
    out.reaches[i] = fates[i] == RayFate::transmitted;
    out.passes[i] =
        out.reaches[i] && (!own_pupil || model.pupils().contains(film, lines.pupil_x[i], lines.pupil_y[i], wavelength));
  }
}

Tracing tracing(const RayModel& model, bool own_pupil) {
  const bool in_double = model.kind() == ModelKind::exact_double;
  return [&model, in_double, own_pupil](const PointLines& lines, std::size_t wavelength, PointRays& out) {
    if (in_double) {
      trace_lines<double>(model, own_pupil, lines.lines(), lines.film, wavelength, out);
    } else {
      trace_lines<float>(model, own_pupil, lines.float_lines(), lines.film, wavelength, out);
    }
  };
}

}  // namespace

Tracing tracing(const RayModel& model) { return tracing(model, !model.clips_at_apertures() && !model.pinhole()); }

Tracing tracing_within(const RayModel& model) { return tracing(model, false); }

}  // namespace petzval::analysis_detail
