// SPDX-License-Identifier: Apache-2.0
// Loops from lines to rays towards the scene or to transmittances, and back from rays to lines; polynomial_loops.cpp
// defines them for each instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "core/widest.hpp"
#include "lens/wavelength_rows.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::polynomial_detail {

/// Degrees 3, 5, 7, 9, 11.
inline constexpr std::size_t degree_count = 5;
/// Largest number of coefficients of a wavelength: degree 11 with two mirror symmetries.
inline constexpr std::size_t most_coefficients = 1568;

/// The constants of a domain, rounded once from double.
template <class R>
struct Scales {
  struct Section {
    R pupil_shift, per_pupil_radius;
  };
  R per_film_radius, reference_z;
  Section along_x, along_y;
};

/// Limit of |f|^2 and |p|^2; exceeds 1, so that lines on the rim belong to the domain in float as well.
inline constexpr double within_domain = 1 + 1e-5;

/// Largest number of modes of a polynomial.
inline constexpr std::size_t most_modes = 8;
/// Fits at any wavelength, borrowed. A mode has as many coefficients as a fit. The fit at a wavelength is the sum of
/// the modes, multiplied by the weights of the wavelength. The weight of the first mode is 1.
template <class R>
struct Modes {
  const R* coefficients = nullptr;  ///< by mode
  std::size_t count = 0;
  lens_detail::WavelengthRows<R> weights;
};

template <class R>
struct Job {
  const R* coefficients;  ///< film and pupil coefficients of direction, then of offset; by wavelength if rays have
                          ///< positions
  const R* rows;          ///< one row for each coefficient, by wavelength
  std::size_t row_length;
  std::size_t fits;
  Modes<R> modes;
  Scales<R> scales;
  std::size_t count;
  RayWavelengths wavelengths;
  std::array<const R*, 6> in;  ///< lines: film x, y, pupil x, y; or rays: origin and direction
  std::array<R*, 6> out;       ///< rays, transmittances or lines
  RayFate* fates;              ///< null for transmittances
};

template <class R, std::size_t symmetries>
using Loops = std::array<void (*)(const Job<R>&) noexcept, symmetries>;
/// Transmittances have degree 2 to 8 for lenses of revolution and degree 2 or 4 with mirror symmetry.
inline constexpr std::size_t revolution_transmittances = 4, transmittance_count = 6;

/// Maps one line.
using OneToScene = std::array<RayFate (*)(const double* coefficients, const Scales<double>&, const TwoPlaneRay&,
                                          Ray<double>&) noexcept,
                              2 * degree_count>;

/// Tables indexed by Data::loop(), and by transmittance (by_transmittance() in sums.hpp).
struct PolynomialLoops {
  std::tuple<Loops<float, 2 * degree_count>, Loops<double, 2 * degree_count>> to_scene;
  std::tuple<Loops<float, transmittance_count>, Loops<double, transmittance_count>> transmittances;
  OneToScene one;
  Loops<double, 2 * degree_count> to_film;  ///< all rays of a call have one wavelength
};

PETZVAL_WIDEST(PolynomialLoops, polynomial_loops)

}  // namespace petzval::polynomial_detail
