// SPDX-License-Identifier: Apache-2.0
#include "iris_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::inline v0::iris_detail {
namespace {

constexpr double rounding = 1e-9;

/// The part of an edge's line that lies within the other edges: between `low` and `high` along its tangent (-ny, nx).
struct Part {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

Part part_of(const std::vector<IrisEdge>& edges, const IrisEdge& own) noexcept {
  Part part;
  for (const IrisEdge& other : edges) {
    // On the line the other one's condition reads across + t along <= 0.
    const double along = other.ny * own.nx - other.nx * own.ny;
    const double across = own.distance * (own.nx * other.nx + own.ny * other.ny) - other.distance;
    if (std::abs(along) > rounding) {
      double& end = along > 0 ? part.high : part.low;
      end = along > 0 ? std::min(end, -across / along) : std::max(end, -across / along);
    } else if (across > rounding) {
      return {0, 0};
    }
  }
  return part;
}

/// From +y towards +x, in [0, 2 pi).
double angle_of(const Vec2<double>& p) noexcept {
  const double angle = std::atan2(p.x, p.y);
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

}  // namespace

Iris upside_down(Iris iris, bool along_x, bool along_y) {
  for (IrisEdge& edge : iris.edges) {
    if (along_x) edge.nx = -edge.nx;
    if (along_y) edge.ny = -edge.ny;
  }
  return iris;
}

IrisShape::IrisShape(const Iris& iris) {
  if (iris.round()) return;
  std::vector<Vec2<double>> corners;
  double top = std::numeric_limits<double>::infinity();  // where the polygon crosses +y
  for (std::size_t i = 0; i < iris.edges.size(); ++i) {
    const auto& [nx, ny, distance] = iris.edges[i];
    const std::string where = "iris: edge " + std::to_string(i) + ": ";
    if (!(distance > 0)) {
      throw Error(where + "distance is " + to_text(distance) + ", wanted a positive one: the axis within the iris");
    }
    if (ny > 0) top = std::min(top, distance / ny);
    const Part part = part_of(iris.edges, iris.edges[i]);
    if (!(part.low < part.high)) continue;
    const double farthest = std::hypot(distance, std::max(-part.low, part.high));
    if (!(farthest <= 1 + rounding)) {
      throw Error(where + "it reaches " + to_text(farthest, 6) +
                  " semi-diameters from the axis, wanted a polygon with its corners within the rim");
    }
    corners.push_back({distance * nx - part.low * ny, distance * ny + part.low * nx});
  }
  // The triangles begin at +y, which may be a corner.
  const auto at_top = [&](const Vec2<double>& corner) { return std::hypot(corner.x, corner.y - top) < rounding; };
  corners.erase(std::remove_if(corners.begin(), corners.end(), at_top), corners.end());
  std::sort(corners.begin(), corners.end(),
            [](const Vec2<double>& a, const Vec2<double>& b) { return angle_of(a) < angle_of(b); });
  corners.insert(corners.begin(), {0, top});
  corners.push_back({0, top});

  std::vector<double> before{0};
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    const Vec2<double>&a = corners[k], &b = corners[k + 1];
    before.push_back(before.back() + (b.x * a.y - a.x * b.y) / 2);
  }
  area_ = before.back();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    put(single_, corners[k], before[k] / area_);
    put(twice_, corners[k], before[k] / area_);
  }
}

Vec2<double> IrisShape::sample(double u, double v) const noexcept {
  if (round()) {
    const auto [x, y] = disc_point(u, v);
    return {x, y};
  }
  const IrisTriangles<double> t = triangles<double>();
  const auto [x, y] = triangle_point(t, triangle_with(t, u), u, v);
  return {x, y};
}

bool IrisShape::contains(double x, double y) const noexcept {
  const IrisTriangles<double> t = triangles<double>();
  bool within = t.count > 0 || x * x + y * y <= 1;
  for (std::size_t k = 0; k < t.count; ++k) within = within && within_edge(t, k, x, y);
  return within;
}

}  // namespace petzval::inline v0::iris_detail
