// SPDX-License-Identifier: Apache-2.0
#include "least_squares.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "chart.hpp"
#include "core/householder.hpp"
#include "core/text.hpp"
#include "data.hpp"
#include "petzval/core/error.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::polynomial_detail {
namespace {

/// Traces lines through the lens.
Rays trace(const Lens& lens, const TwoPlanes& space, const Lines& lines, std::size_t wavelength) {
  Rays rays = rays_along(lens, space, lines);
  petzval::trace(lens, rays.size(), rays.arrays<const double>(), rays.arrays<double>(), rays.fates.data(), nullptr,
                 {.travel = Travel::to_scene, .wavelengths = {wavelength}});
  return rays;
}

double square(const Vec3<double>& v) noexcept { return glm::dot(v, v); }

/// Collects the sum of squares and the largest value.
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

/// Errors of a fit for some lines, in direction and in offset.
std::array<Errors, 2> errors_of(const Lens& lens, const RayPolynomial& polynomial, std::size_t wavelength,
                                const Lines& lines) {
  const double reference_z = polynomial.domain().reference_z;
  const Rays exact = trace(lens, polynomial.domain().space, lines, wavelength);
  Rays rays(lines.size());
  polynomial.to_scene<double>(lines.size(), lines.rays(), {}, rays.arrays<double>(), rays.fates.data());
  Errors direction, offset;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (exact.fates[i] != RayFate::transmitted || rays.fates[i] != RayFate::transmitted) continue;
    const Vec3<double> towards = exact.direction(i);
    direction.see(square(rays.direction(i) - towards));
    const Vec3<double> apart = rays.origin(i) - exact.origin(i);  // difference of the feet of both perpendiculars
    const Vec3<double> from_reference = exact.origin(i) - Vec3<double>(0, 0, reference_z);
    offset.see(square(apart + glm::dot(from_reference, towards) * towards));
  }
  return {direction, offset};
}

/// Powers 0 to 10 of some numbers.
template <std::size_t N>
class Powers {
 public:
  explicit Powers(const std::array<double, N>& numbers) {
    for (std::size_t k = 0; k < N; ++k) {
      double power = 1;
      for (double& each : powers_[k]) each = std::exchange(power, power * numbers[k]);
    }
  }
  double operator()(std::size_t number, int exponent) const {
    return powers_[number][static_cast<std::size_t>(exponent)];
  }

 private:
  std::array<std::array<double, 11>, N> powers_;
};

/// Equations of lines for the coefficients: the film coefficients, followed by the pupil coefficients. In a lens of
/// revolution both axes share the coefficients; with mirror symmetry each axis has its own. Direction and offset are
/// two right-hand sides.
class Equations {
 public:
  struct Row {
    Eigen::RowVectorXd left;
    Eigen::RowVector2d right;
  };

  Equations(int degree, const RayPolynomial::Domain& domain) : domain_(domain) {
    const int n = (degree - 1) / 2;
    if (domain.along_x) mirror_terms_ = mirror_terms(degree);
    for (int w = 0; w <= n && !domain.along_x; ++w) {
      for (int v = 0; v <= n - w; ++v) {
        for (int u = 0; u <= n - w - v; ++u) terms_.push_back({u, v, w});
      }
    }
    for (Row& row : rows_) row.left.resize(2 * count());
  }

  /// Number of film coefficients.
  Eigen::Index count() const noexcept { return static_cast<Eigen::Index>(terms_.size() + mirror_terms_.size()); }
  /// Index of the system that holds the coefficients of an axis.
  std::size_t system(std::size_t axis) const noexcept { return domain_.along_x ? axis : 0; }
  std::size_t systems() const noexcept { return domain_.along_x ? 2 : 1; }

