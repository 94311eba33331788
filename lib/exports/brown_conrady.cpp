// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/distortion.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/least_squares.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {
namespace {

constexpr double widest_field = radians(88.0);

/// A film position: distances from the centre of projection divided by the focal length, in both images.
struct Radii {
  double distorted = 0, undistorted = 0;
};

/// A radius before and after the mapping.
struct Pair {
  double from = 0, to = 0;
};

std::vector<Radii> radii_of(const LensDistortion& distortion) {
  constexpr int grid_points = 33;
  const Film& film = distortion.camera().film();
  std::vector<Radii> radii;
  for (int row = 0; row < grid_points; ++row) {
    for (int column = 0; column < grid_points; ++column) {
      const Vec2<double> at{film.columns * (column / (grid_points - 1.0)), film.rows * (row / (grid_points - 1.0))};
      const auto undistorted = distortion.undistorted(at);
      if (!undistorted) continue;
      const auto radius = [&](const Vec2<double>& position) {
        const Vec2<double> tangent = (position - distortion.centre()) / distortion.focal_length_px();
        return std::hypot(tangent.x, tangent.y);
      };
      radii.push_back({radius(at), radius(*undistorted)});
    }
  }
  return radii;
}

double polynomial(double r2, const double* k) noexcept { return 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])); }

using Coefficients = std::array<double, 6>;

double ratio(const Coefficients& k, double r2) noexcept { return polynomial(r2, &k[0]) / polynomial(r2, &k[3]); }

double squares(const std::vector<Pair>& pairs, const Coefficients& k) noexcept {
  double sum = 0;
  for (const Pair& pair : pairs) {
    const double error = pair.from * ratio(k, pair.from * pair.from) - pair.to;
    sum += error * error;
  }
  return sum;
}

constexpr double monotone_range =
    1.25;  ///< the mapped radius should increase up to this multiple of the largest radius

/// True if the denominator stays above 1e-3 up to a radius.
bool without_pole(const Coefficients& k, double radius) noexcept {
  constexpr int steps = 200;
  for (int i = 1; i <= steps; ++i) {
    const double r = radius * i / steps;
    if (!(polynomial(r * r, &k[3]) > 1e-3)) return false;
  }
  return true;
}

/// The radius, at most `most`, up to which the mapped radius increases.
double rises_to(const Coefficients& k, double most) noexcept {
  constexpr int steps = 400;
  double before = 0;
  for (int i = 1; i <= steps; ++i) {
    const double r = most * i / steps, found = r * ratio(k, r * r);
    if (!(found > before) || !(polynomial(r * r, &k[3]) > 1e-3)) return most * (i - 1) / steps;
    before = found;
  }
  return most;
}

/// True if no term is so large that other terms must cancel it; radii are relative to the largest radius. (Terms of
/// fisheyes of 150 degrees reach 45. If the scale over the film differs from the scale on the axis, terms of numerator
/// and denominator reach 1e12.)
bool bounded(const Coefficients& k) noexcept {
  return std::all_of(k.begin(), k.end(), [](double term) { return std::abs(term) <= 100; });
}

/// Numbers of terms of numerator and denominator.
struct Terms {
  int in_numerator = 3, in_denominator = 0;
};

/// Least squares solution for the first terms of numerator and denominator. row(pair, r2) gives the derivatives by N
/// and by D, and the right-hand side.
template <class Row>
Coefficients solved(const std::vector<Pair>& pairs, const Terms& terms, const Row& row) {
  const int n = terms.in_numerator, unknowns = n + terms.in_denominator;
  Eigen::MatrixXd rows(pairs.size(), unknowns);
  Eigen::VectorXd targets(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double r2 = pairs[i].from * pairs[i].from;
    const auto [by_numerator, by_denominator, sum] = row(pairs[i], r2);
    const auto at = static_cast<Eigen::Index>(i);
    for (int j = 0; j < unknowns; ++j) {
      rows(at, j) = j < n ? std::pow(r2, j + 1) * by_numerator : std::pow(r2, j - n + 1) * by_denominator;
    }
    targets(at) = sum;
  }
  // The solution of least norm, because numerator and denominator may be redundant, for example without distortion.
  const Eigen::VectorXd solution = core_detail::least_squares(rows, targets);
  Coefficients k{};
  for (int j = 0; j < unknowns; ++j) k[static_cast<std::size_t>(j < n ? j : j - n + 3)] = solution(j);
  return k;
}

struct Slopes {
  double by_numerator = 0, by_denominator = 0, sum = 0;
};

/// After multiplication by D, the equation to = from N / D is linear in the coefficients. Weights 1 / D of the previous
/// round convert its errors to errors of `to` (Sanathanan and Koerner 1963).
Coefficients linear_round(const std::vector<Pair>& pairs, const Terms& terms, const Coefficients& before) {
  return solved(pairs, terms, [&](const Pair& pair, double r2) {
    const double weight = 1 / polynomial(r2, &before[3]);
    return Slopes{weight * pair.from, -weight * pair.to, weight * (pair.to - pair.from)};
  });
}

