// SPDX-License-Identifier: Apache-2.0
#include "declared_beam.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "paraxial/ray_matrix.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval::formats_detail {
namespace {

/// Position of the image of the stop in object space, from the first surface: a ray through the centre of this image
/// passes the centre of the stop.
double entrance_pupil_z(const RayMatrix& to_stop, double object_index) {
  return to_stop.a == 0 ? std::numeric_limits<double>::infinity() : to_stop.b * object_index / to_stop.a;
}

}  // namespace

double entrance_pupil_z(const Lens& compiled, std::size_t stop) {
  const Meridian meridian = main_meridian(compiled);
  return entrance_pupil_z(ray_matrix_to(compiled, stop, {}, meridian),
                          first_order(compiled, {}, meridian).object_index);
}

Lens at_primary_wavelength(const Prescription& rows, const GlassCatalogue* glasses) {
  const DesignData& design = rows.design;
  try {
    if (!design.wavelengths.empty() &&
        design.wavelengths[design.primary_wavelength].nm != rows.reference_wavelength_nm) {
      return compile(rows, std::array{design.wavelengths[design.primary_wavelength].nm},
                     {.glasses = glasses, .missing_glass = MissingGlass::abbe});
    }
  } catch (const Error&) {
    // The wavelength is outside the range of a glass.
  }
  return compile(rows, {.glasses = glasses});
}

Prescription without_rims(Prescription rows) {
  rows.imported.reset();
  rows.configurations.clear();
  for (SurfaceRow& row : rows.surfaces) {
    row.semi_diameter = std::numeric_limits<double>::infinity();  // a missing semi-diameter would be computed
    row.obscuration_semi_diameter.reset();
  }
  return rows;
}

std::size_t stop_of(const Prescription& rows) {
  const auto stop = std::ranges::find_if(rows.surfaces, [](const SurfaceRow& row) { return row.stop; });
  return static_cast<std::size_t>(stop - rows.surfaces.begin());
}

double marginal_height_at_the_stop(const Lens& compiled, std::size_t position, double object,
                                   const DesignAperture& aperture) {
  const FirstOrder first = first_order(compiled, {}, main_meridian(compiled));

  // The marginal ray of the design: height and slope in front of the first surface.
  const RayMatrix to_stop = ray_matrix_to(compiled, position, {}, main_meridian(compiled));
  const bool far = !std::isfinite(object);
  const auto per_unit = [&](double height, double slope) { return to_stop.a * height + to_stop.b * slope; };
  const double unit = far ? per_unit(1, 0) : per_unit(object, first.object_index);  // slope 1: u = 1, n u = n
  const auto image_slope = [&] {
    const RayMatrix all = ray_matrix(compiled, 0, compiled.surface_count(), {}, main_meridian(compiled));
    return std::abs((far ? all.c : all.c * object + all.d * first.object_index) / first.image_index);
  };
  double height = 0;  // marginal ray at the stop
  const double value = aperture.value;
  switch (aperture.setting) {
    case ApertureSetting::entrance_pupil_diameter:
    case ApertureSetting::f_number: {
      const bool by_ratio = aperture.setting == ApertureSetting::f_number;
      if (by_ratio && first.afocal) break;
      const double diameter = by_ratio ? std::abs(first.effective_focal_length) / value : value;
      if (!first.afocal && far) {
        try {
          const double n = std::abs(first.effective_focal_length) / diameter;
          const Lens wide = with_semi_diameter(compiled, position, 100 * std::abs(first.effective_focal_length));
          height = with_f_number(wide, n).surfaces()[position].semi_diameter;
          break;
        } catch (const Error&) {
          // Rays of this height miss a surface: use the first-order height.
        }
      }
      // The beam is a parallel beam, or the cone from the object to the rim of the entrance pupil, the image of the
      // stop.
      height = std::abs(unit) * diameter / 2;
      if (!far) height *= 1 / std::abs(object + entrance_pupil_z(to_stop, first.object_index));
      break;
    }
    case ApertureSetting::working_f_number: height = std::abs(unit) / image_slope() / (2 * value); break;
    case ApertureSetting::image_na: {
      const double sine = std::min(value / std::abs(first.image_index), 0.999999);
      height = std::abs(unit) / image_slope() * sine / std::sqrt(1 - sine * sine);
      break;
    }
    case ApertureSetting::object_na: {
      const double sine = std::min(value / std::abs(first.object_index), 0.999999);
      height = far ? 0 : std::abs(unit) * sine / std::sqrt(1 - sine * sine);
      break;
    }
    case ApertureSetting::stop_size: break;
  }
  return height;
}

}  // namespace petzval::formats_detail
