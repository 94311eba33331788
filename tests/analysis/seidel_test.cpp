// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/aberrations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../seidel.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace seidel_test {

constexpr double open = std::numeric_limits<double>::infinity();
constexpr double f_line_nm = 486.1327, c_line_nm = 656.2725;

constexpr std::array all_terms{&SeidelTerms::s1, &SeidelTerms::s2, &SeidelTerms::s3, &SeidelTerms::s4,
                               &SeidelTerms::s5, &SeidelTerms::c1, &SeidelTerms::c2};
constexpr std::array names{"S1", "S2", "S3", "S4", "S5", "C1", "C2"};

/// Sum of the absolute values of a term: the scale of rounding errors.
double size_of(const SeidelSums& sums, double SeidelTerms::*term) {
  double size = 0;
  for (const SeidelTerms& t : sums.surfaces) size += std::abs(t.*term);
  return size;
}

void expect_near(const SeidelTerms& found, const SeidelTerms& expected, double relative, const std::string& what) {
  for (std::size_t i = 0; i < all_terms.size(); ++i) {
    const double value = expected.*all_terms[i];
    EXPECT_NEAR(found.*all_terms[i], value, relative * std::abs(value) + 1e-15) << what << ": " << names[i];
  }
}

Lens compiled(std::vector<SurfaceRow> surfaces, Medium object_space = {}) {
  Prescription p;
  p.name = "test";
  p.object_space = std::move(object_space);
  p.surfaces = std::move(surfaces);
  return compile(p);
}

bool has_sums(const Lens& lens) {
  const auto fits = [](const LensSurface& s) {
    return s.curved_in == Section::both &&
           std::none_of(s.aspheric.begin(), s.aspheric.end(), [](const AsphereTerm& t) { return t.order == 3; });
  };
  return std::all_of(lens.surfaces().begin(), lens.surfaces().end(), fits);
}

/// A triplet with aspheres behind a plane stop at a distance in front of its first lens.
Prescription aspheric_triplet(double stop_distance) {
  Prescription p;
  p.name = "aspheric triplet";
  p.surfaces = {{.thickness = stop_distance, .semi_diameter = 5, .stop = true},
                {.radius = 23.7,
                 .thickness = 4.8,
                 .medium = {.nd = 1.691, .vd = 54.7},
                 .semi_diameter = 12,
                 .conic = -0.6,
                 .aspheric = {{4, 1e-5}, {6, 2e-8}}},
                {.radius = 7331, .thickness = 5.9, .semi_diameter = 12},
                {.radius = -24.5,
                 .thickness = 1,
                 .medium = {.nd = 1.6727, .vd = 32.3},
                 .semi_diameter = 12,
                 .aspheric = {{2, 1e-3}, {4, -3e-6}}},
                {.radius = 21.9, .thickness = 4.8, .semi_diameter = 12, .conic = 1.5},
                {.radius = 86.8, .thickness = 3.1, .medium = {.nd = 1.691, .vd = 54.7}, .semi_diameter = 12},
                {.radius = -20.5, .thickness = 41, .semi_diameter = 12}};
  return p;
}

Lens compiled_f_d_c(const Prescription& p) {
  return compile(p, std::array{f_line_nm, d_line_nm, c_line_nm}, {.missing_glass = MissingGlass::abbe});
}

TEST(ParaxialRays, InvariantIsEqualAtEverySurfaceOfEveryLens) {
  int lenses = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    if (!has_sums(lens)) continue;
    ++lenses;
    for (const double distance : {open, 1000.0}) {
      const ParaxialRays rays = paraxial_rays(lens, {.object_distance = distance, .field_rad = 0.2});
      for (std::size_t i = 0; i < lens.surface_count(); ++i) {
        const ParaxialRays::Pair& r = rays.surfaces[i];
        const double n = signed_index(lens, i + 1);
        const double rounding =
            1e-12 * (std::abs(n * r.marginal_u * r.chief_y) + std::abs(n * r.chief_u * r.marginal_y));
        EXPECT_NEAR(n * (r.marginal_u * r.chief_y - r.chief_u * r.marginal_y), rays.invariant,
                    1e-12 * std::abs(rays.invariant) + rounding)
            << p.id << ": surface " << i;
      }
    }
  }
  EXPECT_GE(lenses, 65);
}

