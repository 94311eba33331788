// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::inline v0 {

/// A paraxial pupil: the image of the aperture stop. z and diameter are infinite where the lens is telecentric on that
/// side.
struct Pupil {
  double z = 0;         ///< lens frame, mm
  double diameter = 0;  ///< mm
};

/// Entrance and exit pupil of a lens, and the surface that limits it.
struct Pupils {
  Pupil entrance;
  Pupil exit;
  std::size_t stop = 0;
  /// No surface is marked as stop: `stop` is the first that clips the axial beam from infinity (paraxially).
  bool stop_inferred = false;
};

/// Whether any surface limits the beam. Without one there is no stop, and pupils() throws.
PETZVAL_API bool has_pupils(const Lens& lens) noexcept;

/// Throws Error if no surface is marked as stop and none limits the beam.
PETZVAL_API Pupils pupils(const Lens& lens, Wavelength wavelength = {}, Meridian meridian = Meridian::y);

/// |EFL| / entrance pupil diameter, in the main meridian. Infinite for an afocal lens or an empty pupil.
PETZVAL_API double paraxial_f_number(const Lens& lens, Wavelength wavelength = {});

}  // namespace petzval::inline v0
