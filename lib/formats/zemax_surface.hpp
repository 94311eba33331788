// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace petzval::formats_detail {

/// A value picked up from another surface: its value times scale plus offset.
struct ZemaxPickup {
  int line = 0;
  int surface = 0;
  double scale = 1;
  double offset = 0;
};

/// GLAS: a name, and the index data of the file.
struct ZemaxGlass {
  int line = 0;
  std::string name;
  std::optional<int> pickup{};  ///< surface from which the glass is picked up
  bool model = false;           ///< n_d and V_d define the medium, not the name
  std::optional<double> nd{}, vd{};
  double nd_offset = 0, vd_offset = 0;
};

/// OBSC with an opening: an opaque ring.
struct ZemaxRing {
  int line = 0;
  double inner = 0, outer = 0;  ///< mm
};

/// One SURF as stated in a .zmx, in millimetres.
struct ZemaxSurface {
  int line = 0, number = 0;
  std::string type = "STANDARD";
  double curvature = 0;
  double thickness = 0;  ///< may be infinite
  bool has_thickness = false;
  double conic = 0;
  std::map<int, double> parameters;  ///< PARM
  std::map<int, double> extra;       ///< XDAT
  std::optional<ZemaxGlass> glass;
  bool stop = false;
  std::string comment;
  std::string coating;  ///< name of COAT
  int coating_line = 0;
  double semi_diameter = 0;
  bool fixed_semi_diameter = false;  ///< set by the user, not by the width of the design's beams
  std::optional<double> aperture, obscuration;
  std::optional<ZemaxRing> ring;
  std::optional<ZemaxPickup> curvature_pickup, thickness_pickup;
  std::optional<std::array<double, 2>> marginal_height;  ///< MAZH: height and pupil zone
  std::optional<ZemaxPickup> thickness_sum, position;    ///< TCOM, TOLE: the offset is the total
  int solve_line = 0;
};

}  // namespace petzval::formats_detail
