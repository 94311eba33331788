// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus_plane.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// Sharpness against film position, as SVG text: the RMS spot radius of each field and of all fields together, over the
/// distance of the film from the paraxial focus. Lines mark the paraxial focus, the film, and the minima of the axial
/// spot and of all fields; the numbers are printed below.
///
/// RMS radii are about the centroid, over all compiled wavelengths and the vignetted pupil by area. Their square is a
/// parabola in the film position, found from three positions. The same lens gives the same bytes.
///
/// @param subject_z           lens frame, mm, -inf at infinity
/// @param wavelength_weights  one per compiled wavelength, by the light in it; empty: equal weights
/// @throws Error  where pupil_boundary does, for no fields, and for weights that are not one per wavelength, below 0,
///                or all 0
PETZVAL_API std::string focus_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                     std::span<const double> wavelength_weights = {});

/// A film and the subject in focus at one time.
struct FocusPullFrame {
  double time = 0;              ///< s
  Film film;                    ///< z_mm is set
  double subject_distance = 0;  ///< on the axis, mm, > 0; may be infinite
  double rms_mm = 0;            ///< blur of the focus points; NaN where none was used and the film stayed
};

/// Focus over time, as SVG text: the subject distance (on a scale of 1/distance, which shows infinity), the film
/// position, the RMS blur of the focus points, and tilt and swing where the film has any. Vertical lines mark the keys;
/// curves are grey where the film stayed.
///
/// @param title          the lens's name
/// @param remark         a line about the conditions
/// @param frames         in the order of time
/// @param distance_from  origin of the subject distances, in words
/// @throws Error  for no frames and for invalid numbers
PETZVAL_API std::string focus_pull_figure(std::string_view title, std::string_view remark,
                                          std::span<const FocusPullFrame> frames, std::span<const double> key_times,
                                          std::string_view distance_from = "front vertex");

/// A focus point in the figure; a point that the fit did not use is drawn hollow.
struct TiltFigurePoint {
  ScenePoint place;
  bool used = true;
};

/// A film before and after a tilt, with its focus points.
struct TiltView {
  std::string_view title;       ///< the lens's name
  std::string_view remark;      ///< a line about the conditions
  IdealLens lens;               ///< its planes and lines are drawn
  const Lens* glass = nullptr;  ///< drawn as a section; a double arrow without it
  Film before, after;           ///< with their places; before upright
  /// The plane of focus, where it is not that of `lens`: exact rays put the film elsewhere. Unset: that of `lens`.
  std::optional<FocusPlane> focus = {};
  double blur_mm = 0.03;  ///< largest blur that counts as sharp, > 0
  std::span<const TiltFigurePoint> points;
};

/// Film, lens and plane of focus from the side, as SVG text: the section through the axis and the normal of the plane
/// of focus, in which the hinge line and the Scheimpflug line are points. The scene is drawn above, lens and film
/// below, each to scale. Focus points are projected along the hinge line and numbered from 1.
///
/// The region that is sharp within blur_mm is a wedge with its edge on the hinge line, by the blur that signed_blur()
/// gives. Throws Error for films that are not finite or have no place or size, and a blur that is not above 0.
PETZVAL_API std::string tilt_figure(const TiltView& view);

/// A focal surface in front of its lens.
struct FocalSurfaceView {
  std::string_view title;   ///< the lens's name
  std::string_view remark;  ///< a line about the conditions
  IdealLens lens;           ///< with the entrance pupil that the surface has
  Film film;                ///< with its place
  const FocalSurface& surface;
  std::span<const FocalPoint> points;
};

/// Film, lens and focal surface in section through the axis, as SVG text: from the side and from above, to scale except
/// where lens and film would be too small to see, with the edges of what the film sees. Focus points are projected into
/// both and numbered from 1, at their own distances, hollow where they have a blur; those at infinity and those that
/// fix the extent alone are left out. The panels reach a quarter beyond the farthest sharp point that is not at
/// infinity.
/// Throws Error for a film that has no place or size.
PETZVAL_API std::string focal_surface_figure(const FocalSurfaceView& view);

}  // namespace petzval
