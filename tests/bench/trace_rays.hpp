// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/kernel_vec.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "textbook_tracer.hpp"

/// Rays in double, and rounded to float.
struct RaySet {
  template <class T>
  struct Of {
    std::vector<petzval::Ray<T>> rays;
    /// Direction of each ray behind the lens in long double; nullopt if the ray is lost.
    std::vector<std::optional<petzval::kernel::Vec<long double>>> exact;
  };
  Of<float> in_float;
  Of<double> in_double;
  double passing = 0;  ///< fraction of rays that pass

  template <class T>
  const Of<T>& of() const {
    if constexpr (std::is_same_v<T, float>) {
      return in_float;
    } else {
      return in_double;
    }
  }
};

/// A lens and rays from its film towards the scene, as in a renderer.
///
/// mix: rays from all over a 3:2 frame towards boxes in the plane of the rear vertex. As in pbrt, the boxes bound the
/// transmitted rays of 64 rings of the film. pass: the transmitted rays of mix.
struct BenchLens {
  std::string id, name;
  petzval::Lens lens;
  TextbookTracer textbook{lens};
  RaySet pass{}, mix{};

  /// half_diagonal: half diagonal of the frame, mm. count: number of rays of each set.
  BenchLens(const petzval::Prescription& prescription, double half_diagonal, std::size_t count);
};
