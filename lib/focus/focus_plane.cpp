// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/focus.hpp"

namespace petzval {

std::optional<FocusPlane> focus_plane(const IdealLens& lens, const Film& film) {
  const std::optional<Plane> plane = lens.scene_of(film.plane());
  if (!plane) return {};
  return FocusPlane{*plane, line_at(*plane, lens.front_focal_z), line_at(*plane, lens.front_principal_z())};
}

}  // namespace petzval
