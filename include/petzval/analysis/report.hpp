// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "petzval/analysis/aberrations.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/error.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {

/// First-order data, pupils and aberrations of a lens. Each quantity has a value, or the reason why it cannot be
/// computed.
///
///     const LensReport report = lens_report(lens, {.fields_deg = {0, 14, 20}});
///     if (!report.wavefront) std::cout << report.wavefront.failure;
///     else if (const auto& front = (*report.wavefront)[2][0]) std::cout << front->rms_waves;  // 20 degrees
struct LensReport {
  struct Conditions {
    double subject_z = -std::numeric_limits<double>::infinity();  ///< subject plane (lens frame, mm)
    std::vector<double> fields_deg = {};          ///< field angles towards +y, as in FieldPoint; empty: no fields
    std::vector<double> wavelength_weights = {};  ///< weights of the compiled wavelengths; empty: equal weights
    int first_surface_number = 0;                 ///< number of the first surface in to_json()
    int threads = 1;                              ///< at least 1; the result is the same for every number
    std::optional<double> entrance_pupil_diameter = {};  ///< declared, mm; nullopt: none
  };
  // As Grid, Quantity has no default values.
  /// A value, or the reason why it cannot be computed.
  template <class T>
  struct Quantity {
    std::optional<T> value;
    std::string failure;  ///< empty if there is a value

    explicit operator bool() const noexcept { return value.has_value(); }
    /// @throws Error  with `failure` if there is no value
    const T& operator*() const { return value ? *value : throw Error(failure); }
    const T* operator->() const { return &**this; }
  };
  /// First-order data in one meridian, at the primary wavelength.
  struct Section {
    Meridian meridian = Meridian::y;
    FirstOrder first_order = {};
    Quantity<Pupils> pupils = {};
  };

  Lens lens;
  Conditions conditions = {};
  std::vector<Section> sections = {};  ///< main_meridian() first; the other one only for a lens with cylinders
  Quantity<double> f_number = {};      ///< real_f_number()
  /// The object and the largest field of the conditions, for `paraxial_rays` and `seidel`.
  ParaxialField largest_field = {};
  Quantity<ParaxialRays> paraxial_rays = {};
  Quantity<SeidelSums> seidel = {};  ///< with colour from the shortest to the longest wavelength
  /// The same for the declared entrance pupil; no value and no `failure` if the conditions have no such pupil.
  Quantity<ParaxialRays> paraxial_rays_declared = {};
  Quantity<SeidelSums> seidel_declared = {};
  Quantity<Grid<RayFan>> ray_fans = {};                    ///< [field][wavelength]
  Quantity<std::vector<FieldFocus>> field_curvature = {};  ///< [field]
  Quantity<std::vector<FieldDistortion>> distortion = {};  ///< [field]
  /// [field][wavelength]: 32768 rays each; fewer for lenses of more than 512 surfaces, so that their reports take
  /// seconds. `mtf_over_field` has an eighth of this number.
  Quantity<Grid<Spot>> spots = {};
  Quantity<Grid<MtfPoint>> mtf = {};  ///< [field][frequency]: geometric_mtf() at 0, 5, ... 100 per mm
  Quantity<std::vector<double>> diffraction_limit = {};  ///< [frequency]: of `mtf`, at the primary wavelength
  /// [field][frequency]: at 10, 20 and 40 per mm for eleven fields up to the largest field; empty if all fields are 0.
  Quantity<Grid<MtfPoint>> mtf_over_field = {};
  /// [field][frequency]: diffraction_mtf() at 0, 5, 10, 20, ... 100 per mm.
  Quantity<Grid<MtfPoint>> mtf_diffraction = {};
  /// f-numbers, and diffraction_mtf() at 10, 20, 30 and 40 per mm at the fields of `mtf_over_field`: of the lens, and
  /// of the lens at f/8 on the same film if it is faster; empty if all fields are 0.
  Quantity<std::vector<MtfChart>> mtf_chart = {};
  /// [field][film]: five films, two through_focus_step() to both sides; empty if the spots have no focus.
  Quantity<Grid<ThroughFocusSpot>> through_focus = {};
  /// [field][film]: diffraction_mtf() at 30 per mm on films at mtf_film_shifts(); empty if the spots have no focus.
  Quantity<Grid<MtfPoint>> mtf_through_focus = {};
  Quantity<Grid<EncircledEnergy>> encircled_energy = {};       ///< [field][fraction]: of 0.5, 0.8, 0.9 and 0.95
  Quantity<Grid<AxialRayFocus>> longitudinal_aberration = {};  ///< [wavelength][position on the stop]
  /// [field][wavelength]: shift of Spot::chief_ray_height from the primary wavelength, mm; nullopt: no chief ray.
  Quantity<Grid<std::optional<double>>> lateral_colour = {};
  Quantity<Grid<std::optional<Wavefront>>> wavefront = {};  ///< [field][wavelength]: nullopt if no ray passes
};

/// Computes the report of a focused lens at its compiled wavelengths. This takes up to seconds, without fields
/// milliseconds. If a quantity fails, only quantities that are derived from it fail, too: MTF, through focus, encircled
/// energy and lateral colour are derived from `spots`.
///
/// @throws Error  if `threads` is below 1, a field is not finite, a weight is negative or not finite, or the number of
///                weights differs from the number of compiled wavelengths
PETZVAL_API LensReport lens_report(const Lens& lens, LensReport::Conditions conditions = {});

/// The films of LensReport::mtf_through_focus as shifts towards +z (mm): 21 films with equal distances between the
/// second and the fourth film of `through_focus`; empty without such films.
PETZVAL_API std::vector<double> mtf_film_shifts(const LensReport& report);

/// The report as a JSON object. lib/docs/reports.md lists its keys; `failures` has the reasons for `seidel`,
/// `paraxial_rays` and quantities by exact rays from `ray_fans` on that have no value. Infinite numbers are null.
///
/// @throws Error  if the name of the lens is not UTF-8
PETZVAL_API std::string to_json(const LensReport& report);

}  // namespace petzval
