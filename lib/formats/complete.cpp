// SPDX-License-Identifier: Apache-2.0
#include "complete.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "declared_beam.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/core/error.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/trace/trace.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

/// The size of the stop in one position: the rim in the file and the height of the declared marginal ray.
struct StopSize {
  std::size_t surface = 0;
  std::optional<double> rim{};     ///< nullopt if open
  std::optional<double> height{};  ///< marginal ray at the stop; nullopt if undetermined by the aperture

  bool clips_the_beam() const { return rim && height && *rim < 0.99 * *height; }
  /// The smaller of rim and height; nullopt if both are unknown. If both are equal within the digits of files, it is
  /// the rim.
  std::optional<double> semi_diameter() const {
    constexpr double relative_rounding = 1e-6;
    if (!height || (rim && *rim <= *height * (1 + relative_rounding))) return rim;
    return height;
  }
};

/// Sets the size of the stop in each position: the stop may open and close as the lens zooms.
void set_the_stop(Prescription& lens, std::span<const StopSize> sizes) {
  const std::size_t marked = stop_of(lens);
  const std::optional<double> old = lens.surfaces[marked].semi_diameter;
  if (sizes.front().surface == marked) lens.surfaces[marked].semi_diameter = sizes.front().semi_diameter();
  const bool changed = lens.surfaces[marked].semi_diameter != old;
  for (std::size_t i = 0; i < lens.configurations.size(); ++i) {
    Configuration& c = lens.configurations[i];
    const auto size = sizes[i].semi_diameter();
    const auto known = std::ranges::find(c.changes, static_cast<int>(sizes[i].surface), &SurfaceChange::surface);
    const auto now = known != c.changes.end() && known->semi_diameter ? known->semi_diameter
                                                                      : lens.surfaces[sizes[i].surface].semi_diameter;
    if (size && !(now && std::abs(*now - *size) <= 1e-9 * *size)) {
      change_of(c, static_cast<int>(sizes[i].surface)).semi_diameter = size;
    }
    if (sizes[i].surface == marked || !changed) continue;
    SurfaceChange& other = change_of(
        c, static_cast<int>(marked));  // another surface is the stop in this position, and this one keeps its rim
    if (!other.semi_diameter) other.semi_diameter = old.value_or(std::numeric_limits<double>::infinity());
  }
}

/// Position, from the last surface, at which the ray that enters parallel to the axis at a height crosses the axis; NaN
/// if the ray is lost or does not cross the axis.
double crossing(const Lens& lens, double height) {
  const double start = -10 - std::abs(height);
  const auto exit = trace(lens, Ray<double>{{0, height, start}, {0, 0, 1}});
  const auto& [at, direction] = exit.ray;
  if (!exit.transmitted()) return std::numeric_limits<double>::quiet_NaN();
  return at.z - at.y / direction.y * direction.z - lens.surfaces().back().vertex_z;
}

/// The thickness that satisfies a solve, without its offset; not finite if there is no such thickness.
/// @param lens the surfaces in front of the thickness
double solution(const ThicknessSolve& solve, const Lens& lens, const DesignData& design) {
  const Meridian meridian = main_meridian(lens);
  const FirstOrder first = first_order(lens, {}, meridian);
  const double object = design.object_distance_mm;
  const bool far = !std::isfinite(object);
  if (far && first.afocal) return std::numeric_limits<double>::infinity();
  if (solve.zone != 0) {
    const double value = design.aperture->value;
    const bool by_ratio = design.aperture->setting == ApertureSetting::f_number;
    return crossing(lens, solve.zone * std::abs(by_ratio ? first.effective_focal_length / value : value) / 2);
  }
  const RayMatrix all = ray_matrix(lens, 0, lens.surface_count(), {}, meridian);
  const double radius = solve.beam_radius.value_or(1), slope = far ? 0 : first.object_index * radius / object;
  const double height = all.a * radius + all.b * slope;
  return (solve.height - height) / ((all.c * radius + all.d * slope) / first.image_index);
}

/// Planes with the same medium on both sides.
std::vector<std::size_t> planes_in_one_medium(const Prescription& lens) {
  std::vector<std::size_t> result;
  const Medium* before = &lens.object_space;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    const SurfaceRow& row = lens.surfaces[i];
    const bool plane = row.radius == 0 && row.conic == 0 && row.aspheric.empty() && !row.mirror;
    if (plane && row.medium == *before) result.push_back(i);
    before = &row.medium;
  }
  return result;
}

