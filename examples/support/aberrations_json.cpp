// SPDX-License-Identifier: Apache-2.0
// Aberrations by exact rays as JSON.
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "lens_report.hpp"
#include "petzval/analysis/aberrations.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text.hpp"

namespace examples {
namespace {

/// Wavefront errors at the fields and wavelengths of the report.
Json wavefronts(const Report& r, const petzval::Lens& colours) {
  Json json = Json::array();
  const std::size_t count = colours.wavelengths_nm().size();
  const auto fronts = report_wavefronts(r, colours);
  for (std::size_t k = 0; k < fronts.size(); ++k) {
    Json one{{"field_deg", r.subject.fields.degrees[k / count]},
             {"wavelength_nm", colours.wavelengths_nm()[k % count]}};
    const auto& front = fronts[k];
    const auto value = [&](double petzval::Wavefront::*member) { return front ? Json((*front).*member) : Json(); };
    one["rms_waves"] = value(&petzval::Wavefront::rms_waves);
    one["rms_without_tilt_waves"] = value(&petzval::Wavefront::rms_without_tilt);
    one["peak_to_valley_waves"] = value(&petzval::Wavefront::peak_to_valley_waves);
    one["strehl"] = front && front->strehl ? Json(*front->strehl) : Json();
    one["strehl_error"] = front && front->strehl ? finite_or_null(front->strehl_error) : Json();
    one["zernike_fringe"] = front ? Json(front->zernike) : Json();
    one["zernike_residual_waves"] = value(&petzval::Wavefront::zernike_residual_waves);
    one["sampling_error_waves"] = value(&petzval::Wavefront::sampling_error_waves);
    json.push_back(std::move(one));
  }
  return json;
}

/// Aberrations by exact rays at the fields of a report, one method for each quantity.
class ExactAberrations {
 public:
  ExactAberrations(const Report& r, const petzval::Lens& colours)
      : r_(r), colours_(colours), z_(subject_z(r.subject, colours)), degrees_(r.subject.fields.degrees) {
    for (const double degrees : degrees_) fields_.push_back(petzval::radians(degrees));
  }

  Json ray_fans() {
    Json json = Json::array();
    const auto all = petzval::ray_fans(colours_, z_, fields_);
    for (std::size_t k = 0; k < all.size(); ++k) {
      for (const petzval::RayFan::Point& at : all[k].points) {
        json.push_back({{"field_deg", degrees_[k / colours_.wavelengths_nm().size()]},
                        {"wavelength_nm", colours_.wavelengths_nm()[all[k].wavelength]},
                        {"pupil", at.pupil},
                        {"tangential_mm", or_null(at.tangential_mm)},
                        {"sagittal_mm", or_null(at.sagittal_mm)},
                        {"tangential_waves", or_null(at.tangential_waves)},
                        {"sagittal_waves", or_null(at.sagittal_waves)}});
      }
    }
    return json;
  }

  Json field_curvature() {
    Json json = Json::array();
    for (const petzval::FieldFocus& focus : petzval::field_curvature(colours_, z_, fields_)) {
      json.push_back({{"field_deg", degrees_[json.size()]},
                      {"tangential_mm", or_null(focus.tangential_mm)},
                      {"sagittal_mm", or_null(focus.sagittal_mm)}});
    }
    return json;
  }

  Json distortion() {
    Json json = Json::array();
    for (const petzval::FieldDistortion& one : petzval::distortion_percent(colours_, z_, fields_)) {
      json.push_back({{"field_deg", degrees_[json.size()]},
                      {"f_tan_theta", or_null(one.f_tan_theta_percent)},
                      {"f_theta", or_null(one.f_theta_percent)}});
    }
    return json;
  }

  Json mtf() {
    Json json = Json::array();
    const auto points = report_mtf(r_, spots());
    const double f_number = petzval::film_side_f_number(colours_);
    const double nm_in_film_space = r_.subject.light.primary_nm / colours_.index(colours_.surface_count());
    const std::size_t frequencies = degrees_.empty() ? 1 : points.size() / degrees_.size();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const petzval::MtfPoint& point = points[k];
      const double limit = petzval::diffraction_limited_mtf(point.frequency_per_mm, nm_in_film_space, f_number);
      const bool dark = points[k / frequencies * frequencies].tangential == 0;  // at frequency 0
      json.push_back({{"field_deg", degrees_[k * degrees_.size() / points.size()]},
                      {"frequency_per_mm", point.frequency_per_mm},
                      {"tangential", dark ? Json() : Json(point.tangential)},
                      {"sagittal", dark ? Json() : Json(point.sagittal)},
                      {"sampling_error", point.sampling_error},
                      {"diffraction_limit", limit}});
    }
    return json;
  }

