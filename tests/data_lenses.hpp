// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval::testing {

/// A lens of data/lenses, such as "double_gauss_100mm_f2.0", or a position of a zoom, such as "zoom_14-30mm_f4:wide".
inline Prescription data_prescription(const std::string& id) {
  const std::string file = id.substr(0, id.find(':'));
  const auto lens = read_prescription(std::filesystem::path(PETZVAL_TEST_DATA) / "lenses" / (file + ".json"));
  return file == id ? lens : configured(lens, id.substr(file.size() + 1));
}

inline Lens data_lens(const std::string& id) { return compile(data_prescription(id)); }

/// A biconvex 100 mm lens behind its stop. The stop is the entrance pupil and the only limiting aperture.
inline Lens front_stop_lens(double stop_semi_diameter = 2) {
  Prescription p;
  p.name = "front stop";
  p.surfaces = {{.thickness = 2, .semi_diameter = stop_semi_diameter, .stop = true},
                {.radius = 102.16, .thickness = 4, .medium = {.nd = 1.5168}, .semi_diameter = 30},
                {.radius = -102.16, .thickness = 98.6, .semi_diameter = 30}};
  return compile(p);
}

/// Every lens of data/lenses in the order of names, and each position of zooms with the id "FILE:POSITION".
inline std::vector<Prescription> data_prescriptions() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(PETZVAL_TEST_DATA) / "lenses")) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Prescription> result;
  for (const auto& file : files) {
    const Prescription lens = read_prescription(file);
    if (lens.configurations.empty()) result.push_back(lens);
    for (const Configuration& position : lens.configurations) {
      result.push_back(configured(lens, position.name));
      result.back().id += ':' + position.name;
    }
  }
  return result;
}

/// A lens whose stop has no rim, with and without the mark of the stop; both must be equal.
struct OpenLens {
  Lens marked, unmarked;
};
inline OpenLens without_the_rim_of_its_stop(Prescription p) {
  for (SurfaceRow& row : p.surfaces) {
    if (row.stop) row.semi_diameter = std::numeric_limits<double>::infinity();
  }
  const Lens marked = compile(p);
  for (SurfaceRow& row : p.surfaces) row.stop = false;
  return {marked, compile(p)};
}

/// An ideal 50 mm lens of thickness 0, which has no edge. The stop is its front surface; only the rear may have a rim.
inline Prescription open_singlet(std::optional<double> rear_semi_diameter = {}) {
  Prescription p;
  p.name = "open";
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  p.surfaces = {{.radius = 50, .medium = {.nd = 1.5}, .semi_diameter = unlimited, .stop = true},
                {.radius = -50, .thickness = 48, .semi_diameter = rear_semi_diameter.value_or(unlimited)}};
  return p;
}

}  // namespace petzval::testing
