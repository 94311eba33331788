// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/analysis/psf_set.hpp"

namespace petzval::analysis_detail {

/// A kernel and its weights in a blend, which sum to 1: of polynomials through all nodes around, some negative; and of
/// lines through the next ones, 0 for the others.
struct WeightedKernel {
  const PsfKernel* kernel;
  double smooth, linear;
};

/// The kernel between several: PsfSet::at(). All have the same number of pixels.
PsfKernel blend(std::span<const WeightedKernel> nodes);

}  // namespace petzval::analysis_detail
