// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "petzval/camera/bokeh.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/apertures.hpp"
#include "tilted_films.hpp"

namespace petzval::testing {

inline const BokehControls ring{.weight_distribution = 12.7, .weight_strength = 0.6};

/// Controls with a weight map without symmetries.
inline BokehControls mapped() {
  BokehControls result;
  result.weight_map = {16, 16, {}, false};
  for (int i = 0; i < 256; ++i) {
    result.weight_map.values.push_back(static_cast<float>(0.3 + 0.04 * (i % 16) + 0.01 * (i / 16)));
  }
  return result;
}

/// A surface through points at several distances and at infinity. With `extents`, three points set the extent.
inline FocalSurface surface_of(const Lens& lens, const Film& film, bool extents, double nearest_mm = 1200) {
  std::vector<FocalPoint> points{{.film_point = {-12, 6}, .inverse_distance = 1 / nearest_mm},
                                 {.film_point = {11, -5}, .inverse_distance = 1 / 4000.},
                                 {.film_point = {2, 8}, .inverse_distance = 0},
                                 {.film_point = {-4, -9}, .inverse_distance = 1 / 2000.},
                                 {.film_point = {14, 9}, .inverse_distance = 1 / 2600., .weight = 2}};
  if (extents) points[0].extent_stops = 2, points[1].extent_stops = -1, points[2].extent_stops = 0.5;
  return {thick_lens(lens), pose_of(lens, film), points};
}

inline ExpressiveLens aberrations() {
  return {.power = {{0, 1}, {0.5, 1.004}, {0.8, 0.99}, {1, 1.02}},
          .film_offsets = {{{0, 0}, 0}, {{18, 0}, 0.6}, {{-18, 0}, 0.5}, {{0, 12}, -0.4}, {{0, -12}, 0.3}},
          .dispersion = {3}};
}

/// The lens at these wavelengths, with the glasses of data/.
inline Lens compiled(const Prescription& prescription, const std::vector<double>& wavelengths_nm) {
  static const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  return compile(prescription, wavelengths_nm, {.glasses = &glasses, .missing_glass = MissingGlass::abbe});
}

/// Eight wavelengths from 400 to 700 nm, unsorted.
inline std::vector<double> eight_wavelengths() {
  std::vector<double> result;
  for (const int i : {3, 0, 7, 1, 6, 2, 5, 4}) result.push_back(400 + 300. * i / 7);
  return result;
}

}  // namespace petzval::testing
