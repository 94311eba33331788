// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import.hpp"

namespace petzval::formats_detail {

/// A value that another surface gives: PK.
struct OsloPickup {
  int line = 0;
  std::string what;
  int surface = 0;
  double constant = 0;
};

/// What is behind a surface.
struct OsloMedium {
  int line = 0;
  enum class Kind { air, mirror, glass, indices } kind = Kind::air;
  std::string name;
  std::vector<double> indices;      ///< at `wavelengths`
  std::vector<double> wavelengths;  ///< micrometres
};

/// A surface as the file has it, in its own units.
struct OsloSurface {
  int line = 0;
  double curvature = 0;
  std::optional<double> thickness;
  OsloMedium medium;
  std::optional<double> aperture;
  bool checked = false;  ///< rays end at the aperture
  bool stop = false;
  double conic = 0;
  std::map<int, double> terms;   ///< of the asphere: coefficient by order
  std::string asphere;           ///< ASP: its type
  std::optional<double> height;  ///< PY: of the axial ray on the next surface
  std::vector<OsloPickup> pickups;
  std::string note;
};

/// A lens of OSLO as its file has it.
struct OsloLens {
  int line = 0;                 ///< of LEN
  std::optional<double> scale;  ///< the number of LEN
  double unit = 1;              ///< mm
  std::vector<OsloSurface> surfaces;
  std::vector<double> wavelengths, weights;  ///< micrometres
  std::optional<double> beam_radius, object_na, image_na, f_number, angle, object_height, image_height;
};

/// Rows, media and design data of a lens that was read.
void build_oslo(OsloLens& oslo, Import& in);

}  // namespace petzval::formats_detail
