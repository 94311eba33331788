// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/trace/trace.hpp"
#include "trace/sequential.hpp"

/// The lenses of data/lenses and transmitted rays.
namespace testing_lenses {

struct Sample {
  std::string id;
  petzval::Prescription prescription;
  petzval::Lens lens;
  double size;  ///< largest clear aperture, mm
};

inline Sample sample_of(petzval::Prescription prescription, const std::string& id) {
  auto lens = petzval::compile(prescription);
  double size = 0;
  for (const auto& s : lens.surfaces()) {
    if (std::isfinite(s.semi_diameter)) size = std::max(size, s.semi_diameter);
  }
  return {id, std::move(prescription), std::move(lens), size};
}

inline Sample load(const std::string& id) { return sample_of(petzval::testing::data_prescription(id), id); }

/// Every lens of data/lenses in the order of names; zooms in each position.
inline const std::vector<Sample>& all() {
  static const std::vector<Sample> samples = [] {
    std::vector<Sample> result;
    for (const auto& lens : petzval::testing::data_prescriptions()) result.push_back(sample_of(lens, lens.id));
    return result;
  }();
  return samples;
}

/// A lens of one surface between two media.
inline petzval::Lens one_surface(const petzval::SurfaceRow& row, double n_in = 1) {
  petzval::Prescription p;
  p.name = "one surface";
  p.object_space.nd = n_in;
  p.surfaces = {row};
  return petzval::compile(p);
}

/// Rays in object space that pass the lens to the film, found from points of the stop (or of the first surface)
/// outwards. Deterministic. Fewer than `count` if few rays pass the lens.
inline std::vector<petzval::Ray<double>> passing_rays(const petzval::Lens& lens, std::size_t count, unsigned seed = 1) {
  using petzval::Travel;
  const auto view = petzval::kernel::view<double>(lens);
  const std::size_t stop = lens.stop().value_or(0);
  const auto& at = lens.surfaces()[stop];
  const bool mirrors =
      std::any_of(lens.surfaces().begin(), lens.surfaces().end(), [](const auto& s) { return s.mirror; });
  double towards = -1;
  for (std::size_t i = 0; i < stop; ++i) towards *= lens.surfaces()[i].mirror ? -1 : 1;

  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<petzval::Ray<double>> rays;
  for (int i = 0; i < 4000 && rays.size() < count; ++i) {
    const double reach = 0.98 * at.semi_diameter * std::sqrt(uniform(random)), turn = 6.3 * uniform(random);
    const double slope = (mirrors ? 0.02 : 0.4) * std::pow(uniform(random), 2), heading = 6.3 * uniform(random);
    const petzval::kernel::Vec<double> d{slope * std::cos(heading), slope * std::sin(heading),
                                         towards * std::sqrt(1 - slope * slope)};
    petzval::kernel::Vec<double> p{reach * std::cos(turn), reach * std::sin(turn), at.vertex_z};
    const auto out = trace(view, p, d, {.travel = Travel::to_scene, .last = stop});
    if (out.fate != petzval::RayFate::transmitted) continue;
    const auto start = out.origin + out.direction * (1 + 10 * uniform(random));
    const petzval::Ray<double> ray{petzval::kernel::to_public(start), petzval::kernel::to_public(out.direction * -1.0)};
    if (petzval::trace(lens, ray).transmitted()) rays.push_back(ray);
  }
  return rays;
}

}  // namespace testing_lenses
