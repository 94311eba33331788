// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0 {

/// Derivatives of the points and directions of N rays by two parameters u and v, such as the steps of a pixel; N values
/// each.
template <class T>
struct RayTangents {
  RayArrays<T> u, v;
};

/// Traces N rays with their exact derivatives (double or float), by the chain rule through every surface. There is no
/// step to choose.
///
/// in, out, fates, surfaces, options: as for `trace`. The rays are those of `trace`: to the bit if reproducible, else
/// within some ulp. tangents_in: derivatives of directions are perpendicular to them, as those of unit vectors are.
/// tangents_out: derivatives of the point on the last surface met and of the unit direction behind it; zero for a lost
/// ray, not finite for a ray that leaves exactly along a surface. out may be in, and tangents_out tangents_in.
template <class T>
PETZVAL_API void trace_differentials(const Lens& lens, std::size_t count, const RayArrays<const T>& in,
                                     const RayTangents<const T>& tangents_in, const RayArrays<T>& out,
                                     const RayTangents<T>& tangents_out, RayFate* fates, int* surfaces,
                                     const BatchOptions& options = {}) noexcept;

}  // namespace petzval::inline v0
