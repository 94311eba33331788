// SPDX-License-Identifier: Apache-2.0
#include "petzval/lint/lint.hpp"

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "spacing.hpp"

namespace petzval::inline v0 {
namespace {

using Kind = FindingKind;
constexpr double tolerance = 0.02;

std::string mm(double value) { return to_text(value, 6) + " mm"; }

std::string at(int surface) { return "surface " + std::to_string(surface) + ": "; }

bool differs(double found, double wanted) { return !(std::abs(found - wanted) <= tolerance * std::abs(wanted)); }

using Findings = std::vector<Finding>;

void check_stops(const Prescription& prescription, Findings& findings) {
  int stops = 0, last = 0;
  for (const SurfaceRow& row : prescription.surfaces) {
    if (row.stop) ++stops, last = static_cast<int>(&row - prescription.surfaces.data());
  }
  if (stops == 0) {
    findings.push_back(
        {Kind::no_stop, {}, 0, 1, "no surface is marked as stop; the one that clips the axial beam first is used"});
  } else if (stops > 1) {
    findings.push_back({Kind::several_stops, last, static_cast<double>(stops), 1,
                        at(last) + "is the last of " + std::to_string(stops) + " marked as stop; the first is used"});
  }
}

void check_surfaces(const Lens& lens, Findings& findings) {
  const int count = static_cast<int>(lens.surface_count());
  for (int i = 0; i < count; ++i) {
    const auto position = static_cast<std::size_t>(i);
    const LensSurface& surface = lens.surfaces()[position];
    const double domain = lint_detail::domain(surface);
    if (std::isfinite(surface.semi_diameter) && surface.semi_diameter > domain) {
      findings.push_back({Kind::semi_diameter, i, surface.semi_diameter, domain,
                          at(i) + "semi_diameter is " + mm(surface.semi_diameter) + ", wanted at most " + mm(domain) +
                              ", where the surface ends"});
    }
    // A stop of 0 is a closed iris. Any other rim of 0 is hardly intended.
    if (surface.semi_diameter == 0 && lens.stop() != position) {
      findings.push_back(
          {Kind::semi_diameter, i, 0, domain, at(i) + "semi_diameter is 0 mm; only the axial ray passes"});
    }
    if (i + 1 == count) break;
    const auto spacing = lint_detail::least_spacing(lens, position);
    if (spacing && spacing->width < -1e-9 * std::max(spacing->height, std::abs(surface.thickness))) {
      findings.push_back(
          {Kind::overlap, i, spacing->width, 0,
           at(i) + "overlaps the next surface by " + mm(-spacing->width) + " at a height of " + mm(spacing->height)});
    }
  }
}

/// False for an unlimited stop and for a lens without clear apertures: they do not fix the f-number.
bool limits_the_beam(const Lens& lens) {
  const auto surfaces = lens.stop() ? lens.surfaces().subspan(*lens.stop(), 1) : lens.surfaces();
  return std::any_of(surfaces.begin(), surfaces.end(),
                     [](const LensSurface& s) { return std::isfinite(s.semi_diameter); });
}

void check_first_order(const Prescription& prescription, const Lens& lens, Findings& findings) {
  const FirstOrder data = first_order(lens, 0, main_meridian(lens));
  const double focal_length = data.effective_focal_length;
  if (prescription.focal_length_mm && differs(focal_length, *prescription.focal_length_mm)) {
    findings.push_back({Kind::focal_length,
                        {},
                        focal_length,
                        *prescription.focal_length_mm,
                        "focal length is " + mm(focal_length) + ", declared " + mm(*prescription.focal_length_mm)});
  }
  if (prescription.f_number && limits_the_beam(lens)) {
    const double f_number = real_f_number(lens);
    if (differs(f_number, *prescription.f_number)) {
      findings.push_back({Kind::f_number,
                          {},
                          f_number,
                          *prescription.f_number,
                          "f-number is " + to_text(f_number, 6) + ", declared " + to_text(*prescription.f_number, 6)});
    }
  }
  const int last = static_cast<int>(lens.surface_count()) - 1;
  const double distance = lens.surfaces().back().thickness;
  if (!data.afocal && std::abs(distance - data.back_focal_distance) > tolerance * std::abs(focal_length)) {
    findings.push_back({Kind::image_distance, last, distance, data.back_focal_distance,
                        at(last) + "the film is " + mm(distance) + " behind it and the paraxial focus " +
                            mm(data.back_focal_distance)});
  }
}

}  // namespace

std::string_view name(FindingKind kind) noexcept {
  switch (kind) {
    case Kind::focal_length: return "focal_length";
    case Kind::f_number: return "f_number";
    case Kind::overlap: return "overlap";
    case Kind::semi_diameter: return "semi_diameter";
    case Kind::no_stop: return "no_stop";
    case Kind::several_stops: return "several_stops";
    case Kind::image_distance: return "image_distance";
    case Kind::film_size: return "film_size";
  }
  return "unknown";
}

std::vector<Finding> lint(const Prescription& prescription) {
  const Lens lens = compile(prescription);
  Findings findings;
  check_stops(prescription, findings);
  check_surfaces(lens, findings);
  check_first_order(prescription, lens, findings);
  return findings;
}

std::vector<Finding> lint(const Lens& lens, const Film& film) {
  constexpr double too_large = 3, too_small = 0.02;
  const double circle = image_circle_mm(with_film(lens, film.z_mm.value_or(lens.film_z())));
  const double diameter = 2 * film.radius_mm();
  const auto finding = [&](const std::string& wanted) {
    return std::vector<Finding>{{Kind::film_size,
                                 {},
                                 diameter,
                                 circle,
                                 "the film is " + to_text(film.width_mm, 6) + " by " + mm(film.height_mm) +
                                     " and needs an image circle of " + mm(diameter) + "; the lens has one of " +
                                     to_text(circle, 4) + " mm, wanted a " + wanted + " film"}};
  };
  if (diameter > too_large * circle) return finding("smaller");
  if (diameter < too_small * circle && std::isfinite(circle)) return finding("larger");
  return {};
}

}  // namespace petzval::inline v0
