// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/analysis/psf.hpp"

namespace petzval::analysis_detail {

/// A kernel and its weights in two blends. In each blend the sum of the weights is 1. The weights `smooth` belong to
/// polynomials through all surrounding nodes, and some are negative. The weights `linear` belong to lines through
/// adjacent nodes, and are 0 for other nodes.
struct WeightedKernel {
  const PsfKernel* kernel;
  double smooth, linear;
};

/// Interpolates a kernel between several nodes, for PsfSet::at(). All nodes must have the same number of pixels.
PsfKernel blend(std::span<const WeightedKernel> nodes);

}  // namespace petzval::analysis_detail