/// The name, with a number appended if it is already used.
std::string unique_name(std::set<std::string>& taken, const std::string& name) {
  std::string unique = name;
  for (int i = 2; !taken.insert(unique).second; ++i) unique = name + " (" + std::to_string(i) + ")";
  return unique;
}

class Completion {
 public:
  explicit Completion(Import in) : in_(std::move(in)), lens_(in_.lens), asked_(in_.requests) {}
  Prescription run();

 private:
  Lens compiled(const Prescription& rows) const { return compile(rows, {.glasses = in_.loaded_glasses()}); }
  Lens at_primary(const Prescription& rows) const { return at_primary_wavelength(rows, in_.loaded_glasses()); }
  FirstOrder first_order_of(const Prescription& rows) const {
    const Lens lens = compiled(without_rims(rows));
    return first_order(lens, {}, main_meridian(lens));
  }
  int line_of(std::size_t surface) const {
    return surface < asked_.surface_lines.size() ? asked_.surface_lines[surface] : 0;
  }

  void name_the_lens();
  void take_reference();
  void drop_film_row();
  void mark_a_plane_as_stop();
  void mark_a_stop();
  void choose_apertures();
  void name_missing_apertures();
  void solve(const ThicknessSolve& solve);
  void put_film_at_focus();
  void compare_focal_length();
  void prove_table(const Prescription& lens, double stated, const std::string& position);
  void check_telecentric() const;
  void find_subject_distances();
  void name_positions();
  void size_the_stop();
  void declare();
  void compare_the_declared();

  Import in_;
  Prescription& lens_;
  ImportRequests& asked_;
  /// True if the stop has the size of the declared beam, or if a warning says that its rim clips the beam.
  bool has_declared_beam_ = false;
};

void Completion::name_the_lens() {
  const FileOrigin& origin = *lens_.imported;
  if (lens_.name.empty()) lens_.name = origin.title.empty() ? lens_.id : origin.title;
  if (lens_.source_design.empty()) lens_.source_design = origin.title;
  lens_.source_numbers = origin.file;
}

/// If a glass has no index at the d line, the reference becomes the primary wavelength of the design.
void Completion::take_reference() {
  std::vector<Medium*> media{&lens_.object_space};
  for (SurfaceRow& row : lens_.surfaces) media.push_back(&row.medium);
  for (Configuration& c : lens_.configurations) {
    for (SurfaceChange& change : c.changes) {
      if (change.medium) media.push_back(&*change.medium);
    }
  }
  const auto unknown = [](const Medium* m) { return m->glass && !m->nd; };
  if (lens_.design.wavelengths.empty() || std::ranges::none_of(media, unknown)) return;
  const double from = lens_.reference_wavelength_nm, to = lens_.design.wavelengths[lens_.design.primary_wavelength].nm;
  lens_.reference_wavelength_nm = to;
  const GlassCatalogue* glasses = in_.loaded_glasses();
  try {
    for (Medium* m : media) {
      if (m->glass && m->catalogue && glasses) {
        const Glass* glass = glass_of(*m, *glasses);
        const auto before = index_at(*glass, from);
        const double after = refractive_index(*glass, to);
        m->nd = m->nd && before ? *m->nd + after - *before : after;
      } else if (m->nd && m->vd && *m->vd > 0) {
        m->nd = *m->nd + abbe_index(*m->nd, *m->vd, to) - abbe_index(*m->nd, *m->vd, from);
      }
    }
  } catch (const Error& error) {
    throw Error(in_.where() + ": primary wavelength: " + error.what());
  }
}

void Completion::drop_film_row() {
  const auto planes = planes_in_one_medium(lens_);
  if (planes.empty() || planes.back() + 1 != lens_.surfaces.size()) return;
  const FirstOrder first = first_order_of(lens_);
  constexpr double max_relative_defocus =
      0.05;  // fraction of the focal length: tables state the sharpest film, or the film for a near subject
  if (first.afocal ||
      std::abs(first.back_focal_distance) > max_relative_defocus * std::abs(first.effective_focal_length))
    return;
  in_.warn(line_of(planes.back()), "row", "is a plane in the paraxial focus; it is taken as the film");
  lens_.surfaces.pop_back();
}

void Completion::mark_a_plane_as_stop() {
  const auto planes = planes_in_one_medium(lens_);
  if (stop_of(lens_) < lens_.surfaces.size() || planes.empty()) return;
  lens_.surfaces[planes.front()].stop = true;
  in_.warn(line_of(planes.front()), "stop", "is not marked; the plane in one medium is taken as the stop");
  for (const std::size_t other : std::span(planes).subspan(1)) {
    in_.warn(line_of(other), "stop", "a second stop only limits rays; the first is the stop");
  }
}

