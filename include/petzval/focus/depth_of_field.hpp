// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// Diameter of the blur (circle of confusion) on the lens's film of a subject at some distance, in the measure of the
/// criterion; several fields: the root of the weighted mean square (min_rms), the largest weighted with the largest
/// weight as 1 (min_max).
///
/// thin, paraxial: D f |U - Uf| / (U (Uf - f)) and its thick counterpart, with the pupil of the marked stop, else of
/// the rim that limits the axial beam. Nothing where no ray gets through and for an afocal lens. Throws Error where
/// solve_focus does, for a subject that is not in front of the lens, and where nothing limits the beam.
PETZVAL_API std::optional<double> blur_diameter(const Lens& lens, double distance_mm, const FocusOptions& options = {});

/// Distances of the nearest and the farthest subject whose blur on the lens's film is no larger than asked for; the
/// farthest may be infinite.
struct DepthOfField {
  FocusStatus status = FocusStatus::solved;
  double near_distance = 0;  ///< from the origin of the options, mm
  double far_distance = 0;

  explicit operator bool() const noexcept { return status == FocusStatus::solved; }
};

/// Depth of field about the subject that is in focus on the lens's film (where none is, about the one that comes
/// nearest: infinity for a film too far in). The limits give back the blur within 1e-9 of it, except where the near one
/// is the front of the lens. Throws Error for a blur that is not a positive length, and where blur_diameter does.
PETZVAL_API DepthOfField depth_of_field(const Lens& lens, double blur_mm, const FocusOptions& options = {});

/// The nearest subject to focus at with infinity still no more blurred than asked for, and its film. With a stop of
/// radius 0 (paraxially) nearest_focus(). Throws Error as depth_of_field.
PETZVAL_API FocusSolution hyperfocal(const Lens& lens, double blur_mm, const FocusOptions& options = {});

/// Focus breathing: how much larger the image is on a film at film_z than on that of infinity focus, as a fraction of
/// it, by the paraxial chief ray through the exit pupil. 0 in image-space telecentric lenses. Nothing where infinity
/// is not in focus on any film, and where that lies in the exit pupil.
PETZVAL_API std::optional<double> breathing(const Lens& lens, double film_z, const FocusOptions& options = {});

}  // namespace petzval::inline v0
