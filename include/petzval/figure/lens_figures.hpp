// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "petzval/analysis/aberrations.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {

/// Draws a scaled section of a lens through the axis as SVG text: light from left to right, +y up.
///
/// Glass is filled, darker for a higher index; mirrors are thick lines; central holes stay open. Two ticks mark the rim
/// of the stop. They are dashed if the lens has no marked stop and the surface that limits the axial beam is used
/// instead. A line shows the film. The rays of a field have one colour and cross its vignetted pupil from edge to edge,
/// including the chief ray. Vignetted rays through the rim or the centre of the stop are thin and end at the surface
/// that clips the ray. Surfaces without a rim are drawn up to the outermost ray. The output is deterministic.
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

/// Draws the vignetted pupil of each field at the primary wavelength as SVG text.
///
/// A cell shows the transmitting region of the pupil plane, its boundary with one colour per limiting surface, and the
/// paraxial entrance pupil dashed. All cells have the same scale, x to the right and +y up. The area relative to the
/// axis and the relative illumination are printed below. If the pupil is far from the paraxial pupil, the cell shows
/// the pupil only and prints the distance. The output is deterministic.
///
/// @param lens        the lens
/// @param subject_z   subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad  field angles (rad)
/// @param first_surface_number  number of the first surface in the legend, as in layout_figure()
/// @throws Error      if there are no fields; also under the conditions of scene_point()
PETZVAL_API std::string footprint_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                         int first_surface_number = 0);

/// Draws relative illumination against field angle at the primary wavelength, with cos^4 for comparison, as SVG text.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param field_rad  largest field angle (rad)
/// @throws Error     if the field is not positive; also under the conditions of relative_illumination()
PETZVAL_API std::string illumination_figure(const Lens& lens, double subject_z, double field_rad);

/// Draws transmittance over wavelength as SVG text: a colour for each field. Fields from which no ray passes have no
/// curve.
///
/// @param lens       the lens, compiled for two or more wavelengths
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param points     transmittance() of this lens
/// @throws Error     if there are no points, less than two wavelengths, or not one point per wavelength and field
PETZVAL_API std::string transmittance_figure(const Lens& lens, double subject_z,
                                             std::span<const FieldTransmittance> points);

/// Draws transmittance over the field as SVG text: a colour for each wavelength. Fields from which no ray passes
/// interrupt the curves.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param points     transmittance() of this lens for ascending fields
/// @throws Error     if there are less than two fields, or not one point per wavelength and field
PETZVAL_API std::string transmittance_field_figure(const Lens& lens, double subject_z,
                                                   std::span<const FieldTransmittance> points);

/// Draws ray fans as SVG text: a row for each field, tangential on the left, sagittal on the right, a colour for each
/// wavelength. All cells have the same scale.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param fans       ray_fans() of this lens
/// @throws Error     if there are no fans, or their number is not a multiple of the number of wavelengths
PETZVAL_API std::string fan_figure(const Lens& lens, double subject_z, std::span<const RayFan> fans);

/// Draws the wavefront errors of the same fans in waves.
///
/// @param lens, subject_z, fans  as in fan_figure()
/// @throws Error                 as fan_figure()
PETZVAL_API std::string wavefront_figure(const Lens& lens, double subject_z, std::span<const RayFan> fans);

/// Draws field_curvature() and distortion_percent() against field angle at the primary wavelength as SVG text.
/// Distortion is relative to f tan(theta), or to f theta if the field exceeds 60 degrees.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param field_rad  largest field angle (rad)
/// @throws Error     if the field is not positive; also under the conditions of aim()
PETZVAL_API std::string field_figure(const Lens& lens, double subject_z, double field_rad);

/// Draws geometric MTF over frequency as SVG text: a colour for each field, tangential solid, sagittal dashed, with the
/// diffraction limit of the axis at the primary wavelength.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param points     geometric_mtf() of this lens
/// @throws Error     if there are no points
PETZVAL_API std::string mtf_figure(const Lens& lens, double subject_z, std::span<const MtfPoint> points);

