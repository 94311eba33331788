// SPDX-License-Identifier: Apache-2.0
#include "polynomial/ray_polynomial.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "../expect_error.hpp"
#include "camera/dual_rays.hpp"
#include "lines.hpp"

namespace petzval {
namespace ray_polynomial_test {

using testing::expect_error;
using testing::Lines;
constexpr double infinity = std::numeric_limits<double>::infinity();

using Section = RayPolynomial::Domain::Section;

RayPolynomial::Domain domain(bool mirrors = false) {
  return {.space = {.film_z = 100, .pupil_z = 20},
          .film_radius = 20,
          .pupil_shift = 0.25,
          .pupil_radius = 10,
          .reference_z = 30,
          .along_x = mirrors ? std::optional(Section{-0.1, 14}) : std::nullopt};
}

Section along_x(const RayPolynomial::Domain& d) { return d.along_x.value_or(Section{d.pupil_shift, d.pupil_radius}); }

/// Exponents of f.f, f.p and p.p of each coefficient; with mirror symmetry those of f, p, f' and p'.
std::vector<std::array<int, 4>> exponents(int degree, bool mirrors) {
  const int n = (degree - 1) / 2;
  std::vector<std::array<int, 4>> result;
  for (int w = 0; w <= n && !mirrors; ++w) {
    for (int v = 0; v <= n - w; ++v) {
      for (int u = 0; u <= n - w - v; ++u) result.push_back({u, v, w});
    }
  }
  for (int odd = 0; odd < 2 && mirrors; ++odd) {
    for (int l = 0; l <= n - odd; ++l) {
      for (int k = 0; k <= n - odd - l; ++k) {
        for (int j = 0; j <= n - odd - l - k; ++j) {
          for (int i = 0; i <= n - odd - l - k - j; ++i) result.push_back({2 * i, 2 * j, 2 * k + odd, 2 * l + odd});
        }
      }
    }
  }
  return result;
}

/// s = slope f + 0.05 p, o = 0.5 f + 8 p, with some higher terms; with mirror symmetry the slope along x is 0.8 slope.
RayPolynomial::Fit numbers(int degree, double slope, double higher = 0, double nm = 587.5618, bool mirrors = false) {
  const std::size_t each = exponents(degree, mirrors).size(), count = mirrors ? 2 * each : each;
  RayPolynomial::Fit fit;
  fit.wavelength_nm = nm;
  for (auto* list : {&fit.direction_by_film, &fit.direction_by_pupil, &fit.offset_by_film, &fit.offset_by_pupil}) {
    for (std::size_t k = 0; k < count; ++k) {
      list->push_back(higher * std::sin(static_cast<double>(k) + static_cast<double>(list->size())));
    }
  }
  fit.direction_by_film[0] = slope, fit.direction_by_pupil[0] = 0.05;
  fit.offset_by_film[0] = 0.5, fit.offset_by_pupil[0] = 8;
  if (mirrors) {
    fit.direction_by_film[0] *= 0.8;
    fit.direction_by_film[each] = slope, fit.direction_by_pupil[each] = 0.05;
    fit.offset_by_film[each] = 0.5, fit.offset_by_pupil[each] = 8;
  }
  return fit;
}

/// Lines all over the domain, including its edges and its centre.
template <class T>
Lines<T> all_over(bool mirrors = false) {
  Lines<T> lines;
  const auto d = domain(mirrors);
  const auto [shift_x, radius_x] = along_x(d);
  for (const double r : {0.0, 0.3, 0.7, 1.0}) {
    for (const double q : {0.0, 0.5, 1.0}) {
      for (int k = 0; k < 12; ++k) {
        const double x = r * d.film_radius * std::sin(k * 0.7), y = r * d.film_radius * std::cos(k * 0.7);
        lines.add(x, y, shift_x * x + q * radius_x * std::sin(k * 1.9),
                  d.pupil_shift * y + q * d.pupil_radius * std::cos(k * 1.9));
      }
    }
  }
  return lines;
}

TEST(RayPolynomial, EqualsTheExplicitSum) {
  // The explicit sum gives the angle 2 atan |s| of the direction to the axis, the length of the offset, and the angle
  // of the offset to the plane of axis and direction. A rotation about the normal keeps the latter angle. Fields reach
  // 130 degrees.
  const auto check = [](int degree, bool mirrors) {
    const auto d = domain(mirrors);
    const auto terms = exponents(degree, mirrors);
    const RayPolynomial::Fit fit = numbers(degree, -1.6, 0.02, 587.5618, mirrors);
    const RayPolynomial polynomial(degree, d, {fit});
    Lines<double> lines = all_over<double>(mirrors);
    lines.through(polynomial);
    double widest = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      ASSERT_EQ(lines.fates[i], RayFate::transmitted);
      const glm::dvec2 film(lines.film_x[i], lines.film_y[i]), pupil(lines.pupil_x[i], lines.pupil_y[i]);
      const auto [shift_x, radius_x] = along_x(d);
      const glm::dvec2 f = film / d.film_radius, shift(shift_x, d.pupil_shift), radius(radius_x, d.pupil_radius);
      const glm::dvec2 p = (pupil - shift * film) / radius;
      glm::dvec2 s(0), o(0);
      for (int axis = 0; axis < 2; ++axis) {
        const int other = 1 - axis;
        const auto add = [&](std::size_t k, double term) {
          s[axis] += term * (fit.direction_by_film[k] * f[axis] + fit.direction_by_pupil[k] * p[axis]);
          o[axis] += term * (fit.offset_by_film[k] * f[axis] + fit.offset_by_pupil[k] * p[axis]);
        };
        const std::array factors{mirrors ? f[axis] : glm::dot(f, f), mirrors ? p[axis] : glm::dot(f, p),
                                 mirrors ? f[other] : glm::dot(p, p), p[other]};
        for (std::size_t k = 0; k < terms.size(); ++k) {
          double term = 1;
          for (std::size_t v = 0; v < factors.size(); ++v) term *= std::pow(factors[v], terms[k][v]);
          add(k + (mirrors && axis == 1 ? terms.size() : 0), term);
        }
      }
      const Vec3<double> direction = lines.direction(i), offset = lines.origin(i) - Vec3<double>(0, 0, d.reference_z);
      EXPECT_NEAR(glm::length(direction), 1, 1e-15);
      const double angle = 2 * std::atan(glm::length(s));
      widest = std::max(widest, angle);
      EXPECT_NEAR(std::atan2(std::hypot(direction.x, direction.y), -direction.z), angle, 1e-13);
      EXPECT_NEAR(direction.x * s.y, direction.y * s.x, 1e-13);
      EXPECT_NEAR(glm::dot(direction, offset), 0, 1e-13);
      EXPECT_NEAR(glm::length(offset), glm::length(o), 1e-12);
      if (glm::length(s) > 0) {
        EXPECT_NEAR((s.x * offset.y - s.y * offset.x) / glm::length(s), (s.x * o.y - s.y * o.x) / glm::length(s),
                    1e-12);
      }
    }
    EXPECT_GT(widest, 1.9);
  };
  for (int degree = 3; degree <= 11; degree += 2) check(degree, false), check(degree, true);
}

TEST(RayPolynomial, HasMirrorSymmetry) {
  for (int degree = 3; degree <= 11; degree += 2) {
    const RayPolynomial polynomial(degree, domain(true), {numbers(degree, -0.6, 0.02, 587.5618, true)});
    Lines<float> lines = all_over<float>(true), in_x, in_y;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      in_x.add(-lines.film_x[i], lines.film_y[i], -lines.pupil_x[i], lines.pupil_y[i]);
      in_y.add(lines.film_x[i], -lines.film_y[i], lines.pupil_x[i], -lines.pupil_y[i]);
    }
    lines.through(polynomial), in_x.through(polynomial), in_y.through(polynomial);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      for (std::size_t k = 0; k < 6; ++k) {  // to the bit
        EXPECT_EQ(in_x.ray[k][i], k % 3 == 0 ? -lines.ray[k][i] : lines.ray[k][i]);
        EXPECT_EQ(in_y.ray[k][i], k % 3 == 1 ? -lines.ray[k][i] : lines.ray[k][i]);
      }
    }
  }
}

