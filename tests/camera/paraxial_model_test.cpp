// SPDX-License-Identifier: Apache-2.0
#include "camera/paraxial_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "camera_parts.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace paraxial_model_test {

using camera_detail::ParaxialModel;

const double film_24x36 = std::hypot(18, 12);

/// A line in image space.
struct Line {
  double fx, fy, px, py;
};

struct Result {
  Ray<double> ray;
  RayFate fate;
};

template <class T = double>
std::vector<Result> to_scene(const ParaxialModel& model, const std::vector<Line>& lines,
                             const RayWavelengths& wavelengths = {}) {
  const std::size_t n = lines.size();
  std::array<std::vector<T>, 10> a;
  for (auto& v : a) v.resize(n, std::numeric_limits<T>::quiet_NaN());
  for (std::size_t i = 0; i < n; ++i) {
    a[0][i] = static_cast<T>(lines[i].fx), a[1][i] = static_cast<T>(lines[i].fy);
    a[2][i] = static_cast<T>(lines[i].px), a[3][i] = static_cast<T>(lines[i].py);
  }
  std::vector<RayFate> fates(n, RayFate::no_convergence);
  const auto at = [&](std::size_t k) { return a[k].data(); };
  model.to_scene(n, TwoPlaneRays<const T>{at(0), at(1), at(2), at(3)}, wavelengths,
                 RayArrays<T>{at(4), at(5), at(6), at(7), at(8), at(9)}, fates.data());
  std::vector<Result> results;
  for (std::size_t i = 0; i < n; ++i) {
    results.push_back({{{a[4][i], a[5][i], a[6][i]}, {a[7][i], a[8][i], a[9][i]}}, fates[i]});
  }
  return results;
}

struct Back {
  Line line;
  RayFate fate;
};

Back to_film(const ParaxialModel& model, const Ray<double>& r, std::size_t wavelength = 0) {
  Back b{};
  model.to_film(1, {&r.origin.x, &r.origin.y, &r.origin.z, &r.direction.x, &r.direction.y, &r.direction.z},
                {.all = wavelength}, {&b.line.fx, &b.line.fy, &b.line.px, &b.line.py}, &b.fate);
  return b;
}

std::array<double, 2> meet(const Ray<double>& ray, double z) {
  const double t = (z - ray.origin.z) / ray.direction.z;
  return {ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y};
}

/// The exact lens without clipping.
Ray<double> exact(const Lens& lens, const Line& l, std::size_t wavelength = 0) {
  const TwoPlanes space = two_planes(lens);
  Vec3<double> d{l.px - l.fx, l.py - l.fy, space.depth()};
  const double towards = signed_index(lens, lens.surface_count()) > 0 ? -1 : 1;
  d *= (d.z * towards > 0 ? 1 : -1) / glm::length(d);
  const auto end = trace(lens, Ray<double>{{l.fx, l.fy, space.film_z}, d},
                         {.travel = Travel::to_scene, .wavelength = wavelength, .apertures = false});
  EXPECT_EQ(end.fate, RayFate::transmitted);
  return end.ray;
}

/// A lens telecentric in image space: the stop lies in the front focal plane.
Prescription telecentric() {
  Prescription p;
  p.name = "telecentric";
  p.surfaces = {{.thickness = 100, .semi_diameter = 5, .stop = true},
                {.radius = 102.16, .thickness = 4, .medium = {.nd = 1.5168}, .semi_diameter = 30},
                {.radius = -102.16, .thickness = 98.6, .semi_diameter = 30}};
  p.surfaces[0].thickness -= first_order(compile(p)).front_focal_z;
  return p;
}

