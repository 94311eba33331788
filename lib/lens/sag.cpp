// SPDX-License-Identifier: Apache-2.0
#include "petzval/lens/lens.hpp"

#include <cmath>
#include <limits>

#include "lens/asphere.hpp"
#include "lens/lens_view.hpp"

namespace petzval {

double sag(const Lens& lens, std::size_t surface, double x, double y) noexcept {
  if (surface >= lens.surface_count()) return std::numeric_limits<double>::quiet_NaN();
  const auto& view = kernel::view<double>(lens);
  const auto& row = view.surfaces[surface];
  kernel::Asphere<double> shape;
  shape.base = row.quadric;
  if (row.asphere >= 0) shape = view.aspheres[row.asphere];
  const auto [z, slope, defined] = kernel::sag(shape, shape.base.ax * x * x + shape.base.ay * y * y);
  return defined && std::isfinite(z) ? z : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace petzval
