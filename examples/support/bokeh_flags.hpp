// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli.hpp"
#include "petzval/camera/bokeh.hpp"

namespace examples {

/// Options for iris images, cat's eyes and weights of the pupil, shared by several programs.
struct BokehFlags {
  petzval::BokehControls controls;  ///< without a weight map
  std::string iris_image, weight_map;

  /// True if the flags leave the bokeh of the lens unchanged.
  bool change_nothing() const noexcept;
};

/// Adds --iris-image, --lens-ratio, --rate-of-change, --keep-light, --weight-distribution, --weight-strength and
/// --weight-map.
void add_bokeh(App& app, BokehFlags& flags);

/// The controls with their map. A note on standard error gives the light added by setting negative weights to 0.
/// @throws petzval::Error if a file cannot be read, both maps are given, or a flag has no effect
petzval::BokehControls controls_of(const BokehFlags& flags);

}  // namespace examples
