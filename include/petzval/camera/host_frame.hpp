// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"

namespace petzval {

class Lens;

/// Renderers whose camera frames are known.
enum class Host : std::uint8_t { pbrt, mitsuba, cycles, arnold, appleseed };

/// The origin of a host's camera frame.
enum class FrameOrigin : std::uint8_t { film, front_vertex, entrance_pupil };

/// Converts between the lens frame in mm and a host's camera frame in its unit of length.
///
/// A point (x, y, z) of the lens frame becomes (x, y, -z) for pbrt and Cycles (left-handed, +x right, +y up, view along
/// +z), and (-x, y, -z) for Mitsuba (right-handed, +x left, +y up, view along +z). Arnold and appleseed look along -z,
/// like the lens frame. Default units per mm: 0.001 for metres (pbrt, Mitsuba, Cycles, appleseed), 0.1 for centimetres
/// (Arnold).
class PETZVAL_API HostFrame {
 public:
  /// @throws Error  if the origin is an entrance pupil at infinity, or units_per_mm is not positive and finite
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

}  // namespace petzval
