// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/focus.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "../data_lenses.hpp"
#include "../digits.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace focus_test {

using testing::data_lens;
using testing::data_prescriptions;
using testing::expect_error;
using testing::expect_tokens;
using testing::message;
using Status = FocusStatus;
using enum FocusCriterion;
using enum DistanceOrigin;
constexpr double infinity = std::numeric_limits<double>::infinity();

Prescription element(double n, double r1, double r2, double thickness) {
  Prescription p;
  p.name = "element";
  p.surfaces = {{.radius = r1, .thickness = thickness, .medium = {.nd = n}, .semi_diameter = 2, .stop = true},
                {.radius = r2, .semi_diameter = 2}};
  return p;
}

TEST(ParaxialFocus, IsTheParaxialImageOfTheSubject) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const double f = std::abs(first_order(lens).effective_focal_length);
    for (const double distance : {12 * f, 1e3 * f, 1e9 * f, infinity}) {
      const FocusSolution solution = solve_focus(lens, distance, {paraxial});
      ASSERT_EQ(solution.status, Status::solved);
      EXPECT_EQ(solution.subject_z, -distance);
      EXPECT_NEAR(solution.film_z, paraxial_image_z(lens, -distance), 1e-11 * (f + std::abs(solution.film_z)));
    }
  }
}

TEST(ParaxialFocus, FromTheFilmKeepsTheDistanceAndTakesTheFarConjugate) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const FirstOrder data = first_order(lens);
    const double f = std::abs(data.effective_focal_length);
    for (const double distance : {34 * f, 1e3 * f, 1e9 * f, 1e200}) {
      const FocusSolution solution = solve_focus(lens, distance, {paraxial, film});
      ASSERT_EQ(solution.status, Status::solved);
      EXPECT_NEAR(solution.film_z - solution.subject_z, distance, 1e-14 * distance);
      EXPECT_NEAR(solution.film_z, paraxial_image_z(lens, solution.subject_z), 1e-11 * (f + std::abs(solution.film_z)));
      EXPECT_LE(std::abs(solution.film_z - data.rear_focal_z), f);
    }
    const FocusSolution far = solve_focus(lens, infinity, {paraxial, film});
    EXPECT_EQ(far.film_z, data.rear_focal_z);
    EXPECT_EQ(far.subject_z, -infinity);
  }
}

TEST(ThinFocus, StandsAtTheRearPrincipalPlane) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const FirstOrder data = first_order(lens);
  const double f = data.effective_focal_length, from_plane = 1000 + data.rear_principal_z;
  EXPECT_NEAR(solve_focus(lens, 1000, {thin}).film_z, data.rear_focal_z + thin_lens_extension(f, from_plane), 1e-12);
  // The distance T from the film is the sum of the distances of film and subject from the lens, so that the film lies
  // 2 f T / (T + sqrt(T (T - 4 f))) behind the lens.
  const double t = 1000;
  EXPECT_NEAR(solve_focus(lens, t, {thin, film}).film_z,
              data.rear_principal_z + 2 * f * t / (t + std::sqrt(t * (t - 4 * f))), 1e-11);
  EXPECT_NEAR(solve_focus(lens, infinity, {thin}).film_z, data.rear_focal_z, 0);
}

TEST(Focus, MovesTheFilmAwayAsTheSubjectComesNearer) {
  for (const char* id : {"double_gauss_100mm_f1.35", "achromat_100mm", "modern_58mm_f0.95", "fisheye_8mm_f2.8",
                         "catadioptric_corrector_25mm_f1.25"}) {
    SCOPED_TRACE(id);
    const Lens lens = data_lens(id);
    const double f = first_order(lens).effective_focal_length;
    for (const FocusCriterion criterion : {thin, paraxial, min_rms}) {
      for (const DistanceOrigin origin : {front_vertex, film}) {
        double before = solve_focus(lens, infinity, {criterion, origin}).film_z;
        for (double distance = 1e5 * f; distance > 40 * f; distance *= 0.7) {
          const FocusSolution solution = solve_focus(lens, distance, {criterion, origin});
          ASSERT_EQ(solution.status, Status::solved);
          EXPECT_GT(solution.film_z, before) << name(criterion) << " " << distance;
          before = solution.film_z;
        }
      }
    }
  }
}