TEST(ParaxialRays, MeetStopAndImageOfFirstOrderData) {
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    if (!has_sums(lens)) continue;
    const Pupils pupil = pupils(lens);
    for (const double distance : {open, 1000.0}) {
      const ParaxialRays rays = paraxial_rays(lens, {.object_distance = distance, .field_rad = 0.1});
      const ParaxialRays::Pair &stop = rays.surfaces[pupil.stop], &last = rays.surfaces.back();
      const double rim = lens.surfaces()[pupil.stop].semi_diameter;
      EXPECT_NEAR(std::abs(stop.marginal_y), rim, 1e-11 * rim) << p.id;
      EXPECT_NEAR(stop.chief_y, 0, 1e-11 * (rim + std::abs(rays.surfaces.front().chief_y))) << p.id;
      EXPECT_NEAR(rays.object_chief_u, std::tan(0.1), 1e-14) << p.id;
      EXPECT_GT(rays.surfaces.front().marginal_y, 0) << p.id;
      if (distance == open) {
        EXPECT_NEAR(rays.surfaces.front().marginal_y, pupil.entrance.diameter / 2, 1e-11 * rim) << p.id;
      }
      const double image_z = paraxial_image_z(lens, -distance);
      if (std::isfinite(image_z)) {
        EXPECT_NEAR(last.marginal_y + (image_z - lens.surfaces().back().vertex_z) * last.marginal_u, 0, 1e-9 * rim)
            << p.id;
      }
    }
  }
}

TEST(ParaxialRays, ObjectHeightEqualsItsAngle) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const double entrance_z = pupils(lens).entrance.z, slope = std::tan(0.15);
  const ParaxialRays by_angle = paraxial_rays(lens, {.object_distance = 700, .field_rad = 0.15});
  const ParaxialRays by_height =
      paraxial_rays(lens, {.object_distance = 700, .object_height = -slope * (700 + entrance_z)});
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    EXPECT_NEAR(by_height.surfaces[i].chief_y, by_angle.surfaces[i].chief_y, 1e-12) << i;
    EXPECT_NEAR(by_height.surfaces[i].chief_u, by_angle.surfaces[i].chief_u, 1e-14) << i;
  }
}

TEST(ParaxialRays, InvalidInput_ThrowsError) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  testing::expect_error([&] { paraxial_rays(lens, {.field_rad = 1.6}); }, {"field_rad", 1.6});
  testing::expect_error([&] { paraxial_rays(lens, {.object_height = 5}); }, {"object_distance"});
  testing::expect_error([&] { paraxial_rays(lens, {.object_distance = std::nan("")}); }, {"object_distance"});
  testing::expect_error([&] { seidel_sums(testing::data_lens("cylinder_3.9mm")); }, {"surface", "cylinder"});
  testing::expect_error([&] { seidel_sums(testing::data_lens("phone_5.6mm_f3.5")); }, {"surface", 1, -0.01895});
  testing::expect_error([&] { paraxial_rays(compiled({{.radius = 50, .semi_diameter = open}})); }, {"semi_diameter"});
  // Telecentric in object space: the stop lies in the rear focal plane of a surface with f' = n r / (n - 1) = 150.
  const Lens telecentric = compiled({{.radius = 50, .thickness = 150, .medium = {.nd = 1.5}, .semi_diameter = open},
                                     {.medium = {.nd = 1.5}, .semi_diameter = 3, .stop = true}});
  testing::expect_error([&] { paraxial_rays(telecentric); }, {"marginal"});
  testing::expect_error([&] { paraxial_rays(telecentric, {.object_distance = 200, .field_rad = 0.1}); }, {"chief"});
  const ParaxialRays rays = paraxial_rays(telecentric, {.object_distance = 200, .object_height = 4});
  EXPECT_NEAR(rays.object_chief_u, 0, 1e-15);
  EXPECT_NEAR(rays.surfaces[0].chief_y, 4, 1e-12);
}

TEST(SeidelSums, SphericalSurfaceEqualsClosedForm) {
  const double n = 1.6, c = 1 / 40.0, y = 3, slope = std::tan(0.2);
  const Lens lens = compiled({{.radius = 40, .thickness = 100, .medium = {.nd = n}, .semi_diameter = y, .stop = true}});
  const double h = -slope * y;  // u = 0 and ybar = 0 at the stop
  const SeidelTerms expected{.s1 = y * y * y * y * c * c * c * (n - 1) / (n * n),
                             .s2 = y * y * y * c * c * slope * (n - 1) / (n * n),
                             .s3 = y * y * c * slope * slope * (n - 1) / (n * n),
                             .s4 = h * h * c * (1 - 1 / n),
                             .s5 = y * slope * slope * slope * (1 - 1 / (n * n))};
  const SeidelSums found = seidel_sums(lens, {.field_rad = 0.2});
  expect_near(found.sums, expected, 1e-12, "sphere");
  expect_near(found.surfaces[0], expected, 1e-12, "surface 0");
}