/// Draws geometric MTF over the field as SVG text: a colour for each frequency, tangential solid, sagittal dashed.
/// Fields from which no ray passes interrupt the curves.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param points     geometric_mtf() of several fields
/// @throws Error     if there are less than two fields
PETZVAL_API std::string mtf_field_figure(const Lens& lens, double subject_z, std::span<const MtfPoint> points);

/// Draws geometric encircled energy as SVG text: the fraction of the rays over the radius, a colour for each field. A
/// line marks the Airy radius at the primary wavelength.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param points     encircled_energy() of this lens, with ascending fractions
/// @throws Error     if there are no points
PETZVAL_API std::string energy_figure(const Lens& lens, double subject_z, std::span<const EncircledEnergy> points);

/// Draws colour as SVG text: longitudinal_aberration() of every wavelength over the height on the stop, and lateral
/// colour of chromatic_aberration() over the field, unless there is one wavelength or the field is 0.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param field_rad  largest field angle (rad)
/// @throws Error     if the field is negative; also under the conditions of aim() and chromatic_aberration()
PETZVAL_API std::string colour_figure(const Lens& lens, double subject_z, double field_rad);

/// Draws Seidel sums as SVG text: bars of S1 to S5 and of C1 and C2 for each surface, and their sums on the right.
///
/// @param lens       the lens
/// @param subject_z  subject plane (lens frame, mm); -inf at infinity
/// @param sums       seidel_sums() of this lens
/// @param first_surface_number  number of the first surface on the axis, as in layout_figure()
/// @throws Error     if the sums have another number of surfaces than the lens
PETZVAL_API std::string seidel_figure(const Lens& lens, double subject_z, const SeidelSums& sums,
                                      int first_surface_number = 0);

/// Draws a spot diagram as SVG text: one row per field, with a column for all wavelengths and one per wavelength.
///
/// All cells have the same scale, shown by a bar; +y is up. The origin of a row is the centroid of all its rays, so
/// that its cells show lateral colour. Below each cell, the RMS and largest radius about the centroid of its rays are
/// printed. The dashed Airy circle has the radius 1.22 wavelength N, with the paraxial image-side f-number N. The first
/// 600 rays of a spot are drawn. The output is deterministic.
///
/// @param lens                the lens
/// @param spots               result of spot_diagram() for this lens
/// @param wavelength_weights  weights of the compiled wavelengths in the column of all wavelengths; empty: equal
///                            weights
/// @throws Error              if there are no spots or a wrong number of spots, or if the weights are negative, all 0
///                            or of the wrong number
PETZVAL_API std::string spot_figure(const Lens& lens, std::span<const Spot> spots,
                                    std::span<const double> wavelength_weights = {});

/// Draws spots on moved films as SVG text: one row per field, one column per film.
///
/// All cells have the same scale, shown by a bar; +y is up. The origin of a cell is the centroid of its rays; their RMS
/// radius about it is printed below. The first 200 rays of a spot are drawn. The output is deterministic.
///
/// @param lens                the lens
/// @param spots               result of spot_diagram() for this lens
/// @param film_shifts_mm      shifts of the film towards +z (mm), for example multiples of through_focus_step()
/// @param wavelength_weights  weights of the compiled wavelengths; empty: equal weights
/// @throws Error              if there are no spots or no films; also under the conditions of through_focus()
PETZVAL_API std::string through_focus_figure(const Lens& lens, std::span<const Spot> spots,
                                             std::span<const double> film_shifts_mm,
                                             std::span<const double> wavelength_weights = {});

/// A model in the figure.
struct ParetoPoint {
  std::string_view name;
  double ns_per_ray = 0;
  double max_um = 0, rms_um = 0;  ///< errors on the film; 0: exact
  bool on_front = false;          ///< true if no other model is both faster and more accurate
};

/// Draws accuracy against cost of models as SVG text.
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

}  // namespace petzval
