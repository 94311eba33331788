// SPDX-License-Identifier: Apache-2.0
#include "petzval/paraxial/ideal_lens.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../film_at.hpp"
#include "lens/lens_view.hpp"
#include "paraxial/marginal_ray.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"

namespace petzval {
namespace ideal_lens_test {

using testing::data_lens;
using testing::data_prescriptions;
using testing::expect_error;
using testing::film_at;
using Vec = Vec3<double>;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Values computed with 40 digits, for lenses of F = 0.05 and 0.1 with planes at a distance of 2. The thin lens lies at
/// the origin.
constexpr double F = 0.05, eps12 = 1e-12, eps9 = 1e-9;
const double sin30 = 0.5, cos30 = std::sqrt(0.75);

void expect_near(const Vec& found, const Vec& wanted, double relative) {
  EXPECT_NEAR(glm::length(found - wanted), 0, relative * glm::length(wanted));
}

/// A biconvex lens of R = +-100 mm and 20 mm thickness.
Lens biconvex() {
  Prescription p;
  p.name = "biconvex";
  p.surfaces = {{.radius = 100, .thickness = 20, .medium = {.nd = 1.5168}, .semi_diameter = 5, .stop = true},
                {.radius = -100, .thickness = 100}};
  return compile(p);
}

TEST(IdealLens, ThinLensHasKnownImages) {
  const IdealLens lens = thin_lens(F, 2);
  const auto at = [&](double d) { return lens.image({{0, 0, -d}})->position.z; };
  EXPECT_NEAR(at(2), 0.051282051282051282, eps12 * F);
  EXPECT_NEAR(at(0.5), 0.0555555555555556, 1e-15);
  EXPECT_NEAR(at(0.0500001) / 25000.05, 1, 1e-9);  // rounding of the distance: 0.05 / 1e-7 eps
  EXPECT_EQ(at(infinity), F);
  EXPECT_FALSE(lens.image({{0, 0, -0.05}}));
  EXPECT_FALSE(lens.image({{0, 0, -0.04}}));
  EXPECT_FALSE(lens.image({{0, 0, 0}}));
  EXPECT_FALSE(lens.image({{0, 0, 3}}));
}

TEST(IdealLens, ThinLensHasKnownTilts) {
  const IdealLens lens = thin_lens(F, 2);
  const Plane scene{{0, sin30, -cos30}, 2 * cos30};
  const Film film = film_in(lens.image_of(scene).value());
  EXPECT_NEAR(film.z(), 0.051282051282051282, eps9 * F);
  EXPECT_NEAR(degrees(film.angle()), 0.848136346759917, eps9);
  const FocusPlane focus = focus_plane(lens, film).value();
  EXPECT_NEAR(focus.hinge->point.y, 3.3774990747593107, 4 * eps9);
  EXPECT_NEAR(focus.hinge->point.z, -F, 1e-15);
  EXPECT_NEAR(std::hypot(focus.hinge->point.y, F), 3.3778691508109073, 4 * eps9);  // F / sin(tilt)
  EXPECT_NEAR(focus.scheimpflug->point.y, 3.4641016151377546, 4 * eps9);
  EXPECT_NEAR(line_at(film.plane(), 0)->point.y, 3.4641016151377546, 4 * eps9);
  const auto image = lens.image({{0.3, -0.4, -2.2309401076758503}});
  expect_near(image->position, {-0.00687776796217708, 0.00917035728290278, 0.0511462946603628}, eps12);
  EXPECT_NEAR(signed_blur(*image, film), 0, 1e-15);

  // The ground is 1.5 below the lens.
  const Film ground = film_in(lens.image_of({{0, -1, 0}, 1.5}).value());
  EXPECT_NEAR(ground.z(), F, eps9 * F);
  EXPECT_NEAR(degrees(ground.angle()), 1.9091524329963762, eps9);
  const Line3 hinge = focus_plane(lens, ground)->hinge.value();
  EXPECT_NEAR(std::hypot(hinge.point.y, F), 1.5008331019803634, 2 * eps9);
}

TEST(IdealLens, ThickLensObeysTheLensmakersEquation) {
  const IdealLens lens = thick_lens(biconvex());
  EXPECT_NEAR(lens.rear_focal_length, 100.16191575174180, eps12 * 100);
  EXPECT_NEAR(lens.front_principal_z(), 6.8253794910997051, eps12 * 100);
  EXPECT_NEAR(lens.rear_principal_z(), 20 - 6.8253794910997051, eps12 * 100);
  EXPECT_NEAR(lens.rear_focal_z - 20, 93.336536260642098, eps12 * 100);

  Prescription meniscus;
  meniscus.name = "meniscus";
  meniscus.surfaces = {{.radius = 50, .thickness = 6, .medium = {.nd = 1.62}, .semi_diameter = 5, .stop = true},
                       {.radius = 80, .thickness = 100}};
  const IdealLens other = thick_lens(compile(meniscus));
  EXPECT_NEAR(other.rear_focal_length, 199.76324356318437, eps12 * 200);
  EXPECT_NEAR(other.front_principal_z(), -5.7339449541284, 1e-12 * 200);
  EXPECT_NEAR(other.rear_principal_z() - 6, -9.1743119266055, 1e-12 * 200);
}

TEST(IdealLens, ThickLensHasKnownTilts) {
  // The reference values are metres from the centre of the lens.
  const IdealLens lens = thick_lens(biconvex());
  constexpr double middle = 10, m = 1000;
  EXPECT_NEAR(lens.front_principal_z() - middle, -3.1746205089002949, eps12 * 100);
  EXPECT_NEAR(lens.image({{0, 0, middle - 2 * m}})->position.z - 20, 98.6260404657158, eps12 * 100);
  const Plane scene{{0, sin30, -cos30}, (2 * m - middle) * cos30};
  const Film film = film_in(lens.image_of(scene).value());
  EXPECT_NEAR(film.z() - middle, 108.62604046571582, eps9 * 100);
  EXPECT_NEAR(degrees(film.angle()), 1.7463843377726925, eps9);
  const double z = 2 * m + 400 * std::tan(radians(30));  // z of the point on the plane
  const auto image = lens.image({{300, -400, middle - z}});
  expect_near(image->position - Vec(0, 0, middle), {-14.1232018639333594, 18.8309358185778125, 108.051892778109218},
              eps12);
  EXPECT_NEAR(signed_blur(*image, film), 0, 1e-12);
}

TEST(IdealLens, ThickLensEqualsParaxialImagesOfEveryLens) {
  int tried = 0;
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens compiled = compile(p);
    if (!compiled.rotationally_symmetric() || first_order(compiled).afocal || !has_pupils(compiled)) continue;
    if (signed_index(compiled, compiled.surface_count()) < 0) {  // one mirror, or three
      expect_error([&] { thick_lens(compiled); }, {"towards -z"});
      continue;
    }
    const IdealLens lens = thick_lens(compiled);
    const FirstOrder data = first_order(compiled);
    const double f = std::abs(data.effective_focal_length), z = std::min(lens.front_focal_z, 0.0) - 7 * f;
    const auto image = lens.image({{0, -0.2 * f, z}});
    ASSERT_TRUE(image);
    EXPECT_NEAR(image->position.z, paraxial_image_z(compiled, z), 1e-11 * f);
    // Chief ray and upper marginal ray by matrices.
    const Pupil in = pupils(compiled).entrance;
    if (!std::isfinite(in.z)) continue;
    ++tried;
    const RayMatrix through = ray_matrix(compiled, 0, compiled.surface_count());
    const double n = signed_index(compiled, 0), n_behind = signed_index(compiled, compiled.surface_count());
    const double last = compiled.surfaces().back().vertex_z;
    struct Behind {
      double y, slope;
    };
    const auto behind = [&](double pupil_y) {
      const double slope = (pupil_y + 0.2 * f) / (in.z - z), y = -0.2 * f - slope * z;
      return Behind{through.a * y + through.b * n * slope, (through.c * y + through.d * n * slope) / n_behind};
    };
    const Behind chief = behind(0), edge = behind(in.diameter / 2);
    const double to_image = image->position.z - last;
    EXPECT_NEAR(image->position.y, chief.y + chief.slope * to_image, 1e-10 * f);
    EXPECT_NEAR(image->slope_y, chief.slope, 1e-11);
    EXPECT_EQ(image->slope_x, 0);
    EXPECT_NEAR(image->diameter_per_mm, 2 * std::abs(edge.slope - chief.slope), 1e-11);
  }
  EXPECT_GT(tried, 60);
}

TEST(IdealLens, BlurEqualsTheFocusSolvers) {
  const FocusOptions paraxial{.criterion = FocusCriterion::paraxial};
  const Lens compiled = with_focus(data_lens("double_gauss_100mm_f2_28deg"), 2000, paraxial);
  const Film film = film_at(compiled.film_z());
  const IdealLens thick = thick_lens(compiled), thin = thin_lens(compiled);
  for (const double distance : {300.0, 1000.0, 1999.0, 2001.0, 1e4, 1e9, infinity}) {
    const double wanted = blur_diameter(compiled, distance, paraxial).value() * (distance > 2000 ? 1 : -1);
    EXPECT_NEAR(signed_blur(*thick.image({{0, 0, -distance}}), film), wanted, 1e-11) << distance;
    const double by_thin = blur_diameter(compiled, distance, {.criterion = FocusCriterion::thin}).value();
    EXPECT_NEAR(std::abs(signed_blur(*thin.image({{0, 0, -distance}}), film)), by_thin, 1e-11) << distance;
  }
  const double f = 50, n = 2, focus = 3000;
  const IdealLens alone = thin_lens(f, n);
  for (const double distance : {100.0, 2999.0, 4000.0, 1e6}) {
    const Film at = film_at(f + thin_lens_extension(f, focus));
    EXPECT_NEAR(std::abs(signed_blur(*alone.image({{0, 0, -distance}}), at)),
                thin_lens_blur_diameter(f, f / n, distance, focus), 1e-13);
  }
}

TEST(IdealLens, MapsPointsOnAPlaneToPointsOnItsImageAndBack) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const IdealLens& lens :
       {thin_lens(50, 2), thin_lens(50, 2, 30), thick_lens(biconvex()),
        thick_lens(data_lens("double_gauss_100mm_f2_28deg")), thick_lens(data_lens("eye_gullstrand_le_grand"))}) {
    for (int i = 0; i < 100; ++i) {
      const Vec place(800 * unit(random), 800 * unit(random), -1500 + 900 * unit(random));
      const Vec normal = glm::normalize(Vec(unit(random), unit(random), unit(random)));
      const Plane scene{normal, glm::dot(normal, place)};
      const Vec image = lens.image({place})->position;
      const Plane film = lens.image_of(scene).value();
      EXPECT_NEAR(glm::dot(film.normal, image), film.offset, 1e-10);
      EXPECT_NEAR(glm::length(film.normal), 1, 1e-15);
      EXPECT_GE(film.normal.z, 0);
      const ScenePoint back = lens.scene_of(image);
      EXPECT_FALSE(back.at_infinity);
      expect_near(back.position, place, 1e-11);
      const Plane plane = lens.scene_of(film).value();
      EXPECT_NEAR(glm::dot(plane.normal, place), plane.offset, 1e-9);
    }
  }
}

