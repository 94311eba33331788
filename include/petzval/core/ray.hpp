// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/vec.hpp"

namespace petzval::inline v0 {

/// A ray in the lens frame: millimetres, right-handed, origin at the vertex of the first surface, light from
/// scene to film travels towards +z.
template <class T>
struct Ray {
  Vec3<T> origin{0, 0, 0};
  Vec3<T> direction{0, 0, 1};  ///< unit length
};

/// Rays as a structure of arrays: N values each, lens frame, unit directions.
template <class T>
struct RayArrays {
  T* x = nullptr;
  T* y = nullptr;
  T* z = nullptr;
  T* dx = nullptr;
  T* dy = nullptr;
  T* dz = nullptr;
};

/// Which way a ray goes through the lens. It decides the order of surfaces and indices and the root of each
/// intersection; the sign of the ray's own z component does not (a fisheye takes rays that run towards -z).
enum class Travel : std::uint8_t { to_film, to_scene };

/// What became of a ray. Everything but `transmitted` is an end, at the surface reported with it.
enum class RayFate : std::uint8_t {
  transmitted,        ///< left the last surface asked for
  missed_surface,     ///< has no point in common with the surface (or only on its far sheet)
  totally_reflected,  ///< beyond the critical angle
  vignetted,  ///< outside the clear aperture (or what is described of an asphere), or in the hole of an annular one
  no_convergence,  ///< the iteration for an asphere found no answer
  outside_fit,     ///< outside the domain of a fitted model of the lens
  outside_film,    ///< starts, or ends, beside the film of a camera
};

/// The fate in words, as the programs print it: "transmitted", "missed_surface", ...
PETZVAL_API std::string_view name(RayFate fate) noexcept;

/// A traced ray: where and how it went on, or where it ended.
///
/// origin is the hit on the last surface reached, direction the direction after it (before it, where the ray ended
/// there). A ray that ended as missed_surface or no_convergence did not reach the surface that ended it: its origin is
/// the hit on the surface met before that one, and its own old origin where there is none. Always finite. surface
/// counts from 0: the last surface passed when transmitted, else the one that ended it.
template <class T>
struct TracedRay {
  Ray<T> ray;
  RayFate fate = RayFate::transmitted;
  int surface = -1;

  bool transmitted() const noexcept { return fate == RayFate::transmitted; }
};

}  // namespace petzval::inline v0