void Completion::mark_a_stop() {
  if (stop_of(lens_) < lens_.surfaces.size()) return;
  lens_.surfaces.front().stop = true;
  in_.warn(0, "stop", "no surface is marked as the stop; the first one is taken");
}

/// Decides by the declared f-number if the column has diameters or semi-diameters.
void Completion::choose_apertures() {
  const auto& [line, likely_diameters] = *asked_.unknown_apertures;
  const auto scaled = [&](double factor) {
    Prescription rows = lens_;
    for (SurfaceRow& row : rows.surfaces) {
      if (row.semi_diameter) *row.semi_diameter *= factor;
    }
    return rows;
  };
  bool diameters = likely_diameters;
  const auto meaning = [&] {
    return "the column is taken as " + std::string(diameters ? "diameters" : "semi-diameters") + ": ";
  };
  const double declared = lens_.f_number.value_or(0);
  const double as_diameters = declared > 0 ? paraxial_f_number(compiled(lens_)) : HUGE_VAL;
  const double as_semi_diameters = declared > 0 ? paraxial_f_number(compiled(scaled(2))) : HUGE_VAL;
  if (std::isfinite(as_diameters) && std::isfinite(as_semi_diameters)) {
    const auto off = [&](double found) { return std::abs(std::log(found / declared)); };
    diameters = off(as_diameters) <= off(as_semi_diameters);
    if (diameters != likely_diameters) {
      in_.warn(line, "aperture",
               meaning() + "diameters give f/" + to_text(as_diameters, 3) + ", semi-diameters f/" +
                   to_text(as_semi_diameters, 3) + ", and the file declares f/" + to_text(declared, 3));
    }
  } else {
    in_.warn(line, "aperture", meaning() + "the file declares no usable f-number");
  }
  if (!diameters) lens_.surfaces = scaled(2).surfaces;
  lens_.semi_diameters = diameters ? "half of the table's apertures" : "the table's apertures";
}

void Completion::name_missing_apertures() {
  const auto lacks_one = [](const SurfaceRow& row) { return !row.semi_diameter; };
  const auto first = std::ranges::find_if(lens_.surfaces, lacks_one);
  if (first == lens_.surfaces.end()) return;
  in_.warn(line_of(static_cast<std::size_t>(first - lens_.surfaces.begin())), "aperture",
           "is missing in " + std::to_string(std::ranges::count_if(lens_.surfaces, lacks_one)) +
               " of the rows; these surfaces have no semi-diameters");
}

void Completion::solve(const ThicknessSolve& solve) {
  Prescription rows = without_rims(lens_);
  rows.surfaces.resize(solve.surface + 1);
  const double solved = solution(solve, at_primary(rows), lens_.design) + solve.offset;
  double& stated = lens_.surfaces[solve.surface].thickness;
  if (!(std::abs(solved) < 1e10)) {
    return in_.warn(solve.line, solve.command, "no thickness satisfies the solve; the thickness in the file is taken");
  }
  // The tolerance allows for the digits of files and for editions of a glass catalogue. If the film is in focus, its
  // position is kept.
  const double tolerance = solve.is_taken ? 2e-4 * std::abs(first_order_of(lens_).effective_focal_length)
                                          : 1e-3 * std::max(std::abs(solved), std::abs(stated));
  if (solve.is_stated && std::abs(stated - solved) <= tolerance) return;
  if (solve.is_stated) {
    const std::string taken = ", which is taken";
    in_.warn(solve.line, solve.command,
             "the file states a thickness of " + to_text(stated, 8) + " mm" + (solve.is_taken ? "" : taken) +
                 "; the solve gives " + to_text(solved, 8) + " mm" + (solve.is_taken ? taken : ""));
  }
  if (solve.is_taken || !solve.is_stated) stated = solved;
}

