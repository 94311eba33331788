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

/// A .zmx as it was read.
struct ZemaxLens {
  std::vector<ZemaxSurface> surfaces;  ///< object, lens and image
  std::vector<std::string> catalogues;
  int configurations = 1;
  std::vector<ZemaxOperand> operands;
  int telecentric = 0;  ///< line of FTYP if the object space is telecentric; else 0
};

/// Makes the rows and configurations of a prescription: pickups are evaluated, coordinate breaks are folded.
/// unit: of the lengths in operands, mm.
void build_lens(ZemaxLens zemax, double unit, Import& in);

/// Takes out breaks that change nothing and folds by plane mirrors. place: the number that each surface had in the
/// file. Throws Error for any other tilt or decentre.
void fold_breaks(std::vector<ZemaxSurface>& surfaces, std::vector<int>& place, Import& in);

}  // namespace petzval::formats_detail
