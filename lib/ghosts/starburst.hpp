// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "footprint.hpp"
#include "surface_waves.hpp"

namespace petzval::ghosts_detail {

/// Light that the edges of the pupil diffract, about the image of a light, out to the corners of a frame.
///
/// Each edge sends half of its light to either side, along its normal in the space of directions at the film: for an
/// edge of length L of a pupil of area A (direction cosines) and power P, the rate per distance r from the image of
/// the edge is P wavelength L / (4 pi^2 A r^2), the mean of Fraunhofer's integral over its fringes. A straight edge
/// has a spike of width wavelength / L; a round edge spreads its light over the angles of its normals.
Footprint starburst(const Lens& lens, const Entrance& entrance, const ScenePoint& light, const Surfaces& surfaces,
                    Wavelength wavelength, const Film& film, const Box& frame);

}  // namespace petzval::ghosts_detail
