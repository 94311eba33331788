// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace f_number_test {

using testing::data_lens;
using testing::data_prescriptions;
using testing::expect_error;
using testing::message;
constexpr double infinity = std::numeric_limits<double>::infinity();

double focal_length(const Lens& lens) { return std::abs(first_order(lens).effective_focal_length); }

Prescription telescope() {
  Prescription p;
  p.name = "telescope";
  p.surfaces = {{.medium = {.nd = 1.5}, .semi_diameter = 5, .stop = true}};
  return p;
}

TEST(WithFNumber, RefusesClosedLenses) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  expect_error([&] { with_f_number(lens, 1e300); }, {lens.name(), "number", 1e300, "stop"});
  const Lens closed = with_semi_diameter(lens, *lens.stop(), 0);
  expect_error([&] { with_f_number(closed, 8); }, {lens.name(), "number", "axis"});
}

TEST(RealFNumber, EveryLensIsWithinTwoPercentOfTheDeclaredFNumber) {
  for (const Prescription& p : data_prescriptions()) {
    if (!p.f_number) continue;
    EXPECT_NEAR(real_f_number(compile(p)), *p.f_number, 0.02 * *p.f_number) << p.id;
  }
}

TEST(FastestFNumber, IsTheSmallestThatWithFNumberAccepts) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    if (std::isinf(real_f_number(lens))) continue;
    const double fastest = fastest_f_number(lens);
    EXPECT_EQ(fastest, real_f_number(lens));
    expect_error([&] { with_f_number(lens, fastest / 1.006); }, {lens.name(), fastest / 1.006});
    EXPECT_NEAR(real_f_number(with_f_number(lens, fastest)), fastest, 1e-9 * fastest);
  }
  // If the marked stop has no rim, the outermost ray that reaches the stop is the limit.
  Prescription open = testing::data_prescription("double_gauss_100mm_f2.0");
  for (SurfaceRow& row : open.surfaces) {
    if (row.stop) row.semi_diameter = infinity;
  }
  const Lens lens = compile(open);
  const double fastest = fastest_f_number(lens);
  EXPECT_LT(fastest, real_f_number(compile(testing::data_prescription("double_gauss_100mm_f2.0"))));
  expect_error([&] { with_f_number(lens, fastest / 1.001); }, {lens.name(), fastest / 1.001});
  expect_error([] { fastest_f_number(compile(telescope())); }, {"telescope", "afocal"});
}

TEST(RealFNumber, BelongsToTheRayThatMeetsTheRimOfTheStop) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const std::size_t stop = lens.stop().value();
    const double y = focal_length(lens) / (2 * real_f_number(lens));
    const auto end = kernel::trace(petzval::kernel::view<double>(lens), kernel::Vec<double>{0, y, 0},
                                   kernel::Vec<double>{0, 0, 1}, {.apertures = false, .last = stop + 1});
    ASSERT_EQ(end.surface, static_cast<int>(stop));
    EXPECT_NEAR(std::abs(end.origin.y), lens.surfaces()[stop].semi_diameter, 1e-12 * y);
  }
}

TEST(RealFNumber, TendsToTheParaxialFNumberAsTheStopCloses) {
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    const std::size_t stop = lens.stop().value();
    const Lens closed = with_semi_diameter(lens, stop, 1e-4 * lens.surfaces()[stop].semi_diameter);
    EXPECT_NEAR(real_f_number(closed) / paraxial_f_number(closed), 1, 1e-8) << p.id;
  }
}

TEST(RealFNumber, RayHasToReachTheStopOnly) {
  // In glass of index 1.5, total reflection at the sphere of 20 mm begins at a height of 13.3 mm; the stop has 16 mm.
  Prescription p;
  p.name = "hemisphere";
  p.surfaces = {{.thickness = 25, .medium = {.nd = 1.5}}, {.radius = -20, .semi_diameter = 16, .stop = true}};
  EXPECT_NEAR(real_f_number(compile(p)), 40.0 / 32, 1e-14);
  // A rim larger than the sphere is limited by the radius of the sphere.
  p.surfaces[1].semi_diameter = 30;
  EXPECT_NEAR(real_f_number(compile(p)), 1, 1e-14);
}

/// The number after the given f-number in a message: the limit, or a possible f-number.
double stated_in(std::string message, const Lens& lens, double f_number) {
  message.erase(0, lens.name().size());
  const std::string given = testing::Token(f_number).text();
  const auto at = message.find_first_of("0123456789", message.find(given) + given.size());
  if (at >= message.size()) {
    ADD_FAILURE() << "no limit in: " << message;
    return infinity;
  }
  return std::stod(message.substr(at));
}

/// The f-number at which the central obscuration hides the stop; infinite without an obscuration.
double slowest(const Lens& lens) {
  const std::string said = message([&] { with_f_number(lens, 1e6); });
  return testing::has_token(said, "obscuration") ? stated_in(said, lens, 1e6) : infinity;
}

