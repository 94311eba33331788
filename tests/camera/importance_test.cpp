// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/camera_ray.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <ostream>
#include <string>

#include "../data_lenses.hpp"
#include "../low_discrepancy.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace importance_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
const Film film{.width_mm = 36, .height_mm = 24}, small{.width_mm = 6, .height_mm = 6};

CameraSample sample_at(const Film& f, const std::array<double, 5>& x) {
  return {.film = f.point(x[0] * f.columns, x[1] * f.rows), .pupil_u = x[2], .pupil_v = x[3]};
}

void expect_finite(const Importance& i) {
  EXPECT_TRUE(std::isfinite(i.we + i.film.x + i.film.y + i.raster[0] + i.raster[1] + i.pdf_film + i.pdf_pupil +
                            i.pdf_position + i.pdf_direction));
}

struct Case {
  std::string lens;
  Film film;
  ModelKind model;
  double near;  ///< tolerance of returning rays, mm on the film
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.lens << ' ' << name(c.model); }

class Importances : public ::testing::TestWithParam<Case> {};

TEST_P(Importances, ReversedCameraRaysReturnToTheirSamples) {
  const auto& [id, f, model, near] = GetParam();
  const Camera camera(testing::data_lens(id), f, {.model = model});
  const testing::Kronecker<5> random(3);
  int seen = 0, at_edges = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const auto x = random(i);
    const CameraSample s = sample_at(f, x);
    const CameraRay r = camera.sample(s);
    if (!r) continue;
    ++seen;
    const Vec3<double> point = r.ray.origin + r.ray.direction * std::pow(10, 9 * x[4]);
    const Importance back = camera.importance({point, -r.ray.direction});
    expect_finite(back);
    // A ray next to an edge of the pupil or next to the border of two of its sectors may return on the other side.
    const bool same = back && std::abs(back.pdf_pupil / r.pdf_pupil - 1) <= 1e-2 * near;
    at_edges += !same;
    if (!same) continue;
    EXPECT_EQ(back.fate, RayFate::transmitted);
    EXPECT_NEAR(std::hypot(back.film.x - s.film.x, back.film.y - s.film.y), 0, near);
    const auto raster = f.raster(s.film);
    EXPECT_NEAR(back.raster[0], raster[0], near / f.width_mm * f.columns);
    EXPECT_NEAR(back.raster[1], raster[1], near / f.width_mm * f.columns);
    EXPECT_EQ(back.pdf_film, r.pdf_film);
    // Reciprocity: importance divided by density is the weight.
    EXPECT_NEAR(back.we / (back.pdf_position * back.pdf_direction) / r.weight, 1, 1e-2 * near);
  }
  EXPECT_GT(seen, 1500);
  EXPECT_LE(at_edges, seen / 500);
}

TEST_P(Importances, VisiblePointsAreConnected) {
  const auto& [id, f, model, near] = GetParam();
  const Camera camera(testing::data_lens(id), f, {.model = model});
  const testing::Kronecker<5> random(2);
  std::uint32_t seen = 0, missed = 0, overlapping = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const auto x = random(i);
    const CameraRay r = camera.sample(sample_at(f, x));
    if (!r) continue;
    // First-order rays start in the pupil, inside the lens.
    const double leaves = r.ray.direction.z < 0 ? std::max((r.ray.origin.z + 2) / -r.ray.direction.z, 0.0) : 0;
    const Vec3<double> point = r.ray.origin + r.ray.direction * (leaves + 10 * std::pow(10, 5 * x[4]));
    ++seen;
    missed += !(camera.pdf_importance(point, -r.ray.direction) > 0);
    const ImportanceSample s = camera.sample_importance(point, x[0], x[1]);
    expect_finite(s.importance);
    if (!(s.pdf > 0)) continue;
    overlapping += std::abs(camera.pdf_importance(point, s.direction) / s.pdf - 1) > 1e-9;
    EXPECT_NEAR(glm::length(s.direction), 1, 1e-12);
    EXPECT_NEAR(glm::distance(point + s.direction * s.distance, s.on_front) / (1 + s.distance), 0, 1e-14);
    // The connection equals the importance of its ray.
    const Importance again = camera.importance({point, s.direction});
    EXPECT_EQ(again.fate, s.importance.fate);
    EXPECT_NEAR(again.film.x, s.importance.film.x, near);
  }
  EXPECT_GT(seen, 8000U);
  EXPECT_EQ(missed, 0U);
  // Sectors of interpolated polygons may overlap: 5 of 100,000 connections to the corner of the anamorphic lens's
  // field.
  EXPECT_LE(overlapping, seen / 5000);
}

