// SPDX-License-Identifier: Apache-2.0
#include "least_squares.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "chart.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::inline v0::polynomial_detail {
namespace {

/// Rays as arrays of their own.
struct Rays {
  std::array<std::vector<double>, 6> v;
  std::vector<RayFate> fates;

  explicit Rays(std::size_t count) : fates(count) { v.fill(std::vector<double>(count)); }
  std::size_t size() const noexcept { return fates.size(); }
  template <class T>
  RayArrays<T> arrays() noexcept {
    return {v[0].data(), v[1].data(), v[2].data(), v[3].data(), v[4].data(), v[5].data()};
  }
  Vec3<double> origin(std::size_t i) const noexcept { return {v[0][i], v[1][i], v[2][i]}; }
  Vec3<double> direction(std::size_t i) const noexcept { return {v[3][i], v[4][i], v[5][i]}; }
};

/// Traces the lines through the lens. Rays start at the last vertex, so that no digits are lost for a distant film or
/// pupil.
Rays trace(const Lens& lens, const TwoPlanes& space, const MeridianLines& lines, std::size_t wavelength) {
  const double last_z = lens.surfaces().back().vertex_z;
  const double part = (last_z - space.film_z) / space.depth();  // of the distance from the film to the pupil
  const double towards = towards_scene(lens, space);
  Rays rays(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double dx = lines.pupil_x[i], dy = lines.pupil_y[i] - lines.film_y[i], dz = space.depth();
    const double per_length = towards / std::sqrt(dx * dx + dy * dy + dz * dz);
    const std::array<double, 6> ray{
        part * dx, lines.film_y[i] + part * dy, last_z, dx * per_length, dy * per_length, dz * per_length};
    for (std::size_t k = 0; k < ray.size(); ++k) rays.v[k][i] = ray[k];
  }
  petzval::trace(lens, rays.size(), rays.arrays<const double>(), rays.arrays<double>(), rays.fates.data(), nullptr,
                 {.travel = Travel::to_scene, .wavelengths = {wavelength}});
  return rays;
}

double square(const Vec3<double>& v) noexcept { return glm::dot(v, v); }

/// Sum of squares, and the largest value.
struct Errors {
  double sum = 0, largest = 0;
  std::size_t count = 0;

  void see(double squared) noexcept {
    sum += squared;
    largest = std::max(largest, squared);
    ++count;
  }
  double rms() const noexcept { return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0; }
  double max() const noexcept { return std::sqrt(largest); }
};

/// The errors of a fit for some lines, in direction and offset.
std::array<Errors, 2> errors_of(const Lens& lens, const RayPolynomial& polynomial, std::size_t wavelength,
                                const MeridianLines& lines) {
  const double reference_z = polynomial.domain().reference_z;
  const Rays exact = trace(lens, polynomial.domain().space, lines, wavelength);
  Rays rays(lines.size());
  const std::vector<double> film_x(lines.size(), 0.0);
  polynomial.to_scene<double>(lines.size(),
                              {film_x.data(), lines.film_y.data(), lines.pupil_x.data(), lines.pupil_y.data()}, {},
                              rays.arrays<double>(), rays.fates.data());
  Errors direction, offset;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (exact.fates[i] != RayFate::transmitted || rays.fates[i] != RayFate::transmitted) continue;
    const Vec3<double> towards = exact.direction(i);
    direction.see(square(rays.direction(i) - towards));
    const Vec3<double> apart = rays.origin(i) - exact.origin(i);  // between the feet of the perpendiculars
    const Vec3<double> from_reference = exact.origin(i) - Vec3<double>(0, 0, reference_z);
    offset.see(square(apart + glm::dot(from_reference, towards) * towards));
  }
  return {direction, offset};
}

}  // namespace

