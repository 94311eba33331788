// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

class GlassCatalogue;

/// Source of the indices of media that state both an index and a glass.
///
/// Media without a stated index take the index of the glass.
enum class IndexPolicy {
  printed,    ///< the printed n_d plus n(lambda) - n(d) of the catalogue glass
  catalogue,  ///< the catalogue glass only
};

/// Treatment of a medium that states an index but has no known glass, at wavelengths other than the reference.
enum class MissingGlass {
  error,  ///< throw Error that names the surface and the glass
  abbe,   ///< the n_d/V_d model; without V_d the printed index within 0.05 nm of its line, Error farther away
};

/// Quality of the dispersion data of a lens.
enum class Dispersion {
  catalogue,  ///< every dispersive medium has a catalogue glass
  abbe,       ///< at least one medium has n_d and V_d only
  none        ///< at least one medium has n_d only (valid at the reference wavelength), or no medium is dispersive
};

/// "catalogue", "abbe" or "none".
PETZVAL_API std::string_view name(Dispersion dispersion) noexcept;

/// Options of compile() (pupil/apertures.hpp): glasses, configuration and wavelengths.
struct CompileOptions {
  const GlassCatalogue* glasses = nullptr;  ///< nullptr: glass_tables(), loaded if a medium names a glass
  IndexPolicy index_policy = IndexPolicy::printed;
  MissingGlass missing_glass = MissingGlass::error;
  ConfigurationChoice configuration{};  ///< configuration to compile; default: the first
  /// True: outside the range of a glass, or of the n_d/V_d model (365 to 1014 nm), take the index at the end of the
  /// range instead of throwing Error. Lens::clamped_glasses() lists the surfaces.
  bool clamp_wavelengths = false;
  /// Primary wavelength (nm), a compiled wavelength; nullopt: the default of Lens::primary_wavelength().
  std::optional<double> primary_nm{};
};

/// One surface of a compiled lens. Lengths in mm.
struct LensSurface {
  double vertex_z = 0;   ///< lens frame, mm
  double thickness = 0;  ///< signed distance to the next vertex or the film, mm
  double curvature = 0;  ///< 1/mm
  double conic = 0;
  Section curved_in = Section::both;
  std::vector<AsphereTerm> aspheric;
  /// Clear aperture, mm. Values above 1e15 mm count as infinite (unlimited), values below 1e-12 mm as 0. The aperture
  /// of an asphere ends at the equator of its base conic and at a slope of 4, the aperture of an element at `edge`.
  double semi_diameter = 0;
  /// Height at which the surface meets the surface before or after it, mm; infinite if it meets neither. Beyond the
  /// edge the element, or the air between two elements, has no positive thickness, and no ray passes.
  double edge = std::numeric_limits<double>::infinity();
  double obscuration_semi_diameter = 0;  ///< central obscuration, mm; 0 if there is none
  bool mirror = false;
  /// Semi-diameter that the prescription states, the upper limit of with_semi_diameter(); otherwise infinite.
  double widest_semi_diameter = 0;
  /// Coating that the prescription states, or of with_coating(). Rays ignore it unless transmittance is asked for; then
  /// surfaces without a stated coating are uncoated, and mirrors without one lose no light.
  std::optional<Coating> coating{};
};

/// The thicknesses of a lens with moving groups, focused at one distance.
struct FocusPosition {
  double inverse_distance = 0;      ///< 1 / distance of the subject from the first surface (1/mm); 0 for infinity
  std::vector<double> thicknesses;  ///< of all surfaces, mm

  bool operator==(const FocusPosition&) const = default;
};

/// A compiled lens: always valid, immutable, thread-safe, cheap to copy (one shared pointer).
///
///     petzval::Lens lens = petzval::compile(petzval::read_prescription("data/lenses/double_gauss_100mm_f1.35.json"));
///     auto exit = petzval::trace(lens, petzval::Ray<double>{{0, 10, -50}, {0, 0, 1}});
///
/// Functions that change a lens return a new lens: with_semi_diameter(), with_film(), with_groups_at(), with_iris(),
/// with_coating(), with_f_number(), with_focus().
class PETZVAL_API Lens {
 public:
  /// Copies. A move also copies, so that no Lens is ever empty.
  Lens(const Lens&) = default;
  Lens& operator=(const Lens&) = default;

