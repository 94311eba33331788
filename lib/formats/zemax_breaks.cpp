// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "text_file.hpp"
#include "zemax_lens.hpp"

namespace petzval::formats_detail {
namespace {

using Surfaces = std::vector<ZemaxSurface>;

/// PARM 1 to 5 of a break: decentres in x and y, tilts about x, y and z (degrees).
double parameter(const ZemaxSurface& s, int i) {
  const auto found = s.parameters.find(i);
  return found == s.parameters.end() ? 0 : found->second;
}

bool is_break(const ZemaxSurface& s) { return s.type == "COORDBRK"; }

bool changes_nothing(const ZemaxSurface& s) {
  return std::ranges::all_of(s.parameters, [](const auto& p) { return p.first > 5 || p.second == 0; });
}

/// True for a plane without glass on either side, whose only purpose is to position breaks.
bool is_dummy(const ZemaxSurface& s, const ZemaxSurface& before) {
  return s.type == "STANDARD" && s.curvature == 0 && !s.stop && !s.glass && !before.glass && !s.aperture &&
         !s.obscuration && !s.ring;
}

/// The number of the only parameter that is not 0; nullopt if there are several.
std::optional<int> only_parameter(const ZemaxSurface& s) {
  std::optional<int> only;
  for (int i = 1; i <= 5; ++i) {
    if (parameter(s, i) == 0) continue;
    if (only) return {};
    only = i;
  }
  return only;
}

bool undoes(const ZemaxSurface& second, const ZemaxSurface& first) {
  const auto one = only_parameter(first), other = only_parameter(second);
  const bool single = one && one == other;
  const bool in_reverse_order = parameter(first, 6) != parameter(second, 6);
  if (!single && !in_reverse_order) return false;
  for (int i = 1; i <= 5; ++i) {
    if (std::abs(parameter(first, i) + parameter(second, i)) > 1e-9) return false;
  }
  return true;
}

/// True for two equal tilts about x or y at a plane mirror: the axis follows the mirrored light.
bool is_fold(std::span<const ZemaxSurface> three) {
  const auto tilt = only_parameter(three[0]);
  return is_break(three[0]) && is_break(three[2]) && (tilt == 3 || tilt == 4) && only_parameter(three[2]) == tilt &&
         std::abs(parameter(three[0], *tilt) - parameter(three[2], *tilt)) <= 1e-9 && three[0].thickness == 0 &&
         three[1].thickness == 0 && three[1].type == "STANDARD" && three[1].curvature == 0 && three[1].glass &&
         three[1].glass->name == "MIRROR" && !three[1].stop;
}

/// Warns of surface data at a coordinate break, which is not a surface.
void warn_of_surface(const ZemaxSurface& found, Import& in) {
  std::string said;
  const auto add = [&](bool is_there, std::string_view what) {
    if (is_there) append(said, ", ", what);
  };
  add(found.curvature != 0 || found.curvature_pickup, "CURV");
  add(found.conic != 0, "CONI");
  add(found.glass.has_value(), found.glass ? "GLAS " + found.glass->name : "");
  add(found.aperture || found.obscuration || found.ring, "aperture");
  if (!said.empty()) in.warn(found.line, "COORDBRK", "is not a surface; its " + said + " is left out");
}

/// Inverts a surface behind a removed mirror, where light travels in the opposite direction along z.
void turn(ZemaxSurface& s) {
  const auto opposite = [](double& value) { value = 0.0 - value; };
  opposite(s.thickness);
  opposite(s.curvature);
  if (s.type == "EVENASPH" || s.type == "ODDASPHE") {
    for (auto& [number, value] : s.parameters) opposite(value);
  }
  for (auto& [number, value] : s.extra) {
    if (number > 2) opposite(value);
  }
}

}  // namespace

void fold_breaks(Surfaces& surfaces, Import& in) {
  Surfaces kept;
  bool turned = false;
  const auto keep = [&](std::size_t i) {
    if (turned) turn(surfaces[i]);
    kept.push_back(std::move(surfaces[i]));
  };
  // Removes surfaces up to `end`. The surface in front of them gets the thickness of the last one.
  const auto take_out = [&](std::size_t end) {
    const double thickness = surfaces[end - 1].thickness;
    kept.back().thickness += turned ? 0.0 - thickness : thickness;
    return end;
  };

  std::size_t i = 0;
  while (i < surfaces.size()) {
    if (i == 0 || i + 1 == surfaces.size() || !is_break(surfaces[i])) {
      keep(i++);
      continue;
    }
    const ZemaxSurface& found = surfaces[i];
    warn_of_surface(found, in);
    if (changes_nothing(found) && !found.stop) {
      i = take_out(i + 1);
      continue;
    }
    if (i + 3 < surfaces.size() && is_fold(std::span(surfaces).subspan(i, 3))) {
      in.warn(found.line, "COORDBRK",
              "the light folded by the plane mirror of surface " + std::to_string(surfaces[i + 1].number) +
                  " is unfolded; the mirror is left out");
      turned = !turned;
      i = take_out(i + 3);
      continue;
    }
    std::size_t end = i + 1;
    bool bare = found.thickness == 0 && !found.stop;
    while (bare && end + 1 < surfaces.size() && !(is_break(surfaces[end]) && undoes(surfaces[end], found))) {
      bare = (is_dummy(surfaces[end], kept.back()) || (is_break(surfaces[end]) && changes_nothing(surfaces[end]))) &&
             surfaces[end].thickness == 0;
      ++end;
    }
    if (bare && end + 1 < surfaces.size()) {
      i = take_out(end + 1);
      continue;
    }
    in.refuse(
        found.line, "COORDBRK",
        "a tilt or decentre of surface " + std::to_string(found.number) + " that is not undone, or has glass within it",
        "a centred lens, folded only by plane mirrors");
  }
  surfaces = std::move(kept);
}

}  // namespace petzval::formats_detail
