// SPDX-License-Identifier: Apache-2.0
// Astigmatism along real rays: Coddington equations, surface by surface, compared with exact derivatives of the ray.
#include <gtest/gtest.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#include <ceres/jet.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/aim.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace coddington_test {

using Jet = ceres::Jet<double, 1>;
using kernel::Vec;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Inverse distances of the sagittal and tangential focus from the last hit, along the ray.
struct Vergences {
  double sagittal = 0, tangential = 0;
};

/// Sagittal and tangential curvature of a surface of revolution at a height, from the prescription.
struct Curvatures {
  double sagittal, tangential, slope;
};

Curvatures curvatures(const LensSurface& s, double r) {
  const double c = s.curvature, root = std::sqrt(1 - (1 + s.conic) * c * c * r * r);
  double slope_over_r = c / root, bend = c / (root * root * root);
  for (const AsphereTerm& t : s.aspheric) {
    slope_over_r += t.coefficient * t.order * std::pow(r, t.order - 2);
    bend += t.coefficient * t.order * (t.order - 1) * std::pow(r, t.order - 2);
  }
  const double slope = slope_over_r * r, length = std::hypot(1, slope);
  return {slope_over_r / length, bend / (length * length * length), slope};
}

/// Foci of the pencil around a ray in the y-z plane from a point at z or at infinity, by Coddington: n'/s' = n/s + (n'
/// cos I' - n cos I) c_s in the sagittal section. The tangential section has c_t and the factors cos^2 I' and cos^2 I.
Vergences by_coddington(const Lens& lens, const Ray<double>& ray, double z) {
  std::vector<Vec<double>> hits;
  kernel::trace(petzval::kernel::view<double>(lens), kernel::to_kernel(ray.origin), kernel::to_kernel(ray.direction),
                {.apertures = false}, [&](int, const Vec<double>& hit, const Vec<double>&) { hits.push_back(hit); });
  Vergences v;
  double dy = ray.direction.y, dz = ray.direction.z;
  const auto along = [&](const Vec<double>& from, const Vec<double>& to) {
    return (to.y - from.y) * dy + (to.z - from.z) * dz;
  };
  if (std::isfinite(z)) {
    const double distance = (hits[0].z - z) / dz;
    v = {-1 / distance, -1 / distance};
  }
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const LensSurface& s = lens.surfaces()[i];
    if (i > 0) {
      const double d = along(hits[i - 1], hits[i]);
      v = {v.sagittal / (1 - d * v.sagittal), v.tangential / (1 - d * v.tangential)};
    }
    // The normal is oriented along the ray, and curvatures follow its sign.
    const double height = hits[i].y;
    const auto [c_s, c_t, slope] = curvatures(s, std::abs(height));
    const double signed_slope = std::copysign(slope, slope * height), length = std::hypot(1, slope);
    double ny = -signed_slope / length, nz = 1 / length, cosine = dy * ny + dz * nz;
    const double side = cosine < 0 ? -1 : 1;
    ny *= side, nz *= side, cosine *= side;
    if (s.mirror) {
      v.sagittal -= 2 * cosine * side * c_s;
      v.tangential -= 2 * side * c_t / cosine;
      dy -= 2 * cosine * ny, dz -= 2 * cosine * nz;
      continue;
    }
    const double n = lens.index(i, 0), n_out = lens.index(i + 1, 0);
    const double sine = (dy * nz - dz * ny) * n / n_out, cosine_out = std::sqrt(1 - sine * sine);
    const double bend = (n_out * cosine_out - n * cosine) * side;
    v.sagittal = (n * v.sagittal + bend * c_s) / n_out;
    v.tangential = (n * cosine * cosine * v.tangential + bend * c_t) / (n_out * cosine_out * cosine_out);
    dy = cosine_out * ny + sine * nz, dz = cosine_out * nz - sine * ny;
  }
  return v;
}

/// Foci from derivatives of the ray with respect to its direction from the object point.
Vergences by_derivatives(const Lens& lens, const Ray<double>& ray, double z) {
  Vergences v;
  for (const bool sagittal : {true, false}) {
    Vec<Jet> origin{Jet(ray.origin.x), Jet(ray.origin.y), Jet(ray.origin.z)};
    Vec<Jet> direction{Jet(ray.direction.x), Jet(ray.direction.y), Jet(ray.direction.z)};
    (sagittal ? origin.x : origin.y).v[0] = 1;
    if (std::isfinite(z)) {
      // d = (o - point) / |o - point|, so that dd is the component of do perpendicular to d, divided by the distance.
      const double distance = (ray.origin.z - z) / ray.direction.z;
      const double part = sagittal ? ray.direction.x : ray.direction.y;
      direction.x.v[0] = ((sagittal ? 1 : 0) - part * ray.direction.x) / distance;
      direction.y.v[0] = ((sagittal ? 0 : 1) - part * ray.direction.y) / distance;
      direction.z.v[0] = -part * ray.direction.z / distance;
    }
    const auto end = kernel::trace(petzval::kernel::view<double>(lens), origin, direction, {.apertures = false});
    const Vec<Jet>&o = end.origin, &d = end.direction;
    if (sagittal) {
      v.sagittal = -d.x.v[0] / o.x.v[0];
    } else {
      const double place = o.y.v[0] * d.z.a - o.z.v[0] * d.y.a, turn = d.y.v[0] * d.z.a - d.z.v[0] * d.y.a;
      v.tangential = -turn / place;
    }
  }
  return v;
}

// Spherical and aspheric lenses, mirrors, an eye and fisheyes, up to the edge of their fields.
TEST(Coddington, FociEqualDerivativesOfRays) {
  double worst = 0;
  int rays = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    if (!lens.rotationally_symmetric()) continue;
    const double f = std::abs(*p.focal_length_mm), edge = p.half_field_deg.value_or(1);
    for (const double z : {-infinity, -30 * f}) {
      for (const double share : {0.0, 0.3, 0.7, 1.0}) {
        if (std::isfinite(z) && share * edge > 80) continue;
        const AimedRay chief = chief_ray(lens, {radians(share * edge), z});
        if (!chief || !chief.end.transmitted()) continue;
        const Vergences expected = by_coddington(lens, chief.ray, z), found = by_derivatives(lens, chief.ray, z);
        const double scale = std::max({1 / f, std::abs(expected.sagittal), std::abs(expected.tangential)});
        const double error =
            std::max(std::abs(found.sagittal - expected.sagittal), std::abs(found.tangential - expected.tangential)) /
            scale;
        EXPECT_LE(error, 1e-9) << p.id << " at " << share * edge << " degrees, z = " << z;
        worst = std::max(worst, error);
        ++rays;
      }
    }
  }
  EXPECT_GT(rays, 450);
  RecordProperty("worst", std::to_string(worst * 1e12) + "e-12");
  RecordProperty("rays", rays);
}

}  // namespace coddington_test
}  // namespace petzval