TEST(SeidelSums, ThinLensAtStopEqualsClosedForms) {
  // Welford, section 8: bending B = (c1 + c2) / (c1 - c2), conjugate C = (u + u') / (u - u').
  const double n = 1.5168, v = 64.17, y = 4;
  for (const double c1 : {0.02, -0.005, 0.013}) {
    for (const double distance : {open, 90.0}) {
      const double c2 = c1 - 0.02, power = (n - 1) * 0.02, slope = std::tan(0.1);
      Prescription p;
      p.name = "thin lens";
      p.surfaces = {{.semi_diameter = y, .stop = true},
                    {.radius = 1 / c1, .medium = {.nd = n, .vd = v}, .semi_diameter = open},
                    {.radius = c2 == 0 ? 0 : 1 / c2, .thickness = 90, .semi_diameter = open}};
      const Lens lens = compiled_f_d_c(p);
      const double u = std::isinf(distance) ? 0 : y / distance, u_out = u - y * power;
      const double bending = (c1 + c2) / (c1 - c2), conjugate = (u + u_out) / (u - u_out), h = -slope * y;
      const double shape = bending + 2 * (n * n - 1) / (n + 2) * conjugate;
      const double m = n - 1;
      SeidelTerms expected;
      expected.s1 = std::pow(y, 4) * std::pow(power, 3) / 4 *
                    (n * n / (m * m) + (n + 2) / (n * m * m) * shape * shape - n / (n + 2) * conjugate * conjugate);
      expected.s2 = -y * y * power * power * h / 2 * ((n + 1) / (n * m) * bending + (2 * n + 1) / n * conjugate);
      expected.s3 = h * h * power;
      expected.s4 = h * h * power / n;
      expected.s5 = 0;
      const double dispersion = lens.index(2, lens.wavelength_index(Wavelength::nm(f_line_nm))) -
                                lens.index(2, lens.wavelength_index(Wavelength::nm(c_line_nm)));
      expected.c1 = y * y * power * dispersion / m;
      const SeidelSums found = seidel_sums(lens, {.object_distance = distance, .field_rad = 0.1}, {},
                                           lens.wavelength_index(Wavelength::nm(f_line_nm)),
                                           lens.wavelength_index(Wavelength::nm(c_line_nm)));
      for (std::size_t i = 0; i < all_terms.size(); ++i) {
        EXPECT_NEAR(found.sums.*all_terms[i], expected.*all_terms[i], 1e-12 * size_of(found, all_terms[i]) + 1e-17)
            << "c1 = " << c1 << ": " << names[i];
      }
      EXPECT_NEAR(found.sums.c1, y * y * power / v, 1e-3 * found.sums.c1);
    }
  }
}

TEST(SeidelSums, ParabolicMirrorHasNoSphericalAberration) {
  const auto mirror = [](double conic) {
    return compiled(
        {{.radius = -400, .thickness = -200, .semi_diameter = 25, .conic = conic, .stop = true, .mirror = true}});
  };
  const double y = 25, c = 1 / 400.0, slope = std::tan(0.01);
  const SeidelSums sphere = seidel_sums(mirror(0), {.field_rad = 0.01}),
                   parabola = seidel_sums(mirror(-1), {.field_rad = 0.01});
  EXPECT_NEAR(sphere.sums.s1, 2 * y * y * y * y * c * c * c, 1e-12 * sphere.sums.s1);
  EXPECT_NEAR(parabola.sums.s1, 0, 1e-15 * sphere.sums.s1);
  // With the stop at the mirror, the conic constant has no influence on the other sums.
  for (const SeidelTerms& t : {sphere.sums, parabola.sums}) {
    EXPECT_NEAR(std::abs(t.s2), 2 * y * y * y * c * c * slope, 1e-15);
    EXPECT_NEAR(t.s3, 2 * y * y * c * slope * slope, 1e-15);
    EXPECT_NEAR(t.s4, -2 * y * y * c * slope * slope, 1e-15);
    EXPECT_NEAR(t.s5, 0, 1e-15);
  }
}

