// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"

namespace petzval::inline v0 {

/// A film at one time, and what it has in focus.
struct FocusPullFrame {
  double time = 0;              ///< s
  Film film;                    ///< z_mm is set
  double subject_distance = 0;  ///< in focus on the axis, from the film, mm, > 0; may be infinite
  double rms_mm = 0;            ///< blur of the points that were served; NaN: there was none, and the film stayed
};

/// Focus over time, as SVG text: the distance in focus (as 1/distance, in which infinity has a place), where the film
/// stands, the RMS blur of the points, and tilt and swing where the film has any. Upright lines mark the keys.
/// Stretches in which the film stayed are grey.
///
/// title: the lens's name; remark: a line about the conditions. Frames in time order. Throws Error for no frames, and
/// numbers that are not finite where they must be.
PETZVAL_API std::string focus_pull_figure(std::string_view title, std::string_view remark,
                                          std::span<const FocusPullFrame> frames, std::span<const double> key_times);

}  // namespace petzval::inline v0