  const std::string& name() const noexcept;

  /// @name Surfaces, stop and film
  /// @{

  std::span<const LensSurface> surfaces() const noexcept;
  std::size_t surface_count() const noexcept { return surfaces().size(); }

  /// The surface marked as aperture stop (the first if several are marked); nullopt if no surface is marked.
  ///
  /// A marked stop without a rim clips no ray; pupils().stop is the surface that limits the beam.
  std::optional<std::size_t> stop() const noexcept;

  /// The shape of the stop.
  const Iris& iris() const noexcept;

  /// Position of the film (lens frame, mm): from the prescription, or set by with_film().
  double film_z() const noexcept;

  /// Positions of the moving groups, sorted by inverse distance from infinity on; empty if the film moves to focus.
  std::span<const FocusPosition> focus_positions() const noexcept;

  /// @}
  /// @name Wavelengths
  /// @{

  /// The compiled wavelengths, in the order given to compile().
  std::span<const double> wavelengths_nm() const noexcept;
  /// Wavelength index of the primary wavelength, the default of every function.
  ///
  /// The primary wavelength is CompileOptions::primary_nm if set; else the reference wavelength of the prescription if
  /// it was compiled (within 1e-6 nm); else the compiled wavelength nearest to the d line. The order of the compiled
  /// wavelengths does not matter.
  std::size_t primary_wavelength() const noexcept;
  /// Index of a compiled wavelength. Values in nm count as compiled within 1e-6 nm.
  ///
  /// @throws Error with the list of compiled wavelengths if the wavelength was not compiled
  std::size_t wavelength_index(Wavelength wavelength) const;
  /// Index of the compiled wavelength nearest to `nm`.
  ///
  /// @throws Error if `nm` is not finite
  std::size_t nearest_wavelength(double nm) const;
  /// True if rays can be traced at a wavelength: a valid index, or a value in nm within the compiled range.
  ///
  /// The range is extended by the rounding of a float. It is empty if index_error() is infinite.
  bool covers(Wavelength wavelength) const noexcept;

  /// @}
  /// @name Media
  /// @{

  /// Refractive index of the medium before surface `space`.
  ///
  /// @param space       0 is object space, surface_count() is image space
  /// @param wavelength  a wavelength index, or a value in nm within the compiled range
  /// @throws Error if the lens does not have the space or the wavelength
  double index(std::size_t space, Wavelength wavelength = {}) const;
  /// Absorption coefficient (1/mm) of the medium before surface `space`: L mm transmit exp(-absorption L).
  ///
  /// 0 for air and for media without a table of absorption. Tables come from glass files (Glass::absorption). If the
  /// catalogue that a medium names has no table for the glass, an added glass of the same name is used whose n_d is
  /// within 0.002.
  ///
  /// @param space       0 is object space, surface_count() is image space
  /// @param wavelength  a wavelength index, or a value in nm within the compiled range
  /// @throws Error if the lens does not have the space or the wavelength
  double absorption(std::size_t space, Wavelength wavelength = {}) const;
  /// Bound on the error of index() at wavelengths in nm, relative to the dispersion formulas of all media.
  ///
  /// Between compiled wavelengths index() evaluates polynomials of degree 7 in 1 / nm. The bound is their largest error
  /// at their extremes and at the compiled wavelengths, plus 10 %. It depends on the range of the compiled wavelengths,
  /// not on their number or spacing. Infinite if a formula gives no index between compiled wavelengths: the lens then
  /// has the compiled wavelengths only. For clamped glasses the bound refers to the clamped formula, whose kink the
  /// polynomial rounds; clamped indices at compiled wavelengths are exact.
  ///
  /// Accuracy: from 400 to 700 nm below 6e-8 for every lens of data/lenses and 7e-7 for every glass of data/glass
  /// (tests/lens); from 360 to 830 nm below 9e-3 for every clamped glass of data/glass. Rays in float add 2e-7.
  double index_error() const noexcept;
  /// Direction along z of light from the scene in a space: +1, or -1 behind an odd number of mirrors.
  ///
  /// @throws Error if the lens does not have the space
  double light_direction(std::size_t space) const;