INSTANTIATE_TEST_SUITE_P(
    Models, Importances,
    ::testing::Values(Case{"double_gauss_100mm_f2_28deg", film, ModelKind::exact_double, 1e-5},
                      Case{"double_gauss_100mm_f2_28deg", film, ModelKind::exact_float, 1e-2},
                      Case{"double_gauss_100mm_f2_28deg", film, ModelKind::thin, 1e-5},
                      Case{"double_gauss_100mm_f2_28deg", film, ModelKind::thin_two_disc, 1e-5},
                      Case{"double_gauss_100mm_f2_28deg", film, ModelKind::thick, 1e-5},
                      Case{"double_gauss_100mm_f2_28deg", film, ModelKind::polynomial(3), 1e-5},
                      Case{"double_gauss_100mm_f2_28deg", film, ModelKind::polynomial(9), 1e-5},
                      Case{"fisheye_10mm_f4", {.width_mm = 24, .height_mm = 16}, ModelKind::exact_double, 1e-5},
                      Case{"eye_gullstrand_le_grand", small, ModelKind::exact_double, 1e-5},
                      Case{"anamorphic_60mm_2x", film, ModelKind::polynomial(5), 2e-5},
                      Case{"anamorphic_60mm_2x", film, ModelKind::exact_double, 1e-5}));

TEST(Importance, PolynomialsFindFilmPointsOnFilmsWiderThanTheLight) {
  // These films are larger than the image circle, and polynomials fold back outside the image circle.
  const std::array<std::pair<const char*, Film>, 4> wide{{{"telephoto_100mm_f5", {.width_mm = 105, .height_mm = 70}},
                                                          {"heliar_100mm_f4", {.width_mm = 219, .height_mm = 146}},
                                                          {"phone_5.6mm_f3.5", {.width_mm = 20, .height_mm = 14}},
                                                          {"zoom_14-30mm_f4", {.width_mm = 72, .height_mm = 48}}}};
  for (const auto& [id, size] : wide) {
    for (const ModelKind model : {ModelKind::polynomial(3), ModelKind::polynomial(5), ModelKind::polynomial(7),
                                  ModelKind::polynomial(9), ModelKind::polynomial(11)}) {
      SCOPED_TRACE(std::string(id) + ' ' + std::string(name(model)));
      const Camera camera(testing::data_lens(id), size, {.model = model});
      const testing::Kronecker<5> random(6);
      int passed = 0, lost = 0;
      for (std::size_t i = 0; i < 20000; ++i) {
        const CameraSample sample = sample_at(camera.film(), random(i));
        const CameraRay ray = camera.sample(sample);
        if (!ray) continue;
        ++passed;
        const Importance met = camera.importance({ray.ray.origin, -ray.ray.direction});
        const Vec2<double> off{met.film.x - sample.film.x, met.film.y - sample.film.y};
        lost += !met || std::hypot(off.x, off.y) > 1e-6;
      }
      EXPECT_GT(passed, 1000);
      EXPECT_LE(lost, 0.02 * passed);
    }
  }
}

TEST(Importance, PinholeEqualsThickLensThroughOnePoint) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  const Camera pinhole(lens, film, {.model = ModelKind::pinhole}), thick(lens, film, {.model = ModelKind::thick});
  for (const Vec3<double> point : {Vec3<double>{0, 0, -3000}, Vec3<double>{200, -150, -2500}}) {
    ASSERT_TRUE(pinhole.sample_importance(point, 0.3, 0.7));
    double one = 0, all = 0;
    const testing::Kronecker<2> random(5);
    constexpr std::uint32_t draws = 1 << 14;
    for (std::uint32_t i = 0; i < draws; ++i) {
      const auto [u, v] = random(i);
      const ImportanceSample s = thick.sample_importance(point, u, v), p = pinhole.sample_importance(point, u, v);
      if (s) all += s.importance.we / s.pdf / draws;
      one += p.importance.we / p.pdf / draws;
      const Vec3<double> to_pupil = Vec3<double>{0, 0, pupils(lens).entrance.z} - p.on_front;
      EXPECT_NEAR(glm::length(glm::cross(to_pupil, p.direction)), 0, 1e-10);
      EXPECT_EQ(pinhole.importance({point, p.direction}).we, 0);
    }
    // The results differ slightly, because the scene side uses the cosines of its own rays.
    EXPECT_NEAR(one / all, 1, 1e-2);
  }
}