// Near the axis the models equal the exact lens up to errors of third order. As the stop closes, the focus of exact
// rays tends to the paraxial focus.
TEST(ParaxialModel, ErrorIsOfThirdOrderInTheHeight) {
  std::vector<Prescription> prescriptions;
  for (const char* id : {"double_gauss_100mm_f2.0", "fisheye_10mm_f4", "eye_gullstrand_le_grand", "modern_50mm_f1.0",
                         "catadioptric_mangin_1000mm_f7.5", "mirror_newton_200mm_f8", "telephoto_250mm_f5.6"}) {
    prescriptions.push_back(testing::data_prescription(id));
  }
  // The film of the eye lies in water, and the scene of the reversed eye.
  prescriptions.push_back(reverse(testing::data_prescription("eye_gullstrand_le_grand")));
  prescriptions.back().surfaces.back().thickness = 30;
  for (const Prescription& prescription : prescriptions) {
    SCOPED_TRACE(prescription.name);
    const Lens open = compile(prescription);
    const std::size_t stop = pupils(open).stop;
    const double focal = std::abs(first_order(open).effective_focal_length);
    const auto difference = [&](double h) {
      const Lens lens = with_semi_diameter(open, stop, h * open.surfaces()[stop].semi_diameter);
      const ParaxialModel model(ModelKind::thick, lens, 0.1 * focal);
      const double depth = model.pupils().space().depth();
      const Line line{0.3 * h * focal, 0.5 * h * focal, -0.4 * h * depth, 0.7 * h * depth};
      const Ray<double> ray = to_scene(model, {line})[0].ray, real = exact(lens, line);
      const auto a = meet(ray, -focal), b = meet(real, -focal);
      return std::hypot(a[0] - b[0], a[1] - b[1]) / focal +
             std::hypot(ray.direction.x - real.direction.x, ray.direction.y - real.direction.y);
    };
    const double h = 0.01, far = difference(h), near = difference(h / 2);
    EXPECT_LT(far, 100 * h * h * h);
    EXPECT_NEAR(far / near, 8, 0.2);
  }
}

// With the exit pupil at infinity, every film point sees the same disc parallel to the axis.
TEST(ParaxialModel, HandlesPupilsAtInfinity) {
  const Lens lens = compile(telecentric());
  ASSERT_GT(std::abs(pupils(lens).exit.z), 1e6);
  const ParaxialModel model(ModelKind::thick, lens, 20);
  EXPECT_EQ(model.pupils().space().pupil_z, lens.surfaces().back().vertex_z);
  for (const double y : {0.0, 7.0, 19.0}) {
    EXPECT_NEAR(model.pupils().middle({0, y})[1], y, 0.05);
    EXPECT_NEAR(model.pupils().area({0, y}), model.pupils().area({0, 0}), 1e-4);
    const auto middle = model.pupils().middle({0, y});
    const Result chief = to_scene(model, {{0, y, middle[0], middle[1]}})[0];
    EXPECT_NEAR(meet(chief.ray, 0)[1], 0, 0.05);  // the stop
  }
  const auto [ray, fate] = to_scene(ParaxialModel(ModelKind::pinhole, lens, 20), {{0, 19, 0, 3}})[0];
  EXPECT_NEAR(meet(ray, 0)[1], 0, 1e-9);
  // On the scene side rays start next to the lens.
  Prescription reversed = reverse(telecentric());
  reversed.surfaces.back().thickness = 120;
  const ParaxialModel turned(ModelKind::thick, compile(reversed), 5);
  EXPECT_LT(std::abs(to_scene(turned, {{0, 1, 0, 0}})[0].ray.origin.z), 1e-9);
  EXPECT_NEAR(to_film(turned, {{0, 3, -50}, {0, 0, 1}}).line.fy,
              -3 * 120 / first_order(compile(reversed)).effective_focal_length, 1e-9);
}

