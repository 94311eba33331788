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
  bool on_front = false;          ///< true if no other model is both faster and more accurate
};

/// Draws accuracy against cost of models as SVG text.
///
/// Plots largest and RMS error on the film over ns per ray on logarithmic axes. Models on the Pareto front are filled
/// and joined by a line. Errors of 0 are drawn at the bottom.
///
/// @param title   name of the lens
/// @param remark  a line about the conditions
/// @param points  the models
/// @throws Error  if there are no points, a time is not positive and finite, or an error is negative or not finite
PETZVAL_API std::string pareto_figure(std::string_view title, std::string_view remark,
                                      std::span<const ParetoPoint> points);

}  // namespace petzval
