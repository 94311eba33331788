// SPDX-License-Identifier: Apache-2.0
#include "lens_section.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bisect.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::figure_detail {
namespace {

/// Sag of a surface at a height of the section; NaN if undefined.
double sag_at(const Lens& lens, std::size_t surface, Meridian meridian, double height) {
  return meridian == Meridian::y ? sag(lens, surface, 0, height) : sag(lens, surface, height, 0);
}

/// The largest value in [low, high] for which `holds` is true. It must be true at `low` and change at most once.
template <class Predicate>
double last_where(double low, double high, const Predicate& holds) {
  return holds(high) ? high : core_detail::last_with(low, high, holds);
}

}  // namespace

LensSection::LensSection(const Lens& lens, Meridian meridian, std::span<const double> needed, std::size_t wavelength)
    : lens_(lens), meridian_(meridian), wavelength_(wavelength) {
  const auto surfaces = lens.surfaces();
  std::vector<std::size_t> bending;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const double required = std::isfinite(surfaces[i].semi_diameter) ? surfaces[i].semi_diameter : 1.05 * needed[i];
    rims_.push_back(farthest_defined(i, required));
    if (bends(i)) bending.push_back(i);
  }
  drawn_ = rims_;
  extend_cemented(bending);
}

double LensSection::z(std::size_t surface, double height) const {
  return lens_.surfaces()[surface].vertex_z + sag_at(lens_, surface, meridian_, height);
}

bool LensSection::bends(std::size_t i) const {
  return lens_.surfaces()[i].mirror || lens_.index(i, wavelength_) != lens_.index(i + 1, wavelength_);
}

/// True if the medium behind a surface is drawn: gases are left out.
bool LensSection::glass_behind(std::size_t i) const { return lens_.index(i + 1, wavelength_) > 1.01; }

double LensSection::farthest_defined(std::size_t surface, double height) const {
  return last_where(0, height, [&](double h) { return !std::isnan(sag_at(lens_, surface, meridian_, h)); });
}

double LensSection::gap(std::size_t front, std::size_t back, double height) const {
  return z(back, height) - z(front, height);
}

SectionLine LensSection::line(std::size_t surface, double from, double to) const {
  constexpr int steps = 48;
  SectionLine result;
  for (int k = 0; k <= steps; ++k) {
    // Points are denser towards the ends, because a deep surface is steep there.
    const double t = std::sin(std::numbers::pi * (static_cast<double>(k) / steps - 0.5)) / 2 + 0.5;
    const double height = k == steps ? to : from + t * (to - from);
    result.push_back({z(surface, height), height});
  }
  return result;
}

std::vector<SectionLine> LensSection::surface(std::size_t i) const {
  const double hole = lens_.surfaces()[i].obscuration_semi_diameter, rim = drawn_[i];
  if (hole > 0) return {line(i, hole, rim), line(i, -rim, -hole)};
  return {line(i, -rim, rim)};
}

std::vector<SectionLine> LensSection::mirrors() const {
  std::vector<SectionLine> result;
  for (std::size_t i = 0; i < rims_.size(); ++i) {
    if (!lens_.surfaces()[i].mirror) continue;
    for (SectionLine& piece : surface(i)) result.push_back(std::move(piece));
  }
  return result;
}

/// Extends cemented surfaces to the rims of their neighbours: the elements of a cemented group have the same diameter,
/// but tables often list the clear height of each surface. Polynomials are not extrapolated beyond their rims.
void LensSection::extend_cemented(const std::vector<std::size_t>& bending) {
  for (std::size_t k = 1; k + 1 < bending.size(); ++k) {
    const std::size_t before = bending[k - 1], i = bending[k], after = bending[k + 1];
    const LensSurface& s = lens_.surfaces()[i];
    if (!glass_behind(before) || !glass_behind(i) || s.mirror || !s.aspheric.empty()) continue;
    if (lens_.surfaces()[before].mirror || lens_.surfaces()[after].mirror) continue;
    const double required = std::max(rims_[before], rims_[after]);
    const double sense = lens_.surfaces()[after].vertex_z > s.vertex_z ? 1 : -1;
    const double reach = last_where(rims_[i], std::max(rims_[i], required), [&](double h) {
      return !std::isnan(sag_at(lens_, i, meridian_, h)) && (h > rims_[before] || sense * gap(before, i, h) > 0) &&
             (h > rims_[after] || sense * gap(i, after, h) > 0);
    });
    // A partial extension would match neither the table nor the real glass.
    if (reach == required) drawn_[i] = reach;
  }
}

/// The outline from the upper rim of the front surface to the upper rim of the back surface, without both ends.
SectionLine LensSection::edge(std::size_t front, std::size_t back, const Edge& edge) const {
  const auto [f, b] = edge;
  if (f == b) return {};
  // The flat ring is at the rim of the lower surface, unless it would cut the higher surface.
  const bool front_lower = f < b;
  const double flat_z = front_lower ? z(front, f) : z(back, b);
  const SectionLine higher = front_lower ? line(back, f, b) : line(front, b, f);
  const bool clear =
      std::ranges::all_of(higher, [&](const SectionPoint& p) { return front_lower ? p.z >= flat_z : p.z <= flat_z; });
  if (!clear) return {};
  return {{flat_z, std::max(f, b)}};
}

GlassBody LensSection::body(std::size_t first, std::size_t second, double index) const {
  const auto surfaces = lens_.surfaces();
  // Behind mirrors, light may pass a body in the opposite direction.
  const bool forwards = surfaces[first].vertex_z <= surfaces[second].vertex_z;
  const std::size_t front = forwards ? first : second, back = forwards ? second : first;
  Edge edges{drawn_[front], drawn_[back]};

  // If the surfaces intersect inside their rims, the glass ends at the intersection.
  const double common = std::min(edges.front, edges.back);
  const double meet = last_where(0, common, [&](double h) { return gap(front, back, h) >= 0; });
  if (meet < common && gap(front, back, 0) >= 0) edges = {meet, meet};

  const SectionLine rim = edge(front, back, edges);
  const double hole = std::min(surfaces[front].obscuration_semi_diameter, surfaces[back].obscuration_semi_diameter);
  const auto mirrored = [](SectionLine points) {
    for (SectionPoint& p : points) p.height = -p.height;
    std::ranges::reverse(points);
    return points;
  };
  const auto append = [](SectionLine& to, const SectionLine& more) { to.insert(to.end(), more.begin(), more.end()); };

  GlassBody result{index, {}};
  SectionLine outline = line(front, hole > 0 ? hole : -edges.front, edges.front);
  append(outline, rim);
  append(outline, line(back, edges.back, hole > 0 ? hole : -edges.back));
  if (hole == 0) append(outline, mirrored(rim));
  result.outlines.push_back(outline);
  if (hole > 0) result.outlines.push_back(mirrored(outline));
  return result;
}

std::vector<GlassBody> LensSection::bodies() const {
  std::vector<GlassBody> result;
  std::size_t previous = rims_.size();
  for (std::size_t i = 0; i < rims_.size(); ++i) {
    if (!bends(i)) continue;
    if (previous < rims_.size() && glass_behind(previous)) {
      result.push_back(body(previous, i, lens_.index(i, wavelength_)));
    }
    previous = i;
  }
  return result;
}

}  // namespace petzval::figure_detail