TEST(IdealLens, FarPointsTendToInfinity) {
  for (const IdealLens& lens : {thin_lens(50, 2), thick_lens(data_lens("double_gauss_100mm_f2_28deg"))}) {
    const Vec direction(0.2, -0.1, -1);
    const ImagePoint ideal = lens.image({3e5 * direction, true}).value();
    EXPECT_EQ(ideal.position.z, lens.rear_focal_z);
    for (const double far : {1e12, 1e100, 1e300}) {
      const ImagePoint image = lens.image({far * direction}).value();
      expect_near(image.position, ideal.position, 1e-9);
      EXPECT_NEAR(image.slope_x, ideal.slope_x, 1e-9);
      EXPECT_NEAR(image.slope_y, ideal.slope_y, 1e-9);
      EXPECT_NEAR(image.diameter_per_mm, ideal.diameter_per_mm, 1e-9);
    }
    const ScenePoint back = lens.scene_of(ideal.position);
    EXPECT_TRUE(back.at_infinity);
    EXPECT_NEAR(glm::length(glm::normalize(back.position) - glm::normalize(direction)), 0, 1e-14);
    EXPECT_EQ(lens.image({{3, 4, -infinity}})->position, Vec(0, 0, lens.rear_focal_z));
  }
}

TEST(IdealLens, TelecentricLensesHaveConesAndChiefRays) {
  // The stop lies in the front focal plane, so that chief rays are parallel to the axis in image space, and in object
  // space of the reversed lens.
  Prescription p = testing::data_prescription("singlet_50mm_biconvex");
  for (auto& s : p.surfaces) s.stop = false;
  const double front = first_order(compile(p)).front_focal_z;
  p.surfaces.insert(p.surfaces.begin(), {.thickness = -front, .semi_diameter = 2, .stop = true});
  const IdealLens lens = thick_lens(compile(p));
  const ImagePoint image = lens.image({{30, -40, -500}}).value();
  EXPECT_NEAR(image.slope_x, 0, 1e-12);
  EXPECT_NEAR(image.slope_y, 0, 1e-12);
  EXPECT_NEAR(image.diameter_per_mm, 4 / lens.rear_focal_length, 1e-12);

  IdealLens object_side = thin_lens(50, 5);  // the pupil in the rear focal plane
  object_side.pupils = {{infinity, infinity}, {50, 10}};
  const ImagePoint other = object_side.image({{10, 0, -100}}).value();
  EXPECT_NEAR(other.position.z, 100, 1e-12);
  EXPECT_NEAR(other.slope_x, other.position.x / 50, 1e-14);
  EXPECT_NEAR(other.diameter_per_mm, 10.0 / 50, 1e-14);
}