TEST(Importance, InvalidPointsAndRaysHaveNoImportance) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  for (const ModelKind model : {ModelKind::pinhole, ModelKind::thick, ModelKind::polynomial(5), ModelKind::exact_float,
                                ModelKind::exact_double}) {
    SCOPED_TRACE(name(model));
    const Camera camera(lens, film, {.model = model});
    for (const Vec3<double> point : {Vec3<double>{nan, 0, -1000}, Vec3<double>{0, infinity, -1000},
                                     Vec3<double>{0, 0, 20}, Vec3<double>{0, 0, 1000}, Vec3<double>{0, 0, -infinity}}) {
      const ImportanceSample s = camera.sample_importance(point, 0.4, 0.6);
      EXPECT_FALSE(s);
      EXPECT_EQ(s.importance.we, 0);
      EXPECT_TRUE(std::isfinite(s.direction.x + s.distance + s.on_front.z + s.pdf));
      expect_finite(s.importance);
      EXPECT_EQ(camera.project(point).status, AimStatus::no_ray) << point.z;
    }
    for (const Ray<double>& ray :
         {Ray<double>{{nan, 0, -1000}, {0, 0, 1}}, Ray<double>{{0, 0, -1000}, {0, nan, 1}},
          Ray<double>{{0, 0, -1000}, {0, 0, 0}}, Ray<double>{{0, 0, -1000}, {0, 0, 3}},
          Ray<double>{{0, 0, -infinity}, {0, 0, 1}}, Ray<double>{{0, 500, -1000}, {0, 0, 1}}}) {
      const Importance i = camera.importance(ray);
      EXPECT_EQ(i.we, 0);
      EXPECT_NE(i.fate, RayFate::transmitted);
      // The last ray is valid and misses the lens.
      EXPECT_EQ(i.fate == RayFate::invalid, ray.origin.y != 500) << name(i.fate);
      expect_finite(i);
    }
    EXPECT_EQ(camera.sample_importance({0, 0, -1000}, 0.4, 0.6, 1).importance.fate, RayFate::outside_spectrum);
    EXPECT_EQ(camera.importance({{0, 0, -1000}, {0, 0, 1}}, 1).fate, RayFate::outside_spectrum);
    EXPECT_EQ(camera.importance({{0, 0, -1000}, {0, 0, 0.9}}).fate, RayFate::invalid);
    EXPECT_EQ(camera.pdf_importance({0, 0, -1000}, {0, 0, 1}) > 0, model != ModelKind::pinhole);
    EXPECT_EQ(camera.pdf_distant_importance({{0, 0, -1000}, {0, 0, 1}}) > 0, model != ModelKind::pinhole);
    for (const double length : {0.9, 1e-160, 0.0, HUGE_VAL, std::numeric_limits<double>::quiet_NaN()}) {
      EXPECT_EQ(camera.pdf_importance({0, 0, -1000}, {0, 0, length}), 0) << length;
      EXPECT_EQ(camera.pdf_distant_importance({{0, 0, -1000}, {0, 0, length}}), 0) << length;
    }
    EXPECT_FALSE(camera.project({0, 0, -1000}, 1));
    if (model != ModelKind::pinhole) {
      EXPECT_FALSE(camera.sample_importance({0, 0, -1000}, nan, 0.6));
    }
  }
}

