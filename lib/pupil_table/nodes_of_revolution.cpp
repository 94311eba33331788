// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "pupil/boundary_search.hpp"
#include "scene_nodes.hpp"

namespace petzval::pupil_table_detail {
namespace {

/// Bounds of the intersections of a node's plane with the rays of this node and its neighbours.
struct Bounds {
  double low = 0, high = 0, across = 0;
  bool any = false;

  void take(double x, double y) noexcept {
    low = any ? std::min(low, y) : y;
    high = any ? std::max(high, y) : y;
    across = std::max(across, std::abs(x));
    any = true;
  }
};

/// Makes a polygon for a node without a pupil. polygon[-1] belongs to the previous node; `before` nodes precede this
/// node in the row. The pupil becomes empty between both nodes: the polygon moves on by the last step, and is widened
/// because the motion accelerates.
PupilPolygon beyond(const PupilPolygon* polygon, std::size_t before) noexcept {
  constexpr double widening = 1.2;
  PupilPolygon result = polygon[-1];
  if (before > 1) {
    for (int i : {0, 1}) result.middle[i] += polygon[-1].middle[i] - polygon[-2].middle[i];
  }
  result.widen(widening);
  return result;
}

/// True if a pupil is a ring about its middle.
bool is_ring(const PupilPolygon& polygon) noexcept {
  const auto& [middle, corners, from, width] = polygon;
  return *std::max_element(from.begin(), from.end()) == 0 && *std::min_element(width.begin(), width.end()) > 0;
}

}  // namespace

SceneNodes<2> nodes_of_revolution(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
                                  std::size_t wavelength, const ScenePassing& passing, ClippedBy clipped_by) {
  using L = SceneLayout<2>;
  constexpr std::size_t fields = L::row, distances = L::distances + 1;
  SceneNodes<2> result;
  std::vector<PupilPolygon>& polygons = result.polygons;
  // The nodes, and points halfway between them, at which interpolated polygons are checked.
  constexpr std::size_t rows = 2 * L::distances + 1, columns = 2 * L::fields + 1;
  const auto reciprocal_of = [&](std::size_t row) { return steepest * static_cast<double>(row) / (rows - 1); };

  // Largest field at each distance, with a margin because the rays are samples.
  constexpr double field_margin = 1.05, axis_field_rad = 1e-6;
  std::array<double, rows> widest{};
  for (std::size_t row = 0; row < rows; ++row) {
    const double field = widest_field(centre, rays, reciprocal_of(row));
    widest[row] = std::min(field_margin * field + axis_field_rad, std::numbers::pi);
  }
  for (std::size_t row = 1; row < rows; row += 2) {
    const double lacking = widest[row] - (widest[row - 1] + widest[row + 1]) / 2;
    if (lacking > 0) widest[row - 1] += lacking, widest[row + 1] += lacking;
  }
  for (std::size_t row = 1; row < rows; row += 2) widest[row] = (widest[row - 1] + widest[row + 1]) / 2;
  for (std::size_t i = 0; i < distances; ++i) result.widest[i] = widest[2 * i];

  // Search area for the pupil of a field: bounds of the rays in its plane, at the distance at which the fields of all
  // rays of a film point differ least.
  const auto sharpest = static_cast<std::size_t>(std::min_element(widest.begin(), widest.end()) - widest.begin());
  std::vector<Bounds> bounds(columns);
  for (const Ray<double>& ray : rays) {
    const Bearing bearing = bearing_on_sphere(centre, ray, reciprocal_of(sharpest));
    const Vec2<double> position = plane_facing(centre, bearing, 0).meet(ray);
    const auto nearest = static_cast<std::size_t>(std::lround(bearing.field / widest[sharpest] * (columns - 1)));
    for (std::size_t j = nearest - std::min<std::size_t>(nearest, 2); j <= std::min(nearest + 2, columns - 1); ++j) {
      bounds[j].take(position.x, position.y);
    }
  }
  // The pupil on the axis may be empty.
  const auto lit = std::find_if(bounds.begin(), bounds.end(), [](const Bounds& b) { return b.any; });
  std::fill(bounds.begin(), lit, *lit);
  double half_extent = 0, across = 0;
  for (std::size_t j = 0; j < columns; ++j) {
    if (!bounds[j].any) bounds[j] = bounds[j - 1];
    half_extent = std::max(half_extent, (bounds[j].high - bounds[j].low) / 2);
    across = std::max(across, bounds[j].across);
  }
  std::vector<pupil_detail::PupilGuess> guesses;  // rows x columns
  std::vector<PupilPlane> planes;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t j = 0; j < columns; ++j) {
      const double field = widest[row] * static_cast<double>(j) / (columns - 1);
      const double known = std::min(field / widest[sharpest], 1.0) * (columns - 1);
      const Bounds& b = bounds[static_cast<std::size_t>(std::lround(known))];
      guesses.push_back({0, b.low - half_extent, b.high + half_extent, std::max(across, half_extent)});
      planes.push_back(PupilPlane::facing(centre, field, {0, 1}, reciprocal_of(row)));
    }
  }

  constexpr std::size_t directions = 32;
  RayClearances clearances_of(passing, wavelength);
  const auto passes = [&](std::size_t count, const std::uint32_t* which, const double* x, const double* y,
                          double* clearances) {
    clearances_of(
        count, [&](std::size_t r) { return planes[which[r]].ray(x[r], y[r]); }, clearances);
  };
  const auto pupils = pupil_detail::find_regions(guesses, pupil_detail::SearchOrder::rows(guesses.size(), columns),
                                                 directions, true, passes);

  const auto node = [](std::size_t position) { return position / columns / 2 * fields + position % columns / 2; };
  polygons.resize(distances * fields);
  std::vector<InterpolationCheck> checks;
  for (std::size_t p = 0; p < pupils.size(); ++p) {
    const std::size_t row = p / columns, column = p % columns, at = node(p);
    if (row % 2 == 0 && column % 2 == 0) {
      PupilPolygon& polygon = polygons[at];
      polygon = pupils[p].empty() && at % fields > 0 ? beyond(&polygon, at % fields)
                                                     : polygon_of(pupils[p], PolygonFit::enclosing);
    } else {
      const std::size_t down = row % 2 * fields, right = column % 2;
      checks.push_back({&pupils[p], {{at, at + right, at + down, at + down + right}, {0.25, 0.25, 0.25, 0.25}}});
    }
  }
  expand_to_cover(polygons, checks);
  constexpr double unchecked_margin = 1.008;  // scale of polygons, for points that are not checked
  for (PupilPolygon& polygon : polygons) polygon.widen(unchecked_margin);
  // Exclude obscurations only if all pupils are rings. Other obscurations move, and polygons without them are correct
  // only at the points that are checked.
  const bool rings = std::all_of(polygons.begin(), polygons.end(), is_ring);
  if (!rings) {
    for (PupilPolygon& polygon : polygons) polygon.obscured.fill(0);
  }

  // In the outermost fields pupils shrink, and their boundaries are more curved between the points that are checked:
  // expand polygons to the sampled rays. Do so in all fields if the sampled rays bound the pupils.
  const bool all = rings || clipped_by == ClippedBy::samples;
  constexpr double ray_margin = 1.08, outer_field_fraction = 0.75, obscuration_scale = 0.8;
  for (std::size_t row = 0; row < rows; ++row) {
    const double reciprocal = reciprocal_of(row);
    for (const Ray<double>& ray : rays) {
      const Bearing bearing = bearing_on_sphere(centre, ray, reciprocal);
      if (!all && bearing.field < outer_field_fraction * widest[row]) continue;
      const Vec2<double> position = plane_facing(centre, bearing, reciprocal).meet(ray);
      const PolygonWeights at = result.weights(angles<2>(bearing), reciprocal / steepest).value_or(PolygonWeights{});
      const double relative = interpolated(polygons, at).relative_radius(position.x, position.y);
      if (std::isinf(relative)) {  // a line outwards meets the edge of the pupil more than once
        polygons.clear();
        return result;
      }
      for (std::size_t j = 0; j < at.polygons.size(); ++j) {
        if (at.weights[j] == 0) continue;
        PupilPolygon& polygon = polygons[at.polygons[j]];
        if (relative < 0) {
          for (double& width : polygon.obscured) width *= obscuration_scale;
        } else if (ray_margin * relative > 1) {
          polygon.widen(ray_margin * relative);
        }
      }
    }
  }
  return result;
}

}  // namespace petzval::pupil_table_detail
