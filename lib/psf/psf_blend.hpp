// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/psf/psf_set.hpp"

namespace petzval::inline v0::psf_detail {

/// A kernel and its share of a blend; shares are positive and sum to 1.
struct WeightedKernel {
  const PsfKernel* kernel;
  double weight;
};

/// The kernel between several: PsfSet::at(). All have the same number of pixels.
PsfKernel blend(std::span<const WeightedKernel> nodes);

}  // namespace petzval::inline v0::psf_detail
