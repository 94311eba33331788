// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace petzval::trace_detail {

/// The variable of a polynomial for the transmittance of a surface, made from the components of the directions along
/// the normal, times the indices (p N and p' N in steps.hpp).
enum class LightVariable : std::uint8_t {
  /// high / (low + pole high) of the smaller component low and the larger one high. Fresnel's equations are rational in
  /// low / high, and their poles are near -pole, so that few terms suffice.
  ratio,
  cosine,  ///< the component in the medium of the lower index, or at a mirror
};

/// The side of a surface on which the index is lower, at all wavelengths.
enum class LowerIndex : std::uint8_t { before, behind, varies };

/// The polynomial of a surface: coefficients from the highest power on, in powers of scale * variable + offset.
template <class R>
struct SurfacePolynomial {
  LightVariable variable = LightVariable::ratio;
  LowerIndex lower = LowerIndex::varies;  ///< before at a mirror
  R pole = 1, scale = 1, offset = 0;
  std::uint32_t first = 0, terms = 0;  ///< rows of the coefficients; no terms: all light passes
};

/// Numbers by wavelength, one row for each coefficient: values at nodes, and for wavelengths between the nodes the
/// differences to the next node.
template <class R>
struct LightRows {
  const R *values = nullptr, *differences = nullptr;
  std::size_t count = 0, length = 0;
};

/// Tables of the light that the surfaces of a lens pass (LensLight), borrowed by the loops over rays.
template <class R>
struct LightView {
  const SurfacePolynomial<R>* surfaces = nullptr;
  LightRows<R> compiled;  ///< nodes are the compiled wavelengths
  LightRows<R> between;   ///< nodes are equally spaced in SpectralCoordinate; empty if only compiled wavelengths exist
  std::uint32_t first_depth = 0;  ///< row of the first space: absorption times index, 1/mm
  bool absorbs = false;
};

/// Position of a wavelength in LightView::between.
template <class R>
struct LightNode {
  std::int32_t node = 0;
  R fraction = 0;
};

/// @param t as SpectralCoordinate::at(); values outside -1 to 1 and NaN are limited
template <class R>
inline LightNode<R> light_node(const LightRows<R>& rows, R t) noexcept {
  const auto last = static_cast<std::int32_t>(rows.count) - 2;
  R at = (t + R(1)) * (R(0.5) * static_cast<R>(last + 1));
  at = at > R(0) ? at : R(0);
  at = at < static_cast<R>(last + 1) ? at : static_cast<R>(last + 1);
  auto node = static_cast<std::int32_t>(at);
  node = node < last ? node : last;
  return {node, at - static_cast<R>(node)};
}

}  // namespace petzval::trace_detail
