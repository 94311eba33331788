// SPDX-License-Identifier: Apache-2.0
#include "clearance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lens/lens_view.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::inline v0::pupil_detail {

Clearance clearance(const Lens& lens, const PupilPlane& plane, double x, double y, std::size_t wavelength) noexcept {
  const auto view = kernel::view<double>(lens);
  Clearance result{.value = std::numeric_limits<double>::infinity()};
  const auto take = [&](double value, int surface) {
    if (value < result.value) result.value = value, result.surface = surface;
  };
  // The same numbers as in the trace's own test of the rim, so that sign and fate agree to the bit.
  const auto watch = [&](int surface, const Vec3<double>& point) {
    const auto& row = view.surfaces[surface];
    const double r2 = point.x * point.x + point.y * point.y;
    if (std::isinf(row.semi_diameter_squared)) return;
    const double scale = row.semi_diameter_squared > 0 ? row.semi_diameter_squared : 1;
    take((row.semi_diameter_squared - r2) / scale, surface);
    if (row.obscuration_squared > 0) take((r2 - row.obscuration_squared) / scale, surface);
    if (surface != view.stop) return;
    for (const auto& [nx, ny, distance] : view.iris) {
      take((distance - (point.x * nx + point.y * ny)) / std::sqrt(scale), surface);
    }
  };
  const auto end = trace<double>(lens, plane.ray(x, y),
                                 {.travel = plane.travel(), .wavelength = wavelength, .apertures = false}, watch);
  // Within (-1, 0) for rays that rims stop, however small the stop is beside the lens, and below for the others.
  if (result.value < 0) result.value /= 1 - result.value;
  if (end.fate != RayFate::transmitted) {
    const auto count = static_cast<double>(view.count);
    const double left = plane.travel() == Travel::to_film ? count - end.surface : end.surface + 1.0;
    result.value = std::min(result.value, 0.0) - 1 - left / count;
    result.surface = end.surface;
    result.fate = end.fate;
  } else if (result.value < 0) {
    result.fate = RayFate::vignetted;
  }
  return result;
}

}  // namespace petzval::inline v0::pupil_detail
