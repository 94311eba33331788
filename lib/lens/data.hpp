// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "build_tables.hpp"
#include "describe_asphere.hpp"
#include "indices.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// What a Lens shares with its copies.
struct Lens::Data {
  std::string name;
  std::vector<LensSurface> surfaces;
  std::optional<std::size_t> stop;
  Iris iris;
  double film_z = 0;
  std::vector<double> wavelengths_nm;
  std::size_t primary = 0;
  lens_detail::Indices indices;
  lens_detail::Tables<float> in_float;
  lens_detail::Tables<double> in_double;

  /// Builds the tables from the rest.
  void build() {
    using lens_detail::build_tables;
    const std::size_t count = wavelengths_nm.size();
    const auto aspheres = lens_detail::describe_aspheres(surfaces);
    in_float = build_tables<float>(surfaces, aspheres, stop, iris, indices.values, count, indices.spectrum);
    in_double = build_tables<double>(surfaces, aspheres, stop, iris, indices.values, count, indices.spectrum);
    in_float.primary = in_double.primary = primary;
  }
};

}  // namespace petzval::inline v0
