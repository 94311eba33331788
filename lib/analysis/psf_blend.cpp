// SPDX-License-Identifier: Apache-2.0
#include "analysis/psf_blend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analysis/points.hpp"
#include "petzval/core/sobol.hpp"

namespace petzval {
namespace {

using analysis_detail::WeightedKernel;

/// The bundle interpolated between the bundles of several kernels: mean hits, and the fraction of kernels in which the
/// ray passes.
struct MeanBundle {
  int side = 0;
  std::vector<double> x, y, passing;

  /// If the ray passes in all kernels, smooth means are used. Near the edge of the pupil, where some kernels lose the
  /// ray, linear means over the adjacent kernels with the ray are used.
  explicit MeanBundle(std::span<const WeightedKernel> nodes) : side(nodes.front().kernel->pixels) {
    const std::size_t count = nodes.front().kernel->hits_x.size();
    x.assign(count, 0.0), y = passing = x;
    std::vector<double> smooth_x = x, smooth_y = x;
    for (const auto& [kernel, smooth, linear] : nodes) {
      for (std::size_t i = 0; i < count; ++i) {
        const auto hit_x = static_cast<double>(kernel->hits_x[i]), hit_y = static_cast<double>(kernel->hits_y[i]);
        smooth_x[i] += smooth * hit_x, smooth_y[i] += smooth * hit_y;  // NaN if lost
        if (linear == 0 || std::isnan(hit_x)) continue;
        x[i] += linear * hit_x, y[i] += linear * hit_y, passing[i] += linear;
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (passing[i] > 0) x[i] /= passing[i], y[i] /= passing[i];
      if (!std::isnan(smooth_x[i])) x[i] = smooth_x[i], y[i] = smooth_y[i];
    }
  }

  /// The hit of a pupil point's ray, and the fraction of its light.
  struct Hit {
    double x = 0, y = 0, light = 0;
  };

  /// u in turns and v as squared radius, as in PupilSampler. Linear between rays. Extrapolates beyond the last rays at
  /// the centre and the rim if all four neighbours pass in all kernels.
  Hit at(double u, double v) const noexcept {
    const double column = u * side - 0.5 + side, row = std::sqrt(v) * side - 0.5;  // u is periodic
    const int c = static_cast<int>(column), r = std::clamp(static_cast<int>(std::floor(row)), 0, side - 2);
    const double right = column - c;
    double down = row - r;
    const auto index = [&](int i, int k) {
      return static_cast<std::size_t>(r + i) * static_cast<std::size_t>(side) +
             static_cast<std::size_t>((c + k) % side);
    };
    const std::array<std::size_t, 4> near{index(0, 0), index(0, 1), index(1, 0), index(1, 1)};
    const bool whole = std::all_of(near.begin(), near.end(), [&](std::size_t i) { return passing[i] > 1 - 1e-9; });
    if (!whole) down = std::clamp(down, 0.0, 1.0);
    const std::array<double, 4> corner_weights{(1 - down) * (1 - right), (1 - down) * right, down * (1 - right),
                                               down * right};
    Hit hit;
    for (std::size_t k = 0; k < near.size(); ++k) {
      const double weight = corner_weights[k] * passing[near[k]];
      hit.light += weight, hit.x += weight * x[near[k]], hit.y += weight * y[near[k]];
    }
    if (hit.light > 0) hit.x /= hit.light, hit.y /= hit.light;
    return hit;
  }
};

}  // namespace

PsfKernel analysis_detail::blend(std::span<const WeightedKernel> nodes) {
  PsfKernel result;
  result.pixels = nodes.front().kernel->pixels;
  result.chief_ray = true;
  // The light is proportional to the area of the pupil: the square of an amplitude that is a smooth function of
  // f-number and field up to nodes without light.
  double most = 0, amplitude = 0, linear_amplitude = 0;
  bool dark = false;
  for (const auto& [kernel, smooth, linear] : nodes) {
    result.anchor_mm += smooth * kernel->anchor_mm;
    amplitude += smooth * std::sqrt(kernel->total);
    linear_amplitude += linear * std::sqrt(kernel->total);
    dark = dark || kernel->total == 0;
    if (linear == 0) continue;
    result.chief_ray = result.chief_ray && kernel->chief_ray;
    result.throughput += linear * kernel->throughput;
    result.error += linear * kernel->error;
    result.rays += kernel->rays;
    result.pixel_mm = std::max(result.pixel_mm, kernel->pixel_mm);
    if (linear > most) most = linear, result.diffraction = kernel->diffraction;
  }
  const std::size_t plane = static_cast<std::size_t>(result.pixels) * static_cast<std::size_t>(result.pixels);
  result.light.assign(plane, 0.0f);
  result.hits_x.assign(plane, std::nanf("")), result.hits_y = result.hits_x;
  const MeanBundle bundle(nodes);
  bool lit = false;
  double half = 0;
  for (std::size_t i = 0; i < plane; ++i) {
    if (bundle.passing[i] == 0) continue;
    lit = true;
    half = std::max({half, std::abs(bundle.x[i]), std::abs(bundle.y[i])});
    result.hits_x[i] = static_cast<float>(bundle.x[i]), result.hits_y[i] = static_cast<float>(bundle.y[i]);
  }
  if (!lit) return result;
  result.pixel_mm = 2 * analysis_detail::fitting_half_width(half) / result.pixels;

  // The bundle is sampled like a pupil, always at the same pupil points.
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
  result.total = dark ? linear_amplitude * linear_amplitude : amplitude * amplitude;
  for (std::size_t i = 0; i < plane; ++i) result.light[i] = static_cast<float>(light[i] * (result.total / all));
  return result;
}

}  // namespace petzval
