// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "petzval/surface/asphere.hpp"
#include "petzval/surface/quadric.hpp"
#include "petzval/surface/snell.hpp"

namespace petzval::inline v0::kernel {

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

/// Which intersection a surface needs in a batch.
enum class StepKind : std::uint8_t { plane, sphere, quadric, asphere };

/// One surface as a batch meets it: in the order of travel, and in a frame that is turned round at every mirror and for
/// rays towards the scene, so that light always runs towards +z.
template <class R>
struct Step {
  StepKind kind = StepKind::plane;
  bool far = false;          ///< begins so far off that the ray must be brought near the vertex first
  bool bends = false;        ///< the media on its sides differ, at one wavelength at least
  bool mirror = false;       ///< after which the frame turns round
  bool stop = false;         ///< where the iris stands
  bool refresh = false;      ///< directions have gathered the rounding of many surfaces: put their length right
  std::int32_t surface = 0;  ///< its position in the lens
  std::int32_t asphere = -1;
  R gap = 0;                               ///< along z, from the vertex before
  R curvature = 0, e = 1, ax = 1, ay = 1;  ///< as in Quadric, in the turned frame
  R sense = 1;                             ///< -1 where the frame is turned
  R rim2 = 0, hole2 = 0;                   ///< squared semi-diameters; unlimited: the largest finite number
};

/// What refraction at a step needs in the algebra of directions scaled by the index, |p| = n.
template <class R>
struct RefractionConstants {
  R cn2 = 0;     ///< curvature n^2, in front
  R k = 0;       ///< n'^2 - n^2
  R per_n2 = 1;  ///< 1 / n^2, in front
};

/// The way of a batch through the lens.
template <class R>
struct SurfaceSequence {
  const Step<R>* steps = nullptr;
  const RefractionConstants<R>* bends = nullptr;  ///< [wavelength * count + step]
  const R* n_first = nullptr;                     ///< [wavelength], in front of the lens
  const R* per_n_last = nullptr;                  ///< [wavelength], behind it
  R first_z = 0, last_z = 0;                      ///< vertices of the first and the last step, lens frame
  R first_sense = 1, last_sense = 1;              ///< -1 where the frame in front and behind is turned
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
  std::size_t primary = 0;  ///< position of the primary wavelength
  std::int32_t stop = -1;   ///< where the iris stands, or -1
  SurfaceSequence<R> sequence_to_film{}, sequence_to_scene{};
};

}  // namespace petzval::inline v0::kernel
