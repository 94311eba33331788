// SPDX-License-Identifier: Apache-2.0
#include "rays_csv.hpp"

#include <array>
#include <utility>

#include "number_csv.hpp"
#include "petzval/core/error.hpp"

namespace examples {

RayTable parse_rays(std::string_view csv, const std::string& where) {
  constexpr std::array<CsvColumn, 6> columns{{{"x_mm"}, {"y_mm"}, {"z_mm"}, {"dx"}, {"dy"}, {"dz"}}};
  auto all = parse_columns(csv, columns, where);
  RayTable rays{std::move(all[0]), std::move(all[1]), std::move(all[2]),
                std::move(all[3]), std::move(all[4]), std::move(all[5])};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays.dx[i] == 0 && rays.dy[i] == 0 && rays.dz[i] == 0) {
      throw petzval::Error(line_of_row(where, i) + ": direction = 0,0,0; must have a nonzero length");
    }
  }
  return rays;
}

}  // namespace examples
