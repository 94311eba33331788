// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli.hpp"
#include "petzval/io/json.hpp"

namespace examples {

/// Adds --iris-image, --lens-ratio, --rate-of-change, --keep-light, --weight-distribution, --weight-strength and
/// --weight-map, for iris_map and camera.bokeh. The weights of --weight-map, unlike --iris-image, are divided by their
/// mean.
void add_bokeh(App& app, petzval::CameraSetup& setup);

/// True if the set-up leaves the bokeh of the lens unchanged.
bool plain_bokeh(const petzval::CameraSetup& setup) noexcept;

/// The controls with their map. A note on standard error gives the light added by setting negative weights to 0.
/// @throws petzval::Error if the file cannot be read or a flag has no effect
petzval::BokehControls controls_of(const petzval::CameraSetup& setup);

}  // namespace examples
