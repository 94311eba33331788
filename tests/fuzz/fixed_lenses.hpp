// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "../data_lenses.hpp"
#include "bytes.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval::fuzz {

/// A lens of data/lenses at three wavelengths.
inline Lens coloured(const char* id) {
  return compile(testing::data_prescription(id), std::array{450.0, 550.0, 650.0},
                 {.missing_glass = MissingGlass::abbe});
}

/// A wavelength for these lenses: the default, an index that may be one too large, or any number of nm.
inline Wavelength wild_wavelength(Bytes& bytes) {
  const int kind = bytes.byte();
  if (kind < 128) return {};
  if (kind < 192) return static_cast<std::size_t>(kind % 4);
  return Wavelength::nm(bytes.number(430, 670));
}

}  // namespace petzval::fuzz