TEST(ParaxialModel, InvalidNumbersGiveFatesAndFiniteRays) {
  const ParaxialModel model(ModelKind::thick, testing::data_lens("tessar_100mm_f2.8"), film_24x36);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<Line> bad{{nan, 0, 0, 0}, {0, inf, 0, 0}, {0, 0, -inf, 0}, {1, 2, 3, nan}, {1e300, 0, 0, 0}};
  const auto check = [](const std::vector<Result>& results) {
    for (const auto& [ray, fate] : results) {
      EXPECT_EQ(fate, RayFate::missed_surface);
      EXPECT_TRUE(std::isfinite(ray.origin.x + ray.origin.y + ray.origin.z));
      EXPECT_NEAR(glm::length(ray.direction), 1, 1e-6);
    }
  };
  check(to_scene(model, bad));
  check(to_scene<float>(model, bad));
  const std::vector<std::uint16_t> each{1, 7};
  check(to_scene(model, {{0, 0, 0, 0}, {1, 2, 3, 4}}, {.each = each.data()}));
  check(to_scene(model, {{0, 0, 0, 0}, {1, 2, 3, 4}}, {.all = 1}));

  for (const Ray<double>& ray : {Ray<double>{{nan, 0, 0}, {0, 0, 1}}, Ray<double>{{0, 0, -5}, {0, 0, -1}},
                                 Ray<double>{{0, 0, 0}, {0, 1, 0}}, Ray<double>{{0, 0, inf}, {0, 0.6, 0.8}}}) {
    const Back back = to_film(model, ray);
    EXPECT_EQ(back.fate, RayFate::missed_surface);
    EXPECT_TRUE(std::isfinite(back.line.fx + back.line.fy + back.line.px + back.line.py));
  }
  EXPECT_EQ(to_film(model, {{0, 0, -5}, {0, 0, 1}}, 1).fate, RayFate::missed_surface);
}

// A triangle shows the orientation. Stopped down, the pupils of the exact lens are first-order images of the stop.
TEST(ParaxialModel, IrisHasTheOrientationOfTheExactLens) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> one(-1, 1);
  int checked = 0;
  for (const Prescription& prescription : testing::data_prescriptions()) {
    const Lens open = compile(prescription);
    if (!open.stop() || !open.rotationally_symmetric() || first_order(open).afocal) continue;
    // The pupil consists of rings, and the pupils of the models have their total irradiance.
    if (prescription.name.starts_with("Ball lens")) continue;
    SCOPED_TRACE(prescription.name);
    const Lens stopped = with_semi_diameter(open, *open.stop(), open.surfaces()[*open.stop()].semi_diameter / 8);
    const Lens lens = with_iris(stopped, {.blades = 3, .rotation_rad = 0.4});
    for (const ModelKind kind : {ModelKind::thin, ModelKind::thick}) {
      const FilmPupilTable pupils = ParaxialModel(kind, lens, 1).pupils();
      const double radius = std::sqrt(ParaxialModel(kind, stopped, 1).pupils().area({}) / std::numbers::pi);
      int agree = 0, passed = 0;
      constexpr int count = 1000;
      for (int i = 0; i < count; ++i) {
        const double x = radius * one(random), y = radius * one(random), depth = pupils.space().depth();
        const double towards = towards_scene(lens, pupils.space());
        const Ray<double> ray{{x, y, pupils.space().pupil_z}, glm::normalize(Vec3<double>{x, y, depth}) * towards};
        const bool passes = trace(lens, ray, {.travel = Travel::to_scene}).transmitted();
        agree += passes == pupils.contains({}, x, y);
        passed += passes;
      }
      if (passed == 0) continue;  // behind a central obscuration
      ++checked;
      EXPECT_GT(agree, (kind == ModelKind::thick ? 0.98 : 0.9) * count) << name(kind);
    }
  }
  EXPECT_GT(checked, 120);
}

