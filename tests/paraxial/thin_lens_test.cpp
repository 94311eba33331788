// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "../expect_error.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {
namespace thin_lens_test {

using testing::expect_error;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double eps = std::numeric_limits<double>::epsilon();

TEST(ThinLensExtension, IsWithinFourEpsFromTheFocusToTheStars) {
  static_assert(std::numeric_limits<long double>::digits >= 64, "the reference needs more digits than double");
  for (const double f : {50.0, 0.3, 1234.5}) {
    for (double excess = 1e-6; excess < 1e13; excess *= 3.7) {
      const double u = f * (1 + excess);
      const long double lf = f, exact = lf * lf / (static_cast<long double>(u) - lf);
      EXPECT_LE(std::abs(static_cast<double>(thin_lens_extension(f, u) - exact)), 4 * eps * static_cast<double>(exact))
          << u;
    }
    EXPECT_EQ(thin_lens_extension(f, infinity), 0);
  }
}

TEST(ThinLensBlur, IsWithinFourEpsAlsoNextToTheFocus) {
  const double f = 50, diameter = 25;
  for (const double focused : {f * (1 + 1e-6), 51.0, 1000.0, 1e6, 1e12}) {
    for (const double subject :
         {1.0, 60.0, 1000.0, std::nextafter(1000.0, 0), 1000 * (1 + 1e-5), 2000.0, 1e9, 1e20, 1e36}) {
      const long double lf = f, lu = subject, lv = focused;
      const long double exact = diameter * lf * std::abs(lu - lv) / lu / (lv - lf);
      EXPECT_LE(std::abs(static_cast<double>(thin_lens_blur_diameter(f, diameter, subject, focused) - exact)),
                4 * eps * static_cast<double>(exact))
          << subject << " " << focused;
    }
  }
}

TEST(ThinLensBlur, HasItsLimitsAtInfinity) {
  EXPECT_EQ(thin_lens_blur_diameter(50, 25, infinity, infinity), 0);
  EXPECT_EQ(thin_lens_blur_diameter(50, 25, 1000, infinity), 25 * (50.0 / 1000));
  EXPECT_EQ(thin_lens_blur_diameter(50, 25, infinity, 1050), 25 * (50.0 / 1000));
  EXPECT_NEAR(thin_lens_blur_diameter(50, 25, 1e300, 1e301), 0, 1e-290);
  EXPECT_EQ(thin_lens_blur_diameter(50, 25, 700, 700), 0);
}

TEST(ThinLensSubject, IsTheInverseOfTheExtensionWithinFourEps) {
  for (const double f : {50.0, 0.3, 1234.5}) {
    for (double extension = f * 1e-13; extension < f * 1e6; extension *= 3.7) {
      const long double lf = f, exact = lf + lf * lf / static_cast<long double>(extension);
      EXPECT_LE(std::abs(static_cast<double>(thin_lens_subject(f, extension) - exact)),
                4 * eps * static_cast<double>(exact))
          << extension;
    }
    EXPECT_EQ(thin_lens_subject(f, 0), infinity);
    // Far from the focus the round trip has the errors of both functions.
    for (const double u : {3 * f, 100 * f, 1e9 * f}) {
      EXPECT_NEAR(thin_lens_subject(f, thin_lens_extension(f, u)), u, 8 * eps * u);
    }
  }
}

TEST(ThinLensFilmDistance, IsWithinEightEpsFromFourFocalLengthsToTheStars) {
  for (const double f : {50.0, 0.3, 1234.5}) {
    for (double excess = 1e-3; excess < 1e30; excess *= 3.7) {
      const double t = 4 * f * (1 + excess);
      const long double lf = f, lt = t, exact = 2 * lf * lt / (lt + std::sqrt(lt * (lt - 4 * lf)));
      EXPECT_LE(std::abs(static_cast<double>(thin_lens_film_distance(f, t) - exact)),
                8 * eps * static_cast<double>(exact))
          << t;
    }
    EXPECT_EQ(thin_lens_film_distance(f, 4 * f), 2 * f);
    EXPECT_EQ(thin_lens_film_distance(f, 1e308), f);
    EXPECT_EQ(thin_lens_film_distance(f, infinity), f);
  }
}

TEST(ThinLens, RefusesSubjectsWithoutAnImage) {
  expect_error([] { thin_lens_extension(50, 50); }, {"thin_lens_extension", "subject", 50});
  expect_error([] { thin_lens_extension(50, std::nan("")); }, {"thin_lens_extension", "subject", "nan"});
  expect_error([] { thin_lens_extension(-50, 10); }, {"thin_lens_extension", "focal", -50});
  expect_error([] { thin_lens_blur_diameter(50, 25, 0, 1000); }, {"thin_lens_blur_diameter", "subject", 0});
  expect_error([] { thin_lens_blur_diameter(50, 25, 1000, 40); }, {"thin_lens_blur_diameter", "focused", 40});
  expect_error([] { thin_lens_blur_diameter(50, -1, 1000, 400); }, {"thin_lens_blur_diameter", "diameter", -1});
  expect_error([] { thin_lens_subject(50, -1); }, {"thin_lens_subject", "extension", -1});
  expect_error([] { thin_lens_film_distance(50, 199); }, {"thin_lens_film_distance", "distance", 199});
}

TEST(ThinLensBlurDiameter, RefusesInvalidNumbers) {
  for (const double bad : {infinity, -infinity, std::nan("")}) {
    expect_error([&] { thin_lens_blur_diameter(50, bad, 1000, 400); }, {"diameter", bad});
    expect_error([&] { thin_lens_blur_diameter(bad, 25, 1000, 400); }, {"focal", bad});
  }
  EXPECT_EQ(thin_lens_blur_diameter(50, 0, 1000, 400), 0);
}

TEST(ThinLensBlurDiameter, IsFiniteAtTheEndsOfTheRange) {
  EXPECT_EQ(thin_lens_blur_diameter(1e300, 0, 1e-10, infinity), 0);
  EXPECT_NEAR(thin_lens_blur_diameter(1e-300, 1, 1e-10, 1e300), 1e-290, 1e-305);
  for (const double f : {1e-300, 1e-20, 1., 1e300}) {
    for (const double away : {1 + eps, 2., 1e8, infinity}) {
      for (const double subject : {1e-308, 1e-10, 1., 1e300, infinity}) {
        for (const double diameter : {0., 1e-300, 1e300}) {
          EXPECT_GE(thin_lens_blur_diameter(f, diameter, subject, f * away), 0) << f << ' ' << away << ' ' << subject;
        }
      }
    }
  }
}

}  // namespace thin_lens_test
}  // namespace petzval