TEST(SeidelSums, QuadraticTermEqualsParaboloid) {
  const auto behind_stop = [](SurfaceRow row) {
    row.thickness = 100, row.medium = {.nd = 1.6}, row.semi_diameter = 20;
    return compiled({{.thickness = 6, .semi_diameter = 5, .stop = true}, row});
  };
  const Lens paraboloid = behind_stop({.radius = 50, .conic = -1});
  const ParaxialField field{.object_distance = 300, .field_rad = 0.2};
  for (const Lens& lens :
       {behind_stop({.aspheric = {{2, 0.01}}}), behind_stop({.radius = 100, .conic = -1, .aspheric = {{2, 0.005}}})}) {
    expect_near(seidel_sums(lens, field).sums, seidel_sums(paraboloid, field).sums, 1e-12, "paraboloid");
  }
}

TEST(SeidelSums, AplanaticSurfaceHasNoS1S2S3) {
  const Lens lens = compiled({{.thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = 4, .stop = true},
                              {.radius = -50, .thickness = -120, .semi_diameter = 30}},
                             {.nd = 1.5});
  // The aplanatic point lies at r (n + n') / n = -250 / 3 from the surface, thus 250 / 3 - 5 in front of the stop.
  const SeidelSums found = seidel_sums(lens, {.object_distance = 250 / 3.0 - 5, .field_rad = 0.1});
  const SeidelSums beside = seidel_sums(lens, {.object_distance = 75, .field_rad = 0.1});
  EXPECT_NEAR(found.sums.s1, 0, 1e-12 * std::abs(beside.sums.s1));
  EXPECT_NEAR(found.sums.s2, 0, 1e-12 * std::abs(beside.sums.s2));
  EXPECT_NEAR(found.sums.s3, 0, 1e-12 * std::abs(beside.sums.s3));
  EXPECT_GT(std::abs(found.sums.s4), 1e-4);
}

TEST(SeidelSums, StopShiftFollowsItsFormulas) {
  const Lens near = compiled_f_d_c(aspheric_triplet(2)), far = compiled_f_d_c(aspheric_triplet(14));
  const ParaxialField field{.field_rad = 0.15};
  const auto sums_of = [&](const Lens& lens) {
    return seidel_sums(lens, field, {}, lens.wavelength_index(Wavelength::nm(f_line_nm)),
                       lens.wavelength_index(Wavelength::nm(c_line_nm)));
  };
  const SeidelSums a = sums_of(near), b = sums_of(far);
  const ParaxialRays rays = paraxial_rays(near, field), moved = paraxial_rays(far, field);
  const double q = (moved.surfaces[1].chief_y - rays.surfaces[1].chief_y) / rays.surfaces[1].marginal_y;
  EXPECT_GT(std::abs(q), 0.2);
  const auto shifted = [&](const SeidelTerms& t) {
    return SeidelTerms{.s1 = t.s1,
                       .s2 = t.s2 + q * t.s1,
                       .s3 = t.s3 + 2 * q * t.s2 + q * q * t.s1,
                       .s4 = t.s4,
                       .s5 = t.s5 + q * (3 * t.s3 + t.s4) + 3 * q * q * t.s2 + q * q * q * t.s1,
                       .c1 = t.c1,
                       .c2 = t.c2 + q * t.c1};
  };
  for (std::size_t i = 1; i < near.surface_count(); ++i) {
    expect_near(b.surfaces[i], shifted(a.surfaces[i]), 1e-10, "surface " + std::to_string(i));
  }
  const SeidelTerms expected = shifted(a.sums);
  for (std::size_t i = 0; i < all_terms.size(); ++i) {
    EXPECT_NEAR(b.sums.*all_terms[i], expected.*all_terms[i], 1e-12 * size_of(b, all_terms[i])) << names[i];
  }
}

TEST(SeidelSums, ScaledLensScalesSums) {
  const Prescription p = aspheric_triplet(3);
  const Lens lens = compiled_f_d_c(p), scaled = compiled_f_d_c(scale(p, 3));
  for (const double distance : {open, 200.0}) {
    const auto sums_of = [&](const Lens& l, double k) {
      return seidel_sums(l, {.object_distance = k * distance, .field_rad = 0.2}, {},
                         l.wavelength_index(Wavelength::nm(f_line_nm)), l.wavelength_index(Wavelength::nm(c_line_nm)));
    };
    const SeidelSums a = sums_of(lens, 1), b = sums_of(scaled, 3);
    for (std::size_t i = 0; i < all_terms.size(); ++i) {
      EXPECT_NEAR(b.sums.*all_terms[i], 3 * (a.sums.*all_terms[i]), 1e-12 * size_of(b, all_terms[i])) << names[i];
    }
  }
}