TEST(IdealLens, BlurIsSignedAndTheChiefRayCarriesItToATiltedFilm) {
  const IdealLens lens = thin_lens(50, 2);
  const Film film = film_in(lens.image_of({{0, 0, 1}, -2000}).value());
  EXPECT_LT(signed_blur(*lens.image({{100, 0, -1900}}), film), 0);
  EXPECT_GT(signed_blur(*lens.image({{100, 0, -2100}}), film), 0);
  // By construction: from the edges of the pupil through the image to the plane where the chief ray meets the film.
  const Film tilted = film_at(52, radians(12), radians(-7));
  const ImagePoint image = lens.image({{300, 200, -1500}}).value();
  const Vec chief = image.position, n = tilted.normal();
  const double along = tilted.plane().offset / glm::dot(n, chief);
  const double diameter = 25 * (along - 1);  // the pupil of 25 mm, projected through the image
  EXPECT_NEAR(signed_blur(image, tilted), diameter, 1e-13);
}

TEST(IdealLens, MagnificationEqualsChiefRays) {
  const IdealLens lens = thick_lens(data_lens("double_gauss_100mm_f2_28deg"));
  const ImagePoint image = lens.image({{200, -100, -1500}}).value();
  const auto height = [&](double film_z) { return image.position.x + image.slope_x * (film_z - image.position.z); };
  EXPECT_NEAR(1 + lens.magnification_change(150, 140), height(150) / height(140), 1e-13);
  EXPECT_TRUE(std::isnan(lens.magnification_change(150, lens.pupils.exit.z)));
}

