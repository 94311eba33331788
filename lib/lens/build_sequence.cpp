// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "build_tables.hpp"

namespace petzval::lens_detail {
namespace {

/// Distance between vertices, in radii of curvature, beyond which a ray is moved near the vertex before it is
/// intersected: the direct form loses digits with the square of the distance.
constexpr double max_gap_ratio = 1;

/// Squared height of a hit, in radii of curvature of the next sphere, above which the direct form would lose half of
/// the digits: its quadratic subtracts squares of the height. Only rays nearly perpendicular to the axis reach such
/// heights, and they can hit the next sphere, at most a radius away, only if they keep this direction.
template <class R>
double furthest2() noexcept {
  return 1 / std::sqrt(double{std::numeric_limits<R>::epsilon()});
}

/// Directions are normalised after this number of surfaces, and before very steep rims, where an error of the length
/// has twice the effect. Normalising more often would only add rounding errors. (Without normalisation the error is
/// 3.1e-7 rad RMS on the fisheye of the benchmark.)
constexpr std::size_t surfaces_per_refresh = 16;
constexpr double steep_rim = 0.75;

/// True if light meets the same surface again, as on the path of a ghost, which may pass the stop three times.
bool same_surface(const LensSurface& a, const LensSurface& b) noexcept {
  return a.vertex_z == b.vertex_z && a.curvature == b.curvature && a.semi_diameter == b.semi_diameter;
}

}  // namespace

template <class R>
SurfaceSequenceTables<R> build_sequence(std::span<const LensSurface> surfaces, std::optional<std::size_t> stop,
                                        std::span<const double> indices, std::size_t wavelengths,
                                        const Spectrum& spectrum, Travel travel) {
  using kernel::StepKind;
  const std::size_t count = surfaces.size();
  const bool to_film = travel == Travel::to_film;
  const auto mirrors = std::count_if(surfaces.begin(), surfaces.end(), [](const LensSurface& s) { return s.mirror; });
  double sense = to_film ? 1 : mirrors % 2 == 0 ? -1 : 1;

  std::vector<std::int32_t> aspheres;
  std::int32_t seen = 0;
  for (const LensSurface& s : surfaces) aspheres.push_back(s.aspheric.empty() ? -1 : seen++);

  SurfaceSequenceTables<R> tables;
  tables.sequence.first_sense = static_cast<R>(sense);
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t i = to_film ? j : count - 1 - j;
    const LensSurface& s = surfaces[i];
    const double gap = j == 0 ? 0 : sense * (to_film ? surfaces[i - 1].thickness : -s.thickness);
    const auto quadric =
        kernel::make_quadric<R>(sense * s.curvature, s.conic, s.curved_in != Section::y, s.curved_in != Section::x);
    kernel::Step<R> step;
    step.kind = !s.aspheric.empty()           ? StepKind::asphere
                : !quadric.sphere || s.mirror ? StepKind::quadric
                : s.curvature == 0            ? StepKind::plane
                                              : StepKind::sphere;
    step.far = j == 0 || !(std::abs(s.curvature * gap) <= max_gap_ratio);
    step.mirror = s.mirror;
    step.stop = stop && same_surface(s, surfaces[*stop]);
    step.refresh = j > 0 && (j % surfaces_per_refresh == 0 || std::abs(s.curvature) * s.semi_diameter > steep_rim);
    step.surface = static_cast<std::int32_t>(i);
    step.asphere = aspheres[i];
    step.gap = static_cast<R>(gap);
    step.curvature = quadric.curvature;
    step.e = quadric.e;
    step.ax = quadric.ax;
    step.ay = quadric.ay;
    step.sense = static_cast<R>(sense);
    step.obscuration2 = static_cast<R>(s.obscuration_semi_diameter * s.obscuration_semi_diameter);
    tables.steps.push_back(step);
    if (s.mirror) sense = -sense;
  }
  for (std::size_t j = 0; j < count; ++j) {
    kernel::Step<R>& step = tables.steps[j];
    double reach2 = 1e15 * 1e15;  // mm^2: farther out, height and direction lack digits
    if (j + 1 < count && tables.steps[j + 1].kind == StepKind::sphere && !tables.steps[j + 1].far) {
      const double curvature = surfaces[static_cast<std::size_t>(tables.steps[j + 1].surface)].curvature;
      reach2 = std::min(reach2, furthest2<R>() / (curvature * curvature));
    }
    const double semi_diameter = surfaces[static_cast<std::size_t>(step.surface)].semi_diameter;
    step.reach2 = static_cast<R>(reach2);
    step.rim2 = static_cast<R>(std::min(semi_diameter * semi_diameter, reach2));
  }
  tables.sequence.first_z = static_cast<R>((to_film ? surfaces.front() : surfaces.back()).vertex_z);
  tables.sequence.last_z = static_cast<R>((to_film ? surfaces.back() : surfaces.front()).vertex_z);
  tables.sequence.last_sense = static_cast<R>(sense);

  const std::size_t row = kernel::row_length<R>(wavelengths);
  tables.bend_rows.resize(3 * count * row);
  tables.n_first.resize(row);
  tables.per_n_last.resize(row);
  for (std::size_t w = 0; w < wavelengths; ++w) {
    const double* n = indices.data() + w * (count + 1);
    for (auto& step : tables.steps) {
      const auto i = static_cast<std::size_t>(step.surface);
      const double in = n[to_film ? i : i + 1], out = n[to_film ? i + 1 : i];
      const double curvature = double{step.sense} * surfaces[i].curvature;
      step.bends = step.bends || in != out;
      const kernel::RefractionConstants<R> bend{static_cast<R>(curvature * in * in),
                                                static_cast<R>((out - in) * (out + in)), static_cast<R>(1 / (in * in))};
      R* const rows = tables.bend_rows.data() + 3 * (tables.bends.size() % count) * row + w;
      rows[0] = bend.cn2;
      rows[row] = bend.k;
      rows[2 * row] = bend.per_n2;
      tables.bends.push_back(bend);
    }
    tables.n_first[w] = static_cast<R>(n[to_film ? 0 : count]);
    tables.per_n_last[w] = static_cast<R>(1 / n[to_film ? count : 0]);
  }
  const auto& coordinate = spectrum.coordinate();
  tables.sequence.coordinate = {static_cast<R>(coordinate.shortest), static_cast<R>(coordinate.longest),
                                static_cast<R>(coordinate.scale), static_cast<R>(coordinate.offset)};
  for (std::size_t j = 0; j <= count; ++j) {
    const kernel::SquaredIndex<double>& medium = spectrum.medium(to_film ? j : count - j);
    kernel::SquaredIndex<R>& rounded = tables.media.emplace_back();
    std::transform(medium.by_power.begin(), medium.by_power.end(), rounded.by_power.begin(),
                   [](double c) { return static_cast<R>(c); });
    rounded.constant = medium.constant;
  }
  return tables;
}

template SurfaceSequenceTables<float> build_sequence(std::span<const LensSurface>, std::optional<std::size_t>,
                                                     std::span<const double>, std::size_t, const Spectrum&, Travel);
template SurfaceSequenceTables<double> build_sequence(std::span<const LensSurface>, std::optional<std::size_t>,
                                                      std::span<const double>, std::size_t, const Spectrum&, Travel);

}  // namespace petzval::lens_detail
