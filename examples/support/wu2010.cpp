// SPDX-License-Identifier: Apache-2.0
#include "wu2010.hpp"

#include <algorithm>
#include <cmath>

namespace examples {
namespace {

/// Mean irradiance of the bins [first, last), weighted by the areas of their rings.
double mean(std::span<const double, 64> profile, int first, int last) {
  double sum = 0, area = 0;
  for (int k = first; k < last; ++k) {
    sum += profile[static_cast<std::size_t>(k)] * (2 * k + 1);
    area += 2 * k + 1;
  }
  return area > 0 ? sum / area : 0;
}

/// First bin of a tenth of the radius.
int bin(int tenth) { return static_cast<int>(std::lround(6.4 * tenth)); }

}  // namespace

const char* words(Look look) {
  switch (look) {
    case Look::ring: return "dark disc, bright ring";
    case Look::ring_and_core: return "dark disc, bright ring, slight core";
    case Look::hollow_core: return "bright core with dark centre";
    case Look::core: return "bright core, dark ring";
    case Look::uniform: return "uniform disc";
    case Look::even_and_core: return "nearly uniform, bright core";
    case Look::point: return "sharpest of the five";
  }
  return "";
}

std::span<const WuRow> wu_rows() {
  using enum Look;
  static constexpr std::array<WuRow, 4> rows{{
      {"double_gauss_100mm_f1.35",
       "f/1.35  double Gauss (Lowenthal)",
       "row (a) of the paper; agrees with the paper's source in page, speed and focal length",
       {ring, ring, point, hollow_core, hollow_core}},
      {"double_gauss_100mm_f1.7_substitute",
       "f/1.7  double Gauss (substitute)",
       "row (b) of the paper; its f/1.7 lens is not known: replaced by another six-element double Gauss, scaled and "
       "opened",
       {ring, ring_and_core, point, hollow_core, hollow_core}},
      {"double_gauss_100mm_f2_28deg",
       "f/2  double Gauss, 28° field",
       "row (c) of the paper; of two candidates, this lens behaves as the paper says",
       {uniform, core, point, ring, ring}},
      {"double_gauss_100mm_f2.0",
       "f/2  double Gauss (Tronnier)",
       "the other candidate for row (c): it does the opposite, a ring when focused nearer, a core when farther",
       {uniform, core, point, ring, ring}},
  }};
  return rows;
}

ProfileShape profile_shape(std::span<const double, 64> profile) {
  const double disc = mean(profile, 0, 64);
  if (!(disc > 0)) return {};
  std::array<double, 10> rings{};
  ProfileShape shape;
  for (int i = 0; i < 10; ++i) {
    const double relative = mean(profile, bin(i), bin(i + 1)) / disc;
    rings[static_cast<std::size_t>(i)] = relative;
    shape.deviation += (relative - 1) * (relative - 1) * (2 * i + 1) / 100;
  }
  shape.deviation = std::sqrt(shape.deviation);
  const auto brightest = std::max_element(rings.begin(), rings.end());
  shape.brightest_ring = static_cast<int>(brightest - rings.begin());
  shape.brightest = *brightest;
  if (brightest != rings.begin()) shape.darkest_inside = *std::min_element(rings.begin(), brightest);
  shape.centre = rings[0];
  shape.core = mean(profile, 0, bin(2)) / disc;
  return shape;
}

Look look(const ProfileShape& shape) {
  if (shape.deviation < 0.25) return std::max(shape.core, shape.centre) > 1.25 ? Look::even_and_core : Look::uniform;
  if (shape.brightest_ring >= 5) return shape.core > 1.5 * shape.darkest_inside ? Look::ring_and_core : Look::ring;
  return shape.centre < 0.95 * shape.brightest ? Look::hollow_core : Look::core;
}

}  // namespace examples
