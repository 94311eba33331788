// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/low_discrepancy.hpp"
#include "least_squares.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"

namespace petzval::inline v0 {
namespace {

using polynomial_detail::MeridianLines;

constexpr std::size_t fitted = 1536, judged = 4096;

/// The samples u, v of pupils as lines, without those of empty pupils.
MeridianLines lines_of(const FilmPupilTable& pupils, std::size_t wavelength, const std::vector<double>& heights,
                       const std::vector<double>& u, const std::vector<double>& v) {
  const std::size_t count = heights.size();
  const std::vector<double> film_x(count, 0.0);
  std::vector<double> x(count), y(count), areas(count);
  pupils.sample<double>(count, film_x.data(), heights.data(), u.data(), v.data(), {wavelength}, x.data(), y.data(),
                        areas.data());
  MeridianLines lines;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(areas[i] > 0)) continue;
    lines.film_y.push_back(heights[i]);
    lines.pupil_x.push_back(x[i]);
    lines.pupil_y.push_back(y[i]);
  }
  return lines;
}

/// Uniform lines over film and pupils, from any `first` on. Uniform by area, or denser towards the edges of film and
/// pupil like Chebyshev nodes: that makes the largest errors some tenths smaller, and the RMS one tenth larger.
MeridianLines spread(const FilmPupilTable& pupils, std::size_t wavelength, std::size_t first, std::size_t count,
                     bool dense) {
  constexpr double quarter = std::numbers::pi / 2;
  const core_detail::Kronecker<3> points;
  std::vector<double> heights(count), u(count), v(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, around, b] = points(first + i);
    const double edge = std::sin(quarter * b);
    heights[i] = pupils.film_radius() * (dense ? std::sin(quarter * a) : std::sqrt(a));
    u[i] = around;
    v[i] = dense ? edge * edge : b;
  }
  return lines_of(pupils, wavelength, heights, u, v);
}

/// The film's centre, uniformly over its pupil.
MeridianLines axial(const FilmPupilTable& pupils, std::size_t wavelength) {
  constexpr std::size_t count = 512;
  std::vector<double> u, v;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [at_u, at_v] = core_detail::fibonacci_point(i, count);
    u.push_back(at_u), v.push_back(at_v);
  }
  return lines_of(pupils, wavelength, std::vector<double>(count, 0.0), u, v);
}

/// The rims of the pupils.
MeridianLines rims(const FilmPupilTable& pupils, std::size_t wavelength) {
  constexpr int steps = 64, around = 128;
  std::vector<double> heights, u;
  for (int i = 0; i <= steps; ++i) {
    for (int k = 0; k < around; ++k) {
      heights.push_back(pupils.film_radius() * i / steps);
      u.push_back(static_cast<double>(k) / around);
    }
  }
  return lines_of(pupils, wavelength, heights, u, std::vector<double>(u.size(), 1.0));
}

/// Where errors are largest: just within the rims of all pupils, where the last rays pass, and from the film's farthest
/// point, on its rim and through the rest of its pupil.
MeridianLines edges(const FilmPupilTable& pupils, std::size_t wavelength) {
  constexpr std::size_t near_rims = 8192, on_rim = 1024, within = 3072;
  constexpr double margin = 0.02;  // of the pupil's area
  const core_detail::Kronecker<3> points;
  std::vector<double> heights, u, v;
  const auto add = [&](double height, double around, double outwards) {
    heights.push_back(pupils.film_radius() * height), u.push_back(around), v.push_back(outwards);
  };
  for (std::size_t i = 0; i < near_rims; ++i) {
    const auto [height, around, inwards] = points(i);
    add(height, around, 1 - margin * inwards * inwards);
  }
  for (std::size_t i = 0; i < on_rim; ++i) add(1, static_cast<double>(i) / on_rim, 1);
  for (std::size_t i = 0; i < within; ++i) {
    const auto [around, outwards] = core_detail::fibonacci_point(i, within);
    add(1, around, outwards);
  }
  return lines_of(pupils, wavelength, heights, u, v);
}

