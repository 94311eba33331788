// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace examples {

/// Appearance of a defocused point light, in the words of Wu et al. 2010 about their figure 7.
enum class Look {
  ring,           ///< dark disc with a bright ring
  ring_and_core,  ///< dark disc with a bright ring and a slightly bright core
  hollow_core,    ///< bright core with a dark centre, dark ring around
  core,           ///< bright core, dark ring around
  uniform,        ///< uniform disc
  even_and_core,  ///< nearly uniform disc with a bright core; not described in the paper
  point,          ///< in focus: the sharpest of the five pictures
};
const char* words(Look look);

/// One row of figure 7 in Wu et al. 2010.
struct WuRow {
  const char* lens;  ///< file in data/lenses, without .json
  const char* title;
  const char* subtitle;  ///< origin of the lens
  std::array<Look, 5> printed;
};

/// A light at 1000 mm on the axis, at the d line, with five focus distances.
inline constexpr double wu_light_mm = 1000;
inline constexpr std::array<double, 5> wu_focus_mm{800, 900, 1000, 1100, 1200};
std::span<const WuRow> wu_rows();

/// Measures of a radial profile. Irradiances are relative to the mean over the disc.
struct ProfileShape {
  double centre = 0;     ///< mean within 0.1 of the radius
  double core = 0;       ///< mean within 0.2 of the radius
  double brightest = 0;  ///< maximum of ten rings of equal width
  int brightest_ring = 0;
  double darkest_inside = 0;  ///< minimum of the rings inside the brightest ring; 0 if it is the innermost
  double deviation = 0;       ///< RMS over the area of the disc, ten rings
};
ProfileShape profile_shape(std::span<const double, 64> profile);

/// The look of a profile. Never `point`, which needs a comparison of profiles.
Look look(const ProfileShape& shape);

}  // namespace examples
