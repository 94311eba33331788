// SPDX-License-Identifier: Apache-2.0
// Proven bounds of rounding. The kernels run over boxes of inputs (bounded.hpp), which are divided until each proves
// the bound. The boxes cover the domain without gaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <type_traits>

#include "bounded.hpp"
#include "lens/quadric.hpp"
#include "lens/snell.hpp"
#include "quad.hpp"

namespace certified_test {

using namespace petzval::kernel;

constexpr double nothing_proven = std::numeric_limits<double>::infinity();

template <class R>
constexpr double eps = std::numeric_limits<R>::epsilon();

struct Range {
  double least, most;
};
template <std::size_t N>
using Box = std::array<Range, N>;

template <class B, std::size_t N>
std::array<B, N> coordinates(const Box<N>& box) {
  std::array<B, N> result;
  for (std::size_t i = 0; i < N; ++i) result[i] = B::coordinate(i, box[i].least, box[i].most);
  return result;
}

template <std::size_t N>
std::array<Box<N>, 2> halves(const Box<N>& box, std::size_t coordinate) {
  std::array<Box<N>, 2> result{box, box};
  result[0][coordinate].most = result[1][coordinate].least = (box[coordinate].least + box[coordinate].most) / 2;
  return result;
}

struct Proof {
  std::size_t boxes = 0;
  double open = 0;  ///< fraction of the domain that is not proven
};

/// Divides a box until every part has a bound of at most `wanted`, by the coordinate whose upper half gains most.
/// bound(box): infinite if the box proves nothing. `volume`: fraction of the domain.
template <std::size_t N>
void divide(const auto& bound, const Box<N>& domain, const Box<N>& box, double wanted, double volume, Proof& proof) {
  ++proof.boxes;
  if (bound(box) <= wanted) return;
  if (volume < std::ldexp(1.0, -40) || proof.boxes > 10'000'000) {
    proof.open += volume;
    return;
  }
  std::size_t best = 0;
  double least = nothing_proven, widest = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const double found = bound(halves(box, i)[1]), whole = domain[i].most - domain[i].least,
                 side = (box[i].most - box[i].least) / whole;
    if (found < least || (least == nothing_proven && side > widest)) best = i;
    least = std::min(least, found), widest = std::max(widest, side);
  }
  for (const Box<N>& half : halves(box, best)) divide(bound, domain, half, wanted, volume / 2, proof);
}

/// Bounds in eps grow with eps, so that a bound proven in float holds in double.
template <std::size_t N>
void expect_proven(const auto& bound, const Box<N>& domain, double wanted) {
  Proof proof;
  divide(bound, domain, domain, wanted, 1, proof);
  EXPECT_EQ(proof.open, 0);
}

template <class R, std::size_t N>
double length(const Vec<Bounded<R, N>>& v) {
  return std::hypot(v.x.error(), v.y.error(), v.z.error());
}

/// length (cos a, sin a) for the tangent of a / 2.
template <class T>
std::array<T, 2> polar(const T& length, const T& half) {
  const T square = half * half, scale = length / (T(1) + square);
  return {scale * (T(1) - square), T(2) * scale * half};
}

template <class T>
Vec<T> given(const Vec<T>& v) {
  return {v.x.given(), v.y.given(), v.z.given()};
}

/// Rays towards points of a surface at heights up to 1; other sizes scale. By symmetry the light runs towards +z, the
/// surface is curved towards the light, and the point lies between the x axis and the bisector of x and y. Coordinates:
/// - height of the point, and tangent of half its azimuth
/// - signed sine of the angle between ray and axis, and tangent of half the azimuth of the ray
/// - curvature
/// - distance from the start of the ray to the point
/// - for conics: 1 + k
const double bisector = std::sqrt(2.0) - 1;
const Box<6> spheres{{{0, 1}, {0, bisector}, {-0.5, 0.5}, {-1, 1}, {0, 0.6}, {-1, 1}}};
const Box<7> conics{{{0, 1}, {0, bisector}, {-0.4, 0.4}, {-1, 1}, {0, 0.5}, {-1, 1}, {0, 2}}};

/// Error of a hit, |error| cos(incidence) / (height + distance), in eps.
template <class R, std::size_t N>
double hit_bound(const Box<N>& box) {
  using B = Bounded<R, N>;
  B::ambiguous = false;
  const auto at = coordinates<B>(box);
  const B &height = at[0], &sine = at[2], &c = at[4];
  B e(1);
  if constexpr (N == 7) e = at[6];
  const auto [x, y] = polar(height, at[1]);
  const auto [dx, dy] = polar(sine, at[3]);
  const B square = height * height, z = c * square / (B(1) + sqrt(B(1) - e * c * c * square));
  const B dz = sqrt(B(1) - sine * sine);
  const Vec<B> direction{dx.given(), dy.given(), dz.given(eps<R>)};  // unit length up to rounding
  const Vec<B> start = given(Vec<B>{x, y, z} - direction * at[5]);

  const Quadric<B> surface{c, e, B(1), B(1), N == 6, false, false};
  const auto [point, hit, slant] = intersect(surface, start, direction, B(1));
  if (B::ambiguous || !hit) return nothing_proven;
  const B steep = B(1) - c * e * z, gradient2 = c * c * square + steep * steep;
  const double cosine = std::min(1.0, slant.most() / std::sqrt(gradient2.least()));
  const double distance = std::max({0.0, box[5].least, -box[5].most});
  return length(point) * cosine / (eps<R> * (1 + distance));
}

