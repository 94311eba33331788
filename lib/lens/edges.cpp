// SPDX-License-Identifier: Apache-2.0
#include "edges.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/bisect.hpp"
#include "describe_asphere.hpp"
#include "equator.hpp"

namespace petzval::lens_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_sphere(const LensSurface& s) noexcept {
  return s.conic == 0 && s.aspheric.empty() && s.curved_in == Section::both;
}

/// Least height, up to `up_to`, at which two surfaces meet; infinite if they do not meet.
/// @param direction direction of light between them, +1 or -1
double meeting_height(const LensSurface& front, const LensSurface& rear, double direction, double up_to) {
  const double distance = direction * (rear.vertex_z - front.vertex_z);
  if (!(distance > 0)) return infinity;
  // Rounding may put a height on the equator outside the equator.
  const double end = std::min({up_to, equator(front) * (1 - 1e-15), equator(rear) * (1 - 1e-15), 1e15});
  const auto meet_along = [&](double x, double y) {
    const auto ordered = [&](double height) {
      const double gap =
          distance + direction * (sag_of(rear, x * height, y * height) - sag_of(front, x * height, y * height));
      return !(gap < 0);
    };
    // The difference of the slopes of two spheres has the same sign at all heights.
    if (is_sphere(front) && is_sphere(rear)) return ordered(end) ? infinity : core_detail::last_with(0, end, ordered);
    // Other surfaces are sampled in steps of 1 / 64 of the range, or of 1 / 16 of the height if the range is long.
    const double bend = std::abs(front.curvature) + std::abs(rear.curvature);
    const double first = std::min(end, bend > 0 ? std::sqrt(distance / bend) : distance) / 64;
    for (double low = 0; low < end;) {
      const double high = std::min(end, std::max(low + std::min(first, end / 64), low * (1 + 1.0 / 16)));
      if (!ordered(high)) return core_detail::last_with(low, high, ordered);
      low = high;
    }
    return infinity;
  };
  double least = meet_along(0, 1);
  const auto round = [](const LensSurface& s) { return s.curved_in == Section::both; };
  if (round(front) && round(rear)) return least;
  // Cylinders along x and y differ most along an axis or along a diagonal.
  constexpr double diagonal = std::numbers::sqrt2 / 2;
  return std::min({least, meet_along(1, 0), meet_along(diagonal, diagonal)});
}

}  // namespace

double sag_of(const LensSurface& s, double x, double y) noexcept {
  const double r2 = (s.curved_in == Section::y ? 0 : x * x) + (s.curved_in == Section::x ? 0 : y * y);
  double z = s.curvature * r2 / (1 + std::sqrt(1 - (1 + s.conic) * s.curvature * s.curvature * r2));
  const double r = std::sqrt(r2);
  for (const auto& [order, coefficient] : s.aspheric) {
    double power = order % 2 == 0 ? 1 : r;  // by multiplication, which is exact under scaling by powers of two
    for (int i = 0; i < order / 2; ++i) power *= r2;
    z += coefficient * power;
  }
  return z;
}

bool changes_rays(std::span<const LensSurface> surfaces, std::span<const double> indices, std::size_t i) noexcept {
  if (surfaces[i].mirror) return true;
  const std::size_t spaces = surfaces.size() + 1;
  for (std::size_t w = 0; w < indices.size(); w += spaces) {
    if (indices[w + i] != indices[w + i + 1]) return true;
  }
  return false;
}

void end_at_edges(std::span<LensSurface> surfaces, std::span<const double> rims, std::span<const double> indices,
                  bool meet) {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    LensSurface& s = surfaces[i];
    s.semi_diameter = rims[i];
    s.edge = infinity;
    // An asphere that is curved in one section ends at a height, not at a radius.
    const bool describes_rim = !s.aspheric.empty() && s.curved_in == Section::both;
    if (describes_rim && std::isfinite(rims[i]) && rims[i] > 0) s.semi_diameter = described_height(s);
  }
  double direction = 1;
  std::optional<std::size_t> before;
  for (std::size_t i = 0; meet && i < surfaces.size(); ++i) {
    if (!changes_rays(surfaces, indices, i)) continue;
    if (before) {
      const double least = std::min(surfaces[*before].semi_diameter, surfaces[i].semi_diameter);
      const double edge = meeting_height(surfaces[*before], surfaces[i], direction, least);
      for (const std::size_t j : {*before, i}) surfaces[j].edge = std::min(surfaces[j].edge, edge);
    }
    if (surfaces[i].mirror) direction = -direction;
    before = i;
  }
  for (LensSurface& s : surfaces) s.semi_diameter = std::min(s.semi_diameter, s.edge);
}

}  // namespace petzval::lens_detail
