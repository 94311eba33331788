// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf.hpp"

namespace renderer {

/// Partial sums of the multiple importance weights of a path up to a vertex: densities of the other techniques that
/// make the same path, divided by the density of this technique. A path that is connected or ends at the vertex uses
/// `connected`; a path that continues backwards through it uses `through` times the density of that step. Source:
/// Georgiev, Implementing vertex connection and merging, 2012 (dVCM and dVC; without merging).
struct OtherWays {
  double connected = 0, through = 0;

  /// Updates the sums for the arrival at a surface.
  void arrive(double d2, double cosine) noexcept { connected *= d2 / cosine, through /= cosine; }
  /// Updates the sums for a scattering at that surface.
  void scatter(const Bsdf::Sample& next, double goes_on, double cosine) noexcept {
    if (next.specular) {
      connected = 0, through *= cosine;
      return;
    }
    const double pdf = next.pdf * goes_on;
    through = cosine / pdf * (through * next.pdf_reverse * goes_on + connected);
    connected = 1 / pdf;
  }
  double with(double backwards) const noexcept { return connected + through * backwards; }
};

}  // namespace renderer
