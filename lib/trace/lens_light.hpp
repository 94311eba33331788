// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "light_view.hpp"
#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::trace_detail {

/// Transmittance of a lens for exact rays: for every surface a polynomial in the angle of incidence, by wavelength, and
/// for every space its absorption. Immutable, cheap to copy.
///
/// Coatings are as in petzval::transmittance(): surfaces whose coating is unknown are uncoated, and such mirrors lose
/// nothing. Between compiled wavelengths, coefficients are linear between 32 nodes.
class PETZVAL_API LensLight {
 public:
  /// @throws Error  with the surface if a compiled wavelength is outside a table of reflectances
  explicit LensLight(const Lens& lens);

  /// Estimate of the largest error of the product of all surfaces, of the polynomials and between wavelengths.
  double error() const noexcept;
  /// Valid as long as a copy of this object exists.
  template <class R>
  const LightView<R>& view() const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

/// Traces N rays as petzval::trace() and writes the part of the light that each ray passes; 0 for a lost ray.
/// @param light of the lens, or of the lens with another film, stop or focus
template <class T>
void trace_light(const Lens& lens, const LensLight& light, std::size_t count, const RayArrays<const T>& in,
                 const RayArrays<T>& out, RayFate* fates, T* transmittances, const BatchOptions& options) noexcept;

/// Traces one ray.
template <class T>
TracedRay<T> trace_light(const Lens& lens, const LensLight& light, const Ray<T>& ray, T& transmittance,
                         const TraceOptions& options) noexcept;

}  // namespace petzval::trace_detail
