// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "build_tables.hpp"
#include "describe_asphere.hpp"
#include "edges.hpp"
#include "indices.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// Data shared by all copies of a Lens.
struct Lens::Data {
  std::string name;
  std::vector<LensSurface> surfaces;
  std::vector<double> rims;  ///< semi-diameters as given; `surfaces` are limited by edges as well
  std::optional<std::size_t> stop;
  Iris iris;
  double film_z = 0;
  std::vector<FocusPosition> focus_positions;
  std::vector<double> wavelengths_nm;
  std::size_t primary = 0;
  lens_detail::Indices indices;
  std::shared_ptr<const lens_detail::SharedTables<float>> in_float;
  std::shared_ptr<const lens_detail::SharedTables<double>> in_double;

  static Lens lens(std::shared_ptr<const Data> data) noexcept { return Lens(std::move(data)); }

  /// @param meet as in end_at_edges()
  void build(bool meet = true) {
    lens_detail::end_at_edges(surfaces, rims, indices.values, meet);
    const auto aspheres = lens_detail::describe_aspheres(surfaces);
    build(aspheres, in_float);
    build(aspheres, in_double);
  }

 private:
  template <class R>
  void build(std::span<const kernel::Asphere<double>> aspheres,
             std::shared_ptr<const lens_detail::SharedTables<R>>& tables) const {
    auto built = lens_detail::build_tables<R>(surfaces, aspheres, stop, iris, indices.values, wavelengths_nm.size(),
                                              indices.spectrum);
    built.primary = primary;
    tables = std::make_shared<const lens_detail::SharedTables<R>>(std::move(built));
  }
};

}  // namespace petzval
