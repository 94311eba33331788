// SPDX-License-Identifier: Apache-2.0
#include "path_lens.hpp"

#include <limits>
#include <utility>
#include <vector>

#include "data.hpp"

namespace petzval::lens_detail {

Lens along(const Lens& lens, std::span<const Passage> path) {
  const Lens::Data& from = lens.data();
  const std::size_t count = from.surfaces.size();
  auto data = std::make_shared<Lens::Data>();
  data->name = from.name;
  data->iris = from.iris;
  data->film_z = from.film_z;
  data->wavelengths_nm = from.wavelengths_nm;
  data->primary = from.primary;

  std::vector<std::size_t> spaces{0};
  bool forward = true;
  for (const auto& [surface, reflects] : path) {
    LensSurface own;
    if (surface < count) {
      own = from.surfaces[surface];
    } else {
      own.vertex_z = from.film_z;
      own.semi_diameter = std::numeric_limits<double>::infinity();
    }
    own.coating.reset();
    if (reflects) {
      own.mirror = true;
      forward = !forward;
    }
    if (surface == from.stop && !data->stop) data->stop = data->surfaces.size();
    data->rims.push_back(own.semi_diameter);
    data->surfaces.push_back(std::move(own));
    spaces.push_back(reflects ? spaces.back() : forward ? surface + 1 : surface);
  }
  for (std::size_t k = 0; k < path.size(); ++k) {
    const double next = k + 1 < path.size() ? data->surfaces[k + 1].vertex_z : from.film_z;
    data->surfaces[k].thickness = next - data->surfaces[k].vertex_z;
  }
  for (std::size_t w = 0; w < from.wavelengths_nm.size(); ++w) {
    for (const std::size_t space : spaces) data->indices.values.push_back(from.indices.values[w * (count + 1) + space]);
  }
  for (const std::size_t space : spaces) data->indices.absorption.push_back(from.indices.absorption[space]);
  data->indices.spectrum = from.indices.spectrum.along(spaces);
  data->indices.dispersion = from.indices.dispersion;
  if (!data->stop) data->iris = {};
  data->build(false);  // the rims of the lens end at its edges
  return Lens::Data::lens(std::move(data));
}

std::vector<Passage> path_of_pair(const Lens& lens, std::size_t first, std::size_t second) {
  std::vector<Passage> path;
  for (std::size_t i = 0; i < second; ++i) path.push_back({i, false});
  path.push_back({second, true});
  for (std::size_t i = second; i-- > first + 1;) path.push_back({i, false});
  path.push_back({first, true});
  for (std::size_t i = first + 1; i < lens.surface_count(); ++i) path.push_back({i, false});
  return path;
}

}  // namespace petzval::lens_detail
