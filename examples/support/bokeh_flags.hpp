// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli.hpp"
#include "petzval/camera/bokeh_controls.hpp"

namespace examples {

/// Command line of the programs that shape a bokeh beyond its iris.
struct BokehFlags {
  petzval::BokehControls controls;  ///< without its map
  std::string iris_image, weight_map;

  /// Whether pictures are those of the lens alone.
  bool change_nothing() const noexcept;
};

/// Options --iris-image, --lens-ratio, --rate-of-change, --keep-light, --weight-distribution, --weight-strength and
/// --weight-map.
void add_bokeh(App& app, BokehFlags& flags);

/// The controls with their map. Notes on standard error how much light the cut of weights at 0 adds. Throws
/// petzval::Error for files that cannot be read, two maps, and flags without an effect.
petzval::BokehControls controls_of(const BokehFlags& flags);

}  // namespace examples
