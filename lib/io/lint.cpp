// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/lint.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/check_rectangle.hpp"
#include "core/text.hpp"
#include "lens/edges.hpp"
#include "lens/equator.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil/pupil_boundary.hpp"
#include "spacing.hpp"

namespace petzval {
namespace {

using Kind = FindingKind;
constexpr double tolerance = 0.02;

std::string mm(double value) { return to_text(value, 6) + " mm"; }

bool differs(double found, double expected) { return !(std::abs(found - expected) <= tolerance * std::abs(expected)); }

/// The findings so far, with the number of the first surface in their messages.
struct Findings {
  int first_surface_number = 0;
  std::vector<Finding> list{};

  std::string surface(int index) const { return "surface " + std::to_string(index + first_surface_number); }
  std::string at(int index) const { return surface(index) + ": "; }
  void add(Finding finding) { list.push_back(std::move(finding)); }
};

void check_stops(const Prescription& prescription, Findings& findings) {
  int stops = 0, last = 0;
  for (const SurfaceRow& row : prescription.surfaces) {
    if (row.stop) ++stops, last = static_cast<int>(&row - prescription.surfaces.data());
  }
  if (stops == 0) {
    findings.add(
        {Kind::no_stop, {}, 0, 1, "no surface is marked as stop; the surface that clips the axial beam first is used"});
  } else if (stops > 1) {
    findings.add({Kind::several_stops, last, static_cast<double>(stops), 1,
                  findings.at(last) + "is the last of " + std::to_string(stops) + " stops; the first is used"});
  }
}

/// "; both end where they meet, at 10.55 mm, and 28.3 % of the light at 26.6 degrees is lost at such edges". Empty if
/// the surfaces overlap at their vertices and do not end.
std::string light_lost(const Prescription& rows, const Lens& lens, const LensSurface& surface) {
  if (!std::isfinite(surface.edge)) return "";
  const std::string text = "; both end where they meet, at " + mm(surface.edge);
  try {
    const FieldPoint point{.field_rad = declared_half_field(rows, lens).value_or(0),
                           .z = -rows.design.object_distance_mm};
    const double whole = pupil_boundary(lens_detail::without_edges(lens), point).area();
    if (!(whole > 0)) return text;
    const double lost = 1 - pupil_boundary(lens, point).area() / whole;
    constexpr double search_error = 1e-5;
    return text + ", and " + (lost > search_error ? to_text(100 * lost, 3) + " %" : "none") + " of the light at " +
           to_text(degrees(point.field_rad), 4) + " degrees is lost at such edges";
  } catch (const Error&) {
    return text;  // field angles are undefined
  }
}

void check_surfaces(const Prescription& rows, const Lens& lens, Findings& findings) {
  const int count = static_cast<int>(lens.surface_count());
  for (int i = 0; i < count; ++i) {
    const auto position = static_cast<std::size_t>(i);
    const LensSurface& surface = lens.surfaces()[position];
    const double end = std::min(lens_detail::equator(surface), surface.semi_diameter);
    const std::optional<double> declared = rows.surfaces[position].semi_diameter;
    // If an aperture ends because two surfaces meet, an overlap is reported instead.
    const bool meets_another = surface.semi_diameter == surface.edge;
    if (declared && std::isfinite(*declared) && surface.semi_diameter > 0 && *declared > end && !meets_another) {
      findings.add({Kind::semi_diameter, i, *declared, end,
                    findings.at(i) + "semi_diameter = " + mm(*declared) + "; must be at most " + mm(end) +
                        ", where the surface ends"});
    }
    // A stop of 0 is a closed iris. Any other rim of 0 is probably a mistake.
    if (surface.semi_diameter == 0 && lens.stop() != position) {
      findings.add({Kind::semi_diameter, i, 0, lens_detail::equator(surface),
                    findings.at(i) + "semi_diameter = 0 mm; only the axial ray passes"});
    }
    if (i + 1 == count) break;
    const auto spacing = io_detail::least_spacing(lens, position);
    if (spacing && spacing->width < -1e-9 * std::max(spacing->height, std::abs(surface.thickness))) {
      findings.add({Kind::overlap, i, spacing->width, 0,
                    findings.at(i) + "overlaps the next surface by " + mm(-spacing->width) + " at a height of " +
                        mm(spacing->height) + light_lost(rows, lens, surface)});
    }
  }
}

/// False if the stop is unlimited, or if a lens without stop has no clear apertures: then the f-number is undefined.
bool limits_the_beam(const Lens& lens) {
  const auto surfaces = lens.stop() ? lens.surfaces().subspan(*lens.stop(), 1) : lens.surfaces();
  return std::any_of(surfaces.begin(), surfaces.end(),
                     [](const LensSurface& s) { return std::isfinite(s.semi_diameter); });
}

/// The ratio of a length to a declared length if it is 10, 25.4, 1000 or one of their inverses; nullopt otherwise.
std::optional<double> unit_between(double length, double declared) {
  for (const double factor : {10.0, 25.4, 1000.0}) {
    for (const double ratio : {factor, 1 / factor}) {
      if (!differs(length, ratio * declared)) return ratio;
    }
  }
  return {};
}

/// The f-number after all clear apertures are multiplied by a factor; nullopt if the lens has no pupils.
std::optional<double> f_number_with(const Prescription& prescription, double factor, const GlassCatalogue* glasses) {
  Prescription scaled = prescription;
  for (SurfaceRow& row : scaled.surfaces) {
    if (row.semi_diameter) *row.semi_diameter *= factor;
    if (row.obscuration_semi_diameter) *row.obscuration_semi_diameter *= factor;
  }
  const Lens lens = compile(scaled, {.glasses = glasses});
  if (!has_pupils(lens)) return {};
  return real_f_number(lens);
}

/// Factor by which all apertures are too large: 2 or 0.5 if such a factor explains the declared f-number; nullopt
/// otherwise.
std::optional<double> aperture_factor(const Prescription& prescription, double f_number,
                                      const GlassCatalogue* glasses) {
  const double factor = f_number < *prescription.f_number ? 2 : 0.5;
  if (std::abs(std::log2(*prescription.f_number / f_number)) < 0.8) return {};
  const auto mended = f_number_with(prescription, 1 / factor, glasses);
  if (mended && std::abs(*mended - *prescription.f_number) <= 0.04 * *prescription.f_number) return factor;
  return {};
}

/// Reports the rim that clips the axial beam first, if its beam is clearly narrower than the beam of the marked stop.
void check_stop(const Lens& lens, Findings& findings) {
  constexpr double clipping_ratio = 0.7;
  if (!lens.stop()) return;
  const auto to = ray_matrices_to(lens, {}, main_meridian(lens));
  // Semi-diameter divided by the height of a ray that enters at height 1.
  const auto margin = [&](std::size_t i) { return lens.surfaces()[i].semi_diameter / std::abs(to[i].a); };
  const double of_stop = margin(*lens.stop());
  std::size_t first = *lens.stop();
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    if (lens.surfaces()[i].semi_diameter > 0 && margin(i) < margin(first)) first = i;
  }
  if (!(margin(first) < clipping_ratio * of_stop) || !std::isfinite(of_stop)) return;
  findings.add({Kind::idle_stop, static_cast<int>(*lens.stop()), of_stop, margin(first),
                findings.at(static_cast<int>(*lens.stop())) + "the stop passes an axial beam of " + mm(of_stop) +
                    " radius, but " + findings.surface(static_cast<int>(first)) + " clips it at " + mm(margin(first))});
}

/// Distance from the last vertex to the paraxial image of the design object; infinite for an afocal lens.
double image_distance(const Prescription& prescription, const Lens& lens) {
  const double object_z = -prescription.design.object_distance_mm;
  return paraxial_image_z(lens, object_z, {}, main_meridian(lens)) - lens.surfaces().back().vertex_z;
}

void check_first_order(const Prescription& prescription, const Lens& lens, const GlassCatalogue* glasses,
                       Findings& findings) {
  const FirstOrder data = first_order(lens, 0, main_meridian(lens));
  const double focal_length = data.effective_focal_length;
  const auto unit =
      prescription.focal_length_mm ? unit_between(focal_length, *prescription.focal_length_mm) : std::nullopt;
  if (unit) {
    findings.add({Kind::units,
                  {},
                  focal_length,
                  *prescription.focal_length_mm,
                  "focal length = " + mm(focal_length) + ", declared " + mm(*prescription.focal_length_mm) +
                      ": lengths are " + to_text(*unit, 4) + " times the declared scale"});
  } else if (prescription.focal_length_mm && differs(focal_length, *prescription.focal_length_mm)) {
    findings.add({Kind::focal_length,
                  {},
                  focal_length,
                  *prescription.focal_length_mm,
                  "focal length = " + mm(focal_length) + ", declared " + mm(*prescription.focal_length_mm)});
  }
  if (prescription.f_number && limits_the_beam(lens)) {
    const double f_number = real_f_number(lens);
    if (const auto factor = aperture_factor(prescription, f_number, glasses)) {
      findings.add({Kind::apertures,
                    {},
                    f_number,
                    *prescription.f_number,
                    "f-number = " + to_text(f_number, 4) + ", declared " + to_text(*prescription.f_number, 4) +
                        ": semi-diameters are " + (*factor > 1 ? "diameters" : "half semi-diameters")});
    } else if (differs(f_number, *prescription.f_number)) {
      findings.add({Kind::f_number,
                    {},
                    f_number,
                    *prescription.f_number,
                    "f-number = " + to_text(f_number, 6) + ", declared " + to_text(*prescription.f_number, 6)});
    }
  }
  const int last = static_cast<int>(lens.surface_count()) - 1;
  const double distance = lens.surfaces().back().thickness;
  const double image = image_distance(prescription, lens);
  if (std::isfinite(image) && std::abs(distance - image) > tolerance * std::abs(focal_length)) {
    const bool far = std::isinf(prescription.design.object_distance_mm);
    findings.add({Kind::image_distance, last, distance, image,
                  findings.at(last) + "the film is " + mm(distance) + " behind the surface, the paraxial " +
                      (far ? "focus " : "image of the object ") + mm(image)});
  }
}

void check_glasses(const Prescription& prescription, const GlassCatalogue& glasses, Findings& findings) {
  constexpr double min_index_difference = 0.005;
  for (std::size_t i = 0; i < prescription.surfaces.size(); ++i) {
    const Medium& medium = prescription.surfaces[i].medium;
    if (!medium.glass || !medium.catalogue || !medium.nd) continue;
    const Glass* glass = glasses.find(*medium.glass, *medium.catalogue);
    if (!glass || std::abs(glass->nd - *medium.nd) <= min_index_difference) continue;
    const int surface = static_cast<int>(i);
    findings.add({Kind::glass_index, surface, *medium.nd, glass->nd,
                  findings.at(surface) + "n_d = " + to_text(*medium.nd, 6) + ", n_d of " + glass->name + " = " +
                      to_text(glass->nd, 6)});
  }
}

void check_size(const Lens& lens, const Film& film, Findings& findings) {
  constexpr double max_size_ratio = 3, min_size_ratio = 0.02;
  const double circle = image_circle_mm(with_film(lens, film.z_mm.value_or(lens.film_z())));
  const double diameter = 2 * film.radius_mm();
  const bool larger = diameter > max_size_ratio * circle;
  if (!larger && !(diameter < min_size_ratio * circle && std::isfinite(circle))) return;
  findings.add({Kind::film_size,
                {},
                diameter,
                circle,
                "the film is " + to_text(film.width_mm, 6) + " by " + mm(film.height_mm) +
                    " and needs an image circle of " + mm(diameter) + "; the image circle of the lens is " +
                    to_text(circle, 4) + " mm, which requires a " + (larger ? "smaller" : "larger") + " film"});
}

void check_pixels(const Lens& lens, const Film& film, Findings& findings) {
  // Images of an anamorphic lens are stretched afterwards, or have pixels of such a shape.
  if (!with_iris(lens, {}).rotationally_symmetric()) return;
  const double width = film.width_mm / film.columns, height = film.height_mm / film.rows;
  const double expected_height = width * film.rows;
  // With few pixels, rounding to whole pixels changes the height of the film slightly.
  if (std::abs(width / height - 1) <= 0.005 || std::abs(film.height_mm - expected_height) < width) return;
  findings.add({Kind::pixel_shape,
                {},
                width / height,
                1,
                "pixels are " + to_text(width, 4) + " by " + to_text(height, 4) +
                    " mm; must be square: " + to_text(film.width_mm, 6) + " by " + mm(expected_height) + " fit " +
                    std::to_string(film.columns) + " by " + std::to_string(film.rows)});
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
    case Kind::units: return "units";
    case Kind::apertures: return "apertures";
    case Kind::idle_stop: return "idle_stop";
    case Kind::glass_index: return "glass_index";
    case Kind::film_size: return "film_size";
    case Kind::pixel_shape: return "pixel_shape";
  }
  return "unknown";
}

