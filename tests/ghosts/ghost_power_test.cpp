// SPDX-License-Identifier: Apache-2.0
// Powers of rays that are reflected twice, against plain formulas.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <glm/gtc/matrix_access.hpp>
#include <glm/mat3x3.hpp>
#include <random>
#include <vector>

#include "../data_lenses.hpp"
#include "ghosts/surface_waves.hpp"
#include "petzval/trace/trace.hpp"
#include "plain_optics.hpp"

namespace petzval {
namespace ghost_power_test {

using ghosts_detail::Surfaces;
using lens_detail::Passage;
using testing::Bare;
using testing::V;

const std::vector<Passage> plate_path{{0, false}, {1, true}, {0, true}, {1, false}};

Prescription plate(double index, std::optional<Coating> front = {}, std::optional<Coating> back = {}) {
  Prescription p;
  p.name = "plate";
  p.surfaces = {{.thickness = 5, .medium = {.nd = index}, .semi_diameter = 10, .stop = true, .coating = front},
                {.thickness = 50, .semi_diameter = 40, .coating = back}};
  return p;
}

kernel::Vec<double> slanted(double degrees, double azimuth = 0.3) {
  const double sine = std::sin(radians(degrees));
  return {sine * std::sin(azimuth), sine * std::cos(azimuth), std::cos(radians(degrees))};
}

/// Field reflectance of one layer on a substrate for one polarisation, by the sum of all multiple beams.
std::complex<double> one_layer(double first, double second, double phase) {
  const std::complex<double> turn = std::polar(1.0, 2 * phase);
  return (first + second * turn) / (1.0 + first * second * turn);
}

TEST(GhostPower, OfAPlateIsTheSquareOfItsReflectance) {
  for (const double index : {1.3, 1.5168, 2.0}) {
    const Lens lens = compile(plate(index));
    for (const double degrees : {0.0, 20.0, 56.6, 75.0, 89.0}) {
      const double cosine = std::cos(radians(degrees));
      const Bare in(1, index, cosine), out(index, 1, std::sqrt(1 - std::pow(std::sin(radians(degrees)) / index, 2)));
      const double expected = (in.ts * out.s * out.s * out.ts + in.tp * out.p * out.p * out.tp) / 2;
      const auto power = Surfaces(lens, {}, 0).power(plate_path, {0, 0, -1}, slanted(degrees));
      EXPECT_NEAR(power.value(), expected, 1e-12) << index << ", " << degrees << " degrees";
    }
  }
}

TEST(GhostPower, OfACoatedPlateHasTheReflectancesOfItsCoatings) {
  const Coating layer = Coating::quarter_wave(), mirror{.table = {{400, 0.3}, {700, 0.3}}};
  const Lens lens = compile(plate(1.6, layer, mirror));
  for (const double degrees : {0.0, 30.0, 60.0}) {
    const double sine = std::sin(radians(degrees)), cosine = std::cos(radians(degrees));
    const auto inside = [&](double index) { return std::sqrt(1 - sine * sine / (index * index)); };
    const double phase = 2 * std::numbers::pi * 550 / 4 / d_line_nm * inside(1.38);
    const Bare outer(1, 1.38, cosine), inner(1.38, 1.6, inside(1.38));
    double expected = 0;
    for (const auto& [a, b] : {std::pair{outer.fs, inner.fs}, std::pair{outer.fp, inner.fp}}) {
      const double r = std::norm(one_layer(a, b, phase));  // the same from both sides
      expected += (1 - r) * 0.3 * r * 0.7 / 2;
    }
    EXPECT_NEAR(Surfaces(lens, {}, 0).power(plate_path, {0, 0, -1}, slanted(degrees)).value(), expected, 1e-12);
  }
  // The film as the first mirror.
  const std::vector<Passage> by_film{{0, false}, {1, false}, {2, true}, {1, true}};
  const Lens bare = compile(plate(1.5));
  EXPECT_NEAR(Surfaces(bare, {}, 0.25).power(by_film, {0, 0, -1}, {0, 0, 1}).value(), 0.96 * 0.96 * 0.25 * 0.04, 1e-12);
}

// Polarisation ray tracing: a 3 x 3 matrix of fields for each surface, in the lens frame.
TEST(GhostPower, OfSkewRaysKeepsPolarisation) {
  const Lens lens = testing::data_lens("singlet_50mm_biconvex");
  const testing::PlainLens plain(lens);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-6, 6), slope(-0.3, 0.3);
  double rotation = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const V start{place(random), place(random), -1};
    V d = glm::normalize(V{slope(random), slope(random), 1}), o = start;
    const V first = d;
    glm::dmat3 fields(1);
    double scalar = 1;
    bool lost = false;
    for (const auto& [surface, reflects] : std::array<Passage, 4>{{{0, false}, {1, true}, {0, true}, {1, false}}}) {
      V normal;
      const auto hit = plain.meet(surface, o, d, normal);
      if (!hit) {
        lost = true;
        break;
      }
      const auto& own = plain.surfaces[surface];
      const double glass = surface == 0 ? own.behind : own.before;
      const bool enters = surface == 0 && !reflects;
      const double in = enters ? 1 : glass, out = enters ? glass : 1;
      const Bare bare(in, out, -glm::dot(d, normal));
      const V to = reflects ? testing::thrown_back(d, normal) : testing::bent(d, normal, in, out);
      const V s = glm::normalize(glm::cross(d, normal)), p = glm::cross(s, d), q = glm::cross(s, to);
      const double as = reflects ? bare.fs : std::sqrt(bare.ts), ap = reflects ? bare.fp : std::sqrt(bare.tp);
      fields = (as * glm::outerProduct(s, s) + ap * glm::outerProduct(q, p)) * fields;
      scalar *= reflects ? bare.mean() : (bare.ts + bare.tp) / 2;
      o = *hit, d = to;
    }
    if (lost) continue;
    const V a = glm::normalize(glm::cross(first, V{0, 1, 0})), b = glm::cross(first, a);
    const V fa = fields * a, fb = fields * b;
    const double expected = (glm::dot(fa, fa) + glm::dot(fb, fb)) / 2;
    const auto power = Surfaces(lens, {}, 0).power(plate_path, kernel::to_kernel(start), kernel::to_kernel(first));
    EXPECT_NEAR(power.value_or(0), expected, 1e-12);
    rotation = std::max(rotation, std::abs(scalar / expected - 1));
  }
  EXPECT_GT(rotation, 0.01);  // unpolarised light at each surface would be wrong
}

