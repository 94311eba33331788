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

#include "petzval/core/export.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

class GlassCatalogue;

/// Source of the indices of media that state both an index and a glass. The formula of the glass applies to media
/// without a stated index.
enum class IndexPolicy {
  printed,    ///< the printed n_d plus n(lambda) - n(d) of the catalogue glass: at d the printed index
  catalogue,  ///< the catalogue glass alone
};

/// Index of a medium that states an index, but whose glass is in no table, at wavelengths other than the reference.
enum class MissingGlass {
  error,  ///< throw Error naming the surface and the glass
  abbe,   ///< the n_d/V_d model; without V_d the printed index within 0.05 nm of its line, else Error
};

/// How well the dispersion of a lens is known: every medium has a catalogue glass; at least one has n_d and V_d only;
/// at least one has n_d only (the lens can be used at the reference wavelength alone), or no medium disperses.
enum class Dispersion { catalogue, abbe, none };

/// "catalogue", "abbe" or "none".
PETZVAL_API std::string_view name(Dispersion dispersion) noexcept;

struct CompileOptions {
  const GlassCatalogue* glasses = nullptr;  ///< null: glass_tables(), loaded if a medium names a glass
  IndexPolicy index_policy = IndexPolicy::printed;
  MissingGlass missing_glass = MissingGlass::error;
  ConfigurationChoice configuration{};  ///< of a prescription with configurations: its first one
  /// Beyond the range of a glass, or of the n_d/V_d model (365 to 1014 nm), take the index at the end of the range
  /// instead of an Error: Lens::clamped_glasses() lists the surfaces.
  bool clamp_wavelengths = false;
  /// Lens::primary_wavelength in nm, one of the compiled wavelengths; nullopt: the default of primary_wavelength().
  std::optional<double> primary_nm{};
};

/// One surface of a compiled lens, in double. Millimetres. Curvature, never radius.
struct LensSurface {
  double vertex_z = 0;   ///< lens frame, mm
  double thickness = 0;  ///< signed, to the next vertex or the film
  double curvature = 0;  ///< 1/mm
  double conic = 0;
  Section curved_in = Section::both;
  std::vector<AsphereTerm> aspheric;
  /// Clear aperture. Infinite: unlimited, as beyond 1e15 mm; 0 below 1e-12 mm. The aperture of an asphere ends with the
  /// base conic and at a slope of 4, the aperture of an element at `edge`.
  double semi_diameter = 0;
  /// Height at which the surface meets the one before or behind it (infinite if it meets neither): beyond it the
  /// element, or the air between two elements, has no positive thickness, and no ray passes.
  double edge = std::numeric_limits<double>::infinity();
  double obscuration_semi_diameter = 0;  ///< of the central obscuration; 0: none
  bool mirror = false;
  /// Semi-diameter of the prescription, the upper limit of with_semi_diameter(); infinite if the row has none.
  double widest_semi_diameter = 0;
};

/// The thicknesses of a lens whose groups move, focused at one distance.
struct FocusPosition {
  double inverse_distance = 0;  ///< 1 / mm, of the subject from the first surface; 0: infinity
  std::vector<double> thicknesses;

  bool operator==(const FocusPosition&) const = default;
};

/// A compiled lens: always valid, immutable, cheap to copy (one shared pointer), free to share between threads.
///
///     petzval::Lens lens = petzval::compile(petzval::read_prescription("data/lenses/double_gauss_100mm_f1.35.json"));
///     auto exit = petzval::trace(lens, petzval::Ray<double>{{0, 10, -50}, {0, 0, 1}});
///
/// A change makes a new lens: `with_semi_diameter`, `with_film`, `with_groups_at`, `with_iris`, `with_f_number`,
/// `with_focus`.
class PETZVAL_API Lens {
 public:
  /// Copies. Moves copy too, so that no Lens is ever empty.
  Lens(const Lens&) = default;
  Lens& operator=(const Lens&) = default;

  const std::string& name() const noexcept;

  std::span<const LensSurface> surfaces() const noexcept;
  std::size_t surface_count() const noexcept { return surfaces().size(); }

  /// The surface marked as aperture stop (the first one if two are marked). It may lack a rim, and stops no ray then:
  /// pupils().stop is the surface that limits the beam.
  std::optional<std::size_t> stop() const noexcept;

  /// The shape of the stop.
  const Iris& iris() const noexcept;

  /// Place of the film (lens frame, mm): the prescription's or that of `with_film`.
  double film_z() const noexcept;

  /// How the groups move to focus: positions by inverse distance, the first at infinity. Empty if the film moves.
  std::span<const FocusPosition> focus_positions() const noexcept;

  /// Wavelengths the lens was compiled for.
  std::span<const double> wavelengths_nm() const noexcept;
  /// Position of the wavelength at which every function works unless told otherwise: CompileOptions::primary_nm, else
  /// the reference wavelength of the prescription if it was compiled (within 1e-6 nm), else the compiled one nearest to
  /// the d line. It does not depend on the order of wavelengths.
  std::size_t primary_wavelength() const noexcept;
  /// Position of a compiled wavelength (within 1e-6 nm); throws Error with the list if it was not compiled.
  std::size_t wavelength(double nm) const;
  /// Position of the compiled wavelength nearest to one in nm; throws Error if that is not finite.
  std::size_t nearest_wavelength(double nm) const;
  /// Position that a Wavelength stands for. A given position is not checked; nm that were not compiled (within 1e-6 nm)
  /// have one that no lens has.
  std::size_t position(Wavelength wavelength) const noexcept;
  /// The same; throws Error for a wavelength that was not compiled.
  std::size_t compiled_position(Wavelength wavelength) const;
  /// Whether rays have a wavelength: a compiled position, or nm from the smallest to the largest compiled one (floats
  /// beside them by their rounding count as these).
  bool covers(Wavelength wavelength) const noexcept;

