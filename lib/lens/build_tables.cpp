// SPDX-License-Identifier: Apache-2.0
#include "build_tables.hpp"

#include <algorithm>
#include <limits>

#include "describe_asphere.hpp"
#include "iris/iris_edges.hpp"

namespace petzval::lens_detail {
namespace {

template <class R>
kernel::Quadric<R> rounded(const kernel::Quadric<double>& q) {
  return {static_cast<R>(q.curvature),
          static_cast<R>(q.e),
          static_cast<R>(q.ax),
          static_cast<R>(q.ay),
          q.sphere,
          q.cylinder,
          q.steep_conic};
}

template <class R>
kernel::Asphere<R> rounded(const kernel::Asphere<double>& a) {
  kernel::Asphere<R> r;
  r.base = rounded<R>(a.base);
  r.height = static_cast<R>(a.height);
  r.rim2 = static_cast<R>(a.rim2);
  r.even_count = a.even_count;
  r.odd_count = a.odd_count;
  std::transform(a.even.begin(), a.even.end(), r.even.begin(), [](double v) { return static_cast<R>(v); });
  std::transform(a.odd.begin(), a.odd.end(), r.odd.begin(), [](double v) { return static_cast<R>(v); });
  r.lowest = static_cast<R>(a.lowest);
  r.highest = static_cast<R>(a.highest);
  r.steepest = static_cast<R>(a.steepest);
  r.edge = static_cast<R>(a.edge);
  std::transform(a.rings.begin(), a.rings.end(), r.rings.begin(), [](const kernel::AsphereRing<double>& ring) {
    const double huge = std::numeric_limits<R>::max();
    const auto narrow = [huge](double v) { return static_cast<R>(std::clamp(v, -huge, huge)); };
    return kernel::AsphereRing<R>{narrow(ring.inner2),   narrow(ring.outer2),  narrow(ring.outer),
                                  narrow(ring.lowest),   narrow(ring.highest), narrow(ring.least_bend),
                                  narrow(ring.most_bend)};
  });
  return r;
}

}  // namespace

template <class R>
Tables<R> build_tables(std::span<const LensSurface> surfaces, std::span<const kernel::Asphere<double>> aspheres,
                       std::optional<std::size_t> stop, const Iris& iris, std::span<const double> indices,
                       std::size_t wavelengths, const Spectrum& spectrum) {
  const std::size_t count = surfaces.size();
  Tables<R> tables;
  tables.wavelengths = wavelengths;
  if (stop) tables.stop = static_cast<std::int32_t>(*stop);
  for (const auto& [nx, ny, bend, distance] : iris_detail::edges(iris)) {
    const double rim = surfaces[*stop].semi_diameter;
    tables.iris.push_back({static_cast<R>(nx), static_cast<R>(ny), static_cast<R>(rim > 0 ? bend / rim : 0),
                           static_cast<R>(distance * rim)});
  }
  R sense = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const LensSurface& s = surfaces[i];
    kernel::SurfaceTable<R> row;
    row.quadric = rounded<R>(describe_quadric(s));
    row.gap = i + 1 < count ? static_cast<R>(s.thickness) : R(0);
    row.semi_diameter_squared = static_cast<R>(s.semi_diameter * s.semi_diameter);
    row.obscuration_squared = static_cast<R>(s.obscuration_semi_diameter * s.obscuration_semi_diameter);
    row.mirror = s.mirror;
    row.sense = sense;
    if (s.mirror) sense = -sense;
    if (!s.aspheric.empty()) {
      row.asphere = static_cast<std::int32_t>(tables.aspheres.size());
      tables.aspheres.push_back(rounded<R>(aspheres[tables.aspheres.size()]));
    }
    tables.surfaces.push_back(row);
    tables.vertex_z.push_back(static_cast<R>(s.vertex_z));
  }
  for (std::size_t w = 0; w < wavelengths; ++w) {
    const double* n = indices.data() + w * (count + 1);
    for (std::size_t i = 0; i < count; ++i) {
      tables.to_film.push_back(kernel::make_interface<R>(n[i], n[i + 1]));
      tables.to_scene.push_back(kernel::make_interface<R>(n[i + 1], n[i]));
    }
  }
  tables.sequence_to_film = build_sequence<R>(surfaces, stop, indices, wavelengths, spectrum, Travel::to_film);
  tables.sequence_to_scene = build_sequence<R>(surfaces, stop, indices, wavelengths, spectrum, Travel::to_scene);
  return tables;
}

template Tables<float> build_tables(std::span<const LensSurface>, std::span<const kernel::Asphere<double>>,
                                    std::optional<std::size_t>, const Iris&, std::span<const double>, std::size_t,
                                    const Spectrum&);
template Tables<double> build_tables(std::span<const LensSurface>, std::span<const kernel::Asphere<double>>,
                                     std::optional<std::size_t>, const Iris&, std::span<const double>, std::size_t,
                                     const Spectrum&);

}  // namespace petzval::lens_detail
