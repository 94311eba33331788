// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "petzval/core/export.hpp"

namespace petzval {

/// The ray models of a lens, from the cheapest to the most accurate one. All have the exact lens's exposure on the axis
/// within 0.5 %; thin_two_disc and polynomials have it within 2 % over the declared field
/// (tests/camera/exposure_test.cpp). Where a central obscuration divides the pupil, as in catadioptrics beyond their
/// field, their light may be wrong by a factor (FilmPupilTable::equal_area); that of exact models is not. Beyond the
/// declared field polynomials of lenses with cylinders are up to 20 % too dark. Slopes are no angles: first-order
/// models of lenses faster than f/0.36 are up to 5 % too bright, and beyond f/0.31 of no use.
enum class ModelKind : std::uint8_t {
  pinhole,  ///< first order, every ray through the centre of the pupil
  /// First order, a thin lens: a disc in the principal plane. Light on the film follows cos^4, so that the image of an
  /// axial point is darker at its rim than in its centre: by 10 % at f/2 and 33 % at f/1.1. (The thin lens of
  /// LensRays::thin has even discs, without cos^4.)
  thin,
  /// First order, a pupil of two discs that move apart with the field, fitted to the real pupils of film points: light
  /// falls off as through the real lens. Seen from the scene the overlap is larger than the real pupil (TwoDiscs).
  thin_two_disc,
  thick,         ///< first order: cardinal points and the paraxial pupils
  polynomial_3,  ///< rays as polynomials of film and pupil point; the number is the degree
  polynomial_5,
  polynomial_7,
  polynomial_9,
  polynomial_11,
  exact_float,  ///< every surface, traced in float
  exact_double,
  custom,  ///< a renderer's own model: ray_model.hpp
};

/// "pinhole", "thin", "thin_two_disc", "thick", "polynomial_3", ..., "exact_float", "exact_double"; "custom".
PETZVAL_API std::string_view name(ModelKind model) noexcept;
/// The built-in model of a name. Nothing for other names.
PETZVAL_API std::optional<ModelKind> model_named(std::string_view name) noexcept;
/// The built-in models, in the order above.
PETZVAL_API std::span<const ModelKind> models() noexcept;

}  // namespace petzval
