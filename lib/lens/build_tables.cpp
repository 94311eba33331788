// SPDX-License-Identifier: Apache-2.0
#include "build_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace petzval::inline v0::lens_detail {
namespace {

kernel::Quadric<double> quadric(const LensSurface& s) {
  return kernel::make_quadric<double>(s.curvature, s.conic, s.curved_in != Section::y, s.curved_in != Section::x);
}

/// x^n by multiplication, so that a lens scaled by 2 gets the same constants times powers of two (pow() may round).
double power(double x, int n) {
  double result = 1;
  for (int i = 0; i < n; ++i) result *= x;
  return result;
}

/// Steeper parts of an asphere are not described: out there a polynomial of high order runs away, and with bounds of
/// sag and slope that held there every ray would have to be searched for. Rays meet them where Newton's iteration finds
/// them. (The steepest asphere of data/lenses has a slope of 3.)
constexpr double steepest = 4;

/// The height at which the strongest term alone has a slope.
double term_height(const LensSurface& s, double slope) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [order, coefficient] : s.aspheric) {
    if (coefficient == 0) continue;
    least = std::min(least, std::pow(order * std::abs(coefficient) / slope, -1.0 / (order - 1)));
  }
  return least;
}

/// The height up to which an asphere may be described: its clear aperture, within the domain of the base conic. An
/// unlimited one ends where the strongest term alone has a slope of one.
double height(const LensSurface& s) {
  constexpr double runs_away = 1e6;  // whatever the other terms are
  const double curvature = std::abs(s.curvature) * std::sqrt(std::max(0.0, 1 + s.conic));
  double limit = curvature > 0 ? 1 / curvature : std::numeric_limits<double>::infinity();
  if (s.semi_diameter > 0) limit = std::min(limit, s.semi_diameter);
  limit = std::min(limit, term_height(s, std::isfinite(s.semi_diameter) ? runs_away : 1));
  return std::isfinite(limit) && limit > 0 ? limit : 1.0;
}

kernel::Asphere<double> asphere_up_to(double height, const LensSurface& s) {
  kernel::Asphere<double> a;
  a.base = quadric(s);
  a.height = height;
  for (const auto& [order, coefficient] : s.aspheric) {
    const double scaled = coefficient * power(a.height, order);
    if (order % 2 == 0) {
      a.even[static_cast<std::size_t>(order / 2 - 1)] += scaled;
      a.even_count = std::max(a.even_count, order / 2);
    } else {
      a.odd[static_cast<std::size_t>((order - 3) / 2)] += scaled;
      a.odd_count = std::max(a.odd_count, (order - 1) / 2);
    }
  }
  return a;
}

kernel::Asphere<double> asphere(const LensSurface& s) {
  // Bounds of sag and slope from samples, widened by more than what can lie between two of them on a surface of 40th
  // order.
  constexpr int samples = 256;
  kernel::Asphere<double> a = asphere_up_to(height(s), s);
  for (int i = 0; i <= samples; ++i) {
    const double r = a.height * i / samples;
    const auto [z, slope, defined] = kernel::sag(a, r * r);
    if (!defined) continue;
    if (!(std::abs(slope) * r <= steepest)) {
      a = asphere_up_to(a.height * std::max(i - 1, 1) / samples, s);
      i = -1;
      continue;
    }
    a.lowest = std::min(a.lowest, z);
    a.highest = std::max(a.highest, z);
    a.steepest = std::max(a.steepest, std::abs(slope) * r);
  }
  const double margin = 0.02 * (a.highest - a.lowest) + 1e-6 * a.height;
  a.lowest -= margin;
  a.highest += margin;
  a.steepest = 1.02 * a.steepest + 1e-6;
  return a;
}

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
  r.even_count = a.even_count;
  r.odd_count = a.odd_count;
  std::transform(a.even.begin(), a.even.end(), r.even.begin(), [](double v) { return static_cast<R>(v); });
  std::transform(a.odd.begin(), a.odd.end(), r.odd.begin(), [](double v) { return static_cast<R>(v); });
  r.lowest = static_cast<R>(a.lowest);
  r.highest = static_cast<R>(a.highest);
  r.steepest = static_cast<R>(a.steepest);
  return r;
}

}  // namespace

template <class R>
Tables<R> build_tables(std::span<const LensSurface> surfaces, std::optional<std::size_t> stop, const Iris& iris,
                       std::span<const double> indices, std::size_t wavelengths, const Spectrum& spectrum) {
  const std::size_t count = surfaces.size();
  Tables<R> tables;
  tables.wavelengths = wavelengths;
  if (stop) tables.stop = static_cast<std::int32_t>(*stop);
  for (const IrisEdge& edge : iris.edges) {
    tables.iris.push_back({static_cast<R>(edge.nx), static_cast<R>(edge.ny),
                           static_cast<R>(edge.distance * surfaces[*stop].semi_diameter)});
  }
  R sense = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const LensSurface& s = surfaces[i];
    kernel::SurfaceTable<R> row;
    row.quadric = rounded<R>(quadric(s));
    row.gap = i + 1 < count ? static_cast<R>(s.thickness) : R(0);
    row.semi_diameter_squared = static_cast<R>(s.semi_diameter * s.semi_diameter);
    row.obscuration_squared = static_cast<R>(s.obscuration_semi_diameter * s.obscuration_semi_diameter);
    row.mirror = s.mirror;
    row.sense = sense;
    if (s.mirror) sense = -sense;
    if (!s.aspheric.empty()) {
      row.asphere = static_cast<std::int32_t>(tables.aspheres.size());
      tables.aspheres.push_back(rounded<R>(asphere(s)));
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

template Tables<float> build_tables(std::span<const LensSurface>, std::optional<std::size_t>, const Iris&,
                                    std::span<const double>, std::size_t, const Spectrum&);
template Tables<double> build_tables(std::span<const LensSurface>, std::optional<std::size_t>, const Iris&,
                                     std::span<const double>, std::size_t, const Spectrum&);

}  // namespace petzval::inline v0::lens_detail
