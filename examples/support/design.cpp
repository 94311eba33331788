// SPDX-License-Identifier: Apache-2.0
#include "design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cli.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/apertures.hpp"
#include "text.hpp"

namespace examples {
namespace {

using petzval::FieldKind;

/// Height of the chief ray of a field on the film; infinite if the ray is lost.
double chief_height(const petzval::Lens& lens, double field_rad, double object_z) {
  const petzval::AimedRay chief = petzval::chief_ray(lens, {field_rad, object_z});
  if (!chief) return std::numeric_limits<double>::infinity();
  const auto& [origin, direction] = chief.end.ray;
  return std::abs(origin.y + (lens.film_z() - origin.z) / direction.z * direction.y);
}

/// The field whose chief ray meets the film at a height; nullopt if no field does.
std::optional<double> field_of_height(const petzval::Lens& lens, double height, double object_z) {
  double low = 0, high = petzval::radians(1);
  constexpr double max_angle_rad = petzval::radians(89);
  while (high < max_angle_rad && chief_height(lens, high, object_z) < height)
    low = high, high = std::min(1.5 * high, max_angle_rad);
  if (chief_height(lens, high, object_z) < height) return {};
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (chief_height(lens, middle, object_z) < height ? low : high) = middle;
  }
  return std::isfinite(chief_height(lens, low, object_z)) ? std::optional(low) : std::nullopt;
}

/// Absolute paraxial magnification of an object.
double magnification(const petzval::Lens& lens, double object_z) {
  const petzval::Meridian meridian = petzval::main_meridian(lens);
  const petzval::FirstOrder first = petzval::first_order(lens, {}, meridian);
  const double image_z = petzval::paraxial_image_z(lens, object_z, {}, meridian);
  return std::abs((image_z - first.rear_focal_z) / first.effective_focal_length);
}

/// Angle of a field of the design, seen from the entrance pupil (rad); nullopt if undetermined.
std::optional<double> field_angle(const petzval::Prescription& p, const petzval::Lens& lens, double value) {
  const petzval::DesignData& design = p.design;
  if (design.field_kind != FieldKind::real_image_height) {
    return petzval::declared_field(p, lens, design.field_kind, value);
  }
  return field_of_height(lens, value, -design.object_distance_mm);
}

/// Rounds to six significant digits: shorter captions without the rounding errors of a conversion.
double rounded(double degrees) { return parse_number("field", number(degrees, 6), finite_number); }

std::vector<double> declared_fields(const LensFile& file, const petzval::Lens& lens) {
  const petzval::DesignData& design = file.prescription.design;
  std::vector<double> result;
  if (!petzval::has_pupils(lens) || std::isinf(petzval::pupils(lens).entrance.z)) return result;
  std::size_t off_image = 0;
  for (const petzval::DesignField& field : design.fields) {
    if (!lens.rotationally_symmetric() && field.x != 0) {
      ++off_image;
      continue;
    }
    const double sign = field.x == 0 && !lens.rotationally_symmetric() && field.y < 0 ? -1 : 1;
    std::optional<double> found;  // rad
    if (design.field_kind == FieldKind::angle_deg) {
      const double x = std::tan(petzval::radians(field.x)), y = std::tan(petzval::radians(field.y));
      // Angles from 90 degrees on have no tangent; such fields lie in the section y-z.
      if (field.x == 0) {
        result.push_back(sign * std::abs(field.y));
        continue;
      }
      found = std::atan(std::hypot(x, y));
    } else {
      found = field_angle(file.prescription, lens, std::hypot(field.x, field.y));
    }
    if (found && std::isfinite(*found)) result.push_back(sign * rounded(petzval::degrees(*found)));
  }
  if (off_image > 0) note(file.id + ": fields left out, outside the section y-z: " + std::to_string(off_image));
  std::vector<double> once;
  for (const double field : result) {
    if (std::ranges::find(once, field) == once.end()) once.push_back(field);
  }
  return once;
}

}  // namespace

