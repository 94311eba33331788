// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/ray.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "petzval/core/error.hpp"

namespace ray_test {

using petzval::RayFate;

TEST(Ray, FatesHaveDistinctNames) {
  std::set<std::string_view> names;
  for (const RayFate fate : {RayFate::transmitted, RayFate::missed_surface, RayFate::totally_reflected,
                             RayFate::vignetted, RayFate::no_convergence, RayFate::outside_fit, RayFate::outside_film,
                             RayFate::invalid, RayFate::outside_spectrum}) {
    names.insert(name(fate));
  }
  EXPECT_EQ(names, (std::set<std::string_view>{"transmitted", "missed_surface", "totally_reflected", "vignetted",
                                               "no_convergence", "outside_fit", "outside_film", "invalid",
                                               "outside_spectrum"}));
}

TEST(Ray, DefaultRunsAlongTheAxisToTheFilm) {
  const petzval::Ray<float> ray;
  EXPECT_EQ(ray.origin, petzval::Vec3<float>(0, 0, 0));
  EXPECT_EQ(ray.direction, petzval::Vec3<float>(0, 0, 1));
}

TEST(Error, IsCaughtOutsideTheLibrary) {
  try {
    throw petzval::Error("lens: thickness = nan");
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "lens: thickness = nan");
  }
}

}  // namespace ray_test
