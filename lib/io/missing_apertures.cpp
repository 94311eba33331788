// SPDX-License-Identifier: Apache-2.0
#include "missing_apertures.hpp"

#include "petzval/core/error.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval::io_detail {

Prescription with_missing_apertures(Prescription lens, const GlassCatalogue* glasses) {
  try {
    return with_apertures(lens, {.glasses = glasses, .missing_glass = MissingGlass::abbe});
  } catch (const Error&) {
    return lens;
  }
}

}  // namespace petzval::io_detail