TEST(Importance, DirectionsPassWithinTheStatedTolerance) {
  const Lens lens = compile(petzval::testing::data_prescription("double_gauss_100mm_f2.0"));
  const Vec3<double> point{20, 10, -2000};
  for (const ModelKind model :
       {ModelKind::exact_float, ModelKind::exact_double, ModelKind::polynomial(5), ModelKind::thin}) {
    const Camera camera(lens, {}, {.model = model});
    const Vec3<double> direction = camera.sample_importance(point, 0.4, 0.6).direction;
    const Importance unit = camera.importance({point, direction});
    ASSERT_TRUE(unit) << name(model);
    for (const double part : {-1.1, -0.9, 0.9, 1.1}) {
      const Vec3<double> off = direction * std::sqrt(1 + part * unit_direction_tolerance);
      const Importance found = camera.importance({point, off});
      const bool passes = std::abs(part) < 1;
      EXPECT_EQ(found.fate, passes ? RayFate::transmitted : RayFate::invalid) << name(model) << " " << part;
      EXPECT_EQ(camera.sample_distant_importance(off, 0.4, 0.6).importance.fate, found.fate);
      EXPECT_EQ(trace(lens, Ray<double>{point, off}).transmitted(), passes);
      EXPECT_EQ(trace(lens, Ray<float>{Vec3<float>(point), Vec3<float>(off)}).transmitted(), passes);
      if (!passes) continue;
      EXPECT_NEAR(found.raster.x, unit.raster.x, 0.1) << name(model) << " " << part;
      EXPECT_NEAR(found.raster.y, unit.raster.y, 0.1) << name(model) << " " << part;
    }
  }
}

TEST(Importance, FilmDarkOnTheAxisIsConnected) {
  Prescription singlet;
  singlet.name = "singlet";
  singlet.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5168}, .semi_diameter = 12, .stop = true},
                      {.radius = -50, .thickness = 47, .semi_diameter = 12},
                      {.thickness = 1, .semi_diameter = 40, .obscuration_semi_diameter = 12}};
  const Camera camera = Camera(compile(singlet), film, {.model = ModelKind::exact_double});
  EXPECT_FALSE(camera.sample({.film = {}, .pupil_u = 0.3, .pupil_v = 0.6}));
  const testing::Kronecker<5> random(5);
  int seen = 0, missed = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const CameraRay r = camera.sample(sample_at(film, random(i)));
    if (!r) continue;
    ++seen;
    missed += !(camera.pdf_importance(r.ray.origin + r.ray.direction * 1000.0, -r.ray.direction) > 0);
  }
  EXPECT_GT(seen, 500);
  EXPECT_LT(missed, 0.02 * seen);  // the obscuration clips pupils abruptly over the field
}

TEST(Importance, BatchEqualsSingleRays) {
  constexpr std::array<double, 3> nm{450, 587.5618, 650};
  const Lens lens =
      compile(testing::data_prescription("double_gauss_100mm_f2.0"), nm, {.missing_glass = MissingGlass::abbe});
  Film tilted = film;
  tilted.tilt_rad = 0.05;
  for (const Film& f : {film, tilted}) {
    for (const ModelKind model : models()) {
      const Camera camera(lens, f, {.model = model});
      constexpr std::size_t count = 150;
      std::array<std::vector<double>, 6> columns;
      for (auto& column : columns) column.resize(count);
      auto& [x, y, z, dx, dy, dz] = columns;
      std::vector<float> wavelengths(count);
      for (std::size_t i = 0; i < count; ++i) {
        const auto [u, v] = testing::Kronecker<2>()(i);
        const CameraRay r = camera.sample({.film = {36 * (u - 0.5), 24 * (v - 0.5)}, .pupil_u = v, .pupil_v = u});
        const Vec3<double> o = r.ray.origin + 700.0 * r.ray.direction;
        x[i] = o.x, y[i] = o.y, z[i] = o.z;
        dx[i] = -r.ray.direction.x, dy[i] = -r.ray.direction.y, dz[i] = -r.ray.direction.z;
        wavelengths[i] = static_cast<float>(460 + 180 * u);
      }
      dx[3] = 2, z[100] = std::numeric_limits<double>::quiet_NaN(), wavelengths[120] = 1000;
      std::vector<Importance> found(count);
      camera.importance(count, {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()},
                        {.each_nm = wavelengths.data()}, found.data());
      for (std::size_t i = 0; i < count; ++i) {
        const Importance one = camera.importance({{x[i], y[i], z[i]}, {dx[i], dy[i], dz[i]}},
                                                 Wavelength::nm(static_cast<double>(wavelengths[i])));
        EXPECT_EQ(found[i].fate, one.fate) << name(model) << i;
        EXPECT_NEAR(found[i].we, one.we, 1e-9 * one.we);
        EXPECT_NEAR(found[i].pdf_direction, one.pdf_direction, 5e-6 * one.pdf_direction);  // rays in float
        EXPECT_NEAR(found[i].raster.x, one.raster.x, 1e-2);
      }
      std::vector<Vec3<double>> points(count);
      for (std::size_t i = 0; i < count; ++i) points[i] = {x[i], y[i], z[i]};
      std::vector<double> u(count, 0.3), v(count, 0.6);
      std::vector<ImportanceSample> connections(count);
      camera.sample_importance(count, points.data(), u.data(), v.data(), {.each_nm = wavelengths.data()},
                               connections.data());
      int connected = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const ImportanceSample one =
            camera.sample_importance(points[i], u[i], v[i], Wavelength::nm(static_cast<double>(wavelengths[i])));
        EXPECT_EQ(connections[i].importance.fate, one.importance.fate) << name(model) << i;
        EXPECT_EQ(connections[i].pdf, one.pdf);
        EXPECT_EQ(connections[i].on_front, one.on_front);
        EXPECT_NEAR(connections[i].importance.we, one.importance.we, 1e-9 * one.importance.we);
        EXPECT_NEAR(connections[i].importance.raster.y, one.importance.raster.y, 1e-2);
        connected += one.importance.we > 0;
      }
      EXPECT_GT(connected, 50) << name(model);
    }
  }
}

