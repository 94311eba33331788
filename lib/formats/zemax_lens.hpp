// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "import.hpp"
#include "zemax_surface.hpp"

namespace petzval::formats_detail {

/// One line of the multi-configuration table: the value of an operand in a configuration.
struct ZemaxOperand {
  int line = 0;
  std::string name;  ///< "THIC"
  int surface = 0;
  int configuration = 1;
  std::string value;
};

/// The contents of a .zmx.
struct ZemaxLens {
  std::vector<ZemaxSurface> surfaces;  ///< object, lens and image
  std::vector<std::string> catalogues;
  int configurations = 1;
  std::vector<ZemaxOperand> operands;
  int telecentric = 0;  ///< line of FTYP if the object space is telecentric, otherwise 0
};

/// Builds the rows and configurations of a prescription: evaluates pickups and folds coordinate breaks.
/// @param unit unit of the lengths in operands (mm)
void build_lens(ZemaxLens zemax, double unit, Import& in);

/// Removes breaks that change nothing and folds by plane mirrors.
/// @throws Error if there is another tilt or decentre
void fold_breaks(std::vector<ZemaxSurface>& surfaces, Import& in);

}  // namespace petzval::formats_detail
