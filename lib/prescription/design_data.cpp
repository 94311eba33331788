// SPDX-License-Identifier: Apache-2.0
#include "petzval/prescription/prescription.hpp"

namespace petzval {

std::string_view name(ApertureSetting setting) noexcept {
  switch (setting) {
    case ApertureSetting::entrance_pupil_diameter: return "entrance_pupil_diameter";
    case ApertureSetting::f_number: return "f_number";
    case ApertureSetting::working_f_number: return "working_f_number";
    case ApertureSetting::object_na: return "object_na";
    case ApertureSetting::image_na: return "image_na";
    case ApertureSetting::stop_size: return "stop_size";
  }
  return "unknown";
}

std::string_view name(FieldKind kind) noexcept {
  switch (kind) {
    case FieldKind::angle_deg: return "angle_deg";
    case FieldKind::object_height: return "object_height";
    case FieldKind::paraxial_image: return "paraxial_image";
    case FieldKind::real_image_height: return "real_image_height";
  }
  return "unknown";
}

}  // namespace petzval
