// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

class GlassCatalogue;

/// A prescription with glass names, and the lists of matched and unmatched media.
struct MatchedGlasses {
  Prescription prescription;
  std::vector<ImportWarning> matched;    ///< command: "surfaces 0, 4"; message: the medium and its glass
  std::vector<ImportWarning> unmatched;  ///< the same, with the reason
};

/// Assigns to each unnamed medium the catalogue glass nearest to its n_d and V_d.
///
/// A matched medium has the dispersion of the glass instead of the n_d/V_d model.
///
/// @param prescription  the lens; named media, air and mirrors are kept
/// @param glasses       the catalogue, searched with nearest_glasses()
/// @param nd            largest difference of n_d. Tables print n_d to five digits or to three, and V_d to one; two
///                      glasses of a catalogue differ by more.
/// @param vd            largest difference of V_d. Media beyond a limit or without V_d keep their numbers and are
///                      listed in `unmatched`.
/// @return              the lens; a matched medium has glass, catalogue and glass_origin "matched", and keeps its n_d
///                      and V_d
/// @throws Error        if a limit is negative or not finite
PETZVAL_API MatchedGlasses match_glasses(const Prescription& prescription, const GlassCatalogue& glasses,
                                         double nd = 0.001, double vd = 0.5);

}  // namespace petzval