TEST(RayPolynomial, ToFilmInvertsToScene) {
  for (const int n : {3, 5, 7, 9, 11, -3, -5, -7, -9, -11}) {  // negative: with mirror symmetry
    const int degree = std::abs(n);
    const double slope = n < 0 ? -0.9 : -1.6;
    const RayPolynomial polynomial(degree, domain(n < 0),
                                   {numbers(degree, slope, n < 0 ? 0.005 : 0.02, 587.5618, n < 0)});
    Lines<double> lines = all_over<double>(n < 0);
    lines.through(polynomial);
    // Reversed rays may start anywhere on their line.
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double far = i % 3 == 0 ? 0 : i % 3 == 1 ? 1e3 : 1e6;
      for (std::size_t k = 0; k < 3; ++k) {
        lines.ray[k][i] += far * lines.ray[k + 3][i];
        lines.ray[k + 3][i] *= -1;
      }
    }
    Lines<double> back = lines;
    polynomial.to_film(lines.size(), lines.rays<const double>(), {},
                       {back.film_x.data(), back.film_y.data(), back.pupil_x.data(), back.pupil_y.data()},
                       back.fates.data());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      ASSERT_EQ(back.fates[i], RayFate::transmitted) << degree << " " << i;
      const double far = i % 3 == 2 ? 2e-8 : 1e-10;  // at 1e6 mm the rounding of a direction moves the line by 1e-10 mm
      EXPECT_NEAR(back.film_x[i], lines.film_x[i], far);
      EXPECT_NEAR(back.film_y[i], lines.film_y[i], far);
      EXPECT_NEAR(back.pupil_x[i], lines.pupil_x[i], far);
      EXPECT_NEAR(back.pupil_y[i], lines.pupil_y[i], far);
    }
  }
}

