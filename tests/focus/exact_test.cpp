// SPDX-License-Identifier: Apache-2.0
// Laws of least blur, compared with brute-force rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_plane.hpp"

namespace petzval {
namespace exact_test {

using testing::data_lens;
using testing::data_prescription;
using enum FocusCriterion;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Spread {
  double rms = 0, largest = 0;
};

/// Blur about the centroid, by a square grid of rays over the pupil plane.
Spread spread(const Lens& lens, const FieldPoint& point, double film_z, const std::vector<double>& colours = {1},
              int across = 201) {
  const PupilPlane plane(lens, point);
  double reach = 0;
  for (const LensSurface& s : lens.surfaces()) reach = std::max(reach, s.semi_diameter);
  struct Hit {
    double x, y, weight;
  };
  std::vector<Hit> hits;
  double total = 0, x_mean = 0, y_mean = 0;
  for (std::size_t colour = 0; colour < colours.size(); ++colour) {
    for (int i = 0; i < across; ++i) {
      for (int k = 0; k < across; ++k) {
        const auto at = [&](int n) { return reach * (2 * (n + 0.5) / across - 1); };
        const auto [ray, fate, surface] = trace(lens, plane.ray(at(i), at(k)), {.wavelength = colour});
        if (fate != RayFate::transmitted) continue;
        const double t = (film_z - ray.origin.z) / ray.direction.z;
        hits.push_back({ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y, colours[colour]});
        total += colours[colour];
        x_mean += colours[colour] * hits.back().x;
        y_mean += colours[colour] * hits.back().y;
      }
    }
  }
  Spread result;
  for (const Hit& hit : hits) {
    const double r = std::hypot(hit.x - x_mean / total, hit.y - y_mean / total);
    result.rms += hit.weight * r * r / total;
    result.largest = std::max(result.largest, r);
  }
  result.rms = std::sqrt(result.rms);
  return result;
}

TEST(ExactBlur, EqualsAGridOfRays) {
  for (const char* id : {"cooke_triplet_50mm_f5", "double_gauss_100mm_f2.0", "anamorphic_60mm_2x"}) {
    for (const double field : {0.0, radians(8), radians(14)}) {
      if (field > radians(10) && std::string(id).starts_with("anamorphic")) continue;  // needs more rays
      SCOPED_TRACE(std::string(id) + ' ' + std::to_string(field));
      const Lens lens = data_lens(id);
      const std::vector<FocusField> fields{{field, 1}};
      for (const double shift : {-0.5, 0.0, 0.3}) {
        const Lens set =
            with_film(lens, solve_focus(lens, 2000, {.criterion = min_rms, .fields = fields}).film_z + shift);
        const Spread found = spread(set, {field, -2000}, set.film_z());
        const double rms = blur_diameter(set, 2000, {.criterion = min_rms, .fields = fields}).value();
        const double largest = blur_diameter(set, 2000, {.criterion = min_max, .fields = fields}).value();
        EXPECT_NEAR(rms, std::sqrt(8) * found.rms, 0.02 * rms);
        // The grid misses the edges of the pupil; the rays of the quadrature may miss the largest radius inside.
        EXPECT_GE(largest, 2 * found.largest * (1 - 2e-3));
        EXPECT_NEAR(largest, 2 * found.largest, 0.05 * largest);
      }
    }
  }
}

TEST(ExactFocus, MinimisesTheBlur) {
  struct Case {
    const char* id;
    double field_deg = 10, near_mm = 1500;
  };
  for (const auto& [id, field_deg, near_mm] :
       {Case{"cooke_triplet_50mm_f5"}, Case{"double_gauss_100mm_f2.0"}, Case{"anamorphic_60mm_2x"},
        Case{"catadioptric_maksutov_1280mm_f14.4", 0.2, 3e4}, Case{"phone_5.6mm_f3.5"}}) {
    const std::vector<FocusField> fields{{0, 1}, {radians(field_deg), 2}, {radians(-1.7 * field_deg), 0.5}};
    for (const FocusCriterion criterion : {min_rms, min_max}) {
      for (const double distance : {near_mm, infinity}) {
        SCOPED_TRACE(std::string(id) + ' ' + std::string(name(criterion)));
        const FocusOptions options{.criterion = criterion, .fields = fields};
        const Lens best = with_focus(data_lens(id), distance, options);
        const double least = blur_diameter(best, distance, options).value();
        for (const double shift : {-1.0, -0.1, -1e-2, -1e-3, -1e-4, 1e-4, 1e-3, 1e-2, 0.1, 1.0}) {
          if (best.film_z() + shift <= best.surfaces().back().vertex_z) continue;
          const Lens other = with_film(best, best.film_z() + shift);
          EXPECT_GE(blur_diameter(other, distance, options).value(), least) << shift;
        }
      }
    }
  }
}

TEST(ExactFocus, MinMaxIsAtThreeQuartersOfTheAberration) {
  // For third-order longitudinal aberration, proportional to h^2, the film with the smallest maximum radius lies at 3/4
  // of the distance from paraxial to marginal focus, the film with the smallest RMS radius at 2/3. These classical
  // results hold in the limit of a small aperture.
  Prescription p = data_prescription("singlet_50mm_biconvex");
  for (SurfaceRow& row : p.surfaces) row.semi_diameter = 30;
  p.surfaces[0].semi_diameter = 1;
  const Lens lens = compile(p);
  const auto [ray, fate, surface] = trace(lens, Ray<double>{{0, 1, 0}, {0, 0, 1}});
  const double marginal = ray.origin.z - ray.origin.y * ray.direction.z / ray.direction.y;
  const double paraxial_z = solve_focus(lens, infinity, {paraxial}).film_z, aberration = marginal - paraxial_z;
  ASSERT_LT(aberration, 0);
  EXPECT_NEAR((solve_focus(lens, infinity, {min_rms}).film_z - paraxial_z) / aberration, 2.0 / 3, 1e-3);
  EXPECT_NEAR((solve_focus(lens, infinity, {min_max}).film_z - paraxial_z) / aberration, 3.0 / 4, 2e-3);
}

TEST(ExactFocus, SeveralFieldsGiveAFilmBetweenTheirFilms) {
  const Lens lens = data_lens("cooke_triplet_50mm_f5");
  const auto film = [&](std::vector<FocusField> fields, FocusCriterion criterion) {
    return solve_focus(lens, infinity, {.criterion = criterion, .fields = std::move(fields)}).film_z;
  };
  for (const FocusCriterion criterion : {min_rms, min_max}) {
    const double axis = film({{0, 1}}, criterion), edge = film({{radians(18), 1}}, criterion);
    const double both = film({{0, 1}, {radians(18), 1}}, criterion);
    EXPECT_GT(std::abs(edge - axis), 0.01);
    EXPECT_GE(both, std::min(axis, edge));  // equal if a single field has the largest radius
    EXPECT_LE(both, std::max(axis, edge));
    EXPECT_NEAR(film({{0, 1}, {radians(18), 1e-9}}, criterion), axis, 1e-6);
    EXPECT_EQ(film({{0, 3}, {radians(18), 0}}, criterion), axis);
    EXPECT_NEAR(film({{0, 2}, {radians(18), 2}}, criterion), both, 1e-12);
    EXPECT_NEAR(film({{radians(-18), 1}}, criterion), edge, 1e-6);  // the mirror image
  }
}

TEST(ExactFocus, SeveralWavelengthsAreWeighted) {
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const std::vector<double> nm{486.1327, 587.5618, 656.2725};
  const Lens lens = compile(data_prescription("singlet_50mm_biconvex"), nm, {.glasses = &glasses});
  const auto film = [&](std::vector<double> weights) {
    return solve_focus(lens, 1000, {.criterion = min_rms, .wavelength_weights = std::move(weights)}).film_z;
  };
  const double blue = film({1, 0, 0}), green = film({0, 1, 0}), red = film({0, 0, 1});
  EXPECT_LT(blue, green);
  EXPECT_LT(green, red);
  EXPECT_EQ(film({}), green);  // the central wavelength
  EXPECT_NEAR(film({0, 5, 0}), green, 1e-12);
  EXPECT_GT(film({1, 0, 1}), blue);
  EXPECT_LT(film({1, 0, 1}), red);
  EXPECT_GT(film({1, 0, 2}), film({1, 0, 1}));

  // To first order the wavelength of the largest weight counts; of equal weights the central wavelength.
  const auto first = [&](std::vector<double> weights) {
    return solve_focus(lens, 1000, {.criterion = paraxial, .wavelength_weights = std::move(weights)}).film_z;
  };
  EXPECT_EQ(first({1, 1, 1}), solve_focus(lens, 1000, {paraxial}).film_z);
  EXPECT_EQ(first({1, 1, 2}), first({0, 0, 1}));
  EXPECT_LT(first({2, 1, 1}), first({1, 1, 2}));

  const FocusOptions options{.criterion = min_rms, .fields = {{radians(5), 1}}, .wavelength_weights = {1, 2, 1}};
  const Lens set = with_focus(lens, 1000, options);
  const double found = std::sqrt(8) * spread(set, {radians(5), -1000}, set.film_z(), {1, 2, 1}).rms;
  EXPECT_NEAR(blur_diameter(set, 1000, options).value(), found, 0.02 * found);
}

TEST(ExactFocus, PerfectLensFocusesParaxially) {
  for (const char* id :
       {"analytic_ellipsoid_concentric_150mm", "analytic_plano_hyperbolic_100mm", "mirror_newton_200mm_f8"}) {
    const Lens lens = data_lens(id);
    const double film_z = solve_focus(lens, infinity, {paraxial}).film_z;
    EXPECT_NEAR(solve_focus(lens, infinity, {min_rms}).film_z, film_z, 1e-12) << id;
    EXPECT_NEAR(solve_focus(lens, infinity, {min_max}).film_z, film_z, 1e-10) << id;
  }
}

TEST(ExactFocus, ScalesWithTheLens) {
  const Prescription p = data_prescription("cooke_triplet_50mm_f5");
  const std::vector<FocusField> fields{{0, 1}, {radians(12), 1}};
  for (const FocusCriterion criterion : {min_rms, min_max}) {
    const FocusOptions options{.criterion = criterion, .fields = fields};
    const double film_z = solve_focus(compile(p), 800, options).film_z;
    for (const double factor : {1e-3, 8.0}) {
      EXPECT_NEAR(solve_focus(compile(scale(p, factor)), 800 * factor, options).film_z, film_z * factor,
                  1e-11 * film_z * factor);
    }
  }
}

}  // namespace exact_test
}  // namespace petzval