RayPolynomial::Fit fit(const Lens& lens, const RayPolynomial::Domain& domain, int degree, std::size_t wavelength,
                       const FitLines& lines) {
  const std::vector<RayPolynomial::Term> terms = RayPolynomial::terms(degree);
  const auto count = static_cast<Eigen::Index>(terms.size());
  const Rays rays = trace(lens, domain.space, lines.fitted, wavelength);
  const auto passed = std::count(rays.fates.begin(), rays.fates.end(), RayFate::transmitted);
  const double nm = lens.wavelengths_nm()[wavelength];
  if (passed < 2 * count) {
    throw Error(lens.name() + ": polynomial of degree " + std::to_string(degree) + ": " + std::to_string(passed) +
                " rays from a film of radius " + to_text(domain.film_radius) + " mm get through at " + to_text(nm) +
                " nm, wanted " + std::to_string(2 * count) + " or more: a film within the image circle");
  }

  // Two equations for each ray, along x and along y, for A (left) and B (right). Direction and offset are two
  // right-hand sides of the same equations.
  const int n = (degree - 1) / 2;
  const auto equate = [&](const MeridianLines& of, const Rays& traced, std::size_t i, auto&& equations, auto&& wanted) {
    const double fy = of.film_y[i] / domain.film_radius;
    const double px = of.pupil_x[i] / domain.pupil_radius;
    const double py = (of.pupil_y[i] - domain.pupil_shift * of.film_y[i]) / domain.pupil_radius;
    const std::array<double, 3> invariants{fy * fy, fy * py, px * px + py * py};
    std::array<std::array<double, 6>, 3> powers;
    for (std::size_t k = 0; k < 3; ++k) {
      powers[k][0] = 1;
      for (std::size_t e = 0; e < static_cast<std::size_t>(n); ++e) powers[k][e + 1] = powers[k][e] * invariants[k];
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto [u, v, w] = terms[static_cast<std::size_t>(k)];
      const double term = powers[0][static_cast<std::size_t>(u)] * powers[1][static_cast<std::size_t>(v)] *
                          powers[2][static_cast<std::size_t>(w)];
      equations(0, k) = 0;
      equations(0, count + k) = term * px;
      equations(1, k) = term * fy;
      equations(1, count + k) = term * py;
    }
    const SceneLine line = scene_line(traced.direction(i), traced.origin(i) - Vec3<double>(0, 0, domain.reference_z));
    wanted.row(0) << line.sx, line.ox;
    wanted.row(1) << line.sy, line.oy;
  };
  Eigen::MatrixXd equations(1 + 2 * passed, 2 * count);
  Eigen::MatrixX2d wanted(1 + 2 * passed, 2);

  // The focus of the film's centre: the first moments of direction and offset over its pupil are those of the lens, so
  // that rays meet the axis in the same plane on average. A row as heavy as this one holds nearly exactly; heavy rows
  // come first for the sake of QR.
  equations.row(0).setZero(), wanted.row(0).setZero();
  const Rays axial = trace(lens, domain.space, lines.axial, wavelength);
  Eigen::MatrixXd two_equations(2, 2 * count);
  Eigen::Matrix2d two_wanted;
  const double heavy = 1e4 / static_cast<double>(std::max<std::size_t>(1, axial.size()));
  for (std::size_t i = 0; i < axial.size(); ++i) {
    if (axial.fates[i] != RayFate::transmitted) continue;
    equate(lines.axial, axial, i, two_equations, two_wanted);
    const double x = lines.axial.pupil_x[i], y = lines.axial.pupil_y[i], depth = domain.space.depth();
    const double cosine_squared = depth * depth / (x * x + y * y + depth * depth);
    const double light = heavy * cosine_squared * cosine_squared / domain.pupil_radius;
    equations.row(0) += light * (x * two_equations.row(0) + y * two_equations.row(1));
    wanted.row(0) += light * (x * two_wanted.row(0) + y * two_wanted.row(1));
  }

  Eigen::Index row = 1;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays.fates[i] != RayFate::transmitted) continue;
    equate(lines.fitted, rays, i, equations.middleRows<2>(row), wanted.middleRows<2>(row));
    row += 2;
  }
  const Eigen::MatrixX2d solution = equations.householderQr().solve(wanted);

  const auto part = [&](Eigen::Index column, Eigen::Index from) {
    const auto numbers = solution.col(column).segment(from, count);
    return std::vector<double>(numbers.begin(), numbers.end());
  };
  RayPolynomial::Fit fit;
  fit.wavelength_nm = nm;
  fit.direction_by_film = part(0, 0);
  fit.direction_by_pupil = part(0, count);
  fit.offset_by_film = part(1, 0);
  fit.offset_by_pupil = part(1, count);

  const RayPolynomial polynomial(degree, domain, {fit});
  const auto [direction, offset] = errors_of(lens, polynomial, wavelength, lines.fresh);
  fit.rms_rad = direction.rms();
  fit.rms_mm = offset.rms();
  fit.max_rad = direction.max();
  fit.max_mm = offset.max();
  for (const MeridianLines* edge : {&lines.rims, &lines.edges}) {
    const auto [direction_there, offset_there] = errors_of(lens, polynomial, wavelength, *edge);
    fit.max_rad = std::max(fit.max_rad, direction_there.max());
    fit.max_mm = std::max(fit.max_mm, offset_there.max());
  }
  // For rays between those that were looked at.
  constexpr double to_spare = 1.1;
  fit.max_rad *= to_spare;
  fit.max_mm *= to_spare;
  return fit;
}

}  // namespace petzval::inline v0::polynomial_detail
