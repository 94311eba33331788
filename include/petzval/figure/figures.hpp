// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "petzval/analysis/aberrations.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

// Figures as SVG text. Equal input gives equal text.

namespace petzval {

/// Draws a scaled section of a lens through the axis: light from left to right, +y up.
///
/// Glass is filled, darker for a higher index; mirrors are thick lines; central holes stay open. Two ticks mark the rim
/// of the stop. They are dashed if the lens has no marked stop and the surface that limits the axial beam is used
/// instead. A line shows the film. The rays of a field have one colour and cross its vignetted pupil from edge to edge,
/// including the chief ray. Vignetted rays through the rim or the centre of the stop are thin and end at the surface
/// that clips the ray. Surfaces without a rim are drawn up to the outermost ray.
///
/// @param lens        the lens
/// @param subject_z   subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles (rad), also 90 degrees or more; empty: no rays are drawn
/// @param section     the plane of the drawing and of the fields
/// @param rays        transmitted rays per field, 3 to 7
/// @param first_surface_number  number of the first surface in the legend; patents count from 1
/// @throws Error      if the number of rays is not 3 to 7; also under the conditions of aim()
PETZVAL_API std::string layout_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                      Meridian section = Meridian::y, std::size_t rays = 5,
                                      int first_surface_number = 0);

/// Draws the lens as layout_figure(), with rays of a light that pairs of surfaces send to the film as ghosts.
///
/// @param lens, subject_z  as in layout_figure()
/// @param field_rad  field angle of the light in the section (rad)
/// @param pairs      of ghost_pairs(); each has a colour. At most 3 rays of each are drawn
/// @throws Error     under the conditions of scene_point()
PETZVAL_API std::string ghost_figure(const Lens& lens, double subject_z, double field_rad,
                                     std::span<const GhostPair> pairs, Meridian section = Meridian::y,
                                     int first_surface_number = 0);

/// Draws the vignetted pupil of each field at the primary wavelength.
///
/// A cell shows the transmitting region of the pupil plane, its boundary with one colour per limiting surface, and the
/// paraxial entrance pupil dashed. All cells have the same scale, x to the right and +y up. The area relative to the
/// axis and the relative illumination are printed below. If the pupil is far from the paraxial pupil, the cell shows
/// the pupil only and prints the distance.
///
/// @param lens, subject_z  as in layout_figure()
/// @param fields_rad  field angles (rad)
/// @param first_surface_number  number of the first surface in the legend, as in layout_figure()
/// @throws Error      if there are no fields; also under the conditions of scene_point()
PETZVAL_API std::string footprint_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                         int first_surface_number = 0);

/// Draws relative illumination against field angle at the primary wavelength, with cos^4 for comparison.
///
/// @param lens, subject_z  as in layout_figure()
/// @param field_rad  largest field angle (rad)
/// @throws Error     if the field is not positive; also under the conditions of relative_illumination()
PETZVAL_API std::string illumination_figure(const Lens& lens, double subject_z, double field_rad);

/// Draws transmittance over wavelength: a colour for each field. Fields from which no ray passes have no
/// curve.
///
/// @param lens, subject_z  as in layout_figure(); two or more compiled wavelengths
/// @param fields_rad  the fields
/// @param values      transmittance() of this lens at these fields
/// @throws Error      if there are no fields, less than two wavelengths, or not one value per wavelength and field
PETZVAL_API std::string transmittance_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                             const Grid<std::optional<double>>& values);

/// Draws transmittance over the field: a colour for each wavelength. Fields from which no ray passes
/// interrupt the curves.
///
/// @param lens, subject_z, fields_rad, values  as in transmittance_figure(); fields ascend
/// @throws Error  if there are less than two fields, or not one value per wavelength and field
PETZVAL_API std::string transmittance_field_figure(const Lens& lens, double subject_z,
                                                   std::span<const double> fields_rad,
                                                   const Grid<std::optional<double>>& values);

/// Draws ray fans: a row for each field, tangential on the left, sagittal on the right, a colour for each
/// wavelength. All cells have the same scale.
///
/// @param lens, subject_z  as in layout_figure()
/// @param fans       ray_fans() of this lens
/// @throws Error     if there are no fans, or fans of another number of wavelengths
PETZVAL_API std::string fan_figure(const Lens& lens, double subject_z, const Grid<RayFan>& fans);

/// Draws the wavefront errors of the same fans in waves.
///
/// @param lens, subject_z, fans  as in fan_figure()
/// @throws Error                 as fan_figure()
PETZVAL_API std::string wavefront_figure(const Lens& lens, double subject_z, const Grid<RayFan>& fans);

/// Draws field_curvature() and distortion_percent() against field angle at the primary wavelength.
/// Distortion is relative to f tan(theta), or to f theta if the field exceeds 60 degrees.
///
/// @param lens, subject_z  as in layout_figure()
/// @param field_rad  largest field angle (rad)
/// @throws Error     if the field is not positive; also under the conditions of aim()
PETZVAL_API std::string field_figure(const Lens& lens, double subject_z, double field_rad);