/// Rays and normals of unit length up to rounding; by symmetry the azimuth of the normal lies between the x axis and
/// the bisector of x and y. Coordinates:
/// - sine of the angle between normal and axis, and tangent of half the azimuth of the normal
/// - sine of the angle of incidence or refraction in the thinner medium, and tangent of half the azimuth of the ray
///   around the normal
/// - ratio of the lower to the higher index: n / n', or n' / n into the thinner medium
const Box<5> interfaces{{{0, 0.7}, {0, bisector}, {-0.9, 0.9}, {-1, 1}, {0.55, 1}}};

/// Error of a refracted direction, |error| cos(refraction) / max(1, n / n')^2, in eps.
template <class R>
double refraction_bound(bool into_thinner, const Box<5>& box) {
  using B = Bounded<R, 5>;
  B::ambiguous = false;
  const auto at = coordinates<B>(box);
  const B ratio = at[4], in = into_thinner ? ratio * at[2] : at[2], out = into_thinner ? at[2] : ratio * at[2];
  const B tilt = at[0], upright = sqrt(B(1) - tilt * tilt), cosine = sqrt(B(1) - in * in);
  const auto [cos_a, sin_a] = polar(B(1), at[1]);
  const auto [across, along] = polar(in, at[3]);
  const auto given = [](const B& exact) { return exact.given(eps<R>); };  // unit length up to rounding
  const Vec<B> normal{given(tilt * cos_a), given(tilt * sin_a), given(upright)};
  const Vec<B> direction{given(cosine * tilt * cos_a + across * upright * cos_a - along * sin_a),
                         given(cosine * tilt * sin_a + across * upright * sin_a + along * cos_a),
                         given(cosine * upright - across * tilt)};
  const B mu = into_thinner ? B(1) / ratio : ratio, k = B(1) - mu * mu;
  const Interface<B> glass{mu.with_error(eps<R> / 2 * mu.magnitude()), k.with_error(eps<R> / 2 * k.magnitude())};
  const auto [refracted, transmitted] = refract(direction, normal, glass);
  if (B::ambiguous || !transmitted) return nothing_proven;
  return length(refracted) * std::sqrt((B(1) - out * out).most()) / (eps<R> * std::max(1.0, mu.least() * mu.least()));
}

TEST(Certified, HitsOnSpheres) { expect_proven(hit_bound<float, 6>, spheres, 10); }
TEST(Certified, HitsOnConics) { expect_proven(hit_bound<float, 7>, conics, 16); }
TEST(Certified, RefractionIntoTheDenserMedium) {
  const auto bound = [](const Box<5>& box) { return refraction_bound<float>(false, box); };
  expect_proven(bound, interfaces, 16);
}
TEST(Certified, RefractionIntoTheThinnerMedium) {
  const auto bound = [](const Box<5>& box) { return refraction_bound<float>(true, box); };
  expect_proven(bound, interfaces, 24);
}

/// An arithmetic operation on two numbers of any type.
template <class T>
T step(unsigned operation, const T& a, const T& b) {
  using std::sqrt;
  const auto root_of = [](const T& x) {
    if constexpr (std::is_same_v<T, Quad>) {
      return root(x);
    } else {
      return sqrt(x);
    }
  };
  switch (operation) {
    case 0: return a + b;
    case 1: return a - b;
    case 2: return a * b;
    case 3: return quotient(a, b);
    case 4: return root_of(a);
    case 5: return absolute(a);
    default: return -a;
  }
}

/// Checks the analysis: its bounds over a box hold at points of the box.
template <class R>
class BoundedIn : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(BoundedIn, Plain);

TYPED_TEST(BoundedIn, EnclosesAllValuesAndErrors) {
  using R = TypeParam;
  using B = Bounded<R, 3>;
  std::mt19937_64 engine(5);
  const auto between = [&](double least, double most) {
    return static_cast<double>(static_cast<R>(std::uniform_real_distribution<>(least, most)(engine)));
  };
  int compared = 0;
  double closest = 0;
  for (int program = 0; program < 20'000; ++program) {
    const double width = std::pow(10.0, between(-8, 0));
    std::array<Range, 3> box;
    for (Range& range : box) range.least = between(-2, 3), range.most = range.least + between(0, width);
    const auto inside = [&](const Range& range) {
      return static_cast<R>(std::clamp(between(range.least, range.most), range.least, range.most));
    };
    B::ambiguous = false;
    std::array<B, 4> bounds;
    std::array<R, 4> plain;
    std::array<Quad, 4> exact;
    for (std::size_t i = 0; i < 3; ++i) {
      plain[i] = inside(box[i]), exact[i] = plain[i];
      const double at = plain[i];
      bounds[i] = B::coordinate(i, std::min(at, box[i].least), std::max(at, box[i].most));
    }
    bounds[3] = B(0.75), plain[3] = R(0.75), exact[3] = 0.75;
    for (int i = 0; i < 12; ++i) {
      const unsigned operation = engine() % 7;
      const std::size_t a = engine() % 4, b = engine() % 4, to = engine() % 3;
      const B next = step(operation, bounds[a], bounds[b]);
      if (B::ambiguous || next.magnitude() > 1e6) break;
      bounds[to] = next, plain[to] = step(operation, plain[a], plain[b]),
      exact[to] = step(operation, exact[a], exact[b]);
      const Quad error = static_cast<Quad>(plain[to]) - exact[to];
      const double off = std::abs(static_cast<double>(error));
      ASSERT_GE(static_cast<double>(exact[to]), next.least() - 1e-15 * next.magnitude()) << program;
      ASSERT_LE(static_cast<double>(exact[to]), next.most() + 1e-15 * next.magnitude()) << program;
      ASSERT_LE(off, next.error()) << program;
      if (next.error() > 0) closest = std::max(closest, off / next.error());
      ++compared;
    }
  }
  EXPECT_GT(compared, 50'000);
  EXPECT_GT(closest, 0.9);
}

}  // namespace certified_test
