// SPDX-License-Identifier: Apache-2.0
#include "focus/image_rays.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>

#include "../data_lenses.hpp"
#include "../film_at.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {
namespace image_rays_test {

using testing::data_lens;
using testing::film_at;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double degree = std::numbers::pi / 180;

/// The FieldPoint of a scene point: field seen from the entrance pupil, azimuth from +y to +x.
Vec3<double> place_at(const Lens& lens, double field_deg, double z, double azimuth = 0) {
  const double height = (pupils(lens).entrance.z - z) * std::tan(field_deg * degree);
  return {height * std::sin(azimuth), height * std::cos(azimuth), z};
}

ExactBlur blur(const ImageRays& bundles, const Vec3<double>& place, const Film& film) {
  const auto result = blur_on(bundles.bundle({place, false}), film);
  EXPECT_TRUE(result);
  return result.value_or(ExactBlur{});
}

TEST(ImageRays, StoppedDownBlursEqualTheThickLens) {
  for (const char* id : {"double_gauss_100mm_f2.0", "telephoto_100mm_f5.6", "retrofocus_100mm_f2.8",
                         "zoom_57-143mm_f2.8:tele", "singlet_50mm_biconvex"}) {
    SCOPED_TRACE(id);
    const Lens lens = with_f_number(data_lens(id), 64);
    const ImageRays bundles(lens, 20);
    const IdealLens& ideal = bundles.ideal();
    for (const double distance : {5.0, 20.0, 1e4}) {
      const Vec3<double> place{0, 0, -distance * ideal.rear_focal_length};
      const auto image = ideal.image({place, false});
      ASSERT_TRUE(image);
      for (const double behind : {-0.05, 0.03, 0.2}) {
        const Film film = film_at(image->position.z + behind * ideal.rear_focal_length);
        const double expected = signed_blur(*image, film);
        EXPECT_NEAR(blur(bundles, place, film).signed_diameter, expected, 0.01 * std::abs(expected))
            << distance << " " << behind;
      }
    }
  }
}

// Compares two independent computations: boundaries and scrambled points, or tables and a lattice.
TEST(ImageRays, SpotsEqualBoundaries) {
  for (const char* id :
       {"double_gauss_100mm_f2.0", "modern_50mm_f1.0", "zoom_57-143mm_f2.8:tele", "fisheye_8mm_f2.8"}) {
    const Prescription prescription = testing::data_prescription(id);
    const Lens lens = compile(prescription);
    const double f = std::abs(thick_lens(lens).rear_focal_length), film_z = lens.film_z() + 0.01 * f;
    for (const std::size_t rays : {256, 1024}) {
      // The spot of the fisheye has a few distant rays: 0.0244 to 0.0251 mm with 256 rays, 0.0245 mm with 1024, 0.0248
      // mm with 65536.
      const double relative = rays == 256 ? 0.015 : 0.012;
      const ImageRays bundles(lens, 0.4 * f, rays);
      for (const double field : {0.0, 0.5, 0.9}) {
        for (const double distance : {20 * f, 1e9}) {
          const double degrees = field * std::min(prescription.half_field_deg.value_or(15), 20.0);
          SCOPED_TRACE(std::string(id) + ", rays " + std::to_string(rays) + ", degrees " + std::to_string(degrees) +
                       ", mm " + std::to_string(distance));
          const double seen_at = distance == 1e9 ? -infinity : -distance;
          const PupilSampler pupil(pupil_boundary(lens, {degrees * degree, seen_at}, lens.primary_wavelength()));
          const RayBundle hits = trace_bundle(with_film(lens, film_z), pupil, 1 << 16);
          const SpotSize expected = spot_size(hits.x, hits.y);
          const ExactBlur size = blur(bundles, place_at(lens, degrees, -distance), film_at(film_z));
          EXPECT_NEAR(size.rms_radius, expected.rms_radius, relative * expected.rms_radius);
          EXPECT_NEAR(size.centroid.x, 0, 0.02 * expected.rms_radius);
          EXPECT_NEAR(size.centroid.y, expected.centroid.y, 0.02 * expected.rms_radius);
          EXPECT_LT(size.largest_radius, 1.01 * expected.max_radius);
          EXPECT_GT(size.largest_radius, 0.6 * expected.max_radius);
        }
      }
    }
  }
}

TEST(ImageRays, SharpestFilmHasTheStatedRms) {
  for (const char* id : {"modern_50mm_f1.0", "petzval_100mm_f1.6", "double_gauss_52mm_f1.8", "zoom_57-143mm_f2.8",
                         "speed_panchro_26mm_f2", "retrofocus_100mm_f2.8"}) {
    const Lens lens = data_lens(id);
    for (const double slope : {0.0, 0.1}) {
      const ScenePoint place{{0, -2000 * slope, -2000}};
      const ImageRays many(lens, 20, 1 << 16);
      const Film film = autofocus(many, std::vector{FocusTarget{.point = place}}).film;
      const double expected = blur_on(many.bundle(place), film)->rms_radius;
      for (const auto& [rays, within] : {std::pair(256, 0.07), std::pair(1024, 0.05), std::pair(4096, 0.02)}) {
        EXPECT_NEAR(blur_on(ImageRays(lens, 20, static_cast<std::size_t>(rays)).bundle(place), film)->rms_radius,
                    expected, within * expected)
            << id << ' ' << slope << ' ' << rays;
      }
    }
  }
}

TEST(ImageRays, RotateWithTheirPoints) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const ImageRays bundles(lens, 22);
  const Film film = film_at(lens.film_z());
  const ExactBlur first = blur(bundles, place_at(lens, 10, -1500), film);
  const double height = std::hypot(first.centroid.x, first.centroid.y);
  for (int turn = 1; turn < 16; ++turn) {
    const double azimuth = turn * std::numbers::pi / 8;
    const ExactBlur turned = blur(bundles, place_at(lens, 10, -1500, azimuth), film);
    EXPECT_NEAR(turned.rms_radius, first.rms_radius, 1e-9);
    EXPECT_NEAR(turned.centroid.x, -height * std::sin(azimuth), 0.02 * first.rms_radius);
    EXPECT_NEAR(turned.centroid.y, -height * std::cos(azimuth), 0.02 * first.rms_radius);
  }
}

