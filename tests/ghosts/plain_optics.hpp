// SPDX-License-Identifier: Apache-2.0
// Optics of spheres and of single surfaces in plain formulas, independent of the library's code.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "petzval/lens/lens.hpp"

namespace petzval::testing {

using V = Vec3<double>;

/// Reflectances of a bare surface by Fresnel's equations.
struct Bare {
  double s, p;    ///< powers
  double fs, fp;  ///< fields; p in axes along (s x direction)
  double ts, tp;  ///< transmitted powers

  Bare(double in, double out, double cosine) {
    const double sine = in / out * std::sqrt(std::max(0.0, 1 - cosine * cosine));
    if (sine >= 1) {
      s = p = fs = 1, fp = -1, ts = tp = 0;
      return;
    }
    const double other = std::sqrt(1 - sine * sine);
    fs = (in * cosine - out * other) / (in * cosine + out * other);
    fp = (out * cosine - in * other) / (out * cosine + in * other);
    s = fs * fs, p = fp * fp, ts = 1 - s, tp = 1 - p;
  }
  double mean() const { return (s + p) / 2; }
};

/// A coaxial lens of bare spheres, planes, cylinders and aspheres, as numbers.
struct PlainLens {
  struct Surface {
    double z, curvature, rim, before, behind;
    V curved{1, 1, 1};  ///< 0 along the axis of a cylinder
    double conic = 0;
    std::vector<AsphereTerm> terms{};

    /// Sag and its derivative by the height of an asphere.
    std::pair<double, double> sag(double r) const {
      const double root = std::sqrt(1 - (1 + conic) * curvature * curvature * r * r);
      double z_at = curvature * r * r / (1 + root), slope = curvature * r / root;
      for (const AsphereTerm& term : terms) {
        z_at += term.coefficient * std::pow(r, term.order);
        slope += term.order * term.coefficient * std::pow(r, term.order - 1);
      }
      return {z_at, slope};
    }
  };
  std::vector<Surface> surfaces;
  double film_z = 0;

  explicit PlainLens(const Lens& lens) : film_z(lens.film_z()) {
    for (std::size_t i = 0; i < lens.surface_count(); ++i) {
      const LensSurface& own = lens.surfaces()[i];
      const V curved{own.curved_in == Section::y ? 0.0 : 1.0, own.curved_in == Section::x ? 0.0 : 1.0, 1};
      surfaces.push_back({own.vertex_z, own.curvature, own.semi_diameter, lens.index(i), lens.index(i + 1), curved,
                          own.conic, own.aspheric});
    }
  }

  /// Moves a ray to the sheet of a surface at the vertex; nullopt if it misses the surface or its rim. Sets the normal
  /// against the ray.
  std::optional<V> meet(std::size_t i, const V& origin, const V& d, V& normal) const {
    const Surface& own = surfaces[i];
    const V p = origin - V{0, 0, own.z};
    double t = 0;
    const bool asphere = own.conic != 0 || !own.terms.empty();
    if (own.curvature == 0 || asphere) {
      if (d.z == 0) return {};
      t = -p.z / d.z;
      normal = {0, 0, 1};
    } else {
      const double radius = 1 / own.curvature;
      const V from = (p - V{0, 0, radius}) * own.curved, along = d * own.curved;
      const double a = glm::dot(along, along), b = glm::dot(from, along), c = glm::dot(from, from) - radius * radius;
      const double square = b * b - a * c;
      if (square < 0 || a == 0) return {};
      const double root = std::sqrt(square), first = (-b - root) / a, second = (-b + root) / a;
      t = std::abs(p.z + first * d.z) < std::abs(p.z + second * d.z) ? first : second;
      if (std::abs(p.z + d.z * t) > std::abs(radius)) return {};
      normal = glm::normalize(from + along * t);
    }
    if (asphere) {  // Newton's iteration from the plane
      for (int step = 0; step < 20; ++step) {
        const V at = p + d * t;
        const double r = std::hypot(at.x, at.y);
        const auto [z, slope] = own.sag(r);
        const double by_r = r > 0 ? slope / r : 0;
        normal = {-at.x * by_r, -at.y * by_r, 1};
        const double change = (at.z - z) / glm::dot(normal, d);
        t -= change;
        if (!(std::abs(change) > 1e-12)) break;
      }
      normal = glm::normalize(normal);
    }
    const V at = p + d * t;
    if (!(at.x * at.x + at.y * at.y <= own.rim * own.rim)) return {};
    if (glm::dot(normal, d) > 0) normal = -normal;
    return at + V{0, 0, own.z};
  }
};

/// The refracted direction, for a normal against the ray; not called beyond the critical angle.
inline V bent(const V& d, const V& normal, double in, double out) {
  const double cosine = -glm::dot(d, normal), ratio = in / out;
  return d * ratio + normal * (ratio * cosine - std::sqrt(1 - ratio * ratio * (1 - cosine * cosine)));
}

inline V thrown_back(const V& d, const V& normal) { return d - normal * (2 * glm::dot(d, normal)); }

}  // namespace petzval::testing
