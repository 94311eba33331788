// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// The plane of focus of a film, and the two lines about which the plane rotates.
struct FocusPlane {
  Plane plane;  ///< normal.z >= 0
  /// The plane rotates about `hinge`, in the front focal plane, if the film moves along the axis, and about
  /// `scheimpflug`, in the front principal plane, if the film rotates about the conjugate line. Both are nullopt for an
  /// upright film.
  std::optional<SpaceLine> hinge, scheimpflug;
};
/// The plane of focus of a film; nullopt if the plane is at infinity.
///
/// @throws Error if film.z_mm is not set
PETZVAL_API std::optional<FocusPlane> focus_plane(const IdealLens& lens, const Film& film);

}  // namespace petzval
