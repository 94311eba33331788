// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/ray.hpp"

namespace petzval {

std::string_view name(RayFate fate) noexcept {
  switch (fate) {
    case RayFate::transmitted: return "transmitted";
    case RayFate::missed_surface: return "missed_surface";
    case RayFate::totally_reflected: return "totally_reflected";
    case RayFate::vignetted: return "vignetted";
    case RayFate::no_convergence: return "no_convergence";
    case RayFate::outside_fit: return "outside_fit";
    case RayFate::outside_film: return "outside_film";
    case RayFate::invalid: return "invalid";
    case RayFate::outside_spectrum: return "outside_spectrum";
  }
  return "unknown";
}

}  // namespace petzval