TEST(Importance, DistantLightIsTheLimitOfFarPoints) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  for (const ModelKind model : {ModelKind::thin, ModelKind::thick, ModelKind::polynomial(7), ModelKind::exact_double}) {
    const Camera camera(lens, film, {.model = model});
    for (const double field : {0.0, 0.1}) {
      const Vec3<double> direction{0, -std::sin(field), std::cos(field)};
      constexpr int count = 4096;
      double mean = 0, far_mean = 0;
      const double far = 1e7;
      for (int i = 0; i < count; ++i) {
        const auto [u, v] = testing::Kronecker<2>()(static_cast<std::size_t>(i));
        const ImportanceSample s = camera.sample_distant_importance(direction, u, v);
        if (s) {
          mean += s.importance.we / s.pdf / count;
          EXPECT_TRUE(std::isinf(s.distance));
          EXPECT_EQ(s.direction, direction);
          EXPECT_LT(s.on_front.z, lens.surfaces()[0].vertex_z + 40);
          EXPECT_NEAR(camera.importance({s.on_front, direction}).we, s.importance.we, 1e-9 * s.importance.we);
          EXPECT_NEAR(camera.pdf_distant_importance({s.on_front, direction}) / s.pdf, 1, 1e-9);
          EXPECT_EQ(camera.pdf_distant_importance({s.on_front + Vec3<double>{0, 500, 0}, direction}), 0);
        }
        const ImportanceSample near = camera.sample_importance(-far * direction, u, v);
        if (near) far_mean += near.importance.we / near.pdf / count;
      }
      EXPECT_NEAR(mean / (far * far * far_mean), 1, 2e-3) << name(model) << " at " << field;
    }
  }
  const Camera camera(lens, film, {.model = ModelKind::pinhole});
  const Vec3<double> direction{0, 0, 1};
  const ImportanceSample s = camera.sample_distant_importance(direction, 0.3, 0.4);
  ASSERT_TRUE(s);
  EXPECT_NEAR(s.importance.we / s.pdf * film.area_mm2(),
              std::numbers::pi / 4 * std::pow(pupils(lens).entrance.diameter, 2),
              0.1 * s.importance.we / s.pdf * film.area_mm2());
  EXPECT_EQ(camera.sample_distant_importance({0, 0, 2}, 0.3, 0.4).importance.fate, RayFate::invalid);
  EXPECT_EQ(camera.sample_distant_importance(direction, 0.3, 0.4, 7).importance.fate, RayFate::outside_spectrum);
  EXPECT_FALSE(camera.sample_distant_importance({0, 0, -1}, 0.3, 0.4));
  EXPECT_EQ(camera.pdf_distant_importance({s.on_front, direction}), 0);  // no ray meets a pinhole
}

