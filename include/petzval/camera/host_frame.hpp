// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// Renderers whose camera frames are known here.
enum class Host : std::uint8_t { pbrt, mitsuba, cycles, arnold, appleseed };

/// What lies at the origin of a host's camera.
enum class FrameOrigin : std::uint8_t { film, front_vertex, entrance_pupil };

/// A host's camera frame and unit of length, beside the lens frame in mm.
///
/// pbrt, Cycles: left-handed, +x right, +y up, looking along +z: (x, y, -z), a mirror image. Mitsuba: right-handed, +x
/// left, +y up, looking along +z: (-x, y, -z). Arnold, appleseed: looking along -z: as the lens frame. Units per mm:
/// 0.001 for metres (pbrt, Mitsuba, Cycles, appleseed), 0.1 for centimetres (Arnold), unless given.
class PETZVAL_API HostFrame {
 public:
  /// Throws Error for an entrance pupil at infinity as the origin and a unit that is not positive and finite.
  HostFrame(Host host, const Lens& lens, FrameOrigin origin);
  HostFrame(Host host, const Lens& lens, FrameOrigin origin, double units_per_mm);

  double units_per_mm() const noexcept { return units_per_mm_; }
  Vec3<double> point_to_host(const Vec3<double>& lens_mm) const noexcept;
  Vec3<double> point_to_lens(const Vec3<double>& host) const noexcept;
  Vec3<double> direction_to_host(const Vec3<double>& lens) const noexcept;
  Vec3<double> direction_to_lens(const Vec3<double>& host) const noexcept;
  Ray<double> to_host(const Ray<double>& lens) const noexcept;
  Ray<double> to_lens(const Ray<double>& host) const noexcept;

 private:
  Vec3<double> signs_{1, 1, 1};
  double origin_z_ = 0, units_per_mm_ = 1;
};

}  // namespace petzval::inline v0