/// Draws MTF over frequency: a colour for each field, tangential solid, sagittal dashed, with the diffraction limit of
/// the axis at the primary wavelength.
///
/// @param lens, subject_z  as in layout_figure()
/// @param points       geometric_mtf() of this lens
/// @param diffraction  diffraction_mtf() of the same fields: the curves, with the limits of the vignetted pupils in
///                     grey; `points` become thin curves. Empty: `points` only
/// @throws Error     if there are no points
PETZVAL_API std::string mtf_figure(const Lens& lens, double subject_z, const Grid<MtfPoint>& points,
                                   const Grid<MtfPoint>& diffraction = {{}, 1});

/// Draws an MTF chart as makers print it: contrast over image height (mm) in a cell for each f-number, a colour for
/// each frequency, tangential solid, sagittal dashed. Heights from which no ray passes interrupt the curves.
///
/// @param lens, subject_z     as in layout_figure()
/// @param charts              f-numbers, and diffraction_mtf() at the same fields and frequencies
/// @param wavelength_weights  weights of the compiled wavelengths, stated below; empty: equal weights
/// @throws Error              if there are no charts, or less than two fields
PETZVAL_API std::string mtf_chart_figure(const Lens& lens, double subject_z, std::span<const MtfChart> charts,
                                         std::span<const double> wavelength_weights = {});

/// Draws geometric MTF over the field: a colour for each frequency, tangential solid, sagittal dashed.
/// Fields from which no ray passes interrupt the curves.
///
/// @param lens, subject_z  as in layout_figure()
/// @param points     geometric_mtf() of several fields
/// @throws Error     if there are less than two fields
PETZVAL_API std::string mtf_field_figure(const Lens& lens, double subject_z, const Grid<MtfPoint>& points);

/// Draws contrast through focus: a colour for each field, tangential solid, sagittal dashed.
///
/// @param lens, subject_z  as in layout_figure()
/// @param film_shifts_mm   shifts of the film towards +z, in order (mm)
/// @param points           diffraction_mtf() at one frequency: [field][shift]
/// @throws Error           if there are less than two shifts, or their number differs from the number of points
PETZVAL_API std::string mtf_focus_figure(const Lens& lens, double subject_z, std::span<const double> film_shifts_mm,
                                         const Grid<MtfPoint>& points);

/// Draws geometric encircled energy: the fraction of the rays over the radius, a colour for each field. A
/// line marks the Airy radius at the primary wavelength.
///
/// @param lens, subject_z  as in layout_figure()
/// @param points     encircled_energy() of this lens, with ascending fractions
/// @throws Error     if there are no points
PETZVAL_API std::string energy_figure(const Lens& lens, double subject_z, const Grid<EncircledEnergy>& points);

/// Draws colour: longitudinal_aberration() of every wavelength over the height on the stop, and lateral
/// colour of chromatic_aberration() over the field, unless there is one wavelength or the field is 0.
///
/// @param lens, subject_z  as in layout_figure()
/// @param field_rad  largest field angle (rad)
/// @throws Error     if the field is negative; also under the conditions of aim() and chromatic_aberration()
PETZVAL_API std::string colour_figure(const Lens& lens, double subject_z, double field_rad);

/// Draws Seidel sums: bars of S1 to S5 and of C1 and C2 for each surface, and their sums on the right.
///
/// @param lens, subject_z  as in layout_figure()
/// @param sums       seidel_sums() of this lens
/// @param first_surface_number  number of the first surface on the axis, as in layout_figure()
/// @throws Error     if the sums have another number of surfaces than the lens
PETZVAL_API std::string seidel_figure(const Lens& lens, double subject_z, const SeidelSums& sums,
                                      int first_surface_number = 0);

/// Draws a spot diagram: one row per field, with a column for all wavelengths and one per wavelength.
///
/// All cells have the same scale, shown by a bar; +y is up. The origin of a row is the centroid of all its rays, so
/// that its cells show lateral colour. Below each cell, the RMS and largest radius about the centroid of its rays are
/// printed. The dashed Airy circle has the radius 1.22 wavelength N, with the paraxial image-side f-number N. The first
/// 600 rays of a spot are drawn.
///
/// @param lens                the lens
/// @param spots               result of spot_diagram() for this lens
/// @param wavelength_weights  weights of the compiled wavelengths in the column of all wavelengths; empty: equal
///                            weights
/// @throws Error              if there are no spots or a wrong number of spots, or if the weights are negative, all 0
///                            or of the wrong number
PETZVAL_API std::string spot_figure(const Lens& lens, const Grid<Spot>& spots,
                                    std::span<const double> wavelength_weights = {});

