// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/bokeh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "tilted_films.hpp"

namespace petzval {
namespace expressive_lens_test {

using testing::expect_error;
using testing::wide;

constexpr double thinness = 1e-7;

/// A nearly thin lens of 50 mm at f/4 with the stop at z = 0, focused at 2 m to first order.
Lens thin_50mm() {
  Prescription p;
  p.name = "thin";
  constexpr double radius = 2 * 0.5168 * 50;
  p.surfaces = {
      {.radius = radius, .thickness = thinness, .medium = {.nd = 1.5168}, .semi_diameter = 0.01, .stop = true},
      {.radius = -radius, .thickness = 50 * 2000 / (2000. - 50), .semi_diameter = 0.01}};
  return compile(p);
}

/// Inverse distance from z to the point at which a ray crosses the axis, 1 / mm.
double crossing(const Ray<double>& ray, double z) {
  const double slope = ray.direction.y / ray.direction.z;
  const double height = ray.origin.y + slope * (z - ray.origin.z);
  return slope / height;
}

/// The ray from the centre of the film through the upper half of the pupil; v: fraction of the pupil area within its
/// radius.
CameraRay ray_at(const Camera& camera, double share, Wavelength wavelength = {}) {
  for (const double u : {0.0, 0.25}) {
    const CameraRay ray = camera.sample({.film = {0, 0}, .pupil_u = u, .pupil_v = share, .wavelength = wavelength});
    if (std::abs(ray.ray.direction.y) > std::abs(ray.ray.direction.x)) return ray;
  }
  return {};
}

// Changes of the inverse distance by thin-lens formulas: 1/F - 1/(u + D) for film offsets, (k - 1)/F for powers.
TEST(ExpressiveLens, FilmOffsetsAndPowerFollowThinLensFormulas) {
  const Lens lens = thin_50mm();
  const Film film{.width_mm = 10, .height_mm = 10};
  const CameraOptions plain{.model = ModelKind::thick};
  EXPECT_NEAR(crossing(ray_at(Camera(lens, film, plain), 0.5).ray, 0) * 1000, 0.5, 1e-6);
  CameraOptions offset = plain;
  offset.expressive.film_offsets = {{{0, 0}, 0.1}};
  EXPECT_NEAR(crossing(ray_at(Camera(lens, film, offset), 0.5).ray, 0) * 1000, 0.53795099555866061, 1e-6);
  CameraOptions power = plain;
  power.expressive.power = {{0, 1.01}};
  EXPECT_NEAR(crossing(ray_at(Camera(lens, film, power), 0.5).ray, 0) * 1000, 0.7, 1e-6);
}

// The spline of the power over the pupil radius passes through its knots, is smooth, and is even at radius 0.
TEST(ExpressiveLens, PowerGoesThroughItsKnots) {
  const Lens lens = thin_50mm();
  const Film film{.width_mm = 10, .height_mm = 10};
  const std::vector<PowerKnot> knots{{0.1, 1.1}, {0.3, 0.9}, {0.45, 1}, {0.8, 1.3}, {1, 1.2}};
  const Camera plain(lens, film, {.model = ModelKind::thick}),
      bent(lens, film, {.model = ModelKind::thick, .expressive = {.power = knots}});
  const auto power = [&](double radius) {
    const double share = radius * radius;
    return 1 + 50 * (crossing(ray_at(bent, share).ray, 0) - crossing(ray_at(plain, share).ray, 0));
  };
  for (const auto& [radius, value] : knots) EXPECT_NEAR(power(radius), value, 1e-5) << radius;
  EXPECT_NEAR(power(0.05), 1.1, 1e-5);
  for (const auto& knot : knots) {
    if (knot.radius == 1) continue;
    constexpr double h = 1e-3;
    const double before = power(knot.radius) - power(knot.radius - h),
                 behind = power(knot.radius + h) - power(knot.radius);
    EXPECT_NEAR(before / h, behind / h, 0.1) << knot.radius;
  }
}

// The strength scales the axial colour at any wavelength.
TEST(ExpressiveLens, DispersionMultipliesAxialColour) {
  constexpr std::array nm{587.56, 440., 480., 540., 650.};
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const Lens lens = compile(testing::data_prescription("landscape_meniscus_10mm"), nm,
                            {.glasses = &glasses, .missing_glass = MissingGlass::abbe});
  const Film film{.width_mm = 4, .height_mm = 4};
  const auto at = [&](std::vector<double> dispersion) {
    return Camera(lens, film, {.model = ModelKind::thick, .expressive = {.dispersion = std::move(dispersion)}});
  };
  const Camera plain(lens, film, {.model = ModelKind::thick}), none = at({0}), one = at({1}), three = at({3}),
                                                               each = at({1, 2, 3, 4, 5});
  const double z = pupils(lens).entrance.z;
  const auto colour = [&](const Camera& camera, Wavelength wavelength) {
    return crossing(ray_at(camera, 0.5, wavelength).ray, z) - crossing(ray_at(camera, 0.5).ray, z);
  };
  for (const Wavelength wavelength : {Wavelength(1), Wavelength(4), Wavelength::nm(600), Wavelength::nm(465)}) {
    const double own = colour(plain, wavelength);
    EXPECT_GT(std::abs(own), 1e-5);
    EXPECT_NEAR(colour(none, wavelength), 0, 2e-3 * std::abs(own));
    EXPECT_NEAR(colour(one, wavelength), own, 1e-9 * std::abs(own));
    EXPECT_NEAR(colour(three, wavelength), 3 * own, 5e-3 * std::abs(own));
  }
  EXPECT_NEAR(colour(each, Wavelength(1)), 2 * colour(plain, Wavelength(1)),
              1e-2 * std::abs(colour(plain, Wavelength(1))));
  EXPECT_NEAR(colour(each, Wavelength(4)), 5 * colour(plain, Wavelength(4)),
              1e-2 * std::abs(colour(plain, Wavelength(4))));
}

/// Angular blur of a film point in a scene plane: RMS distance of its rays from their mean, divided by the distance.
double spot(const Camera& camera, const FilmPoint& film, double z) {
  double weight = 0, x = 0, y = 0, square = 0;
  const testing::Kronecker<2> random(0);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const auto [u, v] = random(i);
    const CameraRay ray = camera.sample({film, u, v});
    if (!ray) continue;
    const double t = (z - ray.ray.origin.z) / ray.ray.direction.z;
    const double px = ray.ray.origin.x + t * ray.ray.direction.x, py = ray.ray.origin.y + t * ray.ray.direction.y;
    weight += ray.weight, x += ray.weight * px, y += ray.weight * py, square += ray.weight * (px * px + py * py);
  }
  x /= weight, y /= weight;
  return std::sqrt(square / weight - x * x - y * y) / std::abs(z);
}

struct RealLens {
  std::string id;
  double on_axis;     ///< largest relative error of the blur of points 15 to 10000 focal lengths away
  double over_field;  ///< the same over the film, for blurs of at least 3 mrad
  double better;      ///< RMS error relative to the RMS error of the lens without aberrations
};
void PrintTo(const RealLens& lens, std::ostream* out) { *out << lens.id; }

class ExpressiveFromLens : public ::testing::TestWithParam<RealLens> {};

// With the spherical aberration and field curvature of a real lens, the blur equals the blur of exact rays over film
// and depth. Astigmatism and coma remain, and the pupil of first-order models is a few per cent wider at equal
// irradiance.
TEST_P(ExpressiveFromLens, BlurEqualsBlurOfExactRays) {
  const auto& [id, on_axis, over_field, better] = GetParam();
  const Lens lens = testing::data_lens(id);
  const ExpressiveLens found = fit_expressive_lens(lens, wide);
  const Camera exact(lens, wide, {.model = ModelKind::exact_double}),
      plain(lens, wide, {.model = ModelKind::thin_two_disc}),
      bent(lens, wide, {.model = ModelKind::thin_two_disc, .expressive = found});
  const double focal_length = first_order(lens).effective_focal_length;
  double square = 0, square_plain = 0;
  for (const double height : {0.0, 5.0, 10.0, 15.0, 19.0}) {
    for (const double distance : {15.0, 30.0, 60.0, 120.0, 1e4}) {
      const FilmPoint film{0.8 * height, 0.6 * height};
      const double z = -distance * focal_length, real = spot(exact, film, z), error = spot(bent, film, z) - real;
      if (height == 0) {
        EXPECT_NEAR(error / real, 0, on_axis) << distance;
      } else if (real > 3e-3) {
        EXPECT_NEAR(error / real, 0, over_field) << height << " mm, " << distance;
      }
      square += error * error, square_plain += std::pow(spot(plain, film, z) - real, 2);
    }
  }
  EXPECT_LT(std::sqrt(square / square_plain), better);
}

INSTANTIATE_TEST_SUITE_P(Lenses, ExpressiveFromLens,
                         ::testing::Values(RealLens{"double_gauss_100mm_f1.35", 0.05, 0.06, 0.45},
                                           RealLens{"tessar_100mm_f2.8", 0.02, 0.02, 0.3},
                                           RealLens{"petzval_100mm_f2.2_kodak", 0.03, 0.02, 0.7},
                                           RealLens{"double_gauss_52mm_f1.8", 0.04, 0.05, 0.45}),
                         [](const auto& tested) {
                           std::string name = tested.param.id;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

TEST(ExpressiveLens, LensWithoutAberrationsGivesAnEmptyExpressiveLens) {
  const ExpressiveLens found = fit_expressive_lens(thin_50mm(), {.width_mm = 1, .height_mm = 1});
  for (const PowerKnot& knot : found.power) EXPECT_NEAR(knot.power, 1, 1e-6);
  for (const FilmOffset& offset : found.film_offsets) EXPECT_NEAR(offset.offset_mm, 0, 0.02);
}

TEST(ExpressiveLens, CameraAcceptsTheExpressiveLensOfEveryLens) {
  for (const char* id : {"phone_5.6mm_f3.5", "ball_10mm", "eye_gullstrand_le_grand", "fisheye_16mm_f2.8",
                         "catadioptric_mangin_1000mm_f7.5", "landscape_meniscus_10mm", "modern_58mm_f0.95"}) {
    const Lens lens = testing::data_lens(id);
    for (const Film& film : {wide, Film{.width_mm = 4, .height_mm = 3}}) {
      const ExpressiveLens found = fit_expressive_lens(lens, film);
      EXPECT_FALSE(found.power.empty()) << id;
      EXPECT_NO_THROW(Camera(lens, film, {.model = ModelKind::thick, .expressive = found})) << id;
    }
  }
  EXPECT_GT(fit_expressive_lens(testing::data_lens("phone_5.6mm_f3.5")).film_offsets.size(), 30u);
  const Lens anamorphic = testing::data_lens("anamorphic_60mm_2x");
  expect_error([&] { fit_expressive_lens(anamorphic); }, {anamorphic.name(), "fit_expressive_lens"});
}

TEST(ExpressiveLens, RefusesInvalidParameters) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  const auto with = [](const Lens& of, const ExpressiveLens& expressive, ModelKind model = ModelKind::thick) {
    return [=] { Camera(of, wide, {.model = model, .expressive = expressive}); };
  };
  const double nan = std::nan("");
  expect_error(with(lens, {.power = {{0.5, 1}, {0.5, 2}}}), {lens.name(), "power", "knot 2", "radius", 0.5, 0.001});
  expect_error(with(lens, {.power = {{0, 1}, {1e-310, 2}, {1, 1}}}), {lens.name(), "power", "knot 2"});
  expect_error(with(lens, {.power = {{0, nan}}}), {lens.name(), "power", "knot 1", "nan", -1000, 1000});
  expect_error(with(lens, {.power = std::vector<PowerKnot>(33)}), {lens.name(), "power", "knots", 33, 32});
  expect_error(with(lens, {.film_offsets = {{{0, 0}, -200}}}), {lens.name(), "film offsets", -200});
  expect_error(with(lens, {.film_offsets = {{{0, 0}, nan}}}), {lens.name(), "film offsets", "nan"});
  expect_error(with(lens, {.dispersion = {1, 2}}), {lens.name(), "dispersion", 2, 1});
  expect_error(with(lens, {.dispersion = {0}}, ModelKind::exact_float), {lens.name(), "exact_float", "thick"});
  const Lens anamorphic = testing::data_lens("anamorphic_60mm_2x");
  expect_error(with(anamorphic, {.dispersion = {0}}), {anamorphic.name(), "expressive"});
}

}  // namespace expressive_lens_test
}  // namespace petzval