TEST(WithFNumber, InvertsRealFNumber) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const double fastest = real_f_number(lens);
    const std::size_t stop = lens.stop().value();
    for (const double n : {fastest * (1 - 1e-10), fastest / 1.0049}) {
      EXPECT_EQ(with_f_number(lens, n).surfaces()[stop].semi_diameter, lens.surfaces()[stop].semi_diameter);
    }
    expect_error([&] { with_f_number(lens, fastest / 1.0051); }, {lens.name(), fastest / 1.0051});
    for (const double n : {fastest, fastest * 1.0001, fastest * 1.4, 5.6 * fastest, 64 * fastest, 1000 * fastest}) {
      if (n >= slowest(lens)) continue;
      EXPECT_NEAR(real_f_number(with_f_number(lens, n)), n, 1e-12 * n);
    }
  }
}

// Users write the f-number that is engraved on the lens.
TEST(WithFNumber, AcceptsDeclaredFNumbersWithinHalfAPercent) {
  int given = 0, refused = 0;
  for (const Prescription& p : data_prescriptions()) {
    if (!p.f_number) continue;
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const double fastest = real_f_number(lens);
    if (fastest <= *p.f_number * 1.005) {
      EXPECT_NEAR(real_f_number(with_f_number(lens, *p.f_number)), std::max(fastest, *p.f_number), 1e-12 * fastest);
      ++given;
    } else {
      expect_error([&] { with_f_number(lens, *p.f_number); }, {lens.name(), *p.f_number, "fastest"});
      ++refused;
    }
  }
  EXPECT_GE(given, 60);
  RecordProperty("given", given);
  RecordProperty("refused", refused);
}

// Close behind a ball lens, outer rays cross inner rays, so that no radius of the stop selects the requested marginal
// ray.
TEST(WithFNumber, RefusesBeamsFoldedBySphericalAberration) {
  Prescription p;
  p.name = "ball";
  p.surfaces = {{.radius = 10, .thickness = 20, .medium = {.nd = 1.5}, .semi_diameter = 10},
                {.radius = -10, .thickness = 3, .semi_diameter = 10},
                {.thickness = 2, .stop = true}};
  const Lens ball = compile(p);
  for (const double n : {0.85, 3.0, 8.0}) EXPECT_NEAR(real_f_number(with_f_number(ball, n)), n, 1e-9);
  const std::string said = message([&] { with_f_number(ball, 1.5); });
  testing::expect_tokens(said, {"ball", 1.5, "spherical aberration"});
  const double next = stated_in(said, ball, 1.5);
  EXPECT_GT(next, 2);
  EXPECT_NEAR(real_f_number(with_f_number(ball, next)), next, 1e-6 * next);
}

// Full stops from f/0.95 to f/64 and f/1000 are accepted, or the message names the fastest f-number.
TEST(WithFNumber, AcceptsStandardFNumbersOrNamesTheFastest) {
  int given = 0, refused = 0;
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    const double fastest = real_f_number(lens);
    for (const double n : {0.95, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0, 16.0, 22.0, 32.0, 45.0, 64.0, 1000.0}) {
      SCOPED_TRACE(p.id + " f/" + std::to_string(n));
      if (n >= slowest(lens)) {
        expect_error([&] { with_f_number(lens, n); }, {lens.name(), n});
      } else if (n >= fastest) {
        EXPECT_NEAR(real_f_number(with_f_number(lens, n)), n, 1e-12 * n);
        ++given;
      } else if (n < fastest / 1.0051) {
        // The f-number in the message is accepted.
        const double named = stated_in(message([&] { with_f_number(lens, n); }), lens, n);
        EXPECT_NEAR(named, fastest, 1e-9 * fastest);
        EXPECT_NO_THROW(with_f_number(lens, named));
        ++refused;
      }
    }
  }
  EXPECT_GT(given, 500);
  EXPECT_GT(refused, 200);
}

TEST(WithFNumber, FrontStopIsFocalLengthOverDiameter) {
  Prescription p;
  p.name = "front stop";
  p.surfaces = {{.thickness = 3, .semi_diameter = 12, .stop = true},
                {.radius = 50, .thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = 20},
                {.radius = -70, .semi_diameter = 20}};
  const Lens lens = compile(p);
  for (const double n : {4.0, 64.0, 1000.0}) {
    EXPECT_EQ(with_f_number(lens, n).surfaces()[0].semi_diameter, focal_length(lens) / (2 * n));
  }
  // A stop on the front surface is met before refraction.
  p.surfaces[0].stop = false;
  p.surfaces[1].stop = true;
  EXPECT_NEAR(with_f_number(compile(p), 8).surfaces()[1].semi_diameter, focal_length(lens) / 16, 1e-15);
}

