// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace examples {

/// Rays column by column, lens frame (mm), directions as given.
struct RayTable {
  std::vector<double> x, y, z, dx, dy, dz;
  std::size_t size() const noexcept { return x.size(); }
};

/// Reads "x_mm,y_mm,z_mm,dx,dy,dz" and one ray a line (LF or CRLF; a byte-order mark, and blank lines at the end, are
/// skipped). Throws petzval::Error that names `where`, the line (from 1) and the column.
RayTable parse_rays(std::string_view csv, const std::string& where);

/// A number with 17 significant digits, from which a double reads back exactly.
std::string digits17(double value);

}  // namespace examples
