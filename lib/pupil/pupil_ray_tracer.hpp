// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "angle_map.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil/pupil_plane.hpp"

namespace petzval::pupil_detail {

/// A point of the pupil plane and the approximate distances to its neighbours in the search.
struct PassingPoint {
  Vec2<double> at{0, 0}, spacing{0, 0};
};

/// Indices of local maxima among negative values on a grid with rows of length `row`. Near such a maximum a component
/// of a pupil may lie between grid points. Border points are left out.
std::vector<std::size_t> local_maxima(std::span<const double> values, std::size_t row);

/// Meaning of x and y: positions in the plane (mm), or the angles (rad, angle_map.hpp) of these positions, seen from a
/// point at a finite distance.
enum class Coordinates { plane, angles };

/// Traces rays of one point in batches and keeps the buffers.
class PupilRayTracer {
 public:
  PupilRayTracer(const Lens& lens, const PupilPlane& plane, std::size_t wavelength, Coordinates coordinates);

  const Lens& lens() const noexcept { return lens_; }
  const PupilPlane& plane() const noexcept { return plane_; }
  Coordinates coordinates() const noexcept { return coordinates_; }

  /// Clearances of the rays through (x[i], y[i]), as in trace/clearances.hpp, reproducible.
  /// @param apertures as in BatchOptions
  /// @return N values, valid until the next call
  std::span<const double> clearances(std::span<const double> x, std::span<const double> y, bool apertures = true);

  /// Fates and surfaces at the ends of N rays, valid until the next call.
  struct Ends {
    std::span<const RayFate> fates;
    std::span<const int> surfaces;
  };
  Ends ends(std::span<const double> x, std::span<const double> y);

  /// Largest absolute coordinate, seen from the point, of the surface through which rays enter.
  double reach() const;

  /// Position of the chief ray, ignoring apertures; nullopt if no ray goes through the centre of the stop.
  std::optional<Vec2<double>> chief() const;

  /// Finds positions whose rays pass, within the visible part of the surface through which rays enter: on a grid of 48
  /// x 48 steps and, if few rays pass, near maxima of the clearance on a grid of 96 x 96. If there are several
  /// components, it returns the component nearest to the chief ray, or the largest component if there is no chief ray.
  std::vector<PassingPoint> passing_points();

 private:
  RayArrays<double> rays(std::span<const double> x, std::span<const double> y);

  const Lens& lens_;
  PupilPlane plane_;
  AngleMap angle_map_;
  Coordinates coordinates_;
  std::size_t wavelength_;
  std::array<std::vector<double>, 2> positions_;
  std::array<std::vector<double>, 6> rays_;
  std::vector<double> values_;
  std::vector<RayFate> fates_;
  std::vector<int> surfaces_;
};

}  // namespace petzval::pupil_detail
