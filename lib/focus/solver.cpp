// SPDX-License-Identifier: Apache-2.0
#include "solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/text.hpp"
#include "paraxial/focal_points.hpp"
#include "paraxial/marginal_ray.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "search.hpp"

namespace petzval::focus_detail {
namespace {

void check_weight(const Lens& lens, const char* what, double weight) {
  if (weight >= 0 && std::isfinite(weight)) return;
  throw Error(lens.name() + ": focus: weight of a " + what + " = " + to_text(weight) +
              "; must be finite and at least 0");
}

/// Throws Error if criterion or origin is not an enumerator.
void check_kinds(const Lens& lens, const FocusOptions& options) {
  using enum FocusCriterion;
  const FocusCriterion criterion = options.criterion;
  if (criterion != thin && criterion != paraxial && criterion != min_rms && criterion != min_max) {
    throw Error(lens.name() + ": focus: criterion = " + std::to_string(static_cast<int>(criterion)) +
                "; must be thin, paraxial, min_rms or min_max");
  }
  using enum DistanceOrigin;
  const DistanceOrigin origin = options.origin;
  if (origin != front_vertex && origin != film && origin != entrance_pupil && origin != front_principal) {
    throw Error(lens.name() + ": focus: origin = " + std::to_string(static_cast<int>(origin)) +
                "; must be front_vertex, film, entrance_pupil or front_principal");
  }
}

std::vector<FocusField> weighted_fields(const Lens& lens, const FocusOptions& options) {
  std::vector<FocusField> fields;
  for (const FocusField& field : options.fields) {
    check_weight(lens, "field", field.weight);
    if (!std::isfinite(field.field_rad)) {
      throw Error(lens.name() + ": focus: field = " + to_text(field.field_rad) + " rad; must be finite");
    }
    if (field.weight > 0) fields.push_back(field);
  }
  if (fields.empty())
    throw Error(lens.name() + ": focus: the weight of every field is 0; at least one must be above 0");
  return fields;
}

std::vector<WavelengthWeight> weighted_wavelengths(const Lens& lens, const FocusOptions& options) {
  const std::vector<double>& weights = options.wavelength_weights;
  if (weights.empty()) return {{lens.primary_wavelength(), 1.0}};
  const std::size_t wavelength_count = lens.wavelengths_nm().size();
  if (weights.size() != wavelength_count) {
    throw Error(lens.name() + ": focus: number of wavelength weights = " + std::to_string(weights.size()) +
                "; must be " + std::to_string(wavelength_count) + ", one per compiled wavelength");
  }
  std::vector<WavelengthWeight> result;
  for (std::size_t i = 0; i < wavelength_count; ++i) {
    check_weight(lens, "wavelength", weights[i]);
    if (weights[i] > 0) result.push_back({i, weights[i]});
  }
  if (result.empty())
    throw Error(lens.name() + ": focus: the weight of every wavelength is 0; at least one must be above 0");
  return result;
}

}  // namespace

void check_distance(const Lens& lens, double distance) {
  if (distance > 0) return;
  throw Error(lens.name() + ": subject distance = " + to_text(distance) + " mm; must be above 0 (or infinity)");
}

void check_film(const Lens& lens, double film_z) {
  if (std::isfinite(film_z)) return;
  throw Error(lens.name() + ": film_z = " + to_text(film_z) + " mm; must be finite");
}

std::string hint_of_units(double distance) {
  if (!(distance < 50)) return "";
  return "; lengths are in mm: " + to_text(distance) + " m = " + to_text(1000 * distance) + " mm";
}

double entrance_pupil_z(const Lens& lens, Wavelength wavelength, Meridian meridian) {
  const double z = pupils(lens, wavelength, meridian).entrance.z;
  if (std::isfinite(z)) return z;
  throw Error(lens.name() + ": focus: the entrance pupil is at infinity; distances must count from another origin");
}

FocusSolver::FocusSolver(const Lens& lens, const FocusOptions& options)
    : lens_(lens),
      options_(options),
      fields_(weighted_fields(lens, options)),
      wavelengths_(weighted_wavelengths(lens, options)) {
  check_kinds(lens, options);
  // The wavelength of largest weight; the primary wavelength among equal weights.
  wavelength_ = std::ranges::max_element(wavelengths_, {}, [&](const WavelengthWeight& w) {
                  return std::pair(w.weight, w.wavelength == lens.primary_wavelength());
                })->wavelength;
  meridian_ = main_meridian(lens, wavelength_);
  const FirstOrder data = first_order(lens, wavelength_, meridian_);
  afocal_ = data.afocal;
  if (!afocal_) {
    const double pupil_z =
        options.origin == DistanceOrigin::entrance_pupil ? entrance_pupil_z(lens, wavelength_, meridian_) : 0;
    conjugates_ = Conjugates(paraxial_detail::focal_points(lens, data), options.criterion, options.origin, pupil_z);
    if (exact() && has_pupils(lens) && std::isinf(pupils(lens, lens.primary_wavelength()).entrance.z)) {
      throw Error(lens.name() + ": focus: the entrance pupil is at infinity, from where no field is seen; the " +
                  "criterion must be paraxial or thin, not " + std::string(name(options.criterion)));
    }
  }
}

bool FocusSolver::exact() const noexcept {
  return options_.criterion == FocusCriterion::min_rms || options_.criterion == FocusCriterion::min_max;
}

FocusSolution FocusSolver::focus(double distance) const {
  return exact() ? Search(*this).focus(distance) : paraxial_focus(conjugates_, distance);
}

FocusSolution FocusSolver::subject(double film_z) const {
  return exact() ? Search(*this).subject(film_z) : paraxial_subject(conjugates_, film_z);
}

FocusSolution FocusSolver::nearest() const { return exact() ? Search(*this).nearest() : paraxial_nearest(conjugates_); }

std::optional<Image> FocusSolver::image(double subject_z) const {
  if (!(subject_z < 0)) {
    throw Error(lens_.name() + ": subject at z = " + to_text(subject_z) + " mm; must be in front of the lens (z < 0)");
  }
  const auto unlimited = [](const LensSurface& s) { return std::isinf(s.semi_diameter); };
  if (std::ranges::all_of(lens_.surfaces(), unlimited)) {
    throw Error(lens_.name() + ": no surface limits the beam; one must have a semi_diameter");
  }
  if (exact()) return exact_image(lens_, subject_z, fields_, wavelengths_, options_.criterion);
  return cone(subject_z);
}

std::optional<Image> FocusSolver::image_seen(double subject_z) const {
  try {
    return image(subject_z);
  } catch (const Error&) {
    return {};
  }
}

std::optional<Image> FocusSolver::image_at(double vergence) const {
  return image_seen(vergence > 0 ? conjugates_.subject_at(vergence) : -std::numeric_limits<double>::infinity());
}

/// The cone of the paraxial pupil, represented by its marginal ray.
Image FocusSolver::cone(double subject_z) const {
  IdealLens ideal = conjugates_.lens;
  ideal.pupils = pupils(lens_, wavelength_, meridian_);
  const std::size_t stop = ideal.pupils.stop;
  if (std::isinf(lens_.surfaces()[stop].semi_diameter)) {
    throw Error(lens_.name() + ": the stop (surface " + std::to_string(stop) +
                ") has no semi_diameter; must have one that limits the blur");
  }
  const bool at_infinity = std::isinf(ideal.pupils.entrance.z);
  if (options_.criterion == FocusCriterion::thin) {
    if (at_infinity) {
      throw Error(lens_.name() +
                  ": the entrance pupil is at infinity; must be at a finite distance for the blur of a thin lens");
    }
    ideal = thin_lens(ideal);
  } else if (at_infinity && std::isinf(subject_z)) {
    throw Error(
        lens_.name() +
        ": the entrance pupil is at infinity; the subject must be at a finite distance, because the stop limits no "
        "beam from infinity");
  }
  const double p = ideal.front_focal_z - subject_z;
  const MarginalRay marginal = marginal_ray(ideal, p);
  RayBundle ray{
      .plane_z = ideal.rear_focal_z, .x = {0}, .y = {marginal.height}, .slope_x = {0}, .slope_y = {marginal.slope}};
  return {.film_z = conjugates_.film_z(p), .rays = std::move(ray)};
}

}  // namespace petzval::focus_detail
