// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"

namespace petzval::inline v0 {

/// A film and the subject in focus at one time.
struct FocusPullFrame {
  double time = 0;              ///< s
  Film film;                    ///< z_mm is set
  double subject_distance = 0;  ///< on the axis, from the film, mm, > 0; may be infinite
  double rms_mm = 0;            ///< blur of the focus points; NaN where none was used and the film stayed
};

/// Focus over time, as SVG text: the subject distance (on a scale of 1/distance, which shows infinity), the film
/// position, the RMS blur of the focus points, and tilt and swing where the film has any. Vertical lines mark the keys;
/// curves are grey where the film stayed.
///
/// title: the lens's name; remark: a line about the conditions. Frames are in the order of time. Throws Error for no
/// frames and for invalid numbers.
PETZVAL_API std::string focus_pull_figure(std::string_view title, std::string_view remark,
                                          std::span<const FocusPullFrame> frames, std::span<const double> key_times);

}  // namespace petzval::inline v0