namespace {

Findings lint_rows(const Prescription& prescription, const GlassCatalogue* glasses, int first_surface_number = 0) {
  const Prescription rows = configured(prescription, 0);
  const Lens lens = compile(rows, {.glasses = glasses});
  Findings findings{first_surface_number};
  check_stops(rows, findings);
  check_stop(lens, findings);
  check_surfaces(rows, lens, findings);
  check_first_order(rows, lens, glasses, findings);
  return findings;
}

}  // namespace

std::vector<Finding> lint(const Prescription& prescription) { return lint_rows(prescription, nullptr).list; }

std::vector<Finding> lint(const Prescription& prescription, const GlassCatalogue& glasses, int first_surface_number) {
  Findings findings = lint_rows(prescription, &glasses, first_surface_number);
  check_glasses(configured(prescription, 0), glasses, findings);
  return std::move(findings.list);
}

std::vector<ImportWarning> repair(Prescription& p, const GlassCatalogue* glasses) {
  std::vector<ImportWarning> result;
  const auto find = [&](Kind kind) -> std::optional<Finding> {
    const std::vector<Finding> findings = lint_rows(p, glasses).list;
    const auto found = std::ranges::find(findings, kind, &Finding::kind);
    return found == findings.end() ? std::nullopt : std::optional(*found);
  };
  const auto say = [&](const Finding& finding, const std::string& cure) {
    result.push_back({0, std::string(name(finding.kind)), finding.message + "; " + cure});
  };
  // Makes a change unless the lens would be invalid. Returns true if the change was made.
  const auto changed = [&](const std::function<void(Prescription&)>& change) {
    Prescription after = p;
    try {
      change(after);
      validate(after, "");
    } catch (const Error&) {
      return false;
    }
    p = std::move(after);
    return true;
  };
  const bool alone = p.configurations.size() < 2;
  if (const auto units = find(Kind::units); alone && units) {
    const bool made = changed([&](Prescription& lens) {
      lens = scale(lens, 1 / *unit_between(units->found, units->expected));
      lens.focal_length_mm = p.focal_length_mm, lens.image_diagonal_mm = p.image_diagonal_mm;
    });
    if (made) say(*units, "all lengths are scaled");
  }
  if (const auto apertures = find(Kind::apertures); alone && apertures) {
    const double factor = apertures->found < apertures->expected ? 0.5 : 2;
    const bool made = changed([&](Prescription& lens) {
      for (SurfaceRow& row : lens.surfaces) {
        if (row.semi_diameter) *row.semi_diameter *= factor;
        if (row.obscuration_semi_diameter) *row.obscuration_semi_diameter *= factor;
      }
    });
    if (made) say(*apertures, std::string("semi-diameters are ") + (factor < 1 ? "halved" : "doubled"));
  }
  if (const auto stops = find(Kind::several_stops)) {
    bool first = true;
    for (SurfaceRow& row : p.surfaces) {
      row.stop = row.stop && first;
      first = first && !row.stop;
    }
    say(*stops, "only the first mark is kept");
  }
  if (const auto film = find(Kind::image_distance); alone && film && film->expected > 0) {
    if (changed([&](Prescription& lens) { lens.surfaces.back().thickness = film->expected; }))
      say(*film, "the film is moved to the image");
  }
  return result;
}

std::vector<Finding> lint(const Lens& lens, const Film& film) {
  core_detail::check_rectangle(lens.name() + ": film", film);
  Findings findings;
  check_size(lens, film, findings);
  check_pixels(lens, film, findings);
  return std::move(findings.list);
}

}  // namespace petzval
