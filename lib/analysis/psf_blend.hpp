// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/analysis/psf_set.hpp"

namespace petzval::analysis_detail {

/// A kernel and its weights in two blends, each with the sum 1. smooth: polynomials through all surrounding nodes, with
/// some negative weights. linear: lines through adjacent nodes, 0 for other nodes.
struct WeightedKernel {
  const PsfKernel* kernel;
  double smooth, linear;
};

/// Interpolates a kernel between several nodes, for PsfSet::at(). All nodes must have the same number of pixels.
PsfKernel blend(std::span<const WeightedKernel> nodes);

}  // namespace petzval::analysis_detail
