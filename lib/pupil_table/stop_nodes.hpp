// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "iris/iris_shape.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil_table/pupil_grid.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::pupil_table_detail {

/// Intersection of a ray with the stop, in semi-diameters. The ray runs from a film point through a position in the
/// pupil plane. nullopt if the ray does not reach the stop.
using StopOf =
    std::function<std::optional<Vec2<double>>(const FilmPoint&, const Vec2<double>& position, std::size_t wavelength)>;

/// Traces rays, without clipping by apertures. The stop of the lens must have a semi-diameter.
StopOf traced_stop(const Lens& lens, const TwoPlanes& space);

/// The stop behind the pupils of a grid: owns the numbers of GridStop.
struct StopNodes {
  iris_detail::IrisShape shape;
  StopOf stop_of;
  std::vector<double> numbers;  // [wavelength][node] StopLayout
  std::vector<float> numbers_single;

  template <class R>
  GridStop<R> borrowed() const noexcept {
    GridStop<R> result;
    if constexpr (sizeof(R) == sizeof(float)) {
      result.nodes = numbers_single.data();
    } else {
      result.nodes = numbers.data();
    }
    result.iris = shape.sectors<R>();
    result.area = static_cast<R>(shape.area());
    return result;
  }
};

}  // namespace petzval::pupil_table_detail
