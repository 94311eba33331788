// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// The plane of the scene that is in focus on a film, and the two lines about which it turns: the hinge line, in the
/// front focal plane, when the film moves along the axis; the Scheimpflug line, in the front principal plane, when the
/// film turns about the conjugate line. Upright films have no lines.
struct FocusPlane {
  Plane plane;  ///< normal.z >= 0
  std::optional<SpaceLine> hinge, scheimpflug;
};
/// Nothing for a film whose plane of focus is at infinity. Throws Error for a film without a place.
PETZVAL_API std::optional<FocusPlane> focus_plane(const IdealLens& lens, const Film& film);

}  // namespace petzval
