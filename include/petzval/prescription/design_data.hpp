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

/// The quantity by which a design states the width of the beam.
enum class ApertureSetting : std::uint8_t {
  entrance_pupil_diameter,  ///< mm
  f_number,                 ///< focal length divided by the diameter of the paraxial entrance pupil
  working_f_number,         ///< 1 / (2 tan u') of the paraxial marginal ray
  object_na,                ///< n sin u in object space
  image_na,                 ///< n' sin u' in image space
  stop_size,                ///< the table states the semi-diameter of the stop
};

/// The width of the beam of a design.
struct DesignAperture {
  ApertureSetting setting = ApertureSetting::entrance_pupil_diameter;
  double value = 0;

  bool operator==(const DesignAperture&) const = default;
};

/// The quantity by which a design states its fields.
enum class FieldKind : std::uint8_t {
  angle_deg,         ///< angle of the chief ray in object space, degrees
  object_height,     ///< object height, mm
  paraxial_image,    ///< paraxial image height, mm
  real_image_height  ///< image height of the exact chief ray, mm
};

/// The name of a setting ("entrance_pupil_diameter", ...) or of a kind ("angle_deg", ...).
PETZVAL_API std::string_view name(ApertureSetting setting) noexcept;
PETZVAL_API std::string_view name(FieldKind kind) noexcept;

/// One field with its vignetting factors.
///
/// The beam is the full pupil decentred by (decentre_x, decentre_y) and compressed by (compress_x, compress_y), all in
/// units of the pupil radius, in axes rotated by angle_deg.
struct DesignField {
  double x = 0, y = 0;
  double weight = 1;
  double decentre_x = 0, decentre_y = 0;
  double compress_x = 0, compress_y = 0;
  double angle_deg = 0;

  bool operator==(const DesignField&) const = default;
};

/// One wavelength of a design and its weight.
struct DesignWavelength {
  double nm = 0;
  double weight = 1;

  bool operator==(const DesignWavelength&) const = default;
};

/// The data of a design other than its surfaces.
///
/// Functions ignore these data unless their documentation says otherwise: a renderer chooses its own fields,
/// wavelengths and stop.
struct DesignData {
  std::optional<DesignAperture> aperture{};
  double object_distance_mm = std::numeric_limits<double>::infinity();  ///< distance from the first surface
  FieldKind field_kind = FieldKind::angle_deg;
  std::vector<DesignField> fields{};
  std::vector<DesignWavelength> wavelengths{};
  std::size_t primary_wavelength = 0;  ///< index into wavelengths

  bool operator==(const DesignData&) const = default;
};

}  // namespace petzval