TEST(GhostPower, OfAReversedRayIsTheSame) {
  const Prescription forward = testing::data_prescription("double_gauss_100mm_f2.0");
  const Lens lens = compile(forward), back = compile(reverse(forward));
  const std::size_t last = lens.surface_count() - 1;
  const double last_z = lens.surfaces()[last].vertex_z;
  for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 3}, {2, 9}, {7, last}}) {
    std::vector<Passage> path, reversed_path;
    for (std::size_t k = 0; k < j; ++k) path.push_back({k, false});
    path.push_back({j, true});
    for (std::size_t k = j; k-- > i + 1;) path.push_back({k, false});
    path.push_back({i, true});
    for (std::size_t k = i + 1; k <= last; ++k) path.push_back({k, false});
    for (auto k = path.rbegin(); k != path.rend(); ++k) reversed_path.push_back({last - k->surface, k->reflects});
    const Vec3<double> o{1, 2, -1};
    const auto d = slanted(3);
    const double power = Surfaces(lens, {}, 0).power(path, kernel::to_kernel(o), d).value();
    const Lens folded = lens_detail::along(lens, path);
    const auto end = trace(folded, Ray<double>{o, {d.x, d.y, d.z}}, {.apertures = false});
    ASSERT_TRUE(end.transmitted());
    const Vec3<double> from{end.ray.origin.x, end.ray.origin.y, last_z - end.ray.origin.z};
    const kernel::Vec<double> towards{-end.ray.direction.x, -end.ray.direction.y, end.ray.direction.z};
    EXPECT_NEAR(Surfaces(back, {}, 0).power(reversed_path, kernel::to_kernel(from), towards).value(), power,
                1e-12 * power + 1e-18);
  }
}

}  // namespace ghost_power_test
}  // namespace petzval
