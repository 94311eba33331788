// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "petzval/core/config.hpp"

namespace petzval {

/// A ray model of a lens. Models are ordered from the cheapest to the most accurate.
///
/// Accuracy: on the axis, all models have the exposure of the exact lens within 0.5 %. Over the declared field,
/// thin_two_disc and polynomials have it within 2 % (tests/camera/exposure_test.cpp).
///
/// Limitations: if a central obscuration divides the pupil, as in catadioptrics beyond their field, the exposure of
/// models that are not exact may be off by a factor. Beyond the declared field,
/// polynomials of lenses with cylinders are up to 20 % too dark. First-order models of lenses faster than f/0.36 are up
/// to 5 % too bright; for lenses faster than f/0.31 they are useless.
class ModelKind {
 public:
  enum class Family : std::uint8_t { pinhole, thin, thin_two_disc, thick, polynomial, exact_float, exact_double };

  /// First order; every ray passes the centre of the pupil.
  static const ModelKind pinhole;
  /// First order; a disc in the principal plane. Irradiance follows cos^4, so that the blur disc of an axial point is
  /// darker at its rim than at its centre: by 10 % at f/2 and 33 % at f/1.1. (LensRays::thin has uniform discs.)
  static const ModelKind thin;
  /// First order; the pupil is the overlap of two discs that move apart with the field, fitted to the real pupils of
  /// the film points. Irradiance falls off as with the real lens. Limitations: see fit_two_discs().
  static const ModelKind thin_two_disc;
  /// First order; cardinal points and paraxial pupils.
  static const ModelKind thick;
  /// Rays as polynomials of film and pupil point, of degree 3, 5, 7, 9 or 11. A Camera throws Error for other degrees.
  static constexpr ModelKind polynomial(int degree) noexcept;
  /// Rays traced through every surface, in float or double.
  static const ModelKind exact_float, exact_double;

  constexpr ModelKind() noexcept = default;
  constexpr Family family() const noexcept { return family_; }
  constexpr int degree() const noexcept { return degree_; }  ///< of a polynomial; 0 for other models
  constexpr bool is_first_order() const noexcept { return family_ <= Family::thick; }
  constexpr bool is_polynomial() const noexcept { return family_ == Family::polynomial; }
  constexpr bool is_exact() const noexcept { return family_ >= Family::exact_float; }
  friend constexpr auto operator<=>(const ModelKind&, const ModelKind&) noexcept = default;

 private:
  constexpr explicit ModelKind(Family family, int degree = 0) noexcept : family_(family), degree_(degree) {}

  Family family_ = Family::exact_float;
  int degree_ = 0;
};

inline constexpr ModelKind ModelKind::pinhole{Family::pinhole};
inline constexpr ModelKind ModelKind::thin{Family::thin};
inline constexpr ModelKind ModelKind::thin_two_disc{Family::thin_two_disc};
inline constexpr ModelKind ModelKind::thick{Family::thick};
inline constexpr ModelKind ModelKind::exact_float{Family::exact_float};
inline constexpr ModelKind ModelKind::exact_double{Family::exact_double};
constexpr ModelKind ModelKind::polynomial(int degree) noexcept { return ModelKind(Family::polynomial, degree); }

/// "pinhole", "thin", "thin_two_disc", "thick", "polynomial_3", ..., "exact_float" or "exact_double"; "unknown" for
/// polynomials of another degree.
PETZVAL_API std::string_view name(ModelKind model) noexcept;
/// The built-in model with a name; nullopt if there is no such model.
PETZVAL_API std::optional<ModelKind> model_named(std::string_view name) noexcept;
/// The built-in models, in the order above.
PETZVAL_API std::span<const ModelKind> models() noexcept;

}  // namespace petzval
