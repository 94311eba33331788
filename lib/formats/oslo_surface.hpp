// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import.hpp"

namespace petzval::formats_detail {

/// PK: a value picked up from another surface.
struct OsloPickup {
  int line = 0;
  std::string what;
  int surface = 0;
  double constant = 0;
};

struct OsloMedium {
  int line = 0;
  enum class Kind { air, mirror, glass, indices } kind = Kind::air;
  std::string name;
  std::vector<double> indices;      ///< at `wavelengths`
  std::vector<double> wavelengths;  ///< micrometres
};

/// A surface as stated in the file, in the file's unit.
struct OsloSurface {
  int line = 0;
  double curvature = 0;
  std::optional<double> thickness;
  OsloMedium medium;
  std::optional<double> aperture;
  bool checked = false;  ///< rays end at the aperture
  bool stop = false;
  double conic = 0;
  std::map<int, double> terms;   ///< aspheric coefficients by order
  std::string asphere;           ///< ASP: type of the asphere
  std::optional<double> height;  ///< PY: height of the axial ray on the next surface
  std::vector<OsloPickup> pickups;
  std::string note;
};

/// A lens as stated in a file of OSLO.
struct OsloLens {
  int line = 0;                 ///< line of LEN
  std::optional<double> scale;  ///< the number of LEN
  double unit = 1;              ///< mm
  std::vector<OsloSurface> surfaces;
  std::vector<double> wavelengths, weights;  ///< micrometres
  std::optional<double> beam_radius, object_na, image_na, f_number, angle, object_height, image_height;
};

/// Builds rows, media and design data from a lens that was read.
void build_oslo(OsloLens& oslo, Import& in);

}  // namespace petzval::formats_detail