TEST(ImageRays, AreMirroredWithTheirPoints) {
  const Lens lens = data_lens("anamorphic_60mm_2x");
  const ImageRays bundles(lens, 12);
  const Film film = film_at(lens.film_z());
  const Vec3<double> place{200, 100, -1500};
  const ExactBlur one = blur(bundles, place, film);
  for (const auto& [x, y] : {std::pair(-1, 1), std::pair(1, -1), std::pair(-1, -1)}) {
    const ExactBlur other = blur(bundles, {x * place.x, y * place.y, place.z}, film);
    EXPECT_NEAR(other.centroid.x, x * one.centroid.x, 0.1 * one.rms_radius);
    EXPECT_NEAR(other.centroid.y, y * one.centroid.y, 0.1 * one.rms_radius);
    EXPECT_NEAR(other.rms_radius, one.rms_radius, 0.02 * one.rms_radius);
  }
}

TEST(ImageRays, FarPointsTendToInfinity) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const ImageRays bundles(lens, 22);
  for (const Vec3<double>& direction : {Vec3<double>{0, 0, -1}, Vec3<double>{0.1, 0.15, -1}}) {
    const RayBundle infinite = bundles.bundle({direction * 1e-3, true});
    ASSERT_GT(infinite.x.size(), 128u);
    for (const double distance : {1e9, 1e18, 1e60, 1e160}) {
      const RayBundle far = bundles.bundle({direction * distance, false});
      ASSERT_EQ(far.x.size(), infinite.x.size()) << distance;
      for (std::size_t i = 0; i < far.x.size(); ++i) {
        EXPECT_NEAR(far.x[i], infinite.x[i], 3e-6);
        EXPECT_NEAR(far.slope_y[i], infinite.slope_y[i], 1e-7);
      }
    }
  }
  EXPECT_EQ(bundles.bundle({{3, 4, -infinity}, false}).x, bundles.bundle({{0, 0, -1}, true}).x);
}

TEST(ImageRays, KeepHalfOfTheirRays) {
  for (const char* id : {"anamorphic_60mm_2x", "cylinder_3.9mm", "double_gauss_100mm_f2.0"}) {
    const ImageRays bundles(data_lens(id), 10, 200);
    EXPECT_GE(bundles.bundle({{20, 30, -900}, false}).x.size(), 100u) << id;
  }
}

