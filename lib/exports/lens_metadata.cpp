// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/lens_metadata.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/least_squares.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {

LensIdentity identity_of(const Prescription& prescription) {
  return {.model = prescription.name, .nominal_focal_length_mm = prescription.focal_length_mm};
}

LensState lens_state(const LensDistortion& distortion) {
  const Lens& lens = distortion.camera().lens();
  const Pinhole& pinhole = distortion.pinhole();
  const double film_z = distortion.camera().film().z();
  LensState state{aperture_state(lens)};
  state.effective_focal_length_mm = first_order(lens, {}, main_meridian(lens)).effective_focal_length;
  state.pinhole_focal_length_mm = pinhole.focal_length_mm.y;
  state.focus_distance_mm = film_z - pinhole.subject_z_mm;
  state.entrance_pupil_offset_mm = film_z - pinhole.z_mm;
  return state;
}

double ExposureFalloff::light(double radius_mm) const noexcept {
  const double r2 = radius_mm * radius_mm;
  return 1 - r2 * (coefficients[0] + r2 * (coefficients[1] + r2 * coefficients[2]));
}

ExposureFalloff fit_exposure_falloff(const Lens& lens, const Film& film) {
  constexpr int radii = 24;
  const double farthest = film.radius_mm(), on_axis = film_irradiance(lens, {});
  if (!(on_axis > 0)) throw Error(lens.name() + ": exposure falloff: the axis is dark; light must reach it");

  struct FalloffSample {
    double radius = 0, light = 0;
  };
  std::vector<FalloffSample> falloff_samples;
  const int directions = lens.rotationally_symmetric() ? 1 : 4;
  for (int direction = 0; direction < directions; ++direction) {
    const double angle = direction * std::numbers::pi / 6;
    for (int i = 1; i <= radii; ++i) {
      const double radius = farthest * i / radii;
      const double light = film_irradiance(lens, {radius * std::sin(angle), radius * std::cos(angle)}) / on_axis;
      if (light > 0) falloff_samples.push_back({radius, light});
    }
  }
  ExposureFalloff result;
  if (falloff_samples.empty()) return result;
  Eigen::MatrixXd rows(falloff_samples.size(), 3);
  Eigen::VectorXd lost(falloff_samples.size());
  for (std::size_t i = 0; i < falloff_samples.size(); ++i) {
    const double r2 = (falloff_samples[i].radius / farthest) * (falloff_samples[i].radius / farthest);
    const double weight = std::sqrt(falloff_samples[i].radius / farthest);  // its square: area of a ring of the film
    rows.row(static_cast<Eigen::Index>(i)) << weight * r2, weight * r2 * r2, weight * r2 * r2 * r2;
    lost(static_cast<Eigen::Index>(i)) = weight * (1 - falloff_samples[i].light);
  }
  const Eigen::VectorXd a = core_detail::least_squares(rows, lost);
  for (int i = 0; i < 3; ++i) result.coefficients[static_cast<std::size_t>(i)] = a(i) / std::pow(farthest, 2 * (i + 1));
  for (const FalloffSample& falloff_sample : falloff_samples) {
    result.largest_error =
        std::max(result.largest_error, std::abs(result.light(falloff_sample.radius) - falloff_sample.light));
  }
  return result;
}

}  // namespace petzval