/// Draws spots on moved films: one row per field, one column per film.
///
/// All cells have the same scale, shown by a bar; +y is up. The origin of a cell is the centroid of its rays; their RMS
/// radius about it is printed below. The first 200 rays of a spot are drawn.
///
/// @param lens                the lens
/// @param spots               result of spot_diagram() for this lens
/// @param film_shifts_mm      shifts of the film towards +z (mm), for example multiples of through_focus_step()
/// @param wavelength_weights  weights of the compiled wavelengths; empty: equal weights
/// @throws Error              if there are no spots or no films; also under the conditions of through_focus()
PETZVAL_API std::string through_focus_figure(const Lens& lens, const Grid<Spot>& spots,
                                             std::span<const double> film_shifts_mm,
                                             std::span<const double> wavelength_weights = {});

/// A model in the figure.
struct ParetoPoint {
  std::string_view name;
  double ns_per_ray = 0;
  double max_um = 0, rms_um = 0;  ///< errors on the film; 0: exact
  bool on_front = false;          ///< true if no other model is both faster and more accurate
};

/// Draws accuracy against cost of models.
///
/// Plots largest and RMS error on the film over ns per ray on logarithmic axes. Models on the Pareto front are filled
/// and joined by a line. Errors of 0 are drawn at the bottom.
///
/// @param title   name of the lens
/// @param remark  a line about the conditions
/// @param points  the models
/// @throws Error  if there are no points, a time is not positive and finite, or an error is negative or not finite
PETZVAL_API std::string pareto_figure(std::string_view title, std::string_view remark,
                                      std::span<const ParetoPoint> points);

/// Draws sharpness against film position.
///
/// Plots the RMS spot radius of each field and of all fields together over the distance of the film from the paraxial
/// focus. Lines mark the paraxial focus, the film, and the minima of the axial spot and of all fields; the numbers are
/// printed below. RMS radii are about the centroid, over all compiled wavelengths and the area of the vignetted pupil.
/// Their square is a parabola in the film position, by the slopes of the rays.
///
/// @param lens, subject_z  as in layout_figure()
/// @param fields_rad          field angles (rad)
/// @param wavelength_weights  one weight per compiled wavelength; empty: equal weights
/// @throws Error              if there are no fields, or the weights are negative, all 0 or of the wrong number; also
///                            under the conditions of scene_point()
PETZVAL_API std::string focus_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                     std::span<const double> wavelength_weights = {});
/// The same for the rays of spot_diagram(); the axis is traced if it is not among the fields.
PETZVAL_API std::string focus_figure(const Lens& lens, const Grid<Spot>& spots,
                                     std::span<const double> wavelength_weights = {});

/// A film and the subject in focus at one time.
struct FocusPullFrame {
  double time = 0;              ///< s
  Film film;                    ///< z_mm must be set
  double subject_distance = 0;  ///< on the axis, mm, > 0; may be infinite
  double rms_mm = 0;            ///< RMS blur of the focus points; NaN if no point was used and the film did not move
};

/// Draws focus over time.
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

/// A film before and after a tilt, with its focus points.
struct TiltView {
  std::string_view title;       ///< name of the lens
  std::string_view remark;      ///< a line about the conditions
  IdealLens lens;               ///< source of the cardinal planes and lines
  const Lens* glass = nullptr;  ///< drawn as a section; null: a double arrow is drawn
  Film before, after;           ///< z_mm must be set; `before` is upright
  /// The plane of focus, if it differs from the plane of `lens`, as for films fitted with exact rays.
  std::optional<FocusPlane> focus = {};
  double blur_mm = 0.03;                ///< largest blur that counts as sharp, > 0
  std::span<const FocusTarget> points;  ///< focus points; those of weight 0 are drawn hollow
};

/// Draws film, lens and plane of focus from the side.
///
/// The section contains the axis and the normal of the plane of focus; the hinge line and the Scheimpflug line appear
/// as points. The scene is drawn above, lens and film below, each to scale. Focus points are projected along the hinge
/// line and numbered from 1. The region with a signed_blur() within blur_mm is a wedge with its edge on the hinge line.
///
/// @throws Error if a film is not finite or has no position or size, or `blur_mm` is not positive
PETZVAL_API std::string tilt_figure(const TiltView& view);

/// Draws film, lens and focal surface from the side and from above.
///
/// Both sections contain the axis and show the edges of the field. They are to scale, unless lens and film would be too
/// small to see. Focus points are projected into both and numbered from 1, at their true distances; points with a blur
/// are hollow. Points at infinity and points that fix only the extent are left out. The panels extend a quarter beyond
/// the farthest sharp point at a finite distance.
///
/// @param title    name of the lens
/// @param remark   a line about the conditions
/// @param lens     the lens with the entrance pupil of the surface
/// @param film     the film; z_mm must be set
/// @param surface  the focal surface
/// @param points   its points
/// @throws Error   if the film has no position or size
PETZVAL_API std::string focal_surface_figure(std::string_view title, std::string_view remark, const IdealLens& lens,
                                             const Film& film, const FocalSurface& surface,
                                             std::span<const FocalPoint> points);

}  // namespace petzval
