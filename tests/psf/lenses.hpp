// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "petzval/io/prescription_json.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

inline std::filesystem::path lens_file(const std::string& id) {
  return std::filesystem::path(PETZVAL_TEST_DATA) / "lenses" / (id + ".json");
}

/// A lens of data/lenses at its reference wavelength.
inline Lens data_lens(const std::string& id) { return compile(read_prescription(lens_file(id))); }

/// A biconvex lens of 100 mm behind a plane stop, so that the stop is the entrance pupil and nothing else clips.
inline Lens front_stop_lens(double stop_semi_diameter = 2) {
  Prescription p;
  p.name = "front stop";
  p.surfaces = {{.thickness = 2, .semi_diameter = stop_semi_diameter, .stop = true},
                {.radius = 102.16, .thickness = 4, .medium = {.nd = 1.5168}, .semi_diameter = 30},
                {.radius = -102.16, .thickness = 98.6, .semi_diameter = 30}};
  return compile(p);
}

}  // namespace petzval