ReportLight light_of(const LensFile& file) {
  const petzval::DesignData& design = file.prescription.design;
  ReportLight light;
  for (const petzval::DesignWavelength& wavelength : design.wavelengths) {
    const bool known = std::ranges::find(light.wavelengths_nm, wavelength.nm) != light.wavelengths_nm.end();
    if (known || !(wavelength.weight > 0 && wavelength.nm > 0)) continue;
    light.wavelengths_nm.push_back(wavelength.nm);
    light.weights.push_back(wavelength.weight);
  }
  if (!light.wavelengths_nm.empty()) {
    const bool has_primary = design.primary_wavelength < design.wavelengths.size();
    const double primary = has_primary ? design.wavelengths[design.primary_wavelength].nm : 0;
    const bool kept = std::ranges::find(light.wavelengths_nm, primary) != light.wavelengths_nm.end();
    light.primary_nm = kept ? primary : light.wavelengths_nm.front();
    try {
      petzval::compile(file.prescription, light.wavelengths_nm, compile_options(file));
      light.of_file = true;
      return light;
    } catch (const petzval::Error& error) {
      note(std::string(error.what()) + "; the wavelengths of the file are not used");
    }
  }
  const double reference = file.prescription.reference_wavelength_nm;
  const petzval::Lens at_reference = petzval::compile(file.prescription, std::array{reference}, compile_options(file));
  if (at_reference.dispersion() == petzval::Dispersion::none) {
    return {.wavelengths_nm = {reference}, .weights = {1}, .primary_nm = reference};
  }
  return {.wavelengths_nm = {petzval::spectral_line_nm("F"), petzval::d_line_nm, petzval::spectral_line_nm("C")},
          .weights = {1, 1, 1}};
}

ReportFields fields_of(const LensFile& file, const petzval::Lens& lens) {
  if (std::vector<double> declared = declared_fields(file, lens); !declared.empty()) return {std::move(declared), true};
  const double half = half_field_deg(file, lens);
  // Half of the picture's area lies within 0.7 of its radius. Three digits keep captions short.
  std::vector<double> fields{0, half};
  const double power = std::pow(10, std::floor(std::log10(0.7 * half)) - 2);
  if (half > 0) fields.insert(fields.begin() + 1, std::round(0.7 * half / power) * power);
  return {std::move(fields), false};
}

std::optional<DeclaredPupil> declared_pupil(const petzval::DesignData& design, const petzval::Lens& lens) {
  if (!design.aperture) return {};
  const petzval::Meridian meridian = petzval::main_meridian(lens);
  const petzval::FirstOrder first = petzval::first_order(lens, {}, meridian);
  const double focal_length = std::abs(first.effective_focal_length), value = design.aperture->value;
  const double object_z = -design.object_distance_mm;
  const bool far = std::isinf(design.object_distance_mm);
  const bool pupils = petzval::has_pupils(lens);
  // The cone of the object fills the pupil.
  const auto by_slope = [&](double slope) {
    return 2 * slope * (petzval::pupils(lens, {}, meridian).entrance.z - object_z);
  };
  const auto by_image_slope = [&](double slope) -> std::optional<double> {
    if (far) return 2 * slope * focal_length;
    if (!pupils) return {};
    return by_slope(slope * magnification(lens, object_z) * std::abs(first.image_index / first.object_index));
  };
  const auto slope_of = [](double na, double index) {
    const double sine = std::min(na / std::abs(index), 0.999999);
    return sine / std::sqrt(1 - sine * sine);
  };
  std::optional<double> diameter;
  using enum petzval::ApertureSetting;
  switch (design.aperture->setting) {
    case entrance_pupil_diameter: diameter = value; break;
    case f_number: diameter = focal_length / value; break;
    case working_f_number: diameter = by_image_slope(1 / (2 * value)); break;
    case image_na: diameter = by_image_slope(slope_of(value, first.image_index)); break;
    case object_na:
      if (!far && pupils) diameter = by_slope(slope_of(value, first.object_index));
      break;
    case stop_size:
      if (pupils) diameter = petzval::pupils(lens, {}, meridian).entrance.diameter;
      break;
  }
  if (!diameter || !std::isfinite(*diameter)) return {};
  return DeclaredPupil{*diameter, focal_length / *diameter};
}

bool reached_by_light(const petzval::Lens& lens, const petzval::FieldPoint& point) {
  const auto spots = petzval::spot_diagram(lens, point.z, {&point.field_rad, 1}, 64);
  return std::ranges::any_of(spots.values, [](const petzval::Spot& spot) { return !spot.x.empty(); });
}

void want_light(const petzval::Lens& lens, const petzval::FieldPoint& point, const std::string& flag) {
  if (reached_by_light(lens, point)) return;
  throw petzval::Error(flag + " = " + number(rounded(petzval::degrees(point.field_rad))) + ": no light passes " +
                       lens.name() + " from there; must be a field that the lens sees");
}

}  // namespace examples