/// Gauss-Newton iteration for the errors of `to`. Each step reduces the errors and avoids poles.
Coefficients refined(const std::vector<Pair>& pairs, const Terms& terms, Coefficients k, double reach) {
  double now = squares(pairs, k);
  for (int round = 0; round < 30; ++round) {
    const Coefficients step = solved(pairs, terms, [&](const Pair& pair, double r2) {
      const double slope = pair.from / polynomial(r2, &k[3]), value = ratio(k, r2);
      return Slopes{slope, -slope * value, pair.to - pair.from * value};
    });
    double step_fraction = 1, next = now;
    Coefficients there = k;
    for (; step_fraction > 1e-3; step_fraction /= 2) {
      for (std::size_t j = 0; j < k.size(); ++j) there[j] = k[j] + step_fraction * step[j];
      next = without_pole(there, reach) ? squares(pairs, there) : now;
      if (next < now) break;
    }
    if (!(next < now)) break;
    const bool settled = next > now * (1 - 1e-9);
    k = there, now = next;
    if (settled) break;
  }
  return k;
}

/// Least-squares coefficients without a pole up to the radius `reach`.
/// @param fewer coefficients with a shorter denominator, a second starting point of the search
Coefficients fit_coefficients(const std::vector<Pair>& pairs, const Terms& terms, const Coefficients& fewer,
                              double reach) {
  if (terms.in_denominator == 0) return linear_round(pairs, terms, {});
  Coefficients best = refined(pairs, terms, fewer, reach), round{};
  for (int i = 0; i < 8; ++i) {
    round = linear_round(pairs, terms, round);
    if (!without_pole(round, reach)) continue;
    const Coefficients found = refined(pairs, terms, round, reach);
    if (squares(pairs, found) < squares(pairs, best)) best = found;
  }
  return best;
}

void measure(BrownConrady& model, const std::vector<Pair>& pairs, double focal_length_px) {
  double squares = 0;
  model.largest_px = 0;
  for (const Pair& pair : pairs) {
    const double error = std::abs(model.radius(pair.from) - pair.to) * focal_length_px;
    squares += error * error;
    model.largest_px = std::max(model.largest_px, error);
  }
  model.rms_px = std::sqrt(squares / static_cast<double>(pairs.size()));
}

}  // namespace

std::string_view name(BrownConradyDirection direction) noexcept {
  return direction == BrownConradyDirection::to_undistorted ? "Brown-Conrady D-U" : "Brown-Conrady U-D";
}

double BrownConrady::radius(double r) const noexcept { return r * polynomial(r * r, &k[0]) / polynomial(r * r, &k[3]); }

BrownConrady fit_brown_conrady(const LensDistortion& distortion, BrownConradyDirection direction, RadialForm form) {
  const Camera& camera = distortion.camera();
  const std::string where = camera.lens().name() + ": Brown-Conrady: ";
  if (!with_iris(camera.lens(), {}).rotationally_symmetric()) {  // blades do not bend rays
    throw Error(where + "the lens has cylinders; must be a lens of revolution, with radial distortion");
  }
  if (camera.film().tilted()) throw Error(where + "the film is tilted; must be upright, with radial distortion");
  if (const double widest = distortion.widest_field_rad(); widest > widest_field) {
    throw Error(where + "the film sees a field of " + to_text(degrees(widest), 3) +
                " degrees, as a fisheye's; must be below 88 for a pinhole image");
  }
  const std::vector<Radii> radii = radii_of(distortion);
  if (radii.empty()) throw Error(where + "no light reaches the film");

  BrownConrady result{.direction = direction, .pinhole = distortion.pinhole()};
  const bool to_undistorted = direction == BrownConradyDirection::to_undistorted;
  std::vector<Pair> pairs;
  double farthest = 0;
  for (const Radii& r : radii) {
    pairs.push_back(to_undistorted ? Pair{r.distorted, r.undistorted} : Pair{r.undistorted, r.distorted});
    farthest = std::max(farthest, pairs.back().from);
    result.field_rad = std::max(result.field_rad, std::atan(r.undistorted));
  }
  if (!(farthest > 0)) throw Error(where + "no light reaches the film outside its centre");
  // Radii relative to the largest one, so that all powers have the same magnitude.
  std::vector<Pair> scaled;
  for (const Pair& pair : pairs) scaled.push_back({pair.from / farthest, pair.to / farthest});
  const double px = distortion.focal_length_px().x;
  const auto model_of = [&](const Coefficients& k) {
    BrownConrady model = result;
    for (std::size_t j = 0; j < k.size(); ++j) {
      model.k[j] = k[j] / std::pow(farthest, 2.0 * static_cast<double>(j % 3 + 1));
    }
    measure(model, pairs, px);
    const double rise = farthest * rises_to(k, 4);
    model.rises_to_rad = std::atan(to_undistorted ? model.radius(rise) : rise);
    return model;
  };
  // Unnecessary terms would follow rounding errors and diverge beyond the film.
  constexpr double exact_px = 2e-5;
  std::vector<Terms> forms{{1, 0}, {2, 0}, {3, 0}};
  if (form == RadialForm::rational) forms.insert(forms.end(), {{3, 1}, {3, 2}, {3, 3}});
  BrownConrady rising = model_of({}), within = rising;
  Coefficients k{};
  for (const Terms& terms : forms) {
    k = fit_coefficients(scaled, terms, k, 1.1);
    const BrownConrady next = model_of(k);
    if (!bounded(k)) continue;
    if (next.rms_px < within.rms_px) within = next;
    if (rises_to(k, monotone_range) >= monotone_range && next.rms_px < 0.8 * rising.rms_px) rising = next;
    if (rising.rms_px < exact_px) break;
  }
  return rising.rms_px <= std::max(2 * within.rms_px, 0.001) ? rising : within;
}

}  // namespace petzval
