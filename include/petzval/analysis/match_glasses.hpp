// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

class GlassCatalogue;

/// The largest differences of n_d and V_d between a medium and its glass. Tables print n_d to five digits or to three,
/// and V_d to one; two glasses of a catalogue differ by more.
struct GlassTolerance {
  double nd = 0.001;
  double vd = 0.5;
};

/// A prescription with names of glasses, and the lists of matched and unmatched media.
struct MatchedGlasses {
  Prescription prescription;
  std::vector<ImportWarning> matched;    ///< command: "surfaces 0, 4"; message: the medium and its glass
  std::vector<ImportWarning> unmatched;  ///< the same, with the reason
};

/// Gives media without a name the catalogue glass that is nearest to their n_d and V_d, so that they disperse as a
/// glass and not as the n_d/V_d model.
///
/// @param prescription  the lens; media with a name, air and mirrors stay
/// @param glasses       the catalogue; nearest_glasses() chooses
/// @param tolerance     a medium beyond it keeps its numbers and is listed in `unmatched`, and so is one without V_d
/// @return              the lens; a matched medium has glass, catalogue and glass_origin "matched" beside its n_d and
/// V_d
/// @throws Error        if a tolerance is negative or not finite
PETZVAL_API MatchedGlasses match_glasses(const Prescription& prescription, const GlassCatalogue& glasses,
                                         const GlassTolerance& tolerance = {});

}  // namespace petzval