TEST(Focus, TheNearestSubjectOfANarrowBeamHasItsImageAtInfinity) {
  for (const char* id : {"double_gauss_100mm_f2.0", "achromat_100mm"}) {
    const Lens lens = with_f_number(data_lens(id), 1000);
    EXPECT_EQ(nearest_focus(lens, {min_rms}).film_z, infinity) << id;
  }
}

TEST(Focus, NamesTheNearestDistanceThatCanBeReached) {
  for (const char* id :
       {"double_gauss_100mm_f2.0", "achromat_100mm", "eye_gullstrand_le_grand", "singlet_50mm_biconvex"}) {
    const Lens lens = data_lens(id);
    for (const FocusCriterion criterion : {thin, paraxial, min_rms}) {
      for (const DistanceOrigin origin : {front_vertex, film}) {
        SCOPED_TRACE(std::string(id) + " " + std::string(name(criterion)) +
                     (origin == film ? " film" : " front vertex"));
        const FocusSolution limit = solve_focus(lens, 0.5, {criterion, origin});
        ASSERT_EQ(limit.status, Status::unreachable);
        EXPECT_FALSE(limit);
        EXPECT_TRUE(std::isfinite(limit.distance));
        const FocusSolution inside = solve_focus(lens, limit.distance * (1 - 1e-6), {criterion, origin});
        EXPECT_EQ(inside.status, Status::unreachable);
        EXPECT_NEAR(inside.distance, limit.distance, 1e-8 * limit.distance);
        for (const double all_but_touching : {1e-3, 1e-9}) {
          EXPECT_EQ(solve_focus(lens, all_but_touching, {criterion, origin}).distance, limit.distance);
        }
        EXPECT_EQ(solve_focus(lens, limit.distance * (1 + 1e-6), {criterion, origin}).status, Status::solved);
      }
    }
  }
}

TEST(ParaxialFocus, EndsAtItsLimits) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const FirstOrder data = first_order(lens);
  const FocusSolution at_focus = solve_focus(lens, -data.front_focal_z, {paraxial});
  EXPECT_EQ(at_focus.status, Status::unreachable);
  EXPECT_EQ(at_focus.distance, -data.front_focal_z);
  EXPECT_EQ(at_focus.film_z, infinity);

  const double planes = data.rear_principal_z - data.front_principal_z;
  const FocusSolution near = solve_focus(lens, 100, {paraxial, film});
  EXPECT_EQ(near.status, Status::unreachable);
  EXPECT_NEAR(near.distance, 4 * data.effective_focal_length + planes, 1e-11);
  EXPECT_NEAR(near.film_z, data.rear_principal_z + 2 * data.effective_focal_length, 1e-11);
  EXPECT_EQ(solve_focus(lens, near.distance, {paraxial, film}).status, Status::solved);
}

TEST(ParaxialFocus, BehindOneMirrorReachesAnyDistanceFromTheFilm) {
  const Lens lens = data_lens("mirror_newton_200mm_f8");
  for (const double distance : {1e-3, 1.0, 200.0, 1e6}) {
    const FocusSolution solution = solve_focus(lens, distance, {paraxial, film});
    ASSERT_EQ(solution.status, Status::solved);
    EXPECT_NEAR(solution.film_z - solution.subject_z, distance, 1e-12 * (1000 + distance));
    EXPECT_NEAR(1 / -solution.subject_z + 1 / -solution.film_z, 1.0 / 200, 1e-15);
  }
}

TEST(Focus, DivergingLensHasNoFocus) {
  const Lens lens = compile(element(1.5, -80, 80, 3));
  for (const FocusCriterion criterion : {thin, paraxial, min_rms}) {
    for (const DistanceOrigin origin : {front_vertex, film}) {
      for (const double distance : {10.0, 1000.0, infinity}) {
        const FocusSolution solution = solve_focus(lens, distance, {criterion, origin});
        EXPECT_EQ(solution.status, Status::unreachable) << name(criterion) << distance;
        EXPECT_EQ(solution.distance, infinity);
        EXPECT_EQ(solution.film_z, infinity);
      }
    }
  }
  expect_error([&] { with_focus(lens, 1000); }, {"element", "subject", 1000, "min_rms", "image"});
}