  Dispersion dispersion() const noexcept;
  /// One message for each surface whose medium has no catalogue glass, with the reason: no name, a name that is not in
  /// the tables, a different n_d, or missing tables.
  std::span<const std::string> missing_glasses() const noexcept;
  /// One message for each surface whose glass does not cover all compiled wavelengths
  /// (CompileOptions::clamp_wavelengths).
  std::span<const std::string> clamped_glasses() const noexcept;

  /// @}

  /// True if every surface is the same in both sections and the stop is round.
  bool rotationally_symmetric() const noexcept;

  /// The tables of the kernels, for the library's own modules.
  struct Data;
  const Data& data() const noexcept { return *data_; }

 private:
  explicit Lens(std::shared_ptr<const Data> data) noexcept : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

/// The lens with another clear aperture of one surface.
///
/// @param lens           the lens
/// @param surface        the surface, from 0
/// @param semi_diameter  0 or more (mm); the surface passes no ray unless it exceeds the central obscuration
/// @throws Error if the surface does not exist; if `semi_diameter` is negative, NaN or above
///               LensSurface::widest_semi_diameter (a diaphragm cannot open beyond its mount); if it is above 1e15 mm
///               for a stop that is not round
PETZVAL_API Lens with_semi_diameter(const Lens& lens, std::size_t surface, double semi_diameter);

/// The lens with its film at another position.
///
/// @param lens    the lens
/// @param film_z  position of the film (lens frame, mm)
/// @throws Error if `film_z` is not behind the last vertex, in the direction of the light
PETZVAL_API Lens with_film(const Lens& lens, double film_z);

/// The lens with its moving groups and its film set for one subject distance.
///
/// Thicknesses are linear in the inverse distance between adjacent focus positions, and extrapolated beyond the first
/// and the last position.
///
/// @param lens              a lens with focus positions
/// @param inverse_distance  1 / distance of the subject from the first surface (1/mm)
/// @throws Error if the lens has no focus positions; if `inverse_distance` is not finite; if groups would collide: a
///               thickness is negative, but positive at both adjacent focus positions
PETZVAL_API Lens with_groups_at(const Lens& lens, double inverse_distance);

/// The lens with another shape of its stop; Iris{} restores the round stop.
///
/// The iris clips every ray that is traced with apertures, and applies to pupil boundaries, film irradiance, spots,
/// PSFs and cameras. Paraxial pupils and f-numbers refer to the round stop.
///
/// @throws Error if blades, roundness or rotation is out of range; if the iris is not round and the lens has no marked
///               stop, or a stop without a finite semi-diameter
PETZVAL_API Lens with_iris(const Lens& lens, const Iris& iris);

/// The lens with one coating on every surface between air and another medium, instead of the coatings of its surfaces.
///
/// Surfaces between two media other than air are uncoated (cement), and mirrors lose no light. Air is a medium with an
/// index below 1.01.
///
/// @param lens     the lens
/// @param coating  layers from the air to the glass; no layers: uncoated
/// @throws Error   if the coating is invalid
PETZVAL_API Lens with_coating(const Lens& lens, const Coating& coating);

/// Sag of a surface at (x, y): the height along z above the vertex plane (mm).
///
/// Clear apertures are ignored. NaN beyond the equator of a sphere or conic, and if the surface does not exist.
PETZVAL_API double sag(const Lens& lens, std::size_t surface, double x, double y) noexcept;

/// The glass of a medium; nullptr if the medium names no glass or the tables do not contain the name.
///
/// The glass is looked up by name and catalogue, else by name and n_d, else by name (GlassCatalogue::find).
///
/// @throws Error if the medium states neither catalogue nor n_d and the name is ambiguous
PETZVAL_API const Glass* glass_of(const Medium& medium, const GlassCatalogue& glasses);

/// The index of a medium at the reference wavelength of its prescription; nullopt if its glass is in no table.
///
/// The result is 1 for air, the stated index, or the index of the glass.
///
/// @throws Error if the name of the glass is ambiguous, or if its range does not include the wavelength
PETZVAL_API std::optional<double> reference_index(const Medium& medium, const GlassCatalogue& glasses,
                                                  double reference_wavelength_nm);

}  // namespace petzval
