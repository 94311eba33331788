// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::inline v0 {

/// Something in a prescription that a careful reader would ask about. Data, not failure: the lens can be traced as it
/// is.
struct Finding {
  enum class Kind {
    focal_length,   ///< computed differs from declared by more than 2 %
    f_number,       ///< the same for the f-number by exact ray
    overlap,        ///< neighbouring surfaces cross inside their clear apertures
    semi_diameter,  ///< beyond the surface's domain (past the equator of the conic), or 0 away from the stop
    no_stop,
    several_stops,
    image_distance,  ///< the last gap differs from the paraxial focus by more than 2 % of the focal length
  };
  Kind kind{};
  std::optional<int> surface;  ///< from 0
  double found = 0;
  double wanted = 0;
  std::string message;  ///< one line, with units
};

/// "focal_length", "f_number", "overlap", ...
PETZVAL_API std::string_view name(Finding::Kind kind) noexcept;

/// Compares what a prescription declares with what it is, at its reference wavelength. Throws Error for an invalid one
/// only.
PETZVAL_API std::vector<Finding> lint(const Prescription& prescription);

}  // namespace petzval::inline v0