TEST(ImageRays, AreEmptyOutsideTheField) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const ImageRays bundles(lens, 22);
  for (const ScenePoint& place :
       {ScenePoint{{0, 0, 500}, false}, ScenePoint{{0, 0, 10}, false}, ScenePoint{{2000, 0, -500}, false},
        ScenePoint{{nan, 0, -500}, false}, ScenePoint{{0, infinity, -500}, false}, ScenePoint{{0, 0, 0}, true},
        ScenePoint{{0, 0, 1}, true}, ScenePoint{{0.1, 0, 1}, true}, ScenePoint{{0, 0, nan}, true},
        ScenePoint{{infinity, 0, -infinity}, false}}) {
    const RayBundle bundle = bundles.bundle(place);
    EXPECT_TRUE(bundle.empty()) << place.position.x << " " << place.position.y << " " << place.position.z;
    EXPECT_EQ(bundle.plane_z, lens.surfaces().back().vertex_z);
    EXPECT_FALSE(blur_on(bundle, film_at(100)));
  }
}

TEST(ImageRays, AreRefusedWithoutRaysOrFilm) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  EXPECT_THROW(ImageRays(lens, 22, 15), Error);
  EXPECT_THROW(ImageRays(lens, nan), Error);
  EXPECT_THROW(ImageRays(lens, -1), Error);
  EXPECT_THROW(ImageRays(data_lens("mirror_newton_200mm_f8"), 10), Error);  // light leaves the lens towards -z
}

TEST(ExactBlur, RequiresSlopes) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const RayBundle spots = trace_bundle(lens, PupilSampler(pupil_boundary(lens, FieldPoint{.z = -infinity})), 64);
  ASSERT_FALSE(spots.empty());
  EXPECT_THROW(blur_on(spots, film_at(lens.film_z())), Error);
}

TEST(ExactBlur, TiltedFilmUsesTheHitsInItsPlane) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const RayBundle bundle = ImageRays(lens, 22).bundle({{150, -250, -1200}, false});
  for (const auto& [tilt, swing] : {std::pair(0.0, 0.0), std::pair(0.2, 0.0), std::pair(-0.15, 0.3)}) {
    const Film film = film_at(lens.film_z() + 2, tilt, swing);
    const auto [normal, offset] = film.plane();
    std::vector<double> x, y;
    for (std::size_t i = 0; i < bundle.x.size(); ++i) {
      const Vec3<double> at{bundle.x[i], bundle.y[i], bundle.plane_z};
      const Vec3<double> along = glm::normalize(Vec3<double>{bundle.slope_x[i], bundle.slope_y[i], 1});
      const FilmPoint hit = film.point(at + along * ((offset - glm::dot(normal, at)) / glm::dot(normal, along)));
      x.push_back(hit.x), y.push_back(hit.y);
    }
    const SpotSize expected = spot_size(x, y);
    const auto size = blur_on(bundle, film);
    ASSERT_TRUE(size);
    EXPECT_NEAR(size->centroid.x, expected.centroid.x, 1e-12);
    EXPECT_NEAR(size->centroid.y, expected.centroid.y, 1e-12);
    EXPECT_NEAR(size->rms_radius, expected.rms_radius, 1e-12);
    EXPECT_NEAR(size->largest_radius, expected.max_radius, 1e-12);
    EXPECT_NEAR(std::abs(size->signed_diameter), std::sqrt(8) * expected.rms_radius, 1e-12);
  }
}

TEST(ExactBlur, SignIsIndependentOfTheNumberOfRays) {
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f2_28deg"), 4);
  const ScenePoint place{{-150, 86, -1100}};
  const RayBundle few = ImageRays(lens, 22, 256).bundle(place), many = ImageRays(lens, 22, 4096).bundle(place);
  const double sharpest = autofocus(ImageRays(lens, 22), std::vector{FocusTarget{.point = place}}).film.z();
  for (const double away : {-2e-3, -1e-3, 0.0, 1e-3, 2e-3}) {
    const double a = blur_on(few, film_at(sharpest + away))->signed_diameter;
    const double b = blur_on(many, film_at(sharpest + away))->signed_diameter;
    EXPECT_GT(a, 0);
    EXPECT_NEAR(a, b, 0.02 * b);
  }
  EXPECT_LT(blur_on(few, film_at(sharpest - 0.1))->signed_diameter, 0);
}

TEST(ExactBlur, IsNulloptOnFilmsParallelToTheRays) {
  const RayBundle bundle = ImageRays(data_lens("double_gauss_100mm_f2.0"), 22).bundle({{0, 0, -1200}, false});
  EXPECT_FALSE(blur_on(bundle, film_at(100, std::numbers::pi / 2)));
  EXPECT_FALSE(blur_on(bundle, film_at(nan)));
}

}  // namespace image_rays_test
}  // namespace petzval
