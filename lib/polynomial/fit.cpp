// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/low_discrepancy.hpp"
#include "data.hpp"
#include "least_squares.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval {
namespace {

using polynomial_detail::Lines;

/// Samples of the pupils of film points, over the part of the film that represents the rest by symmetry.
class Samples {
 public:
  Samples(const FilmPupilTable& pupils, bool mirrors) : pupils_(pupils), mirrors_(mirrors) {}

  void reserve(std::size_t count) {
    for (auto* numbers : {&film_x_, &film_y_, &u_, &v_}) numbers->reserve(count);
  }

  /// Adds a film point.
  /// @param height fraction of the film radius
  /// @param turn with mirror symmetry, fraction of a right angle from +y to +x
  void add(double height, double turn, double u, double v) {
    constexpr double right_angle = std::numbers::pi / 2;
    const double radius = pupils_.film_radius() * height;
    film_x_.push_back(mirrors_ ? radius * std::sin(right_angle * turn) : 0);
    film_y_.push_back(mirrors_ ? radius * std::cos(right_angle * turn) : radius);
    u_.push_back(u), v_.push_back(v);
  }

  /// Uniform numbers for height, azimuth in the pupil, radius in the pupil, turn.
  std::array<double, 4> uniform(std::size_t index) const {
    static constexpr core_detail::Kronecker<3> three;
    static constexpr core_detail::Kronecker<4> four;
    if (mirrors_) return four(index);
    const auto [height, around, outwards] = three(index);
    return {height, around, outwards, 0};
  }

  /// The samples as lines, without samples of empty pupils.
  Lines lines(std::size_t wavelength) const {
    const std::size_t count = u_.size();
    std::vector<double> x(count), y(count), areas(count);
    pupils_.sample<double>(count, film_x_.data(), film_y_.data(), u_.data(), v_.data(), {wavelength}, x.data(),
                           y.data(), areas.data());
    Lines lines;
    for (auto* numbers : {&lines.film_x, &lines.film_y, &lines.pupil_x, &lines.pupil_y}) numbers->reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (!(areas[i] > 0)) continue;
      lines.film_x.push_back(film_x_[i]);
      lines.film_y.push_back(film_y_[i]);
      lines.pupil_x.push_back(x[i]);
      lines.pupil_y.push_back(y[i]);
    }
    return lines;
  }

 private:
  const FilmPupilTable& pupils_;
  bool mirrors_;
  std::vector<double> film_x_, film_y_, u_, v_;
};

/// The samples of polynomial_detail::spread().
Samples spread(Samples samples, std::size_t first, std::size_t count, bool dense) {
  constexpr double quarter = std::numbers::pi / 2;
  samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [height, around, outwards, turn] = samples.uniform(first + i);
    const double edge = std::sin(quarter * outwards);
    samples.add(dense ? std::sin(quarter * height) : std::sqrt(height), turn, around, dense ? edge * edge : outwards);
  }
  return samples;
}

/// Lines from the centre of the film, uniform over its pupil.
Samples axial(Samples samples) {
  constexpr std::size_t count = 512;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [u, v] = core_detail::fibonacci_point(i, count);
    samples.add(0, 0, u, v);
  }
  return samples;
}

/// Equal steps from 0 to 1; 0 if count is 1.
double fraction_at(int k, int count) noexcept { return count > 1 ? static_cast<double>(k) / (count - 1) : 0; }

/// The rims of the pupils.
/// @param turns number of film points of equal height
Samples rims(Samples samples, int steps, int turns) {
  constexpr int azimuths = 128;
  samples.reserve(static_cast<std::size_t>((steps + 1) * turns * azimuths));
  for (int i = 0; i <= steps; ++i) {
    for (int turn = 0; turn < turns; ++turn) {
      for (int k = 0; k < azimuths; ++k) {
        samples.add(static_cast<double>(i) / steps, fraction_at(turn, turns), static_cast<double>(k) / azimuths, 1);
      }
    }
  }
  return samples;
}

/// Lines with the largest errors: just inside the rims of all pupils and, from the edge of the film, on the rims and
/// across the pupils.
/// @param turns number of film points at the edge
Samples edges(Samples samples, int turns) {
  constexpr std::size_t near_rim_samples = 8192, rim_samples = 1024, interior_samples = 3072;
  constexpr double margin = 0.02;  // fraction of the area of the pupil
  const auto all = static_cast<std::size_t>(turns);
  samples.reserve((near_rim_samples + rim_samples + interior_samples) * all);
  for (std::size_t i = 0; i < near_rim_samples * all; ++i) {
    // Most lines lie near the edge of the film and near the rim, where errors have narrow peaks.
    const auto [inside, around, inwards, turn] = samples.uniform(i);
    samples.add(1 - inside * inside * inside, turn, around, 1 - margin * inwards * inwards);
  }
  for (int k = 0; k < turns; ++k) {
    const double turn = fraction_at(k, turns);
    for (std::size_t i = 0; i < rim_samples; ++i) samples.add(1, turn, static_cast<double>(i) / rim_samples, 1);
    for (std::size_t i = 0; i < interior_samples; ++i) {
      const auto [around, outwards] = core_detail::fibonacci_point(i, interior_samples);
      samples.add(1, turn, around, outwards);
    }
  }
  return samples;
}

