// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/camera.hpp"

#include <cmath>
#include <string>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

Vec3<double> signs_of(Host host) noexcept {
  switch (host) {
    case Host::pbrt:
    case Host::cycles: return {1, 1, -1};
    case Host::mitsuba: return {-1, 1, -1};
    case Host::arnold:
    case Host::appleseed: break;
  }
  return {1, 1, 1};
}

double usual_unit(Host host) noexcept { return host == Host::arnold ? 0.1 : 0.001; }

double z_of(const Lens& lens, DistanceOrigin origin) {
  if (origin != DistanceOrigin::entrance_pupil) return origin_z(lens, origin);
  const double z = pupils(lens, lens.primary_wavelength()).entrance.z;
  if (std::isfinite(z)) return z;
  throw Error(
      lens.name() +
      ": host frame: the entrance pupil is at infinity; must be at a finite distance, or choose another origin");
}

}  // namespace

HostFrame::HostFrame(Host host, const Lens& lens, DistanceOrigin origin)
    : HostFrame(host, lens, origin, usual_unit(host)) {}

HostFrame::HostFrame(Host host, const Lens& lens, DistanceOrigin origin, double units_per_mm)
    : signs_(signs_of(host)), origin_z_(z_of(lens, origin)), units_per_mm_(units_per_mm) {
  // Areas and their reciprocals stay finite, also as floats.
  if (!(units_per_mm >= 1e-15 && units_per_mm <= 1e15)) {
    throw Error(lens.name() + ": host frame: units_per_mm = " + to_text(units_per_mm) + "; must be from 1e-15 to 1e15");
  }
}

// A sign is its own inverse, so both directions differ only in the order of operations.
Vec3<double> HostFrame::point_to_host(const Vec3<double>& lens_mm) const noexcept {
  return (lens_mm - Vec3<double>{0, 0, origin_z_}) * signs_ * units_per_mm_;
}

Vec3<double> HostFrame::point_to_lens(const Vec3<double>& host) const noexcept {
  return host * signs_ / units_per_mm_ + Vec3<double>{0, 0, origin_z_};
}

Vec3<double> HostFrame::direction_to_host(const Vec3<double>& lens) const noexcept { return lens * signs_; }

Vec3<double> HostFrame::direction_to_lens(const Vec3<double>& host) const noexcept { return host * signs_; }

Ray<double> HostFrame::to_host(const Ray<double>& lens) const noexcept {
  return {point_to_host(lens.origin), direction_to_host(lens.direction)};
}

Ray<double> HostFrame::to_lens(const Ray<double>& host) const noexcept {
  return {point_to_lens(host.origin), direction_to_lens(host.direction)};
}

}  // namespace petzval
