// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace petzval::testing {

/// True for each point of the pupil plane if the ray from the film point through it reaches the scene.
inline std::vector<bool> passing(const Lens& lens, const FilmPupilTable& table, const FilmPoint& film,
                                 const std::vector<std::array<double, 2>>& places, Wavelength wavelength = {}) {
  const TwoPlanes& space = table.space();
  const double sense = signed_index(lens, lens.surface_count()) > 0 ? -1 : 1;
  std::vector<Ray<double>> rays;
  for (const auto& [x, y] : places) {
    const Vec3<double> d{x - film.x, y - film.y, space.depth()};
    const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) * (d.z * sense > 0 ? 1 : -1);
    rays.push_back({{x, y, space.pupil_z}, d / length});
  }
  std::vector<TracedRay<double>> traced(rays.size());
  trace<double>(lens, rays, traced.data(), {.travel = Travel::to_scene, .wavelengths = {wavelength}});
  std::vector<bool> result;
  for (const auto& ray : traced) result.push_back(ray.transmitted());
  return result;
}

struct Coverage {
  double mean = 0, worst = 1;  // fraction of samples that pass: mean and minimum over film points
  double missed = 0;           // fraction of the pupils that is not sampled
};

/// Coverage of pupils over film points at several radii. Missed light is counted by rays outside the polygon: rays in a
/// band with a tenth of its area find small errors, rays in a box 1.5 times as large as the polygon find lost
/// components.
inline Coverage coverage(const Lens& lens, const FilmPupilTable& table, double radius, int points, int samples,
                         Wavelength wavelength = {}) {
  std::mt19937_64 random(points);
  std::uniform_real_distribution<double> unit(0, 1);
  Coverage result;
  double band_missed = 0, box_missed = 0, box_passed = 0;
  int lit = 0;
  for (int i = 0; i < points; ++i) {
    const double r = radius * (i + unit(random)) / points, azimuth = 2 * std::numbers::pi * unit(random);
    const FilmPoint film{r * std::sin(azimuth), r * std::cos(azimuth)};
    if (table.area(film, wavelength) == 0) continue;
    ++lit;
    std::vector<std::array<double, 2>> inside, band, box;
    const Vec2<double> middle = table.middle(film, wavelength);
    double reach = 0;
    for (int k = 0; k < samples; ++k) {
      const PupilSample s = table.sample(film, unit(random), unit(random), wavelength);
      const PupilSample edge = table.sample(film, unit(random), 1, wavelength);
      const double out = std::sqrt(1 + 0.1 * unit(random));
      inside.push_back({s.x, s.y});
      band.push_back({middle.x + out * (edge.x - middle.x), middle.y + out * (edge.y - middle.y)});
      reach = std::max(reach, std::hypot(edge.x - middle.x, edge.y - middle.y));
    }
    for (int k = 0; k < samples; ++k) {
      box.push_back({middle.x + 1.5 * reach * (2 * unit(random) - 1), middle.y + 1.5 * reach * (2 * unit(random) - 1)});
    }
    const auto in = passing(lens, table, film, inside, wavelength),
               beside = passing(lens, table, film, band, wavelength), all = passing(lens, table, film, box, wavelength);
    const double part = static_cast<double>(std::count(in.begin(), in.end(), true)) / samples;
    result.mean += part;
    result.worst = std::min(result.worst, part);
    for (int k = 0; k < samples; ++k) {
      const auto outside = [&](const std::array<double, 2>& p) {
        return !table.contains(film, p[0], p[1], wavelength);
      };
      if (beside[k] && outside(band[k])) band_missed += 0.1 / samples;
      if (all[k]) box_passed += 1, box_missed += outside(box[k]);
    }
  }
  result.mean /= std::max(lit, 1);
  result.missed = band_missed / std::max(lit, 1) + box_missed / std::max(box_passed, 1.0);
  return result;
}

}  // namespace petzval::testing
