// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace examples {

/// Rays by column, in the lens frame (mm); directions are not normalized.
struct RayTable {
  std::vector<double> x, y, z, dx, dy, dz;
  std::size_t size() const noexcept { return x.size(); }
};

/// Reads "x_mm,y_mm,z_mm,dx,dy,dz" and one ray per line, like parse_columns.
/// @throws petzval::Error also if a direction is 0,0,0
RayTable parse_rays(std::string_view csv, const std::string& where);

}  // namespace examples