void Completion::put_film_at_focus() {
  const FilmAtFocus& film = *asked_.film_at_focus;
  const auto focus = [&](const Prescription& rows, const std::string& position) {
    const FirstOrder first = first_order_of(rows);
    const double distance = first.afocal ? 0 : std::max(first.back_focal_distance, 0.0);
    if (distance > 0) {
      lens_.image_distance = "paraxial focus";
      in_.warn(film.line, film.command,
               film.reason + "; the film is put at the paraxial focus, " + to_text(distance, 7) + " mm" + position);
    } else if (film.is_needed) {
      in_.refuse(film.line, film.command, "unknown, and light from infinity has no focus behind the lens",
                 "the position of the film");
    } else {
      in_.warn(film.line, film.command,
               film.reason + ", and no image lies behind the lens; the film is put at the last vertex" + position);
    }
    return distance;
  };
  const auto last = static_cast<int>(lens_.surfaces.size()) - 1;
  if (film.in_the_rows && lens_.surfaces.back().thickness == 0) lens_.surfaces.back().thickness = focus(lens_, "");
  for (const std::size_t i : film.configurations) {
    Configuration& c = lens_.configurations[i];
    change_of(c, last).thickness = focus(configured(lens_, i), ", in " + c.name);
  }
}

/// Accepts a nominal focal length within 1 %, as it has few digits.
void Completion::compare_focal_length() {
  const StatedFocalLength& stated = *asked_.focal_length;
  if (stated.proves_table) {
    prove_table(lens_, stated.mm, "");
    for (std::size_t i = 1; i < lens_.configurations.size(); ++i) {
      const Configuration& c = lens_.configurations[i];
      const bool own = c.focal_length_mm && c.focal_length_mm != lens_.focal_length_mm;  // else a position of focus
      if (own && !c.subject_distance_mm) prove_table(configured(lens_, i), *c.focal_length_mm, ", in " + c.name);
    }
    return;
  }
  const FirstOrder first = first_order_of(lens_);
  if (!first.afocal && std::abs(std::abs(first.effective_focal_length) / stated.mm - 1) < 0.01) {
    lens_.focal_length_mm = std::copysign(stated.mm, first.effective_focal_length);
  } else if (!stated.is_default) {
    in_.warn(stated.line, stated.command,
             "states " + to_text(stated.mm) + " mm, which is not the focal length" +
                 (first.afocal ? " of an afocal lens" : ", " + to_text(first.effective_focal_length, 6) + " mm"));
  }
}

/// Refuses a lens whose focal length is not the printed one: a number of the table is then wrong. A radius whose sign
/// explains the difference is named. A table for a focal length of 1, 10, 100 or 1000 is accepted.
void Completion::prove_table(const Prescription& lens, double stated, const std::string& position) {
  const auto off = [&](const Prescription& rows) {
    const FirstOrder first = first_order_of(rows);
    return first.afocal ? HUGE_VAL : std::abs(std::abs(first.effective_focal_length / stated) - 1);
  };
  const double found = off(lens);
  if (found < 0.02) return;
  for (const double normal : {1.0, 10.0, 100.0, 1000.0}) {
    const double scaled = first_order_of(lens).effective_focal_length / normal;
    if (std::abs(scaled - 1) < 0.02) return;  // compare_the_declared() warns
  }
  const StatedFocalLength& asked = *asked_.focal_length;
  const FirstOrder first = first_order_of(lens);
  const std::string is = to_text(stated) + " mm, and the table gives " +
                         (first.afocal ? "no focal length" : to_text(first.effective_focal_length, 6) + " mm") +
                         position;
  std::string suspect;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    Prescription changed = lens;
    changed.surfaces[i].radius *= -1;
    if (lens.surfaces[i].radius == 0 || off(changed) > 0.005) continue;
    append(suspect, ", ", to_text(lens.surfaces[i].radius) + " in line " + std::to_string(line_of(i)));
  }
  in_.refuse(asked.line, asked.command, is,
             "the same within 2 %" + (suspect.empty() ? "" : "; the sign of a radius may be missing: " + suspect));
}

/// A telecentric object space has its pupil at infinity, but a file may ask for it with any position of the stop. The
/// stop must therefore be imaged to at least 100 object distances.
void Completion::check_telecentric() const {
  const double object = lens_.design.object_distance_mm;
  const std::size_t stop = stop_of(lens_);
  std::string found = "telecentric in object space";
  if (std::isfinite(object) && stop < lens_.surfaces.size()) {
    const double pupil = entrance_pupil_z(at_primary(without_rims(lens_)), stop);
    if (std::abs(pupil + object) >= 100 * std::abs(object)) return;
    found += ", and the stop, surface " + std::to_string(stop) + ", puts the entrance pupil " +
             to_text(pupil + object, 6) + " mm from the object";
  }
  in_.refuse(asked_.telecentric_line, asked_.telecentric_command, found,
             "consistent with the stop: switch Telecentric Object Space off (the second number is 0), or mark as "
             "the stop the surface at which the chief rays cross the axis");
}