TEST(SeidelSums, EqualIndependentSumsAndPetzvalSumOfEveryLens) {
  int lenses = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    if (!has_sums(lens)) continue;
    ++lenses;
    const SeidelSums found = seidel_sums(lens, {.field_rad = 0.2});
    const ParaxialRays rays = paraxial_rays(lens, {.field_rad = 0.2});
    const double h = rays.invariant, petzval = h * h * first_order(lens).petzval_sum;
    EXPECT_NEAR(found.sums.s4, petzval, 1e-12 * size_of(found, &SeidelTerms::s4)) << p.id;

    const testing::SeidelSums unit = testing::seidel_sums(lens, pupils(lens).entrance.z);
    const double r = rays.surfaces[0].marginal_y, f = std::tan(0.2);
    const std::array expected{
        static_cast<double>(unit.s1) * r * r * r * r, static_cast<double>(unit.s2) * r * r * r * f,
        static_cast<double>(unit.s3) * r * r * f * f, static_cast<double>(unit.s4) * r * r * f * f,
        static_cast<double>(unit.s5) * r * f * f * f};
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(found.sums.*all_terms[i], expected[i], 1e-9 * size_of(found, all_terms[i]) + 1e-14)
          << p.id << ": " << names[i];
    }
  }
  EXPECT_GE(lenses, 65);
}

TEST(SeidelSums, ChromaticSumsEqualDifferencesOfCloseWavelengths) {
  Prescription p = testing::data_prescription("double_gauss_100mm_f2.0");
  const double middle = 550, half = 0.5;
  const Lens lens = compile(p, std::array{middle - half, middle, middle + half},
                            {.missing_glass = MissingGlass::abbe, .primary_nm = middle});
  for (const double distance : {open, 500.0}) {
    ParaxialField field{.object_distance = distance, .field_rad = 0.2};
    if (std::isfinite(distance)) field.object_height = -80;
    const SeidelSums sums = seidel_sums(lens, field, {}, 0, 2);
    const double n_u = paraxial_rays(lens, field).surfaces.back().marginal_u,
                 image_z = paraxial_image_z(lens, -distance);
    const double shift = paraxial_image_z(lens, -distance, 0) - paraxial_image_z(lens, -distance, 2);
    const auto height = [&](Wavelength wavelength) {
      const ParaxialRays::Pair last = paraxial_rays(lens, field, wavelength).surfaces.back();
      return last.chief_y + (image_z - lens.surfaces().back().vertex_z) * last.chief_u;
    };
    EXPECT_NEAR(sums.sums.c1, -n_u * n_u * shift, 1e-4 * size_of(sums, &SeidelTerms::c1)) << distance;
    EXPECT_NEAR(sums.sums.c2, n_u * (height(0) - height(2)), 1e-4 * size_of(sums, &SeidelTerms::c2)) << distance;
  }
}

