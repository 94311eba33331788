// SPDX-License-Identifier: Apache-2.0
#include "trace/stop_points.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace stop_points_test {

/// Where rays along the axis, some mm beside it, meet the stop.
template <class T>
std::array<std::vector<T>, 2> along_the_axis(const Lens& lens, const std::vector<T>& x, const std::vector<T>& y,
                                             Travel travel) {
  const std::size_t count = x.size();
  const bool to_film = travel == Travel::to_film;
  const std::vector<T> z(count, static_cast<T>(to_film ? -50 : lens.film_z())), none(count, 0),
      dz(count, to_film ? T(1) : T(-1));
  constexpr T unset = std::numeric_limits<T>::quiet_NaN();
  std::array<std::vector<T>, 2> at{std::vector<T>(count, unset), std::vector<T>(count, unset)};
  trace_detail::stop_points<T>(lens, count, {x.data(), y.data(), z.data(), none.data(), none.data(), dz.data()},
                               at[0].data(), at[1].data(), {.travel = travel});
  return at;
}

template <class T>
void expect_paraxial_points(const Lens& lens) {
  // Near the axis points of the stop are those of the entrance pupil, over its magnification.
  const double pupil = pupils(lens).entrance.diameter, stop = 2 * lens.surfaces()[*lens.stop()].semi_diameter;
  std::vector<T> x, y;
  for (int i = 0; i < 77; ++i) x.push_back(T(0.01) * static_cast<T>(i % 7)), y.push_back(T(-0.002) * static_cast<T>(i));
  const auto at = along_the_axis<T>(lens, x, y, Travel::to_film);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(at[0][i], x[i] * stop / pupil, 1e-4) << i;
    EXPECT_NEAR(at[1][i], y[i] * stop / pupil, 1e-4) << i;
  }
}

TEST(StopPoints, AreThoseOfTheEntrancePupilNearTheAxis) {
  expect_paraxial_points<double>(testing::data_lens("double_gauss_100mm_f2.0"));
  expect_paraxial_points<float>(testing::data_lens("double_gauss_100mm_f2.0"));
}

// Whole bundles of them, and some among others.
template <class T>
void expect_zeros(const Lens& lens, Travel travel) {
  constexpr std::size_t count = 200;
  for (const std::size_t every : {1, 3}) {
    std::vector<T> x(count, 0), y(count, T(0.5));
    for (std::size_t i = 0; i < count; i += every) x[i] = 1e4;
    const auto at = along_the_axis<T>(lens, x, y, travel);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(at[0][i], 0) << i;
      EXPECT_EQ(at[1][i] == 0, i % every == 0) << i << ": " << at[1][i];
    }
  }
}

TEST(StopPoints, AreZeroForRaysThatAreLostBefore) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
    expect_zeros<double>(lens, travel);
    expect_zeros<float>(lens, travel);
  }
}

}  // namespace stop_points_test
}  // namespace petzval
