// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// Diameter of the blur (circle of confusion) of a subject on the film of the lens, as the criterion measures it. For
/// several fields: the root of the weighted mean square (min_rms), or the largest weighted diameter, with the largest
/// weight as 1 (min_max).
///
/// thin, paraxial: D f |U - Uf| / (U (Uf - f)) and its thick counterpart, with the pupil of the marked stop, else of
/// the rim that limits the axial beam. Nothing if no ray passes, and for an afocal lens. Throws Error where solve_focus
/// does, for a subject that is not in front of the lens, and if nothing limits the beam.
PETZVAL_API std::optional<double> blur_diameter(const Lens& lens, double distance, const FocusOptions& options = {});

/// Distances of the nearest and the farthest subject whose blur on the film of the lens does not exceed a diameter. The
/// farthest may be infinite.
struct DepthOfField {
  FocusStatus status = FocusStatus::solved;
  double near_distance = 0;  ///< from the origin of the options, mm
  double far_distance = 0;

  explicit operator bool() const noexcept { return status == FocusStatus::solved; }
};

/// Depth of field about the subject that is in focus on the film of the lens; if there is none, about the one that
/// comes nearest to it (infinity for a film too far in). The blur at the limits is blur_mm within 1e-9 of it, except
/// where the near limit is the front of the lens. Throws Error for a blur_mm that is not a positive length, and where
/// blur_diameter does.
PETZVAL_API DepthOfField depth_of_field(const Lens& lens, double blur_mm, const FocusOptions& options = {});

/// The nearest subject to focus at with infinity blurred by no more than blur_mm, and its film. For a stop of radius 0
/// (paraxially) nearest_focus(). Throws Error where depth_of_field does.
PETZVAL_API FocusSolution hyperfocal(const Lens& lens, double blur_mm, const FocusOptions& options = {});

/// Focus breathing: the relative growth of the image from the film of infinity focus to one at film_z, by the paraxial
/// chief ray through the exit pupil. 0 for lenses telecentric in image space. Nothing if infinity is not in focus on
/// any film, or if that film lies in the exit pupil.
PETZVAL_API std::optional<double> breathing(const Lens& lens, double film_z, const FocusOptions& options = {});

}  // namespace petzval::inline v0