// Numbers: ray-optics, docs/source/examples/SasianTriplet/SasianTriplet.rst: the triplet of J. Sasian's course Lens
// Design OPTI 517 (University of Arizona), 12.5 mm pupil, 20 degrees, printed to 6 decimals; slopes are optical slopes
// n u.
TEST(SeidelSums, TripletEqualsTableOfRayOptics) {
  const Medium crown{.glass = "N-LAK9", .catalogue = "schott"}, flint{.glass = "N-SF5", .catalogue = "schott"};
  Prescription p;
  p.name = "triplet";
  p.surfaces = {{.radius = 23.713, .thickness = 4.831, .medium = crown, .semi_diameter = open},
                {.radius = 7331.288, .thickness = 5.86, .semi_diameter = open},
                {.radius = -24.456, .thickness = 0.975, .medium = flint, .semi_diameter = 4.66559, .stop = true},
                {.radius = 21.896, .thickness = 4.822, .semi_diameter = open},
                {.radius = 86.759, .thickness = 3.127, .medium = crown, .semi_diameter = open},
                {.radius = -20.4942, .thickness = 41.2365, .semi_diameter = open}};
  const Lens lens = compile(p);
  const ParaxialField field{.field_rad = radians(20)};
  const ParaxialRays rays = paraxial_rays(lens, field);
  constexpr double ray_table[6][4] = {{6.25, -0.182126, -4.25088, 0.487842}, {5.72969, -0.181586, -2.85718, 0.487573},
                                      {4.66559, -0.0532508, 0, 0.487573},    {4.63455, 0.0891357, 0.2842, 0.496304},
                                      {5.06436, 0.0488, 2.67738, 0.47498},   {5.1546, -0.124998, 3.55571, 0.355092}};
  constexpr double table[7][5] = {
      {0.027654, 0.019379, 0.013581, 0.089174, 0.072010},    {0.022082, -0.059501, 0.160327, -0.000288, -0.431229},
      {-0.105156, 0.137692, -0.180295, -0.085097, 0.347506}, {-0.045358, -0.076796, -0.130024, -0.095046, -0.381069},
      {0.007942, 0.028382, 0.101431, 0.024373, 0.449596},    {0.103810, -0.050068, 0.024148, 0.103180, -0.061411},
      {0.010973, -0.000912, -0.010832, 0.036297, -0.004597}};
  const SeidelSums found = seidel_sums(lens, field);
  for (std::size_t i = 0; i < 6; ++i) {
    const double n = lens.index(i + 1);
    EXPECT_NEAR(rays.surfaces[i].marginal_y, ray_table[i][0], 1e-5) << i;
    EXPECT_NEAR(n * rays.surfaces[i].marginal_u, ray_table[i][1], 1e-6) << i;
    EXPECT_NEAR(rays.surfaces[i].chief_y, ray_table[i][2], 1e-5) << i;
    EXPECT_NEAR(n * rays.surfaces[i].chief_u, ray_table[i][3], 1e-6) << i;
    for (std::size_t k = 0; k < 5; ++k)
      EXPECT_NEAR(found.surfaces[i].*all_terms[k], table[i][k], 1.5e-6) << i << ' ' << names[k];
  }
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(found.sums.*all_terms[k], table[6][k], 1.5e-6) << names[k];
}

// Numbers: optiland, tests/aberrations/test_aberrations.py (sums of seidels() at f/5 and 14 degrees) for
// the same double Gauss with radii to 5 decimals. Its signs: S1 to S5 are negative, its field rises to the other side.
TEST(SeidelSums, DoubleGaussEqualsNumbersOfOptiland) {
  const Prescription p = testing::data_prescription("double_gauss_100mm_f2_28deg");
  Lens lens =
      compile(p, std::array{486.1, 587.6, 656.3}, {.index_policy = IndexPolicy::catalogue, .primary_nm = 587.6});
  const std::size_t stop = *lens.stop();
  lens = with_semi_diameter(lens, stop, lens.surfaces()[stop].semi_diameter * paraxial_f_number(lens) / 5);
  const ParaxialField field{.field_rad = radians(14)};
  const SeidelTerms sums = seidel_sums(lens, field, {}, 0, 2).sums;
  EXPECT_NEAR(sums.s1, 0.0039294579, 2e-8);
  EXPECT_NEAR(std::abs(sums.s2), 0.0003954598, 2e-8);
  EXPECT_NEAR(sums.s3, -0.0034239055, 2e-8);
  EXPECT_NEAR(sums.s4, 0.0162, 1e-4);
  EXPECT_NEAR(std::abs(sums.s5), 0.0464, 1e-4);
}

// OpticStudio and optiland take the marginal ray of the declared pupil, 10 mm, and not of the rim of the stop. Their S1
// of the triplet from which the data were rounded is 0.0069603 at 550 nm.
TEST(SeidelSums, OfADeclaredPupilEqualsNumberOfOpticStudio) {
  const Lens lens = compile(testing::data_prescription("cooke_triplet_50mm_f5"), std::array{550.0},
                            {.index_policy = IndexPolicy::catalogue});
  const double field = radians(20), diameter = pupils(lens).entrance.diameter;
  const SeidelTerms real = seidel_sums(lens, {.field_rad = field}).sums,
                    declared = seidel_sums(lens, {.field_rad = field, .entrance_pupil_diameter = 10}).sums;
  EXPECT_NEAR(declared.s1, 0.0069603, 2e-6);
  EXPECT_NEAR(declared.s1, real.s1 * std::pow(10 / diameter, 4), 1e-12);
  EXPECT_NEAR(declared.s5, real.s5 * 10 / diameter, 1e-12);
  testing::expect_error([&] { seidel_sums(lens, {.entrance_pupil_diameter = 0}); }, {"entrance_pupil_diameter", 0});
}

}  // namespace seidel_test
}  // namespace petzval