TEST(IdealLens, HingeAndScheimpflugLinesAreFixed) {
  const IdealLens lens = thick_lens(data_lens("double_gauss_100mm_f2_28deg"));
  const Film film = film_at(lens.rear_focal_z + 8, radians(6), radians(-4));
  const FocusPlane focus = focus_plane(lens, film).value();
  EXPECT_NEAR(focus.hinge->point.z, lens.front_focal_z, 1e-12);
  EXPECT_NEAR(focus.scheimpflug->point.z, lens.front_principal_z(), 1e-12);
  // As the film moves along the axis, the plane of focus rotates about the hinge line.
  Film moved = film;
  moved.z_mm = moved.z() + 3;
  EXPECT_NEAR(glm::length(focus_plane(lens, moved)->hinge->point - focus.hinge->point), 0, 1e-8);
  EXPECT_NEAR(glm::length(focus_plane(lens, moved)->hinge->direction - focus.hinge->direction), 0, 1e-12);
  // Film and rear principal plane intersect in the conjugate of the Scheimpflug line, at equal distance from the axis.
  const Line3 behind = line_at(film.plane(), lens.rear_principal_z()).value();
  EXPECT_NEAR(behind.point.x, focus.scheimpflug->point.x, 1e-8);
  EXPECT_NEAR(behind.point.y, focus.scheimpflug->point.y, 1e-8);
  EXPECT_FALSE(focus_plane(lens, film_at(film.z()))->hinge);
  EXPECT_FALSE(focus_plane(lens, film_at(film.z()))->scheimpflug);
  EXPECT_FALSE(focus_plane(lens, film_at(lens.rear_focal_z)));  // infinity
}