void Completion::find_subject_distances() {
  for (std::size_t i = 0; i < lens_.configurations.size(); ++i) {
    const auto& magnification = asked_.positions->list[i].magnification;
    if (!magnification) continue;
    const FirstOrder first = first_order_of(configured(lens_, i));
    const double distance = first.effective_focal_length * (1 - 1 / *magnification) - first.front_principal_z;
    if (distance > 0 && std::isfinite(distance)) lens_.configurations[i].subject_distance_mm = distance;
  }
}

/// Names the positions. Positions with a subject at infinity are zoom positions; each other position focuses the zoom
/// position with the most similar thicknesses.
void Completion::name_positions() {
  auto& list = lens_.configurations;
  const auto is_named = [&](std::size_t i) { return asked_.positions->list[i].is_named; };
  std::vector<std::size_t> far;
  std::vector<std::vector<double>> thicknesses;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].subject_distance_mm) far.push_back(i);
    auto& own = thicknesses.emplace_back();
    for (const SurfaceRow& row : lens_.surfaces) own.push_back(row.thickness);
    for (const SurfaceChange& c : list[i].changes) {
      own[static_cast<std::size_t>(c.surface)] = c.thickness.value_or(own[static_cast<std::size_t>(c.surface)]);
    }
  }
  const bool is_zoom = far.size() != 1;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < list.size(); ++i) {
    Configuration& c = list[i];
    if (!far.empty() && c.subject_distance_mm) continue;
    c.name = unique_name(taken, is_named(i)         ? c.name
                                : !is_zoom          ? "infinity"
                                : c.focal_length_mm ? to_text(*c.focal_length_mm) + " mm"
                                                    : c.name);
  }
  for (std::size_t i = 0; i < list.size() && !far.empty(); ++i) {
    Configuration& c = list[i];
    if (!c.subject_distance_mm) continue;
    const std::size_t of = *std::ranges::min_element(far, {}, [&](std::size_t other) {
      double sum = 0;
      for (std::size_t k = 0; k < lens_.surfaces.size(); ++k) {
        sum += std::abs(thicknesses[i][k] - thicknesses[other][k]);
      }
      return sum;
    });
    c.focus_of = list[of].name;
    const std::string distance = to_text(*c.subject_distance_mm, 6) + " mm";
    c.name = unique_name(taken, is_named(i) ? c.name : is_zoom ? list[of].name + " at " + distance : distance);
    if (!is_zoom) continue;
    in_.warn(asked_.positions->line, "d0",
             "the position at " + distance + " is taken to focus " + list[of].name +
                 ", whose distances are the most similar");
  }
}

