// SPDX-License-Identifier: Apache-2.0
// Optics of spheres and of single surfaces in plain formulas, independent of the library's code.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
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

/// A coaxial lens of bare spheres and planes, as numbers.
struct PlainLens {
  struct Surface {
    double z, curvature, rim, before, behind;
  };
  std::vector<Surface> surfaces;
  double film_z = 0;

  explicit PlainLens(const Lens& lens) : film_z(lens.film_z()) {
    for (std::size_t i = 0; i < lens.surface_count(); ++i) {
      const LensSurface& own = lens.surfaces()[i];
      surfaces.push_back({own.vertex_z, own.curvature, own.semi_diameter, lens.index(i), lens.index(i + 1)});
    }
  }

  /// Moves a ray to the sheet of a surface at the vertex; nullopt if it misses the surface or its rim. Sets the normal
  /// against the ray.
  std::optional<V> meet(std::size_t i, const V& origin, const V& d, V& normal) const {
    const Surface& own = surfaces[i];
    const V p = origin - V{0, 0, own.z};
    V at;
    if (own.curvature == 0) {
      if (d.z == 0) return {};
      at = p - d * (p.z / d.z);
      normal = {0, 0, 1};
    } else {
      const double radius = 1 / own.curvature;
      const V centre{0, 0, radius}, from = p - centre;
      const double b = glm::dot(from, d), c = glm::dot(from, from) - radius * radius, root = b * b - c;
      if (root < 0) return {};
      std::optional<double> best;
      for (const double t : {-b - std::sqrt(root), -b + std::sqrt(root)}) {
        const V hit = p + d * t;
        if (std::abs(hit.z) > std::abs(radius)) continue;
        if (!best || std::abs(hit.z) < std::abs((p + d * *best).z)) best = t;
      }
      if (!best) return {};
      at = p + d * *best;
      normal = glm::normalize(at - centre);
    }
    if (std::hypot(at.x, at.y) > own.rim) return {};
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
