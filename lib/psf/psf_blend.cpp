// SPDX-License-Identifier: Apache-2.0
#include "psf/psf_blend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "petzval/core/sobol.hpp"

namespace petzval::inline v0 {
namespace {

using psf_detail::WeightedKernel;

/// The bundle between those of several kernels: mean hits, and the share of the kernels whose ray passes.
struct MeanBundle {
  int side = 0;
  std::vector<double> x, y, passing;

  explicit MeanBundle(std::span<const WeightedKernel> nodes) : side(nodes.front().kernel->pixels) {
    const std::size_t count = nodes.front().kernel->hits_x.size();
    x.assign(count, 0.0), y = passing = x;
    for (const auto& [kernel, weight] : nodes) {
      for (std::size_t i = 0; i < count; ++i) {
        if (std::isnan(kernel->hits_x[i])) continue;
        x[i] += weight * static_cast<double>(kernel->hits_x[i]);
        y[i] += weight * static_cast<double>(kernel->hits_y[i]);
        passing[i] += weight;
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (passing[i] > 0) x[i] /= passing[i], y[i] /= passing[i];
    }
  }

  /// Where the ray of a point of the pupil arrives, and how much of it.
  struct Hit {
    double x = 0, y = 0, light = 0;
  };

  /// u in turns, v the square of the radius, as PupilSampler has them. Linear between rays; beyond the last ones at
  /// centre and rim too, where all four neighbours pass whole.
  Hit at(double u, double v) const noexcept {
    const double column = u * side - 0.5 + side, row = std::sqrt(v) * side - 0.5;  // u is periodic
    const int c = static_cast<int>(column), r = std::clamp(static_cast<int>(std::floor(row)), 0, side - 2);
    const double right = column - c;
    double down = row - r;
    const auto place = [&](int i, int k) {
      return static_cast<std::size_t>(r + i) * static_cast<std::size_t>(side) +
             static_cast<std::size_t>((c + k) % side);
    };
    const std::array<std::size_t, 4> near{place(0, 0), place(0, 1), place(1, 0), place(1, 1)};
    const bool whole = std::all_of(near.begin(), near.end(), [&](std::size_t i) { return passing[i] > 1 - 1e-9; });
    if (!whole) down = std::clamp(down, 0.0, 1.0);
    const std::array<double, 4> parts{(1 - down) * (1 - right), (1 - down) * right, down * (1 - right), down * right};
    Hit hit;
    for (std::size_t k = 0; k < near.size(); ++k) {
      const double part = parts[k] * passing[near[k]];
      hit.light += part, hit.x += part * x[near[k]], hit.y += part * y[near[k]];
    }
    if (hit.light > 0) hit.x /= hit.light, hit.y /= hit.light;
    return hit;
  }
};

}  // namespace

PsfKernel psf_detail::blend(std::span<const WeightedKernel> nodes) {
  PsfKernel result;
  result.pixels = nodes.front().kernel->pixels;
  result.chief_ray = true;
  double most = 0, amplitude = 0;
  std::vector<WeightedKernel> lit;
  for (const WeightedKernel& node : nodes) {
    const auto& [kernel, weight] = node;
    result.chief_ray = result.chief_ray && kernel->chief_ray;
    result.anchor_mm += weight * kernel->anchor_mm;
    result.throughput += weight * kernel->throughput;
    result.error += weight * kernel->error;
    result.rays += kernel->rays;
    amplitude += weight * std::sqrt(kernel->total);
    result.pixel_mm = std::max(result.pixel_mm, kernel->pixel_mm);
    if (weight > most) most = weight, result.diffraction = kernel->diffraction;
    if (kernel->total > 0) lit.push_back(node);
  }
  const std::size_t plane = static_cast<std::size_t>(result.pixels) * static_cast<std::size_t>(result.pixels);
  result.light.assign(plane, 0.0f);
  result.hits_x.assign(plane, std::nanf("")), result.hits_y = result.hits_x;
  if (lit.empty()) return result;

  const MeanBundle bundle(lit);
  double half = 0;
  for (std::size_t i = 0; i < plane; ++i) {
    if (bundle.passing[i] == 0) continue;
    half = std::max({half, std::abs(bundle.x[i]), std::abs(bundle.y[i])});
    result.hits_x[i] = static_cast<float>(bundle.x[i]), result.hits_y[i] = static_cast<float>(bundle.y[i]);
  }
  result.pixel_mm = 2 * std::max(1.05 * half, 1e-4) / result.pixels;

  // The bundle is sampled as rays are, from the same points of the pupil each time.
  constexpr std::size_t samples = 1u << 20, block = 4096;
  std::vector<double> u(block), v(block), light(plane, 0.0);
  const double per_mm = 1 / result.pixel_mm, middle = result.pixels / 2.0;
  double all = 0;
  for (std::size_t begin = 0; begin < samples; begin += block) {
    owen_sobol(static_cast<std::uint32_t>(begin), 0, u, v);
    for (std::size_t i = 0; i < block; ++i) {
      const MeanBundle::Hit hit = bundle.at(u[i], v[i]);
      const double column = hit.x * per_mm + middle, row = middle - hit.y * per_mm;
      if (!(column >= 0 && column < result.pixels && row >= 0 && row < result.pixels)) continue;
      light[static_cast<std::size_t>(row) * static_cast<std::size_t>(result.pixels) +
            static_cast<std::size_t>(column)] += hit.light;
      all += hit.light;
    }
  }
  // Light goes with the area of the pupil: the square of what f-numbers and fields change evenly.
  result.total = amplitude * amplitude;
  for (std::size_t i = 0; i < plane; ++i) result.light[i] = static_cast<float>(light[i] * (result.total / all));
  return result;
}

}  // namespace petzval::inline v0