TEST(RayPolynomial, DerivativesEqualFiniteDifferences) {
  // Film and pupil points move with two parameters; central differences with step 1e-4 are accurate to 1e-7.
  for (const int n : {3, 7, 11, -3, -7, -11}) {  // negative: with mirror symmetry
    const int degree = std::abs(n);
    const RayPolynomial polynomial(degree, domain(n < 0),
                                   {numbers(degree, -0.9, n < 0 ? 0.005 : 0.02, 587.5618, n < 0)});
    const TwoPlaneRay by_u{1, -2, 0.5, 0.25}, by_v{0.5, 1, -2, 1};
    const auto duals = [](const TwoPlaneRay& at, const TwoPlaneRay& u, const TwoPlaneRay& v) {
      const auto dual = [&](double TwoPlaneRay::*of) { return kernel::Dual(at.*of, {u.*of, v.*of}); };
      return TwoPlaneRayOf<kernel::Dual>{dual(&TwoPlaneRay::film_x), dual(&TwoPlaneRay::film_y),
                                         dual(&TwoPlaneRay::pupil_x), dual(&TwoPlaneRay::pupil_y)};
    };
    const auto moved = [](const TwoPlaneRay& line, const TwoPlaneRay& by, double step) {
      return TwoPlaneRay{0.9 * line.film_x + step * by.film_x, 0.9 * line.film_y + step * by.film_y,
                         0.9 * line.pupil_x + step * by.pupil_x, 0.9 * line.pupil_y + step * by.pupil_y};
    };
    const Lines<double> lines = all_over<double>(n < 0);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const TwoPlaneRay at{lines.film_x[i], lines.film_y[i], lines.pupil_x[i], lines.pupil_y[i]};
      constexpr double step = 1e-4;
      Lines<double> near;
      for (const TwoPlaneRay& l : {moved(at, by_u, 0), moved(at, by_u, step), moved(at, by_u, -step),
                                   moved(at, by_v, step), moved(at, by_v, -step)}) {
        near.add(l.film_x, l.film_y, l.pupil_x, l.pupil_y);
      }
      near.through(polynomial);
      RayFate fate = RayFate::outside_fit;
      const auto found = polynomial.to_scene(duals(moved(at, by_u, 0), by_u, by_v), 0, fate);
      ASSERT_EQ(fate, RayFate::transmitted);
      const Ray<double> ray = camera_detail::ray_of(found, camera_detail::value_only);
      EXPECT_LT(glm::distance(ray.origin, near.origin(0)), 1e-13);
      EXPECT_LT(glm::distance(ray.direction, near.direction(0)), 1e-15);
      for (const std::size_t k : {1u, 3u}) {
        const Ray<double> by = k == 1 ? camera_detail::ray_of(found, camera_detail::by_first)
                                      : camera_detail::ray_of(found, camera_detail::by_second);
        EXPECT_LT(glm::distance(by.origin, (near.origin(k) - near.origin(k + 1)) / (2 * step)), 1e-7);
        EXPECT_LT(glm::distance(by.direction, (near.direction(k) - near.direction(k + 1)) / (2 * step)), 1e-7);
      }
    }
    const auto fate_of = [&](const TwoPlaneRay& line, std::size_t wavelength) {
      RayFate fate = RayFate::transmitted;
      polynomial.to_scene(duals(line, by_u, by_v), wavelength, fate);
      return fate;
    };
    EXPECT_EQ(fate_of({20.1, 0, 0, 0}, 0), RayFate::outside_fit);
    EXPECT_EQ(fate_of({0, 0, 0, 0}, 1), RayFate::outside_fit);
  }
}

