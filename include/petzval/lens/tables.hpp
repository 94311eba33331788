// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "petzval/surface/asphere.hpp"
#include "petzval/surface/quadric.hpp"
#include "petzval/surface/snell.hpp"

namespace petzval::kernel {

/// One surface as the kernels read it.
template <class R>
struct SurfaceTable {
  Quadric<R> quadric;
  R gap = 0;                    ///< thickness to the next vertex; 0 behind the last surface
  R semi_diameter_squared = 0;  ///< the rim itself is inside
  R inner_squared = 0;
  std::int32_t asphere = -1;  ///< position among the aspheres, or -1
  bool mirror = false;
  R sense = 1;  ///< along z of light towards the film in front of the surface: -1 behind an odd number of mirrors
};

/// The compiled lens seen by the kernels: flat arrays, borrowed from the Lens.
template <class R>
struct LensView {
  const SurfaceTable<R>* surfaces = nullptr;
  const Asphere<R>* aspheres = nullptr;
  const Interface<R>* to_film = nullptr;   ///< [wavelength * count + surface]
  const Interface<R>* to_scene = nullptr;  ///< the same surfaces met from behind
  std::size_t count = 0;
  const R* vertex_z = nullptr;
  std::size_t wavelengths = 0;
};

}  // namespace petzval::kernel
