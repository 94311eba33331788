// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "conjugates.hpp"
#include "exact_image.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::focus_detail {

/// Throws Error if the distance is NaN or not above 0, or if film_z is not finite.
void check_distance(const Lens& lens, double distance);
void check_film(const Lens& lens, double film_z);

/// Hint appended to messages about subjects that are too near: a distance below 50 mm was probably given in metres.
/// Empty for larger distances.
std::string hint_of_units(double distance);

/// @throws Error  if the entrance pupil is at infinity or nothing limits the beam
double entrance_pupil_z(const Lens& lens, Wavelength wavelength, Meridian meridian);

/// Focus of one lens with one set of options: the solvers and images used by focus, depth of field and breathing.
class FocusSolver {
 public:
  /// Throws Error if fields or weights are invalid. Keeps references to both arguments.
  FocusSolver(const Lens& lens, const FocusOptions& options);

  bool afocal() const noexcept { return afocal_; }
  bool exact() const noexcept;
  std::size_t wavelength() const noexcept { return wavelength_; }  ///< wavelength of largest weight
  Meridian meridian() const noexcept { return meridian_; }

  // The members below require a lens that is not afocal.
  const Conjugates& conjugates() const noexcept { return conjugates_; }
  FocusSolution focus(double distance) const;  ///< distance: > 0 or infinite
  FocusSolution subject(double film_z) const;  ///< film_z: finite
  FocusSolution nearest() const;
  /// The image of a subject; nullopt if no ray of a field passes. Throws Error if the subject is not in front of the
  /// lens or nothing limits the beam.
  std::optional<Image> image(double subject_z) const;
  /// Like image(), but returns nullopt instead of throwing an Error, for example if the subject lies behind the rim of
  /// a concave first surface.
  std::optional<Image> image_seen(double subject_z) const;
  /// image_seen() of the subject with this vergence (Conjugates).
  std::optional<Image> image_at(double vergence) const;

 private:
  Image cone(double subject_z) const;

  const Lens& lens_;
  const FocusOptions& options_;
  std::vector<FocusField> fields_;
  std::vector<WavelengthWeight> wavelengths_;
  std::size_t wavelength_ = 0;
  Meridian meridian_ = Meridian::y;
  bool afocal_ = false;
  Conjugates conjugates_;
};

}  // namespace petzval::focus_detail