/// Shift and radius of the smallest disc that moves with the film point and contains the lines of all wavelengths; the
/// smallest interval if only x or only y is used.
RayPolynomial::Domain::Section smallest(const std::vector<Lines>& rims, double film_radius, bool x_counts,
                                        bool y_counts) {
  struct Farthest {
    double square = 0, side = 0;  ///< side: > 0 if a larger shift brings the centre of the disc nearer to the point
  };
  const auto farthest = [&](double shift) {
    Farthest result;
    for (const Lines& lines : rims) {
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const double x = x_counts ? lines.pupil_x[i] - shift * lines.film_x[i] : 0;
        const double y = y_counts ? lines.pupil_y[i] - shift * lines.film_y[i] : 0;
        const double square = x * x + y * y;
        if (square > result.square) result = {square, x * lines.film_x[i] + y * lines.film_y[i]};
      }
    }
    return result;
  };
  // The radius is a convex function of the shift, and the farthest point shows on which side the best shift lies.
  double high = 2 * std::sqrt(farthest(0).square) / film_radius, low = -high;
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = (low + high) / 2;
    (farthest(middle).side > 0 ? low : high) = middle;
  }
  const double shift = (low + high) / 2;
  return {shift, std::sqrt(farthest(shift).square)};
}

/// z of the entrance pupil, near which rays are given; 0 if the pupil is far from the lens.
double reference_of(const Lens& lens) {
  const double longest = 10 * std::abs(lens.film_z() - lens.surfaces().front().vertex_z);
  const double z = has_pupils(lens) ? pupils(lens, lens.primary_wavelength()).entrance.z : 0;
  return std::abs(z) <= longest ? z : 0;
}

}  // namespace

Lines polynomial_detail::spread(const FilmPupilTable& pupils, bool mirrors, std::size_t first, std::size_t count,
                                bool dense, std::size_t wavelength) {
  return petzval::spread(Samples(pupils, mirrors), first, count, dense).lines(wavelength);
}

void polynomial_detail::enclose(const std::vector<Lines>& rims, bool mirrors, RayPolynomial::Domain& domain) {
  constexpr double rim_margin = 1.01;  // corners lie between the directions searched
  auto along_y = smallest(rims, domain.film_radius, !mirrors, true);
  if (mirrors) {
    auto along_x = smallest(rims, domain.film_radius, true, false);
    double farthest = 0;
    for (const Lines& lines : rims) {
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const double x = (lines.pupil_x[i] - along_x.pupil_shift * lines.film_x[i]) / along_x.pupil_radius;
        const double y = (lines.pupil_y[i] - along_y.pupil_shift * lines.film_y[i]) / along_y.pupil_radius;
        farthest = std::max(farthest, std::hypot(x, y));
      }
    }
    along_x.pupil_radius *= rim_margin * farthest, along_y.pupil_radius *= farthest;
    domain.along_x = along_x;
  }
  domain.pupil_shift = along_y.pupil_shift;
  domain.pupil_radius = rim_margin * along_y.pupil_radius;
}

RayPolynomial RayPolynomial::fit(const Lens& lens, const FilmPupilTable& pupils, int degree) {
  const std::string where = lens.name() + ": polynomial: ";
  // Rays do not depend on the shape of the iris.
  if (!lens.iris().round()) return fit(with_iris(lens, {}), pupils.with_round_stop(), degree);
  polynomial_detail::check_degree(where, degree);
  if (pupils.wavelengths() != lens.wavelengths_nm().size()) {
    throw Error(where + "the pupil table has " + std::to_string(pupils.wavelengths()) +
                " wavelengths; must equal the number of the lens, " + std::to_string(lens.wavelengths_nm().size()));
  }
  if (!(pupils.film_radius() > 0)) throw Error(where + "film radius = 0; must be above 0");
  const bool mirrors = !lens.rotationally_symmetric();
  const Samples none(pupils, mirrors);
  const Samples on_rims = mirrors ? rims(none, 32, 17) : rims(none, 64, 1);
  std::vector<Lines> all_rims;
  for (std::size_t wavelength = 0; wavelength < pupils.wavelengths(); ++wavelength) {
    all_rims.push_back(on_rims.lines(wavelength));
    if (all_rims.back().size() == 0) throw Error(where + "the pupils are empty; must transmit rays");
  }

  Domain domain;
  domain.space = pupils.space();
  domain.film_radius = pupils.film_radius();
  domain.reference_z = reference_of(lens);
  polynomial_detail::enclose(all_rims, mirrors, domain);
  // Lenses with two sections need more lines: 12 equations per coefficient.
  const std::size_t fitted =
      mirrors ? std::max<std::size_t>(3072, 24 * polynomial_detail::mirror_terms(degree).size()) : 1536;
  constexpr std::size_t test_samples = 4096;
  const Samples to_fit = spread(none, 0, fitted, true), on_axis = axial(none),
                fresh = spread(none, fitted, test_samples, false), at_edges = edges(none, mirrors ? 17 : 1);
  std::vector<Fit> fits;
  for (std::size_t wavelength = 0; wavelength < pupils.wavelengths(); ++wavelength) {
    fits.push_back(polynomial_detail::fit(lens, domain, degree, wavelength,
                                          {.fitted = to_fit.lines(wavelength),
                                           .axial = on_axis.lines(wavelength),
                                           .fresh = fresh.lines(wavelength),
                                           .rims = std::move(all_rims[wavelength]),
                                           .edges = at_edges.lines(wavelength)}));
  }
  return RayPolynomial(degree, domain, std::move(fits), lens.primary_wavelength());
}

}  // namespace petzval