  /// Index of the medium before surface `space` (space 0 is object space, surface_count() is image space).
  /// Throws Error for a space or a wavelength that the lens does not have.
  double index(std::size_t space, Wavelength wavelength = {}) const;
  /// How far the index of any medium at a wavelength in nm may be from its dispersion formula: the largest error of the
  /// polynomials of degree 7 in 1 / nm that stand for it, at their extremes and the compiled wavelengths, and 10 % to
  /// spare. Neither number nor spacing of the compiled wavelengths matters, but their range. From 400 to 700 nm it is
  /// below 6e-8 for every lens of data/lenses and 7e-7 for every glass of data/glass (tests/lens). Rays in float add
  /// 2e-7. Infinite where a formula gives no index between compiled wavelengths: the lens has these alone. For clamped
  /// glasses it is the distance from the clamped formula, whose kink the polynomial rounds: from 360 to 830 nm it is
  /// below 9e-3 for every glass of data/glass. At compiled wavelengths clamped indices are exact.
  double index_error() const noexcept;
  /// Direction along z of light from the scene in a space: +1, or -1 behind an odd number of mirrors. Throws Error for
  /// a space that the lens does not have.
  double light_direction(std::size_t space) const;

  Dispersion dispersion() const noexcept;
  /// One message for each surface whose medium has no catalogue glass, with the reason: no name, a name outside the
  /// tables, another n_d, or missing tables.
  std::span<const std::string> missing_glasses() const noexcept;
  /// One message for each surface whose glass does not reach all compiled wavelengths
  /// (CompileOptions::clamp_wavelengths).
  std::span<const std::string> clamped_glasses() const noexcept;

  /// True where every surface is the same in both sections and the stop is round.
  bool rotationally_symmetric() const noexcept;

  /// The tables of the kernels, for the library's own modules.
  struct Data;
  const Data& data() const noexcept { return *data_; }

 private:
  explicit Lens(std::shared_ptr<const Data> data) noexcept : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

/// Compiles a prescription, in one of its configurations, for some wavelengths (nm). Surfaces without a clear aperture
/// get a computed one, as with_apertures() does (pupil/apertures.hpp). Throws Error, naming lens and surface, for an
/// invalid prescription, a wavelength given twice (within 1e-6 nm) or outside the range of a glass (unless
/// CompileOptions::clamp_wavelengths), a missing glass (see MissingGlass; always if the medium states no index), an
/// index outside 0..5, and a primary_nm that is not among the wavelengths.
PETZVAL_API Lens compile(const Prescription& prescription, std::span<const double> wavelengths_nm,
                         const CompileOptions& options = {});

/// Compiles for the reference wavelength of the prescription alone.
PETZVAL_API Lens compile(const Prescription& prescription, const CompileOptions& options = {});

/// The largest clear aperture that with_semi_diameter takes.
enum class RimLimit : std::uint8_t {
  prescription,  ///< LensSurface::widest_semi_diameter: a diaphragm cannot open beyond its mount
  none,          ///< no limit, for programs that design a lens
};

/// Changes the clear aperture of one surface.
///
/// @param semi_diameter  in mm, 0 or more; the surface is closed if it is not larger than the central obscuration
/// @throws Error  if the surface does not exist, and if semi_diameter is below 0, NaN, or above `limit`
PETZVAL_API Lens with_semi_diameter(const Lens& lens, std::size_t surface, double semi_diameter,
                                    RimLimit limit = RimLimit::prescription);

/// The lens with its film at another place (lens frame, mm). Throws Error for one that is not behind the last vertex,
/// on the side that light runs to.
PETZVAL_API Lens with_film(const Lens& lens, double film_z);

/// The lens with its groups, and its film, where they stand for subjects at an inverse distance (1 / mm): thicknesses
/// are linear in it between neighbouring focus positions, and go on so beyond the first and the last. Throws Error for
/// a lens without focus positions, an inverse distance that is not finite, and groups that would meet: a thickness of
/// air below 0 whose positions are all above 0.
PETZVAL_API Lens with_groups_at(const Lens& lens, double inverse_distance);

/// The lens with another shape of its stop; Iris{} makes it round again. Every ray that is traced with apertures
/// passes the iris, and so do boundaries of pupils, film irradiance, spots, PSFs and cameras.
/// Paraxial pupils and f-numbers are those of the round stop. Throws Error for a lens without a stop, a stop without a
/// finite semi-diameter, and for blades, roundness or rotation out of range.
PETZVAL_API Lens with_iris(const Lens& lens, const Iris& iris);

/// Sag of a surface at (x, y), mm: the height along z over the plane of its vertex; NaN beyond the equator of a sphere
/// or conic, and for a surface that does not exist. Clear apertures are ignored.
PETZVAL_API double sag(const Lens& lens, std::size_t surface, double x, double y) noexcept;

}  // namespace petzval
