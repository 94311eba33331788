// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/tables.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/media/catalogue.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::inline v0 {

/// Where indices come from away from the reference wavelength.
enum class IndexPolicy {
  printed,    ///< the printed n_d, plus the catalogue glass's n(lambda) - n(d): the table stays what it was at d
  catalogue,  ///< the catalogue glass alone
};

/// What to do where a medium has no glass that the catalogue knows and an index away from the reference wavelength is
/// asked for.
enum class MissingGlass {
  error,  ///< throw Error naming the surface and the glass
  abbe,   ///< the n_d/V_d model; without V_d the printed index, within 0.05 nm of its line, else still an Error
};

/// How far the media of a lens are known: every one by a catalogue glass; at least one by n_d and V_d only; at least
/// one by n_d only, so that the lens can be used at the reference wavelength alone, or nothing that disperses at all.
enum class Dispersion { catalogue, abbe, none };

/// "catalogue", "abbe" or "none".
PETZVAL_API std::string_view name(Dispersion dispersion) noexcept;

struct CompileOptions {
  const GlassCatalogue* glasses = nullptr;  ///< not needed at the reference wavelength under IndexPolicy::printed
  IndexPolicy index_policy = IndexPolicy::printed;
  MissingGlass missing_glass = MissingGlass::error;
};

/// One surface of a compiled lens, in double. Millimetres. Curvature, never radius.
struct LensSurface {
  double vertex_z = 0;   ///< lens frame, mm
  double thickness = 0;  ///< signed, to the next vertex or the film
  double curvature = 0;  ///< 1/mm
  double conic = 0;
  Section curved_in = Section::both;
  std::vector<AsphereTerm> aspheric;
  double semi_diameter = 0;        ///< infinite: unlimited
  double inner_semi_diameter = 0;  ///< 0: no hole
  bool mirror = false;
};

/// A lens ready to trace: always valid, immutable, cheap to copy (one shared pointer), free to share between threads.
///
///     petzval::Lens lens = petzval::compile(petzval::read_prescription("data/lenses/double_gauss_100mm_f1.35.json"));
///     auto exit = petzval::trace(lens, petzval::Ray<double>{{0, 10, -50}, {0, 0, 1}});
///
/// A change makes a new lens: `with_semi_diameter`, `with_film`, and in pupil/ `with_f_number`.
class PETZVAL_API Lens {
 public:
  const std::string& name() const noexcept;

  std::span<const LensSurface> surfaces() const noexcept;
  std::size_t surface_count() const noexcept { return surfaces().size(); }

  /// The surface marked as aperture stop (the first, where a file marks two).
  std::optional<std::size_t> stop() const noexcept;

  /// The film, where the table puts it or `with_film` did.
  double film_z() const noexcept;

  /// Wavelengths the lens was compiled for.
  std::span<const double> wavelengths_nm() const noexcept;
  /// Position of the wavelength at which every function works unless told otherwise: the reference wavelength of the
  /// prescription where it was compiled (within 1e-6 nm), else the compiled one nearest to the d line. It does not
  /// depend on the order of wavelengths.
  std::size_t primary_wavelength() const noexcept;
  /// Position of a compiled wavelength (within 1e-6 nm); throws Error with the list if it was not compiled.
  std::size_t wavelength(double nm) const;
  /// Position of the compiled wavelength nearest to one in nm; throws Error if that is not finite.
  std::size_t nearest_wavelength(double nm) const;
  /// Position that a Wavelength stands for. A given position is not checked.
  std::size_t position(Wavelength wavelength) const noexcept { return wavelength.position(primary_wavelength()); }

  /// Index of the medium before surface `space` (space 0 is object space, surface_count() is image space).
  /// Throws Error for a space or a wavelength that the lens does not have.
  double index(std::size_t space, Wavelength wavelength = {}) const;
  /// Direction along z of light from the scene in a space: +1, or -1 behind an odd number of mirrors. Throws Error for
  /// a space that the lens does not have.
  double light_direction(std::size_t space) const;

  Dispersion dispersion() const noexcept;
  /// Surfaces whose medium has no catalogue glass, in the words of a message each; empty where dispersion() is
  /// catalogue.
  std::span<const std::string> missing_glasses() const noexcept;

  /// True where every surface is the same in both sections.
  bool rotationally_symmetric() const noexcept;

  /// The constants of the kernels, rounded once from double. R: float or double.
  template <class R>
  kernel::LensView<R> view() const noexcept;

 private:
  struct Data;
  explicit Lens(std::shared_ptr<const Data> data) noexcept : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;

  friend PETZVAL_API Lens compile(const Prescription&, std::span<const double>, const CompileOptions&);
  friend PETZVAL_API Lens with_semi_diameter(const Lens&, std::size_t, double);
  friend PETZVAL_API Lens with_film(const Lens&, double);
};

/// Compiles a prescription for some wavelengths (nm). Throws Error, naming lens and surface, for an invalid
/// prescription, a wavelength outside the range of a glass, a missing glass (see MissingGlass) and an index outside
/// 0..5.
PETZVAL_API Lens compile(const Prescription& prescription, std::span<const double> wavelengths_nm,
                         const CompileOptions& options = {});

/// At the prescription's reference wavelength alone.
PETZVAL_API Lens compile(const Prescription& prescription, const CompileOptions& options = {});

/// The lens with another clear aperture at one surface (mm, >= 0; nothing passes one no larger than its hole).
PETZVAL_API Lens with_semi_diameter(const Lens& lens, std::size_t surface, double semi_diameter);

/// The lens with its film at another place (lens frame, mm).
PETZVAL_API Lens with_film(const Lens& lens, double film_z);

template <>
PETZVAL_API kernel::LensView<float> Lens::view<float>() const noexcept;
template <>
PETZVAL_API kernel::LensView<double> Lens::view<double>() const noexcept;

}  // namespace petzval::inline v0