template <class T>
void expect_nothing(const Lines<T>& lines, std::size_t i) {
  EXPECT_EQ(lines.fates[i], RayFate::outside_fit) << i;
  EXPECT_EQ(lines.origin(i), Vec3<double>(0, 0, 30)) << i;
  EXPECT_EQ(lines.direction(i), Vec3<double>(0, 0, -1)) << i;
}

TEST(RayPolynomial, RefusesLinesOutsideItsDomain) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const RayPolynomial polynomial(5, domain(), {numbers(5, -0.6, 0.02)});
  const auto check = [&]<class T>(T) {
    Lines<T> lines;
    lines.add(20.01, 0, 0, 0);
    lines.add(0, -20.01, 0, 0);
    lines.add(0, 0, 7.1, 7.1);
    lines.add(20, 0, -5.1, 0);  // the pupil domain is centred at x = 5
    for (const double bad : {nan, infinity, -infinity}) {
      lines.add(bad, 0, 0, 0);
      lines.add(0, 0, 0, bad);
    }
    lines.through(polynomial);
    for (std::size_t i = 0; i < lines.size(); ++i) expect_nothing(lines, i);

    Lines<T> edge;
    edge.add(20, 0, 15, 0);
    edge.through(polynomial);
    EXPECT_EQ(edge.fates[0], RayFate::transmitted);
    edge.through(polynomial, {1});
    expect_nothing(edge, 0);
    const std::uint16_t each[] = {3};
    edge.through(polynomial, {0, each});
    expect_nothing(edge, 0);

    // An elliptical domain.
    const RayPolynomial of_mirrors(5, domain(true), {numbers(5, -0.6, 0.02, 587.5618, true)});
    Lines<T> ends;
    ends.add(20, 0, -2 + 13.9, 0), ends.add(0, -20, 0, -5 - 9.9);
    ends.through(of_mirrors);
    for (const RayFate fate : ends.fates) EXPECT_EQ(fate, RayFate::transmitted);
    Lines<T> beyond;
    beyond.add(20, 0, -2 + 14.1, 0), beyond.add(0, -20, 0, -5 - 10.1), beyond.add(0, 0, 10, 7.1);
    beyond.through(of_mirrors);
    for (std::size_t i = 0; i < beyond.size(); ++i) expect_nothing(beyond, i);
  };
  check(float()), check(double());
}

