// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "bundle.hpp"
#include "conjugates.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::inline v0::focus_detail {

/// Throw Error: for a subject distance that is NaN or not above 0; for a film_z that is not finite.
void check_distance(const Lens& lens, double distance_mm);
void check_film(const Lens& lens, double film_z);

/// A lens as one criterion sees it: what the functions on focus, depth of field and breathing share.
class FocusModel {
 public:
  /// Throws Error for fields and weights that are none. Borrows both.
  FocusModel(const Lens& lens, const FocusOptions& options);

  bool afocal() const noexcept { return data_.afocal; }
  bool exact() const noexcept;
  std::size_t wavelength() const noexcept { return wavelength_; }  ///< the one of largest weight
  Meridian meridian() const noexcept { return meridian_; }

  // What follows is for lenses that are not afocal.
  const Conjugates& conjugates() const noexcept { return conjugates_; }
  FocusSolution focus(double distance) const;  ///< distance: > 0 or infinite
  FocusSolution subject(double film_z) const;  ///< film_z: finite
  FocusSolution nearest() const;
  /// None where a field has no rays. Throws Error for a subject that is not in front of the lens, and where nothing
  /// limits the beam.
  std::optional<Image> image(double subject_z) const;
  /// By the subject's nearness (Conjugates). None, too, where image throws: exact rays end before the vertex where the
  /// first surface is hollow.
  std::optional<Image> image_at(double nearness) const;

 private:
  Image cone(double subject_z) const;

  const Lens& lens_;
  const FocusOptions& options_;
  std::vector<FocusField> fields_;
  std::vector<WavelengthWeight> wavelengths_;
  std::size_t wavelength_ = 0;
  Meridian meridian_ = Meridian::y;
  FirstOrder data_;
  Conjugates conjugates_{};
};

}  // namespace petzval::inline v0::focus_detail
