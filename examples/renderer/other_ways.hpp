// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf.hpp"

namespace renderer {

/// What the weights of all ways to make a path take from the part behind a vertex: sums of densities of the other ways,
/// over that of this one. A path that is connected at the vertex, or ends there, takes `connected`; one that goes on
/// backwards through it, `through` times the density of that.
/// Source: Georgiev, Implementing vertex connection and merging, 2012 (dVCM and dVC; nothing is merged here).
struct OtherWays {
  double connected = 0, through = 0;

  /// The path arrives at a surface.
  void arrive(double d2, double cosine) noexcept { connected *= d2 / cosine, through /= cosine; }
  /// It is scattered there.
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