// The stop itself has no obscuration, but behind the hole of a mirror the axis is dark.
TEST(WithFNumber, IsLimitedByAnObscurationBeforeTheStop) {
  const Lens lens = data_lens("catadioptric_mangin_1000mm_f7.5");
  ASSERT_EQ(lens.surfaces()[lens.stop().value()].obscuration_semi_diameter, 0);
  const double hidden = slowest(lens);
  const double marginal = focal_length(lens) / (2 * hidden * 0.99) * (1 - 1e-6);
  EXPECT_TRUE(trace(with_f_number(lens, hidden * 0.99), Ray<double>{{0, marginal, -50}, {0, 0, 1}}).transmitted());
  expect_error([&] { with_f_number(lens, hidden * 1.01); }, {lens.name(), "obscuration"});
}

TEST(WithFNumber, AnnularStopIsLimitedByItsHole) {
  const Lens lens = data_lens("catadioptric_maksutov_1280mm_f14.4");
  EXPECT_NEAR(real_f_number(with_f_number(lens, 22)), 22, 22e-12);
  EXPECT_EQ(with_f_number(lens, 22).surfaces()[2].obscuration_semi_diameter,
            lens.surfaces()[2].obscuration_semi_diameter);
  const std::string said = message([&] { with_f_number(lens, 100); });
  testing::expect_tokens(said, {lens.name(), 100, "obscuration", "surface 2"});
  const double obscured = stated_in(said, lens, 100);
  EXPECT_NO_THROW(with_f_number(lens, obscured * (1 - 1e-8)));
  expect_error([&] { with_f_number(lens, obscured * (1 + 1e-8)); }, {lens.name(), "obscuration"});
}

TEST(WithFNumber, KeepsTheInferredStop) {
  for (Prescription p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    for (SurfaceRow& row : p.surfaces) row.stop = false;
    const Lens lens = compile(p);
    const Pupils before = pupils(lens, 0, main_meridian(lens));
    if (lens.surfaces()[before.stop].obscuration_semi_diameter > 0) continue;
    const double n = 1.5 * real_f_number(lens);
    const Lens stopped = with_f_number(lens, n);
    EXPECT_EQ(pupils(stopped).stop, before.stop);
    EXPECT_NEAR(real_f_number(stopped), n, 1e-12 * n);
  }
}

TEST(WithFNumber, RefusesInvalidNumbers) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  for (const double n : {0.0, -2.0, std::nan(""), infinity}) {
    expect_error([&] { with_f_number(lens, n); }, {lens.name(), "number", n});
  }
}

TEST(WithFNumber, NamesTheFastestFNumber) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const std::string said = message([&] { with_f_number(lens, 1.2); });
  testing::expect_tokens(said, {lens.name(), 1.2, "fastest"});
  EXPECT_NEAR(stated_in(said, lens, 1.2), 1.3535, 5e-4);
  // A larger stop does not help, because faster rays miss the glass.
  const Lens open = with_any_semi_diameter(lens, 5, infinity);
  expect_error([&] { with_f_number(open, 0.1); }, {lens.name(), 0.1, 1.013132236});
}

TEST(WithFNumber, RefusesAnAfocalLens) {
  const Lens lens = compile(telescope());
  EXPECT_EQ(real_f_number(lens), infinity);
  EXPECT_EQ(paraxial_f_number(lens), infinity);
  expect_error([&] { with_f_number(lens, 4); }, {"telescope", "afocal"});
}

TEST(RealFNumber, RimsEndAt1e15Mm) {
  Prescription p = testing::data_prescription("mirror_newton_200mm_f8");
  p.surfaces[0].semi_diameter = 1e15;
  EXPECT_NEAR(real_f_number(compile(p)), 1e-13, 1e-14);
  p.surfaces[0].semi_diameter = 1e200;
  expect_error([&] { real_f_number(compile(p)); }, {p.name, "stop", "semi_diameter"});
}

TEST(WithFNumber, GivesAMarkedStopItsRim) {
  for (const Prescription& p : data_prescriptions()) {
    if (!p.f_number) continue;
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p), open = testing::without_the_rim_of_its_stop(p).marked;
    const double slower = 1.5 * real_f_number(lens);
    const Lens stopped = with_f_number(open, slower);
    EXPECT_FALSE(pupils(stopped).stop_inferred);
    EXPECT_EQ(stopped.surfaces()[*lens.stop()].semi_diameter,
              with_f_number(lens, slower).surfaces()[*lens.stop()].semi_diameter);
  }
}

TEST(RealFNumber, StopWithoutRimIsLimitedByOtherRims) {
  const auto [marked, unmarked] = testing::without_the_rim_of_its_stop(testing::open_singlet(10));
  EXPECT_EQ(real_f_number(marked), real_f_number(unmarked));
  EXPECT_NEAR(real_f_number(marked), 2.53, 0.01);
  const Lens endless = compile(testing::open_singlet());
  EXPECT_EQ(message([&] { real_f_number(endless); }), message([&] { pupils(endless); }));
}

}  // namespace f_number_test
}  // namespace petzval
