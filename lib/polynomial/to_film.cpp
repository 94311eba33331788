// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "chart.hpp"
#include "data.hpp"
#include "inverse.hpp"

namespace petzval {
namespace {

using polynomial_detail::horner;
using polynomial_detail::OfMirrors;
using FilmAndPupilPoint = polynomial_detail::Four<double>;

FilmAndPupilPoint sum(const FilmAndPupilPoint& a, double factor, const FilmAndPupilPoint& b) noexcept {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2], a[3] + factor * b[3]};
}

/// The same for mirror symmetry.
template <int n>
FilmAndPupilPoint chief(OfMirrors<n>, const double* c, const FilmAndPupilPoint& line) noexcept {
  // Solves both sections independently; the combined point may lie outside the film.
  const auto along = [](double s, const double* of) {
    const double sign = of[0] < 0 ? -1 : 1;
    const double height =
        polynomial_detail::chief_height(std::abs(s), [&](double h) { return sign * horner<n>(of, h * h); });
    return std::copysign(height, sign * s);
  };
  const double x = along(line[0], c), y = along(line[1], c + OfMirrors<n>::terms);
  const double within = std::max(std::hypot(x, y), 1.0);
  return {x / within, y / within, 0, 0};
}

/// Moves from the line of x to the line `target` over intermediate lines, in steps for which the iteration converges:
/// one step in most cases, several for a fisheye. Returns false if an iteration fails or the result is outside the
/// domain.
template <class Symmetry>
bool follow(const double* c, const FilmAndPupilPoint& target, FilmAndPupilPoint& x) noexcept {
  auto at = evaluate(Symmetry{}, c, x);
  const FilmAndPupilPoint first = at.value;
  double left = 1, step = 1;
  while (left > 0) {
    const double next = std::max(left - step, 0.0);
    FilmAndPupilPoint there = x;
    if (converge(Symmetry{}, c, sum(target, next, sum(first, -1, target)), at, there)) {
      x = there;
      left = next;
      step *= 2;
      if (left > 0) at = evaluate(Symmetry{}, c, x);
    } else if ((step /= 2) < 1.0 / 64) {
      return false;
    }
  }
  return polynomial_detail::within(x, polynomial_detail::within_domain);
}

/// Finds (f, p) of a line; returns false if no solution in the domain is found. Starts at a line of similar direction
/// and, if this fails, at the axis, because the first start may lie outside the fitted region.
template <class Symmetry>
bool solve(const double* c, const FilmAndPupilPoint& target, FilmAndPupilPoint& x) noexcept {
  x = chief(Symmetry{}, c, target);
  if (follow<Symmetry>(c, target, x)) return true;
  x = {};
  return follow<Symmetry>(c, target, x);
}

using Solve = bool (*)(const double*, const FilmAndPupilPoint& target, FilmAndPupilPoint&) noexcept;
constexpr auto solvers =
    polynomial_detail::by_symmetry_and_degree([]<class Symmetry>(Symmetry) -> Solve { return solve<Symmetry>; });

}  // namespace

void RayPolynomial::to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                            const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept {
  using polynomial_detail::inverse_block;
  const std::size_t loop = data_->loop();
  const Solve solve = solvers[loop];
  const Domain& domain = data_->domain;
  const auto [along_x, along_y] = polynomial_detail::sections(domain);
  const bool shared = wavelengths.shared();
  polynomial_detail::WavelengthFits::Buffer<double> buffer;
  const double* coefficients = shared ? data_->by_wavelength.coefficients(wavelengths.all, buffer) : nullptr;
  std::array<std::array<double, inverse_block>, 4> target, at;
  std::array<double, inverse_block> found;
  for (std::size_t begin = 0; begin < count; begin += inverse_block) {
    const std::size_t n = std::min(inverse_block, count - begin);
    std::array<bool, inverse_block> sound;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3<double> direction(-rays.dx[begin + i], -rays.dy[begin + i], -rays.dz[begin + i]);
      const Vec3<double> point(rays.x[begin + i], rays.y[begin + i], rays.z[begin + i] - domain.reference_z);
      const double length = direction.x * direction.x + direction.y * direction.y + direction.z * direction.z;
      const auto line = polynomial_detail::scene_line(direction, point);
      sound[i] = std::abs(length - 1) < 1e-3;
      target[0][i] = line.sx, target[1][i] = line.sy, target[2][i] = line.ox, target[3][i] = line.oy;
      found[i] = 0;
    }
    constexpr std::size_t max_single_rays = 2;  // cheaper one by one than as a block
    if (coefficients && n > max_single_rays && loop < polynomial_detail::degree_count) {
      for (auto& column : target) std::fill(column.begin() + n, column.end(), column[0]);
      polynomial_detail::inverse_loops()[loop](coefficients, target, at, found);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t o = begin + i;
      FilmAndPupilPoint x{};
      bool lit = sound[i] && found[i] > 0;
      if (lit) {
        x = {at[0][i], at[1][i], at[2][i], at[3][i]};
      } else if (sound[i] && found[i] == 0) {
        const double* const c = shared ? coefficients : data_->by_wavelength.coefficients(wavelengths.at(o), buffer);
        lit = c && solve(c, {target[0][i], target[1][i], target[2][i], target[3][i]}, x);
      }
      if (!lit) x = {};
      lines.film_x[o] = x[0] * domain.film_radius;
      lines.film_y[o] = x[1] * domain.film_radius;
      lines.pupil_x[o] = x[2] * along_x.pupil_radius + along_x.pupil_shift * lines.film_x[o];
      lines.pupil_y[o] = x[3] * along_y.pupil_radius + along_y.pupil_shift * lines.film_y[o];
      fates[o] = lit ? RayFate::transmitted : RayFate::outside_fit;
    }
  }
}

}  // namespace petzval