  Json mtf_over_field() {
    Json json = Json::array();
    for (const petzval::MtfPoint& point : report_mtf_over_field(r_, colours_)) {
      json.push_back({{"field_deg", petzval::degrees(point.field_rad)},
                      {"frequency_per_mm", point.frequency_per_mm},
                      {"tangential", point.tangential},
                      {"sagittal", point.sagittal},
                      {"sampling_error", point.sampling_error}});
    }
    return json;
  }

  Json through_focus() {
    Json json = Json::array();
    const auto shifts = report_film_shifts(r_, colours_, spots());
    for (const auto& spot : petzval::through_focus(spots(), wavelengths(), shifts, r_.subject.light.weights)) {
      json.push_back({{"field_deg", degrees_[json.size() / shifts.size()]},
                      {"film_shift_mm", spot.film_shift_mm},
                      {"rms_radius_mm", or_null(spot.rms_radius_mm)},
                      {"sampling_error_mm", spot.sampling_error_mm}});
    }
    return json;
  }

  Json encircled_energy() {
    Json json = Json::array();
    constexpr std::array fractions{0.5, 0.8, 0.9, 0.95};
    const auto& weights = r_.subject.light.weights;
    for (const auto& point : petzval::encircled_energy(spots(), wavelengths(), fractions, weights, threads())) {
      json.push_back({{"field_deg", degrees_[json.size() / fractions.size()]},
                      {"fraction", point.fraction},
                      {"radius_um", um(point.radius_mm)},
                      {"sampling_error_um", 1000 * point.sampling_error_mm}});
    }
    return json;
  }

  Json longitudinal_aberration() {
    Json json = Json::array();
    for (const petzval::AxialRayFocus& focus : petzval::longitudinal_aberration(colours_, z_)) {
      json.push_back({{"wavelength_nm", colours_.wavelengths_nm()[focus.wavelength]},
                      {"pupil", focus.pupil},
                      {"tangential_mm", or_null(focus.tangential_mm)},
                      {"sagittal_mm", or_null(focus.sagittal_mm)}});
    }
    return json;
  }

  Json lateral_colour() {
    Json json = Json::array();
    for (std::size_t i = 0; i < spots().size(); ++i) {
      const std::size_t primary = i - i % wavelengths() + colours_.primary_wavelength();
      const auto &height = spots()[i].chief_ray_height, &at_primary = spots()[primary].chief_ray_height;
      json.push_back({{"field_deg", degrees_[i / wavelengths()]},
                      {"wavelength_nm", r_.subject.light.wavelengths_nm[i % wavelengths()]},
                      {"chief_ray_shift_um", height && at_primary ? um(*height - *at_primary) : Json()}});
    }
    return json;
  }

  Json wavefront() { return wavefronts(r_, colours_); }

 private:
  static Json um(std::optional<double> mm) { return mm ? Json(1000 * *mm) : Json(); }
  std::size_t wavelengths() const { return r_.subject.light.wavelengths_nm.size(); }
  /// The spots of the report, computed at the first call.
  const std::vector<petzval::Spot>& spots() {
    if (!spots_) spots_ = report_spots(r_, colours_);
    return *spots_;
  }

  const Report& r_;
  const petzval::Lens& colours_;
  double z_;
  const std::vector<double>& degrees_;
  std::vector<double> fields_;
  std::optional<std::vector<petzval::Spot>> spots_;
};

}  // namespace

Json exact_aberrations(const Report& r, const petzval::Lens& colours) {
  using A = ExactAberrations;
  Json json, failures = Json::object();
  A aberrations(r, colours);
  for (const auto& [key, quantity] : {std::pair{"ray_fans", &A::ray_fans},
                                      {"field_curvature", &A::field_curvature},
                                      {"distortion_percent", &A::distortion},
                                      {"mtf", &A::mtf},
                                      {"mtf_over_field", &A::mtf_over_field},
                                      {"through_focus", &A::through_focus},
                                      {"encircled_energy", &A::encircled_energy},
                                      {"longitudinal_aberration", &A::longitudinal_aberration},
                                      {"lateral_colour", &A::lateral_colour},
                                      {"wavefront", &A::wavefront}}) {
    try {
      json[key] = (aberrations.*quantity)();
    } catch (const petzval::Error& error) {
      json[key] = nullptr;
      failures[key] = error.what();
    }
  }
  json["failures"] = std::move(failures);
  return json;
}

}  // namespace examples
