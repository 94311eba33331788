// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "import.hpp"

namespace petzval::formats_detail {

/// One surface of a .seq as stated in the file: lengths in the file's unit, `shape` is a radius or a curvature.
struct CodevSurface {
  int line = 0;
  double shape = 0;
  double thickness = 0;
  std::string glass{};
  bool mirror = false, stop = false;
  double conic = 0;
  std::vector<AsphereTerm> aspheric{};
  std::optional<double> aperture{}, edge{}, obscuration{};
  std::string label{};
  bool cylinder_x = false, cylinder_y = false;
};

/// PRV: a private glass of the file, by its indices at wavelengths.
struct PrivateGlass {
  std::string name;
  std::vector<double> indices;
};

/// PIK: a value of a surface that equals a value of another surface times a factor.
struct CodevPickup {
  int line = 0;
  std::string what{}, of{};
  int surface = 0, from = 0;
  double scale = 1;
};

/// A value of a surface in a zoom position.
struct CodevZoom {
  int line = 0;
  std::string what{};
  int surface = 0;
  std::vector<std::string> values{};
};

/// The contents of a .seq.
struct CodevLens {
  std::vector<CodevSurface> surfaces;  ///< object, lens and image
  bool ended = false;                  ///< SI was read
  double unit = 1;                     ///< mm
  bool unit_given = false;
  std::optional<bool> curvatures;  ///< true if the first number of a surface is a curvature (RDM)
  std::vector<PrivateGlass> private_glasses;
  std::vector<double> private_nm;
  std::vector<CodevPickup> pickups;
  std::size_t zoom_positions = 1;
  std::vector<CodevZoom> zooms;
  int paraxial_image = 0;                         ///< line of PIM; 0 if absent
  std::vector<std::array<double, 4>> vignetting;  ///< VUY VLY VUX VLX of each field
};

/// Thicknesses from this value on mean infinity.
inline constexpr double codev_endless = 1e10;

void build_codev(CodevLens codev, Import& in);

}  // namespace petzval::formats_detail