TEST(Importance, IndependentOfTheFirstCallingThread) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const Vec3<double> point{10, 20, -3000};
  const double wanted = Camera(lens, film).sample_importance(point, 0.3, 0.4).importance.we;
  const Camera camera(lens, film);
  std::array<double, 8> found{};
  parallel_for(found.size(), 1, 8,
               [&](std::size_t i, std::size_t) { found[i] = camera.sample_importance(point, 0.3, 0.4).importance.we; });
  for (const double we : found) EXPECT_EQ(we, wanted);
}

TEST(Importance, RayOutsideTheFilmHasAFilmPoint) {
  const Camera camera(testing::data_lens("double_gauss_100mm_f2_28deg"), film, {.model = ModelKind::exact_double});
  const double angle = 0.21;  // 21 mm off the axis upwards, where the film ends at 12
  const Importance i = camera.importance({{0, 0, 0}, {0, -std::sin(angle), std::cos(angle)}});
  EXPECT_EQ(i.fate, RayFate::outside_film);
  EXPECT_EQ(i.we, 0);
  EXPECT_LT(i.film.y, -12);
}

TEST(Importance, ClosedStopVignettes) {
  const Lens open = testing::data_lens("double_gauss_100mm_f2_28deg");
  for (const double radius : {0., 1e-300, 1e-160}) {
    const Lens closed = with_semi_diameter(open, *open.stop(), radius);
    for (const ModelKind model : models()) {
      if (model.is_polynomial()) continue;  // no ray to fit
      SCOPED_TRACE(std::string(name(model)) + ' ' + std::to_string(radius));
      const Camera camera(closed, film, {.model = model});
      const Importance axis = camera.importance({{0, 0, -10}, {0, 0, 1}});
      const ImportanceSample sample = camera.sample_importance({0, 0, -3000}, 0.5, 0.5);
      for (const Importance& i : {axis, sample.importance}) {
        EXPECT_EQ(i.fate, RayFate::vignetted);
        EXPECT_EQ(i.we, 0);
        expect_finite(i);
      }
      EXPECT_EQ(sample.pdf, 0);
    }
  }
}

TEST(Importance, LostRayHasNoFilmPoint) {
  const Film beside{.width_mm = 6, .height_mm = 6, .shift_x_mm = 10};  // does not contain the axis
  for (const char* id : {"double_gauss_100mm_f2_28deg", "fisheye_10mm_f4"}) {
    for (const ModelKind model : {ModelKind::exact_float, ModelKind::exact_double, ModelKind::polynomial(3)}) {
      const Camera camera(testing::data_lens(id), beside, {.model = model});
      for (const double x : {70., 500.}) {
        const Importance lost = camera.importance({{x, 0, -10}, {0, 0, 1}});
        const std::string what = std::string(id) + ' ' + std::string(name(model)) + ' ' + std::to_string(x);
        EXPECT_NE(lost.fate, RayFate::transmitted) << what;
        EXPECT_NE(lost.fate, RayFate::outside_film) << what;
        EXPECT_TRUE(lost.film.x == 0 && lost.film.y == 0) << what;
        EXPECT_EQ(lost.raster, Importance{}.raster) << what;
      }
    }
  }
}

TEST(Importance, RayFromExtremeDistanceEqualsItsLine) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  for (const ModelKind model : models()) {
    if (model == ModelKind::pinhole) continue;
    const Camera camera(lens, film, {.model = model});
    const Importance near = camera.importance({{2, 1, -10}, {0, 0, 1}});
    const Importance far = camera.importance({{2, 1, -1.5e308}, {0, 0, 1}});
    EXPECT_EQ(near.fate, RayFate::transmitted) << name(model);
    EXPECT_EQ(far.fate, near.fate) << name(model);
    EXPECT_NEAR(far.film.x, near.film.x, 1e-5) << name(model);
    EXPECT_NEAR(far.we, near.we, 1e-6 * near.we) << name(model);
  }
}

}  // namespace importance_test
}  // namespace petzval