// Near the axis rays equal exact rays in both sections and in skew directions. At f/64 the focus is paraxial.
TEST(ParaxialModel, CylindersHaveTwoSections) {
  const Lens lens = with_f_number(testing::data_lens("anamorphic_60mm_2x"), 64);
  const ParaxialModel model(ModelKind::thick, lens, 20);
  const TwoPlanes space = model.pupils().space();
  const double towards = towards_scene(lens, space);
  for (const auto& [fx, fy, px, py] : {std::array{0.02, 0., 0., 0.},
                                       {0., 0.02, 0., 0.},
                                       {0., 0., 0.02, 0.},
                                       {0., 0., 0., 0.02},
                                       {0.01, -0.02, 0.015, 0.01}}) {
    Ray<double> ray;
    ASSERT_EQ(model.to_scene({fx, fy, px, py}, 0, ray), RayFate::transmitted);
    const Vec3<double> film{fx, fy, space.film_z}, pupil{px, py, space.pupil_z};
    const auto exact = trace(lens, Ray<double>{pupil, glm::normalize(pupil - film) * towards},
                             {.travel = Travel::to_scene, .apertures = false});
    ASSERT_TRUE(exact.transmitted());
    EXPECT_NEAR(glm::length(ray.direction - exact.ray.direction), 0, 2e-7);
    const double way = (ray.origin.z - exact.ray.origin.z) / exact.ray.direction.z;
    EXPECT_NEAR(glm::length(exact.ray.origin + way * exact.ray.direction - ray.origin), 0, 2e-5);
  }
  // A thin lens has a rear principal plane for each section.
  const ParaxialModel thin(ModelKind::thin, lens, 20);
  const Vec2<double> middle = thin.pupils().middle({5, 5});
  const auto through = [&](Meridian section) {
    return 5 * (1 - space.depth() / (first_order(lens, {}, section).rear_principal_z - space.film_z));
  };
  EXPECT_NEAR(middle.x, through(Meridian::x), 1e-9);
  EXPECT_NEAR(middle.y, through(Meridian::y), 1e-9);
  EXPECT_GT(std::abs(middle.x - middle.y), 0.1);
}

// On a film far larger than the image circle the discs are fitted within the image circle.
TEST(ParaxialModel, TwoDiscsAreIndependentOfTheFilmSize) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const FilmPupilTable huge = ParaxialModel(ModelKind::thin_two_disc, lens, 1e4).pupils();
  const FilmPupilTable exact = FilmPupilTable::equal_area(lens, 1e4);
  ASSERT_LT(huge.lit_radius(), 100);
  for (const double y : {0.0, 15.0, 30.0}) {
    EXPECT_NEAR(huge.area({0, y}) / exact.area({0, y}), 1, 0.02) << y;
    const PupilSample right = huge.sample({0, y}, 0.25, 1), below = huge.sample({0, y}, 0.5, 1);
    const PupilSample exact_right = exact.sample({0, y}, 0.25, 1), exact_below = exact.sample({0, y}, 0.5, 1);
    EXPECT_NEAR(right.x, exact_right.x, 1.5) << y;  // of 20 mm
    EXPECT_NEAR(below.y, exact_below.y, 1.5) << y;
  }
  EXPECT_EQ(huge.area({0, 1000}), 0);
}

TEST(ParaxialModel, RefusesInvalidModelsAndLenses) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const auto made = [](ModelKind model, const Lens& of, double radius = 20) {
    return [=] { ParaxialModel(model, of, radius); };
  };
  testing::expect_error(made(ModelKind::exact_float, lens), {lens.name(), "exact_float"});
  const Lens anamorphic = testing::data_lens("anamorphic_60mm_2x"), cylinder = testing::data_lens("cylinder_3.9mm");
  for (const ModelKind model : {ModelKind::pinhole, ModelKind::thin_two_disc}) {
    testing::expect_error(made(model, anamorphic), {anamorphic.name(), name(model)});
  }
  testing::expect_error(made(ModelKind::thick, cylinder), {cylinder.name(), "afocal"});
  testing::expect_error(made(ModelKind::thick, lens, -1), {"film", "radius", -1});

  Prescription window;
  window.name = "window";
  window.surfaces = {{.thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = 10},
                     {.thickness = 20, .semi_diameter = 10}};
  testing::expect_error(made(ModelKind::thick, compile(window)), {"window", "afocal"});

  Prescription in_principal_plane = testing::data_prescription("double_gauss_100mm_f2.0");
  in_principal_plane.surfaces.back().thickness = first_order(lens).rear_principal_z - lens.surfaces().back().vertex_z;
  testing::expect_error(made(ModelKind::thin, compile(in_principal_plane)), {lens.name(), "principal plane"});
}

}  // namespace paraxial_model_test
}  // namespace petzval
