// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "petzval/core/export.hpp"

namespace petzval {

/// A model in the figure.
struct ParetoPoint {
  std::string_view name;
  double ns_per_ray = 0;
  double max_um = 0, rms_um = 0;  ///< errors on the film; 0: exact
  bool on_front = false;
};

/// Accuracy against cost, as SVG text: largest and RMS error on the film over ns per ray, both axes logarithmic. Models
/// of the Pareto front, for which no other model is both faster and more accurate, are filled and joined by a line.
/// Errors of 0 are drawn at the foot.
///
/// title: the lens's name; remark: a line about the conditions. Throws Error for no points, times that are not positive
/// and finite, and errors that are negative or not finite.
PETZVAL_API std::string pareto_figure(std::string_view title, std::string_view remark,
                                      std::span<const ParetoPoint> points);

}  // namespace petzval
