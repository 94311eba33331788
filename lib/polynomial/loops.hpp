// SPDX-License-Identifier: Apache-2.0
// The loops from lines to rays towards the scene, which to_scene.cpp defines for each instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval::inline v0::polynomial_detail {

/// Degrees 3, 5, 7, 9, 11.
inline constexpr std::size_t degree_count = 5;
/// Coefficients of degree 11 and two mirror symmetries, the most at a wavelength.
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

/// Limit of |f|^2 and |p|^2, at most 1: lines on the rim of the domain belong to it in float too.
inline constexpr double within_domain = 1 + 1e-5;

/// Fits that are mixed for each ray: `weights` of those at the ranks from `first` on, by ray and then by rank.
template <class R>
struct MixedFits {
  const std::uint16_t* positions = nullptr;  ///< of the fits, by rank
  const std::int32_t* first = nullptr;       ///< of each ray; null: rays have fits of their own; negative: no fit
  const R* weights = nullptr;                ///< four of each ray
};

template <class R>
struct ToSceneJob {
  const R* coefficients;  ///< by wavelength: direction by film and by pupil, offset by film and by pupil
  std::size_t fits, primary;
  Scales<R> scales;
  std::size_t count;
  TwoPlaneRays<const R> lines;
  RayWavelengths wavelengths;
  RayArrays<R> rays;
  RayFate* fates;
  MixedFits<R> mixed{};  ///< instead of wavelengths
};

template <class R>
using ToSceneLoops = std::array<void (*)(const ToSceneJob<R>&) noexcept, 2 * degree_count>;

/// One line. coefficients: of its wavelength, null where there is no fit.
using OneToScene = std::array<RayFate (*)(const double* coefficients, const Scales<double>&, const TwoPlaneRay&,
                                          Ray<double>&) noexcept,
                              2 * degree_count>;

/// By Data::loop().
struct PolynomialLoops {
  ToSceneLoops<float> in_float;
  ToSceneLoops<double> in_double;
  OneToScene one;
};

PETZVAL_WIDEST(PolynomialLoops, polynomial_loops)

}  // namespace petzval::inline v0::polynomial_detail