TEST(IdealLens, FindsTheFartherOfTwoObjectsAtASeparation) {
  for (const IdealLens& lens : {thin_lens(50, 2), thick_lens(data_lens("double_gauss_100mm_f2_28deg")),
                                thick_lens(data_lens("eye_gullstrand_le_grand"))}) {
    const double f = std::sqrt(lens.product()), planes = lens.rear_principal_z() - lens.front_principal_z();
    const double least =
        2 * f + lens.rear_focal_z - lens.front_focal_z;  // in air: 4 f plus the distance of the principal planes
    if (lens.front_focal_length == lens.rear_focal_length) {
      EXPECT_NEAR(least, 4 * f + planes, 1e-12 * least);
    }
    for (const double p : {f, 1.001 * f, 3 * f, 1e6 * f, 1e150}) {
      const double separation = (lens.rear_focal_z + lens.product() / p) - (lens.front_focal_z - p);
      // Next to the turning point half of the digits of the separation are lost.
      EXPECT_NEAR(lens.object_at_separation(separation) / p, 1, p > 2 * f ? 1e-14 : 2e-7) << p / f;
    }
    EXPECT_NEAR(lens.object_at_separation(least / 2), f, 1e-15 * f);
    EXPECT_EQ(lens.object_at_separation(infinity), infinity);
  }
}

TEST(IdealLens, MarginalRaysPassPupilAndImage) {
  const IdealLens lens = thick_lens(data_lens("double_gauss_100mm_f2_28deg"));
  for (const double p : {1.0, 50.0, 1e3, 1e9, infinity}) {
    const MarginalRay ray = marginal_ray(lens, p);
    const auto height = [&](double z) { return ray.height + ray.slope * (z - lens.rear_focal_z); };
    EXPECT_NEAR(std::abs(height(lens.pupils.exit.z)), lens.pupils.exit.diameter / 2, 1e-11) << p;
    EXPECT_NEAR(height(lens.rear_focal_z + lens.product() / p), 0, 1e-11) << p;
  }
}

TEST(IdealLens, RefusesInvalidLenses) {
  expect_error([] { thin_lens(0, 2); }, {"thin_lens", "focal", 0});
  expect_error([] { thin_lens(nan, 2); }, {"thin_lens", "focal", "nan"});
  expect_error([] { thin_lens(50, 0); }, {"thin_lens", "f-number", 0});
  expect_error([] { thin_lens(50, nan); }, {"thin_lens", "f-number", "nan"});
  expect_error([] { thin_lens(50, 2, infinity); }, {"thin_lens", "z", "inf"});
  Prescription plate;
  plate.name = "plate";
  plate.surfaces = {{.thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = 5, .stop = true}, {.thickness = 5}};
  expect_error([&] { thick_lens(compile(plate)); }, {"plate", "ideal lens", "focal"});
  const IdealLens lens = thin_lens(50, 2);
  for (const Vec p : {Vec(nan, 0, -100), Vec(0, 0, nan), Vec(infinity, 0, -100), Vec(infinity, 0, -infinity)}) {
    EXPECT_FALSE(lens.image({p}));
    EXPECT_FALSE(lens.image({p, true}));
  }
  EXPECT_FALSE(lens.image({{0, 0, 1}, true}));
  EXPECT_FALSE(lens.image({{0, 0, 0}, true}));
}

}  // namespace ideal_lens_test
}  // namespace petzval