TEST(RayPolynomial, RefusesRaysOutsideItsDomain) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const RayPolynomial polynomial(5, domain(), {numbers(5, -0.6, 0.02)});
  struct Case {
    Ray<double> ray;
    RayFate fate;
  };
  const Case cases[] = {
      {{{0, 0, -50}, {0, 0, 1}}, RayFate::transmitted},
      {{{0, 0, -50}, {0, 0, -1}}, RayFate::outside_fit},  // from behind
      {{{0, 40, -50}, {0, 0, 1}}, RayFate::outside_fit},
      {{{0, 0, 30}, {0, 0.999, std::sqrt(1 - 0.999 * 0.999)}}, RayFate::outside_fit},
      {{{nan, 0, -50}, {0, 0, 1}}, RayFate::outside_fit},
      {{{0, 0, -50}, {0, nan, 1}}, RayFate::outside_fit},
      {{{0, infinity, -50}, {0, 0, 1}}, RayFate::outside_fit},
      {{{0, 0, -50}, {0, 0, 0}}, RayFate::outside_fit},
      {{{0, 0, -50}, {0, 0, 2}}, RayFate::outside_fit},
  };
  for (const Case& c : cases) {
    const auto& [o, d] = c.ray;
    double place[4] = {nan, nan, nan, nan};
    RayFate fate{};
    polynomial.to_film(1, {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z}, {}, {place, place + 1, place + 2, place + 3}, &fate);
    EXPECT_EQ(fate, c.fate) << o.y << " " << d.z;
    for (const double x : place) EXPECT_NEAR(x, 0, 1e-12);
    polynomial.to_film(1, {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z}, {1}, {place, place + 1, place + 2, place + 3}, &fate);
    EXPECT_EQ(fate, RayFate::outside_fit);
  }
}

TEST(RayPolynomial, BatchResultIndependentOfNeighbours) {
  const auto check = [&]<class T>(T, bool mirrors, unsigned fits) {
    std::vector<RayPolynomial::Fit> all_fits;
    for (unsigned w = 0; w < fits; ++w) {
      all_fits.push_back(numbers(9, -0.6 + 0.1 * (w % 5), 0.01 * (w % 7), 400 + w, mirrors));
    }
    const RayPolynomial polynomial(9, domain(mirrors), all_fits);
    Lines<T> all = all_over<T>(mirrors);
    for (int k = 0; k < 3; ++k) {  // more than a block of mixed wavelengths
      const Lines<T> more = all_over<T>(mirrors);
      for (std::size_t i = 0; i < more.size(); ++i) {
        all.add(more.film_x[i], more.film_y[i], more.pupil_x[i], more.pupil_y[i]);
      }
    }
    std::vector<std::uint16_t> each;
    for (std::size_t i = 0; i < all.size(); ++i) each.push_back(static_cast<std::uint16_t>(i * i % 71 % (fits + 1)));
    all.through(polynomial, {0, each.data()});
    for (std::size_t i = 0; i < all.size(); ++i) {
      Lines<T> one;
      one.add(all.film_x[i], all.film_y[i], all.pupil_x[i], all.pupil_y[i]);
      one.through(polynomial, {each[i]});
      EXPECT_EQ(one.fates[0], all.fates[i]);
      EXPECT_EQ(one.fates[0], each[i] == fits ? RayFate::outside_fit : RayFate::transmitted);
      for (std::size_t k = 0; k < 6; ++k)
        EXPECT_EQ(one.ray[k][0], all.ray[k][i]) << i << " of " << fits << " fits, mirrors " << mirrors;
    }
  };
  // The coefficients fit one register, two registers, or need memory.
  for (const unsigned fits : {3u, 16u, 20u, 40u}) {
    for (const bool mirrors : {false, true}) check(float(), mirrors, fits), check(double(), mirrors, fits);
  }
}

TEST(RayPolynomial, RefusesOtherDegreesAndNumbersThatOverflow) {
  for (const int degree : {-1, 0, 1, 2, 4, 13, 2000001}) {
    expect_error([&] { RayPolynomial(degree, domain(), {numbers(5, -0.6)}); }, {"degree", degree});
  }
  RayPolynomial::Fit spoilt = numbers(5, -0.6);
  spoilt.offset_by_pupil[3] = infinity;
  expect_error([&] { RayPolynomial(5, domain(), {spoilt}); }, {"fit", 587.5618, "inf"});
}

}  // namespace ray_polynomial_test
}  // namespace petzval
