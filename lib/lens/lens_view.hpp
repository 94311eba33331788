// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "lens/asphere.hpp"
#include "lens/quadric.hpp"
#include "lens/snell.hpp"
#include "petzval/core/config.hpp"

namespace petzval {
class Lens;
}

namespace petzval::kernel {

/// One surface in the tables of the kernels.
template <class R>
struct SurfaceTable {
  Quadric<R> quadric;
  R gap = 0;                    ///< thickness to the next vertex; 0 for the last surface
  R semi_diameter_squared = 0;  ///< the rim itself is inside
  R obscuration_squared = 0;
  std::int32_t asphere = -1;  ///< index of the asphere, or -1
  bool mirror = false;
  R sense = 1;  ///< direction of light along z in front of the surface: -1 after an odd number of mirrors
};

/// An edge of the iris (mm). Light passes if x nx + y ny + bend (x^2 + y^2) <= distance (iris_detail::IrisEdge).
template <class R>
struct StopEdge {
  R nx = 1, ny = 0, bend = 0, distance = 0;
};

/// The intersection that a surface needs in a batch.
enum class StepKind : std::uint8_t { plane, sphere, quadric, asphere };

/// One surface in the order of travel, in a frame that is inverted after every mirror and for rays towards the scene,
/// so that rays always travel towards +z.
template <class R>
struct Step {
  StepKind kind = StepKind::plane;
  bool far = false;          ///< far from the previous surface: rays are first moved near the vertex
  bool bends = false;        ///< the media on its sides differ at one wavelength or more
  bool mirror = false;       ///< the frame is inverted after this surface
  bool stop = false;         ///< the iris clips here
  bool refresh = false;      ///< normalise directions here
  std::int32_t surface = 0;  ///< index of the surface in the lens
  std::int32_t asphere = -1;
  R gap = 0;                               ///< along z, from the previous vertex
  R curvature = 0, e = 1, ax = 1, ay = 1;  ///< as in Quadric, in the frame of the step
  R sense = 1;                             ///< -1 if the frame is inverted
  R rim2 = 0, obscuration2 = 0;            ///< squared semi-diameters; rim2 is at most reach2
  R reach2 = 0;                            ///< squared height beyond which all rays are lost
};

/// Constants of refraction at a step, for directions scaled by the index, |p| = n.
template <class R>
struct RefractionConstants {
  R cn2 = 0;     ///< curvature n^2, n in front of the surface
  R k = 0;       ///< n'^2 - n^2
  R per_n2 = 1;  ///< 1 / n^2, n in front of the surface
};

/// Maps any wavelength in the range of the compiled wavelengths to t from -1 to 1, linear in 1 / nm. In 1 / nm, the
/// ultraviolet and the infrared poles of dispersion formulas are about equally far from the range.
template <class R>
struct SpectralCoordinate {
  R shortest = 1, longest = 0;  ///< the range, nm; empty if indices between compiled wavelengths are unknown
  R scale = 0, offset = 0;      ///< t = scale / nm - offset, clamped; both 0 for one wavelength

  bool covers(double nm) const noexcept { return nm >= double{shortest} && nm <= double{longest}; }
  R at(R nm) const noexcept {
    const R t = scale / nm - offset;
    return t < R(1) ? (t > R(-1) ? t : R(-1)) : R(1);
  }
};

/// The squared index of a medium at any wavelength: a polynomial in t. The square is used because dispersion formulas
/// give it and refraction needs it.
template <class R>
struct SquaredIndex {
  static constexpr std::size_t terms = 8;
  std::array<R, terms> by_power{1};
  bool constant = true;  ///< only the first coefficient is not zero

  /// Uses Estrin's scheme, whose dependency chain is shorter than Horner's. T: R or lanes of R.
  /// @param t2, t4 powers of t
  template <class T>
  T at(const T& t, const T& t2, const T& t4) const noexcept {
    const auto pair = [&](std::size_t k) { return T(by_power[k]) + T(by_power[k + 1]) * t; };
    return (pair(0) + pair(2) * t2) + (pair(4) + pair(6) * t2) * t4;
  }
};

/// Length of a row with one number per wavelength, padded with zeros to pairs of the widest registers for
/// core_detail::look_up().
template <class R>
constexpr std::size_t row_length(std::size_t wavelengths) noexcept {
  constexpr std::size_t pair = 2 * 64 / sizeof(R);
  return (wavelengths + pair - 1) / pair * pair;
}

/// The surfaces of a lens in the order of travel.
template <class R>
struct SurfaceSequence {
  const Step<R>* steps = nullptr;
  const RefractionConstants<R>* bends = nullptr;  ///< [wavelength * count + step]
  const R* bend_rows = nullptr;                   ///< the same in rows [3 * step + 0 for cn2, 1 for k, 2 for per_n2]
  const R* n_first = nullptr;                     ///< row of indices in front of the lens
  const R* per_n_last = nullptr;                  ///< row of 1 / index behind the lens
  SpectralCoordinate<R> coordinate{};             ///< maps any wavelength to t
  const SquaredIndex<R>* media = nullptr;         ///< [step] in front of the surface; the last is behind the lens
  R first_z = 0, last_z = 0;                      ///< vertices of the first and the last step, lens frame
  R first_sense = 1, last_sense = 1;              ///< -1 if the frame in front or behind is inverted
};

/// The tables of a compiled lens: flat arrays, borrowed from the Lens.
template <class R>
struct LensView {
  const SurfaceTable<R>* surfaces = nullptr;
  const Asphere<R>* aspheres = nullptr;
  const Interface<R>* to_film = nullptr;   ///< [wavelength * count + surface]
  const Interface<R>* to_scene = nullptr;  ///< the same surfaces for light from behind
  std::size_t count = 0;
  const R* vertex_z = nullptr;
  std::size_t wavelengths = 0;
  std::size_t primary = 0;  ///< index of the primary wavelength
  std::int32_t stop = -1;   ///< index of the stop, or -1
  std::span<const StopEdge<R>> iris{};
  SurfaceSequence<R> sequence_to_film{}, sequence_to_scene{};
};

/// The tables of a lens, rounded once from double; valid as long as the lens exists. R: float or double.
template <class R>
const LensView<R>& view(const Lens& lens) noexcept;
template <>
PETZVAL_API const LensView<float>& view(const Lens& lens) noexcept;
template <>
PETZVAL_API const LensView<double>& view(const Lens& lens) noexcept;

}  // namespace petzval::kernel