  /// Equations of one line, along x and y; valid until the next call.
  const std::array<Row, 2>& of(const Lines& lines, const Rays& traced, std::size_t i) {
    const auto [along_x, along_y] = sections(domain_);
    const double fx = lines.film_x[i] / domain_.film_radius, fy = lines.film_y[i] / domain_.film_radius;
    const double px = (lines.pupil_x[i] - along_x.pupil_shift * lines.film_x[i]) / along_x.pupil_radius;
    const double py = (lines.pupil_y[i] - along_y.pupil_shift * lines.film_y[i]) / along_y.pupil_radius;
    const auto& [x, y, z, dx, dy, dz] = traced.v;
    const auto [sx, sy, ox, oy] = into_chart<double>({x[i], y[i], z[i] - domain_.reference_z, dx[i], dy[i], dz[i]});
    rows_[0].right << sx, ox;
    rows_[1].right << sy, oy;
    const auto fill = [this](Row& row, Eigen::Index k, double term, double film, double pupil) {
      row.left[k] = term * film;
      row.left[count() + k] = term * pupil;
    };
    if (domain_.along_x) {
      const Powers<4> powers({fx, px, fy, py});
      for (Eigen::Index k = 0; k < count(); ++k) {
        const auto [film, pupil, other_film, other_pupil] = mirror_terms_[static_cast<std::size_t>(k)];
        fill(rows_[0], k, powers(0, film) * powers(1, pupil) * powers(2, other_film) * powers(3, other_pupil), fx, px);
        fill(rows_[1], k, powers(2, film) * powers(3, pupil) * powers(0, other_film) * powers(1, other_pupil), fy, py);
      }
    } else {
      const Powers<3> powers({fx * fx + fy * fy, fx * px + fy * py, px * px + py * py});
      for (Eigen::Index k = 0; k < count(); ++k) {
        const auto [u, v, w] = terms_[static_cast<std::size_t>(k)];
        const double term = powers(0, u) * powers(1, v) * powers(2, w);
        fill(rows_[0], k, term, fx, px);
        fill(rows_[1], k, term, fy, py);
      }
    }
    return rows_;
  }

 private:
  const RayPolynomial::Domain& domain_;
  std::vector<std::array<int, 3>> terms_;  // exponents of u, v and w, in the order of coefficients
  std::vector<std::array<int, 4>> mirror_terms_;
  std::array<Row, 2> rows_;
};

}  // namespace

std::vector<std::array<int, 4>> mirror_terms(int degree) {
  std::vector<std::array<int, 4>> result;
  for (const int odd : {0, 1}) {
    const int n = (degree - 1) / 2 - odd;
    for (int l = 0; l <= n; ++l) {
      for (int k = 0; k <= n - l; ++k) {
        for (int j = 0; j <= n - l - k; ++j) {
          for (int i = 0; i <= n - l - k - j; ++i) result.push_back({2 * i, 2 * j, 2 * k + odd, 2 * l + odd});
        }
      }
    }
  }
  return result;
}

Rays rays_along(const Lens& lens, const TwoPlanes& space, const Lines& lines) {
  const double last_z = lens.surfaces().back().vertex_z;
  const double fraction = (last_z - space.film_z) / space.depth();  // fraction of the distance from film to pupil
  const double towards = towards_scene(lens, space);
  Rays rays(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double dx = lines.pupil_x[i] - lines.film_x[i], dy = lines.pupil_y[i] - lines.film_y[i], dz = space.depth();
    const double per_length = towards / std::sqrt(dx * dx + dy * dy + dz * dz);
    const std::array<double, 6> ray{lines.film_x[i] + fraction * dx,
                                    lines.film_y[i] + fraction * dy,
                                    last_z,
                                    dx * per_length,
                                    dy * per_length,
                                    dz * per_length};
    for (std::size_t k = 0; k < ray.size(); ++k) rays.v[k][i] = ray[k];
  }
  return rays;
}

