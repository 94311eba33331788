// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "petzval/analysis/spot.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// Draws sharpness against film position as SVG text.
///
/// Plots the RMS spot radius of each field and of all fields together over the distance of the film from the paraxial
/// focus. Lines mark the paraxial focus, the film, and the minima of the axial spot and of all fields; the numbers are
/// printed below. RMS radii are about the centroid, over all compiled wavelengths and the area of the vignetted pupil.
/// Their square is a parabola in the film position, by the slopes of the rays. The output is deterministic.
///
/// @param lens                the lens
/// @param subject_z           subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad          field angles (rad)
/// @param wavelength_weights  one weight per compiled wavelength; empty: equal weights
/// @throws Error              if there are no fields, or the weights are negative, all 0 or of the wrong number; also
///                            under the conditions of scene_point()
PETZVAL_API std::string focus_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                     std::span<const double> wavelength_weights = {});
/// The same for the rays of spot_diagram(); the axis is traced if it is not among the fields.
PETZVAL_API std::string focus_figure(const Lens& lens, std::span<const Spot> spots,
                                     std::span<const double> wavelength_weights = {});

/// A film and the subject in focus at one time.
struct FocusPullFrame {
  double time = 0;              ///< s
  Film film;                    ///< z_mm must be set
  double subject_distance = 0;  ///< on the axis, mm, > 0; may be infinite
  double rms_mm = 0;            ///< RMS blur of the focus points; NaN if no point was used and the film did not move
};

/// Draws focus over time as SVG text.
///
/// Plots the subject distance on a scale of 1/distance that includes infinity, the film position, the RMS blur of the
/// focus points, and tilt and swing if the film has any. Vertical lines mark the keys. Curves are grey where the film
/// did not move.
///
/// @param title          name of the lens
/// @param remark         a line about the conditions
/// @param frames         in ascending order of time
/// @param key_times      times of the keys (s)
/// @param distance_from  name of the origin of the subject distances
/// @throws Error         if there are no frames, or a number is invalid
PETZVAL_API std::string focus_pull_figure(std::string_view title, std::string_view remark,
                                          std::span<const FocusPullFrame> frames, std::span<const double> key_times,
                                          std::string_view distance_from = "front vertex");

/// A focus point in the figure; unused points are drawn hollow.
struct TiltFigurePoint {
  ScenePoint point;
  bool used = true;
};

/// A film before and after a tilt, with its focus points.
struct TiltView {
  std::string_view title;       ///< name of the lens
  std::string_view remark;      ///< a line about the conditions
  IdealLens lens;               ///< source of the cardinal planes and lines
  const Lens* glass = nullptr;  ///< drawn as a section; null: a double arrow is drawn
  Film before, after;           ///< z_mm must be set; `before` is upright
  /// The plane of focus, if it differs from the plane of `lens`, as for films fitted with exact rays.
  std::optional<FocusPlane> focus = {};
  double blur_mm = 0.03;  ///< largest blur that counts as sharp, > 0
  std::span<const TiltFigurePoint> points;
};

/// Draws film, lens and plane of focus from the side as SVG text.
///
/// The section contains the axis and the normal of the plane of focus; the hinge line and the Scheimpflug line appear
/// as points. The scene is drawn above, lens and film below, each to scale. Focus points are projected along the hinge
/// line and numbered from 1. The region with a signed_blur() within blur_mm is a wedge with its edge on the hinge line.
///
/// @throws Error if a film is not finite or has no position or size, or `blur_mm` is not positive
PETZVAL_API std::string tilt_figure(const TiltView& view);

/// A focal surface in front of its lens.
struct FocalSurfaceView {
  std::string_view title;   ///< name of the lens
  std::string_view remark;  ///< a line about the conditions
  IdealLens lens;           ///< with the entrance pupil of the surface
  Film film;                ///< z_mm must be set
  const FocalSurface& surface;
  std::span<const FocalPoint> points;
};

/// Draws film, lens and focal surface from the side and from above as SVG text.
///
/// Both sections contain the axis and show the edges of the field. They are to scale, unless lens and film would be too
/// small to see. Focus points are projected into both and numbered from 1, at their true distances; points with a blur
/// are hollow. Points at infinity and points that fix only the extent are left out. The panels extend a quarter beyond
/// the farthest sharp point at a finite distance.
///
/// @throws Error if the film has no position or size
PETZVAL_API std::string focal_surface_figure(const FocalSurfaceView& view);

}  // namespace petzval