/// The smallest discs, moving with the film point, that hold the rims of all wavelengths.
void enclose(const std::vector<MeridianLines>& rims, RayPolynomial::Domain& domain) {
  struct Farthest {
    double square = 0, side = 0;  ///< side: > 0 if a larger shift brings the centre of the disc nearer
  };
  const auto farthest = [&](double shift) {
    Farthest result;
    for (const MeridianLines& lines : rims) {
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const double y = lines.pupil_y[i] - shift * lines.film_y[i];
        const double square = lines.pupil_x[i] * lines.pupil_x[i] + y * y;
        if (square > result.square) result = {square, y * lines.film_y[i]};
      }
    }
    return result;
  };
  // The radius is convex in the shift: the farthest point tells on which side of the best shift this one is.
  double high = 2 * std::sqrt(farthest(0).square) / domain.film_radius, low = -high;
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = (low + high) / 2;
    (farthest(middle).side > 0 ? low : high) = middle;
  }
  domain.pupil_shift = (low + high) / 2;
  domain.pupil_radius =
      1.01 * std::sqrt(farthest(domain.pupil_shift).square);  // corners lie between the directions searched
}

/// The centre of the entrance pupil unless it is far from the lens: rays begin near it.
double reference_of(const Lens& lens) {
  const double longest = 10 * std::abs(lens.film_z() - lens.surfaces().front().vertex_z);
  const double z = has_pupils(lens) ? pupils(lens, lens.primary_wavelength()).entrance.z : 0;
  return std::abs(z) <= longest ? z : 0;
}

}  // namespace

RayPolynomial RayPolynomial::fit(const Lens& lens, const FilmPupilTable& pupils, int degree) {
  const std::string where = lens.name() + ": polynomial: ";
  if (!lens.iris().round()) throw Error(where + "the iris has edges, wanted a round stop");
  if (!lens.rotationally_symmetric()) {
    throw Error(where + "the lens has surfaces that are curved in one section only, wanted a lens of revolution");
  }
  if (!(degree >= 3 && degree <= 11 && degree % 2 == 1)) {
    throw Error(where + "degree is " + std::to_string(degree) + ", wanted 3, 5, 7, 9 or 11");
  }
  if (pupils.wavelengths() != lens.wavelengths_nm().size()) {
    throw Error(where + "the pupils are of " + std::to_string(pupils.wavelengths()) +
                " wavelengths, wanted the lens's " + std::to_string(lens.wavelengths_nm().size()));
  }
  if (!(pupils.film_radius() > 0)) throw Error(where + "the film's radius is 0, wanted more than one point");
  std::vector<MeridianLines> all_rims;
  for (std::size_t wavelength = 0; wavelength < pupils.wavelengths(); ++wavelength) {
    all_rims.push_back(rims(pupils, wavelength));
    if (all_rims.back().size() == 0) throw Error(where + "the pupils are empty, wanted rays");
  }

  Domain domain;
  domain.space = pupils.space();
  domain.film_radius = pupils.film_radius();
  domain.reference_z = reference_of(lens);
  enclose(all_rims, domain);
  std::vector<Fit> fits;
  for (std::size_t wavelength = 0; wavelength < pupils.wavelengths(); ++wavelength) {
    fits.push_back(polynomial_detail::fit(lens, domain, degree, wavelength,
                                          {.fitted = spread(pupils, wavelength, 0, fitted, true),
                                           .axial = axial(pupils, wavelength),
                                           .fresh = spread(pupils, wavelength, fitted, judged, false),
                                           .rims = all_rims[wavelength],
                                           .edges = edges(pupils, wavelength)}));
  }
  return RayPolynomial(degree, domain, std::move(fits), lens.primary_wavelength());
}

}  // namespace petzval::inline v0