RayPolynomial::Fit fit(const Lens& lens, const RayPolynomial::Domain& domain, int degree, std::size_t wavelength,
                       const FitLines& lines) {
  Equations equations(degree, domain);
  const Rays rays = trace(lens, domain.space, lines.fitted, wavelength);
  const auto passed = std::count(rays.fates.begin(), rays.fates.end(), RayFate::transmitted);
  const Eigen::Index count = equations.count(), systems = static_cast<Eigen::Index>(equations.systems());
  const double nm = lens.wavelengths_nm()[wavelength];
  if (passed < 2 * systems * count) {
    throw Error(lens.name() + ": polynomial of degree " + std::to_string(degree) + ": " + std::to_string(passed) +
                " rays from a film of radius " + to_text(domain.film_radius) + " mm pass at " + to_text(nm) +
                " nm; must be at least " + std::to_string(2 * systems * count) +
                ": use a film within the image circle");
  }
  struct System {
    Eigen::MatrixXd both;  // left and right sides of the equations
    Eigen::Index rows = 1;
    void add(Eigen::Index row, double weight, const Equations::Row& equation) {
      both.row(row).head(equation.left.size()) += weight * equation.left;
      both.row(row).tail<2>() += weight * equation.right;
    }
  };
  std::vector<System> all(equations.systems());
  for (System& system : all) system.both.setZero(1 + 2 * passed / systems, 2 * count + 2);

  // Focus of the film centre: over its pupil, the first moments of direction and offset must equal the moments of the
  // lens, so that the rays meet the axis in the same plane on average. The large weight makes this equation hold almost
  // exactly. Heavy rows come first for the stability of QR.
  const Rays axial = trace(lens, domain.space, lines.axial, wavelength);
  const double heavy = 1e4 / static_cast<double>(std::max<std::size_t>(1, axial.size()));
  for (std::size_t i = 0; i < axial.size(); ++i) {
    if (axial.fates[i] != RayFate::transmitted) continue;
    const auto& along = equations.of(lines.axial, axial, i);
    const double x = lines.axial.pupil_x[i], y = lines.axial.pupil_y[i], depth = domain.space.depth();
    const double cosine_squared = depth * depth / (x * x + y * y + depth * depth);
    const double light = heavy * cosine_squared * cosine_squared / domain.pupil_radius;
    for (const std::size_t axis : {0u, 1u}) {
      all[equations.system(axis)].add(0, light * (axis == 0 ? x : y), along[axis]);
    }
  }

  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays.fates[i] != RayFate::transmitted) continue;
    const auto& along = equations.of(lines.fitted, rays, i);
    for (const std::size_t axis : {0u, 1u}) {
      System& system = all[equations.system(axis)];
      system.add(system.rows++, 1, along[axis]);
    }
  }

  RayPolynomial::Fit fit;
  fit.wavelength_nm = nm;
  for (System& system : all) {
    const Eigen::Index unknowns = 2 * count;
    core_detail::to_triangle(system.both, unknowns);
    const auto triangle = system.both.topLeftCorner(unknowns, unknowns).triangularView<Eigen::Upper>();
    const auto append = [&](std::vector<double>& by_film, std::vector<double>& by_pupil, Eigen::Index side) {
      const Eigen::VectorXd solution = triangle.solve(system.both.col(unknowns + side).head(unknowns));
      by_film.insert(by_film.end(), solution.begin(), solution.begin() + count);
      by_pupil.insert(by_pupil.end(), solution.begin() + count, solution.end());
    };
    append(fit.direction_by_film, fit.direction_by_pupil, 0);
    append(fit.offset_by_film, fit.offset_by_pupil, 1);
  }

  const RayPolynomial polynomial(degree, domain, {fit});
  const auto [direction, offset] = errors_of(lens, polynomial, wavelength, lines.fresh);
  fit.rms_rad = direction.rms();
  fit.rms_mm = offset.rms();
  fit.max_rad = direction.max();
  fit.max_mm = offset.max();
  for (const Lines* edge : {&lines.rims, &lines.edges}) {
    const auto [direction_there, offset_there] = errors_of(lens, polynomial, wavelength, *edge);
    fit.max_rad = std::max(fit.max_rad, direction_there.max());
    fit.max_mm = std::max(fit.max_mm, offset_there.max());
  }
  // Margin for rays between the tested rays.
  constexpr double error_margin = 1.1;
  fit.max_rad *= error_margin;
  fit.max_mm *= error_margin;
  return fit;
}

}  // namespace petzval::polynomial_detail
