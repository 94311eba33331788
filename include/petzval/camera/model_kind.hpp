// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "petzval/core/export.hpp"

namespace petzval {

/// A ray model of a lens. Models are listed and ordered from the cheapest to the most accurate.
///
/// Accuracy: all models have the exposure of the exact lens on the axis within 0.5 %; thin_two_disc and polynomials
/// have it within 2 % over the declared field (tests/camera/exposure_test.cpp). If a central obscuration divides the
/// pupil, as in catadioptrics beyond their field, the light of models that are not exact may be wrong by a factor
/// (FilmPupilTable::equal_area). Beyond the declared field polynomials of lenses with cylinders are up to 20 % too
/// dark. Slopes are no angles: first-order models of lenses faster than f/0.36 are up to 5 % too bright, and beyond
/// f/0.31 of no use.
class ModelKind {
 public:
  enum class Family : std::uint8_t {
    pinhole,
    thin,
    thin_two_disc,
    thick,
    polynomial,
    exact_float,
    exact_double,
    custom
  };

  /// First order, every ray through the centre of the pupil.
  static const ModelKind pinhole;
  /// First order, a thin lens: a disc in the principal plane. Light on the film follows cos^4, so that the image of an
  /// axial point is darker at its rim than in its centre: by 10 % at f/2 and 33 % at f/1.1. (The thin lens of
  /// LensRays::thin has even discs, without cos^4.)
  static const ModelKind thin;
  /// First order, a pupil of two discs that move apart with the field, fitted to the real pupils of film points: light
  /// falls off as through the real lens. Seen from the scene the overlap is larger than the real pupil (TwoDiscs).
  static const ModelKind thin_two_disc;
  /// First order: cardinal points and the paraxial pupils.
  static const ModelKind thick;
  /// Rays as polynomials of film and pupil point, of degree 3, 5, 7, 9 or 11. A camera refuses another degree.
  static constexpr ModelKind polynomial(int degree) noexcept;
  /// Every surface, traced in float or double.
  static const ModelKind exact_float, exact_double;
  /// The model of a renderer: ray_model.hpp.
  static const ModelKind custom;

  constexpr ModelKind() noexcept = default;
  constexpr Family family() const noexcept { return family_; }
  constexpr int degree() const noexcept { return degree_; }  ///< of polynomials; 0 of other models
  constexpr bool is_first_order() const noexcept { return family_ <= Family::thick; }
  constexpr bool is_polynomial() const noexcept { return family_ == Family::polynomial; }
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
inline constexpr ModelKind ModelKind::custom{Family::custom};
constexpr ModelKind ModelKind::polynomial(int degree) noexcept { return ModelKind(Family::polynomial, degree); }

/// "pinhole", "thin", "thin_two_disc", "thick", "polynomial_3", ..., "exact_float", "exact_double"; "custom". "unknown"
/// for polynomials of another degree.
PETZVAL_API std::string_view name(ModelKind model) noexcept;
/// The built-in model of a name. Nothing for other names.
PETZVAL_API std::optional<ModelKind> model_named(std::string_view name) noexcept;
/// The built-in models, in the order above.
PETZVAL_API std::span<const ModelKind> models() noexcept;

}  // namespace petzval
