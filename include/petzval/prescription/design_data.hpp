// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"

namespace petzval {

/// How a designer fixed the width of the beam.
enum class ApertureSetting : std::uint8_t {
  entrance_pupil_diameter,  ///< mm
  f_number,                 ///< focal length over the diameter of the paraxial entrance pupil
  working_f_number,         ///< 1 / (2 tan u') of the paraxial marginal ray
  object_na,                ///< n sin u in object space
  image_na,                 ///< n' sin u' in image space
  stop_size,                ///< the semi-diameter of the stop is what the table says
};

struct DesignAperture {
  ApertureSetting setting = ApertureSetting::entrance_pupil_diameter;
  double value = 0;

  bool operator==(const DesignAperture&) const = default;
};

/// What the fields of a design are.
enum class FieldKind : std::uint8_t {
  angle_deg,         ///< of the chief ray in object space, degrees
  object_height,     ///< mm
  paraxial_image,    ///< paraxial image height, mm
  real_image_height  ///< mm
};

/// "entrance_pupil_diameter", "f_number", ...; "angle_deg", "object_height", ...
PETZVAL_API std::string_view name(ApertureSetting setting) noexcept;
PETZVAL_API std::string_view name(FieldKind kind) noexcept;

/// One field, and how its beam differs from the full pupil: decentred by (decentre_x, decentre_y) and compressed by
/// (compress_x, compress_y), fractions of the pupil's radius, in axes turned by angle_deg.
struct DesignField {
  double x = 0, y = 0;
  double weight = 1;
  double decentre_x = 0, decentre_y = 0;
  double compress_x = 0, compress_y = 0;
  double angle_deg = 0;

  bool operator==(const DesignField&) const = default;
};

struct DesignWavelength {
  double nm = 0;
  double weight = 1;

  bool operator==(const DesignWavelength&) const = default;
};

/// What a designer put in besides surfaces. No function of the library computes with it but those that say so:
/// a renderer chooses its own fields, wavelengths and stop.
struct DesignData {
  std::optional<DesignAperture> aperture{};
  double object_distance_mm = std::numeric_limits<double>::infinity();  ///< from the first surface
  FieldKind field_kind = FieldKind::angle_deg;
  std::vector<DesignField> fields{};
  std::vector<DesignWavelength> wavelengths{};
  std::size_t primary_wavelength = 0;  ///< from 0

  bool operator==(const DesignData&) const = default;
};

}  // namespace petzval
