// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "lens/lens_view.hpp"

namespace testing_lenses {

/// The tables of a lens in another floating-point type, with a view.
template <class R>
struct Tables {
  std::vector<petzval::kernel::SurfaceTable<R>> surfaces;
  std::vector<petzval::kernel::Asphere<R>> aspheres;
  std::vector<petzval::kernel::Interface<R>> to_film, to_scene;
  std::vector<R> vertex_z;

  petzval::kernel::LensView<R> view() const {
    return {surfaces.data(), aspheres.data(), to_film.data(), to_scene.data(), surfaces.size(), vertex_z.data(), 1};
  }
};

/// The tables of a lens in long double, the reference for rays in double and float.
inline Tables<long double> extended(const petzval::kernel::LensView<double>& view) {
  using L = long double;
  Tables<L> t;
  const auto quadric = [](const auto& q) {
    return petzval::kernel::Quadric<L>{q.curvature, q.e, q.ax, q.ay, q.sphere, q.cylinder, q.steep_conic};
  };
  for (std::size_t i = 0; i < view.count; ++i) {
    const auto& s = view.surfaces[i];
    t.surfaces.push_back(
        {quadric(s.quadric), s.gap, s.semi_diameter_squared, s.obscuration_squared, s.asphere, s.mirror, s.sense});
    t.vertex_z.push_back(view.vertex_z[i]);
    t.to_film.push_back({view.to_film[i].mu, view.to_film[i].k});
    t.to_scene.push_back({view.to_scene[i].mu, view.to_scene[i].k});
    if (s.asphere < 0) continue;
    const auto& a = view.aspheres[s.asphere];
    petzval::kernel::Asphere<L> b;
    b.base = quadric(a.base);
    b.height = a.height;
    b.even_count = a.even_count;
    b.odd_count = a.odd_count;
    std::copy(a.even.begin(), a.even.end(), b.even.begin());
    std::copy(a.odd.begin(), a.odd.end(), b.odd.begin());
    b.lowest = a.lowest;
    b.highest = a.highest;
    b.steepest = a.steepest;
    b.edge = a.edge;
    std::transform(a.rings.begin(), a.rings.end(), b.rings.begin(), [](const auto& ring) {
      return petzval::kernel::AsphereRing<L>{ring.inner2,  ring.outer2,     ring.outer,    ring.lowest,
                                             ring.highest, ring.least_bend, ring.most_bend};
    });
    t.aspheres.push_back(b);
  }
  return t;
}

}  // namespace testing_lenses