/// Sizes the stop: the declared aperture defines the beam and the rim clips it, so the smaller size is used.
void Completion::size_the_stop() {
  const auto& aperture = lens_.design.aperture;
  const bool declared = aperture && aperture->setting != ApertureSetting::stop_size && aperture->value > 0 &&
                        std::isfinite(aperture->value);
  std::vector<StopSize> sizes(std::max<std::size_t>(lens_.configurations.size(), 1));
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const Prescription rows = configured(lens_, i);
    StopSize& size = sizes[i];
    size.surface = stop_of(rows);
    size.rim = rows.surfaces[size.surface].semi_diameter;
    if (size.rim && std::isinf(*size.rim)) size.rim.reset();
    if (!declared) break;
    DesignAperture own = *aperture;
    const bool by_position = i < lens_.configurations.size() && own.setting == ApertureSetting::f_number;
    if (by_position) own.value = lens_.configurations[i].f_number.value_or(own.value);
    if (i < asked_.position_apertures.size()) own.value = asked_.position_apertures[i].value_or(own.value);
    const double height =
        marginal_height_at_the_stop(at_primary(without_rims(rows)), size.surface, lens_.design.object_distance_mm, own);
    if (height > 0 && std::isfinite(height)) size.height = height;
  }
  const StopSize& first = sizes.front();
  if (!first.height) {
    if (first.rim) return;
    if (lens_.f_number) {
      const double f_number = paraxial_f_number(compiled(lens_));
      const bool reached = std::abs(f_number / *lens_.f_number - 1) < 0.1;
      return in_.warn(0, "stop",
                      "its size is not given; the declared f/" + to_text(*lens_.f_number, 6) +
                          (reached ? " sets it" : " does not set it: the beam has f/" + to_text(f_number, 3)));
    }
    const bool rims = std::ranges::any_of(
        lens_.surfaces, [](const SurfaceRow& row) { return std::isfinite(row.semi_diameter.value_or(HUGE_VAL)); });
    return in_.warn(0, "stop",
                    std::string(declared ? "the declared aperture does not determine its size; "
                                         : "neither its size nor an f-number is given; ") +
                        (rims ? "the rims limit the beam" : "the edges of the surfaces limit the beam"));
  }
  const std::string beam =
      "the declared " + std::string(name(aperture->setting)) + " of " + to_text(aperture->value, 6);
  if (asked_.nominal_aperture && first.rim) {
    // lint() compares f-numbers.
    if (aperture->setting == ApertureSetting::f_number || std::abs(*first.height / *first.rim - 1) <= 0.01) return;
    return in_.warn(0, "stop",
                    "its rim has a semi-diameter of " + to_text(*first.rim, 6) + " mm; " + beam + " needs " +
                        to_text(*first.height, 6) + " mm; the rim is taken");
  }
  for (StopSize& size : sizes) {
    if (asked_.nominal_aperture && size.rim) size.height.reset();
  }
  if (first.semi_diameter() == first.height) lens_.stop_size = "from " + beam;
  has_declared_beam_ = !asked_.nominal_aperture;
  const auto clipped = std::ranges::find_if(sizes, &StopSize::clips_the_beam);
  if (clipped != sizes.end()) {
    in_.warn(
        0, "stop",
        "the rim of " + to_text(*clipped->rim, 6) + " mm clips " + beam + ", whose marginal ray meets the stop at " +
            to_text(*clipped->height, 6) + " mm" +
            (sizes.size() > 1 ? ", in " + lens_.configurations[static_cast<std::size_t>(clipped - sizes.begin())].name
                              : std::string()));
  }
  set_the_stop(lens_, sizes);
}

void Completion::declare() {
  const auto& aperture = lens_.design.aperture;
  if (aperture && aperture->setting == ApertureSetting::f_number && aperture->value > 0 && !lens_.f_number) {
    lens_.f_number = aperture->value;
  }
  double largest = 0;
  for (const DesignField& field : lens_.design.fields) largest = std::max(largest, std::hypot(field.x, field.y));
  if (largest == 0) return;
  switch (lens_.design.field_kind) {
    case FieldKind::angle_deg:
      if (!lens_.half_field_deg && largest < 180) lens_.half_field_deg = largest;
      break;
    case FieldKind::paraxial_image:
    case FieldKind::real_image_height:
      if (!lens_.image_diagonal_mm) lens_.image_diagonal_mm = 2 * largest;
      break;
    case FieldKind::object_height: break;
  }
}

/// Warns of declared data that differ from the lens according to lint().
void Completion::compare_the_declared() try {
  using enum FindingKind;
  const GlassCatalogue* glasses = in_.loaded_glasses();
  for (const Finding& finding : glasses ? lint(lens_, *glasses) : lint(lens_)) {
    const bool declared = finding.kind == focal_length || finding.kind == units || finding.kind == apertures ||
                          (finding.kind == f_number && !has_declared_beam_);
    if (declared) in_.warn(0, name(finding.kind), finding.message);
  }
} catch (const Error&) {
  // The f-number of the lens cannot be computed.
}

Prescription Completion::run() {
  name_the_lens();
  if (lens_.surfaces.empty()) throw Error(in_.where() + ": 0 surfaces; must be at least 1");
  take_reference();
  validate(lens_, in_.where());
  if (asked_.last_plane_may_be_film) drop_film_row();
  if (asked_.plane_may_be_stop) mark_a_plane_as_stop();
  if (asked_.unknown_apertures) choose_apertures();
  if (asked_.names_missing_apertures) name_missing_apertures();
  for (const ThicknessSolve& each : asked_.solves) solve(each);
  if (asked_.film_at_focus) put_film_at_focus();
  if (asked_.focal_length) compare_focal_length();
  if (asked_.telecentric_line > 0) check_telecentric();
  if (asked_.positions) {
    find_subject_distances();
    name_positions();
  }
  mark_a_stop();
  validate(lens_, in_.where());
  size_the_stop();
  declare();
  compare_the_declared();
  in_.count_left_out_warnings();
  validate(lens_, in_.where());
  return with_apertures(lens_, {.glasses = in_.loaded_glasses()});
}

}  // namespace

Prescription complete(Import in) { return Completion(std::move(in)).run(); }

}  // namespace petzval::formats_detail