TEST(Focus, AfocalLensIsReported) {
  for (const FocusCriterion criterion : {thin, paraxial, min_rms}) {
    EXPECT_EQ(solve_focus(compile(element(1.5, 0, 0, 3)), 1000, {criterion}).status, Status::afocal);
    EXPECT_EQ(solve_focus(compile(element(1.0, 50, -50, 3)), 1000, {criterion, film}).status, Status::afocal);
  }
  expect_error([] { with_focus(compile(element(1.5, 0, 0, 3)), 1000); },
               {"element", "subject", 1000, "min_rms", "afocal"});
}

TEST(Focus, ObjectSpaceTelecentricLensIsParaxial) {
  Prescription p = element(1.5168, 100, -100, 4);
  for (SurfaceRow& row : p.surfaces) row.semi_diameter = 30, row.stop = false;
  p.surfaces.push_back({.thickness = 50, .semi_diameter = 5, .stop = true});
  p.surfaces[1].thickness = first_order(compile(p)).rear_focal_z - 4;
  const Lens lens = compile(p);
  ASSERT_TRUE(std::isinf(pupils(lens).entrance.z));
  EXPECT_TRUE(solve_focus(lens, 300, {paraxial}));
  expect_error([&] { with_focus(lens, 300); }, {"element", "entrance pupil", "min_rms"});
}

TEST(Focus, SingleSurfacesConcentricSurfacesAndBallsFocus) {
  Prescription single;
  single.name = "single";
  single.surfaces = {{.radius = 50, .medium = {.nd = 1.5}, .semi_diameter = 1}};
  EXPECT_EQ(solve_focus(compile(single), infinity, {paraxial}).film_z, 150);  // n R / (n - 1), inside the glass
  EXPECT_NEAR(solve_focus(compile(single), infinity, {min_rms}).film_z, 150, 0.1);
  EXPECT_EQ(solve_focus(compile(element(1.5, 50, 40, 10)), 1000, {paraxial}).status, Status::unreachable);  // diverges
  EXPECT_NEAR(solve_focus(compile(element(1.5168, 5, -5, 10)), infinity, {paraxial}).film_z,
              5 + 1.5168 * 10 / (4 * 0.5168), 1e-13);
}

TEST(Focus, SubjectInsideTheLensHasNoFocus) {
  // A ball of index 2.5 focuses a distant subject inside itself and a near one behind itself.
  const Lens lens = compile(element(2.5, 5, -5, 10));
  for (const FocusCriterion criterion : {paraxial, min_rms}) {
    for (const DistanceOrigin origin : {front_vertex, film}) {
      SCOPED_TRACE(std::string(name(criterion)) + (origin == film ? " film" : " front vertex"));
      const FocusSolution far = solve_focus(lens, 1000, {criterion, origin});
      EXPECT_EQ(far.status, Status::unreachable);
      EXPECT_NEAR(far.film_z, 10, 1e-6);
      EXPECT_LT(far.distance, 1000);
      EXPECT_EQ(solve_focus(lens, far.distance * (1 - 1e-6), {criterion, origin}).status, Status::solved);
      EXPECT_EQ(solve_focus(lens, far.distance * (1 + 1e-6), {criterion, origin}).status, Status::unreachable);
    }
  }
  expect_error([&] { with_focus(lens, 1000); }, {"element", "subject", 1000});
}

TEST(Focus, RefusesInvalidDistances) {
  const Lens lens = compile(element(1.5, 50, -50, 4));
  expect_error([&] { solve_focus(lens, 0); }, {"element", "subject", 0});
  expect_error([&] { solve_focus(lens, -5, {min_rms, film}); }, {"element", "subject", -5});
  expect_error([&] { solve_focus(lens, std::nan("")); }, {"element", "subject", "nan"});
}

TEST(Focus, RefusesInvalidCriteriaAndOrigins) {
  const Lens lens = compile(element(1.5, 50, -50, 4));
  const FocusOptions by_99{.criterion = static_cast<FocusCriterion>(99)};
  expect_error([&] { solve_focus(lens, 1000, by_99); }, {"element", "criterion", 99});
  expect_error([&] { with_focus(lens, 1000, by_99); }, {"element", "criterion", 99});
  expect_error([&] { depth_of_field(lens, 0.1, by_99); }, {"element", "criterion", 99});
  expect_error([&] { solve_subject(lens, 60, {.origin = static_cast<DistanceOrigin>(99)}); }, {"origin", 99});
}

// Film, limits and blur are independent of the origin of the distance of a subject.
TEST(Focus, OriginsShiftDistancesOnly) {
  for (const char* id :
       {"double_gauss_100mm_f2.0", "retrofocus_100mm_f2", "telephoto_250mm_f5.6", "anamorphic_60mm_2x"}) {
    const Lens lens = data_lens(id);
    const double subject_z = -1500;
    for (const FocusCriterion criterion : {thin, paraxial, min_rms, min_max}) {
      const Lens focused = with_focus(lens, -subject_z, {criterion});
      const DepthOfField depth = depth_of_field(focused, 0.3, {criterion});
      ASSERT_TRUE(depth);
      for (const DistanceOrigin origin : {front_vertex, film, entrance_pupil, front_principal}) {
        SCOPED_TRACE(std::string(id) + ' ' + std::string(name(criterion)) + ' ' + std::string(name(origin)));
        const double z = origin_z(focused, origin);
        const FocusOptions options{criterion, origin};
        EXPECT_NEAR(solve_focus(lens, z - subject_z, options).film_z, focused.film_z(), 1e-9);
        EXPECT_NEAR(solve_subject(lens, focused.film_z(), options).distance, z - subject_z, 1e-5);
        EXPECT_NEAR(*blur_diameter(focused, z + 1200, options), *blur_diameter(focused, 1200, {criterion}), 1e-12);
        const DepthOfField own = depth_of_field(focused, 0.3, options);
        EXPECT_NEAR(own.near_distance, depth.near_distance + z, 1e-6);
        EXPECT_NEAR(own.far_distance, depth.far_distance + z, 1e-6);
      }
    }
  }
}

TEST(Focus, OriginsEqualTheLens) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  EXPECT_EQ(origin_z(lens, front_vertex), 0);
  EXPECT_EQ(origin_z(lens, film), lens.film_z());
  EXPECT_EQ(origin_z(lens, entrance_pupil), pupils(lens).entrance.z);
  EXPECT_EQ(origin_z(lens, front_principal), first_order(lens).front_principal_z);
}

TEST(Focus, RefusesAnEntrancePupilAtInfinityAsOrigin) {
  // The stop in the rear focal plane of a thin element: telecentric in object space.
  Prescription p = element(1.5, 50, -50, 0);
  p.surfaces[0].stop = false;
  p.surfaces[1].thickness = first_order(compile(p)).rear_focal_z;
  p.surfaces.push_back({.thickness = 20, .semi_diameter = 2, .stop = true});
  const Lens lens = compile(p);
  ASSERT_TRUE(std::isinf(pupils(lens).entrance.z));
  expect_error([&] { origin_z(lens, entrance_pupil); }, {"entrance pupil"});
  expect_error([&] { solve_focus(lens, 500, {paraxial, entrance_pupil}); }, {"entrance pupil"});
}

TEST(WithFocus, MovesTheFilmOrReportsTheNearestDistance) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  EXPECT_EQ(with_focus(lens, 1000).film_z(), solve_focus(lens, 1000).film_z);
  expect_error([&] { with_focus(lens, 50, {paraxial}); }, {lens.name(), "subject", 50, "paraxial", 54.2448912});
  const double nearest = nearest_focus(lens, {paraxial, film}).distance;
  expect_error(
      [&] {
        with_focus(lens, 40, {paraxial, film});
      },
      {lens.name(), "subject", 40, "film", "paraxial", testing::digits(nearest, 9)});
}

TEST(WithFocus, DistinguishesMetresFromMillimetres) {
  const auto refusal = [&](double distance) {
    return message([&] { with_focus(data_lens("double_gauss_100mm_f2.0"), distance); });
  };
  expect_tokens(refusal(2), {2000});
  EXPECT_FALSE(testing::has_token(refusal(51), "51000")) << refusal(51);
}

}  // namespace focus_test
}  // namespace petzval
