// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/renderer_cameras.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "core/text.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/analysis/colour.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {
namespace {

constexpr std::size_t focus_nodes = 33, stop_nodes = 9, rings = 12, light_nodes = 5;
constexpr double box_scale = 1.02;  ///< enlarges boxes around pupils, because they are computed from samples
constexpr int azimuths = 5;         ///< film points of a lens with cylinders, from +y to +x

/// A number that reads back as the same float, with a point so that it is not an integer.
std::string number(double value) {
  std::string text = to_text(std::clamp(value, -3e38, 3e38), 9);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

/// f(0), f(1), ..., f(count - 1).
template <class F>
std::vector<double> table(std::size_t count, const F& f) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = f(i);
  return values;
}

/// Bounds of the slopes of rays from film points at one distance from the axis: x / z and y / z, which hardly change if
/// the film moves. `from` and `to` are along the direction of the film point from the axis, `across` is perpendicular.
struct Box {
  double from = std::numeric_limits<double>::infinity(), to = -std::numeric_limits<double>::infinity(), across = 0;

  bool empty() const { return !(from < to); }
  void take(const Box& other) {
    from = std::min(from, other.from), to = std::max(to, other.to), across = std::max(across, other.across);
  }
};

Box box_at(const Lens& lens, double radius, std::size_t wavelength) {
  const bool revolution = lens.rotationally_symmetric();
  const double depth = lens.film_z() - lens.surfaces().back().vertex_z;
  const std::size_t directions = !revolution ? 24 : radius == 0 ? 1 : 48;
  Box box;
  for (int k = 0; k < (revolution || radius == 0 ? 1 : azimuths); ++k) {
    const double azimuth = k * std::numbers::pi / 2 / (azimuths - 1);
    const double sine = std::sin(azimuth), cosine = std::cos(azimuth);
    const PupilBoundary pupil = exit_pupil_boundary(lens, {radius * sine, radius * cosine}, wavelength, directions);
    for (const PupilSpan& span : pupil.spans) {
      for (const RimPoint& rim : {span.from, span.to}) {
        const double along = (rim.x * sine + rim.y * cosine - radius) / depth;
        const double across = std::abs((rim.x * cosine - rim.y * sine) / depth), r = std::hypot(along, across);
        box.take(radius == 0 ? Box{-r, r, r} : Box{along, along, across});
      }
    }
  }
  return box;
}

class OslCamera {
 public:
  OslCamera(const Lens& lens, const std::optional<Film>& film);
  std::string text() const;

 private:
  void check() const;
  double distance_from_vertex(double inverse_distance) const;
  Lens focused(double inverse_distance) const;
  void set(const std::string& name, const std::string& value) { values_[name] = value; }
  void set(const std::string& name, double value) { set(name, number(value)); }
  void set_count(const std::string& name, std::size_t value) { set(name, std::to_string(value)); }
  void set_array(const std::string& name, std::span<const double> values);
  void set_parameters();
  void set_surfaces();
  void set_wavelengths();
  void set_focus_and_stop();
  void set_boxes();

  Lens lens_;
  Film film_;
  double origin_z_ = 0;
  double f_number_ = 0;                        ///< wide open
  double nearest_ = 0;                         ///< distance from the origin of the last focus node, mm
  double film_radius_ = 0;                     ///< half diagonal of the largest film, mm
  std::vector<double> stop_radii_;             ///< by f-number, a stop apart, mm
  std::map<std::string, std::string> values_;  ///< values of the names in the template
};

OslCamera::OslCamera(const Lens& lens, const std::optional<Film>& film) : lens_(with_iris(lens, Iris{})) {
  check();
  film_ = film ? *film : default_film(lens_, {}, std::hypot(Film().width_mm, Film().height_mm));
  if (!(film_.width_mm > 0 && film_.height_mm > 0))
    throw Error(lens.name() + ": film without area; area must be positive");
  const Meridian main = main_meridian(lens_);
  const Pupils p = pupils(lens_, {}, main);
  origin_z_ = std::isfinite(p.entrance.z) ? p.entrance.z : 0;
  f_number_ = real_f_number(lens_);
  film_radius_ = std::hypot(film_.width_mm, film_.height_mm) / 2;
  focused(0);  // throws Error if the lens cannot be focused
  const auto& moves = lens_.focus_positions();
  const FocusSolution near = nearest_focus(lens_);
  const double focal_length = std::abs(first_order(lens_, {}, main).effective_focal_length);
  const double least =
      moves.empty() ? std::max(1.25 * near.distance, 6 * focal_length) : 1 / moves.back().inverse_distance;
  nearest_ = least + origin_z_;
  stop_radii_ = table(stop_nodes, [&](std::size_t k) {
    const double f_number = f_number_ * std::exp2(static_cast<double>(k) / 2);
    return (k == 0 ? lens_ : with_f_number(lens_, f_number)).surfaces()[*lens_.stop()].semi_diameter;
  });
  set_parameters();
  set_surfaces();
  set_wavelengths();
  set_focus_and_stop();
  set_boxes();
}

void OslCamera::check() const {
  const std::string& where = lens_.name();
  for (std::size_t i = 0; i < lens_.surface_count(); ++i) {
    if (!lens_.surfaces()[i].mirror) continue;
    throw Error(where + ": surface " + std::to_string(i) + " is a mirror; must be refracting for an OSL camera");
  }
  if (!lens_.stop() || !std::isfinite(lens_.surfaces()[*lens_.stop()].semi_diameter)) {
    throw Error(where + ": no stop with a rim; must be given for an OSL camera");
  }
}

/// Distance from the first vertex (mm) of a subject at an inverse distance (1/mm) from the origin.
double OslCamera::distance_from_vertex(double inverse_distance) const {
  return 1 / inverse_distance - (inverse_distance == 0 ? 0 : origin_z_);
}

/// The lens wide open, focused at an inverse distance (1/mm) from the origin.
Lens OslCamera::focused(double inverse_distance) const {
  return with_focus(lens_, distance_from_vertex(inverse_distance));
}

/// `NAME[3] = { 1.0, 2.0, 3.0 }`, eight numbers in a line.
void OslCamera::set_array(const std::string& name, std::span<const double> values) {
  std::string text = name + "[" + std::to_string(values.size()) + "] = {";
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += (i > 0 ? "," : "") + std::string(i % 8 == 0 ? "\n    " : " ") + number(values[i]);
  }
  set(name, text + " }");
}

void OslCamera::set_parameters() {
  const auto nm = lens_.wavelengths_nm();
  const auto [first, last] = std::ranges::minmax(nm);
  const double focal_length = first_order(lens_, {}, main_meridian(lens_)).effective_focal_length;
  const std::string spectrum = nm.size() == 1 ? to_text(nm[0], 7) + " nm"
                                              : std::to_string(nm.size()) + " wavelengths from " + to_text(first, 7) +
                                                    " to " + to_text(last, 7) + " nm";
  set("title", one_line(lens_.name()));
  set("data", "focal length " + to_text(focal_length, 5) + " mm, f/" + to_text(f_number_, 3) + ", " +
                  std::to_string(lens_.surface_count()) + " surfaces, at " + spectrum);
  set("sensor_width", film_.width_mm);
  set("sensor_height", film_.height_mm);
  set("focus_distance", std::max(nearest_ / 1000 * 4, 3.0));
  set("f_number", f_number_);
  set("nearest", nearest_);
  set("film_radius", film_radius_);
  set("origin", origin_z_);
  set_count("focus_nodes", focus_nodes);
  set_count("stop_nodes", stop_nodes);
  set_count("light_nodes", light_nodes);
  set_count("rings", rings);
}

/// Arrays of the surfaces, without their positions, which may vary with focus.
void OslCamera::set_surfaces() {
  const auto surfaces = lens_.surfaces();
  const std::size_t count = surfaces.size();
  const auto each = [&](const std::string& name, double (*value)(const LensSurface& s)) {
    set_array(name, table(count, [&](std::size_t i) { return value(surfaces[i]); }));
  };
  each("curvature", [](const LensSurface& s) { return s.curvature; });
  each("conic", [](const LensSurface& s) { return s.conic; });
  each("curved_x", [](const LensSurface& s) { return s.curved_in == Section::y ? 0.0 : 1.0; });
  each("curved_y", [](const LensSurface& s) { return s.curved_in == Section::x ? 0.0 : 1.0; });
  each("rim", [](const LensSurface& s) { return std::min(s.semi_diameter, 1e30); });
  each("inner_rim", [](const LensSurface& s) { return s.obscuration_semi_diameter; });
  each("aspheric", [](const LensSurface& s) { return s.aspheric.empty() ? 0.0 : 1.0; });
  int highest = 2;
  for (const LensSurface& s : surfaces)
    for (const AsphereTerm& term : s.aspheric) highest = std::max(highest, term.order);
  const auto orders = static_cast<std::size_t>(highest - 1);  // 2, 3, ...
  std::vector<double> terms(count * orders);
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& [order, coefficient] : surfaces[i].aspheric)
      terms[i * orders + static_cast<std::size_t>(order - 2)] = coefficient;
  }
  set_array("term", terms);
  set_count("orders", orders);
  set_count("surfaces", count);
  set_count("stop", *lens_.stop());
}

/// Chances of the wavelengths in proportion to their colours, so that rays of all wavelengths have similar throughputs.
void OslCamera::set_wavelengths() {
  const auto nm = lens_.wavelengths_nm();
  const std::filesystem::path tables = data_directory() / "glass";
  const Spectrum daylight = illuminant("D65", tables / "cie_daylight_10nm.csv");
  const auto rgb = rgb_weights(nm, ColourMatching::load(tables / "cie1931_2deg_5nm.csv"), daylight, daylight);
  const auto size = [](const std::array<double, 3>& c) { return std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]); };
  double whole = 0;
  for (const auto& colour : rgb) whole += size(colour);
  std::vector<double> end{0}, index, tint;
  for (std::size_t w = 0; w < nm.size(); ++w) {
    const double chance = size(rgb[w]) / whole;
    end.push_back(w + 1 == nm.size() ? 1 : end.back() + chance);
    for (std::size_t space = 0; space <= lens_.surface_count(); ++space) index.push_back(lens_.index(space, w));
    for (const double component : rgb[w]) tint.push_back(component / chance);
  }
  set_count("wavelengths", nm.size());
  set_array("chance_end", end);
  set_array("index", index);
  set_array("tint", tint);
}

void OslCamera::set_focus_and_stop() {
  const bool moves = !lens_.focus_positions().empty();
  std::vector<double> film, z, light, shift;
  for (std::size_t k = 0; k < focus_nodes; ++k) {
    const Lens set = focused(static_cast<double>(k) / static_cast<double>(focus_nodes - 1) / nearest_);
    film.push_back(set.film_z());
    if (!moves && k > 0) continue;
    for (const LensSurface& s : set.surfaces()) z.push_back(s.vertex_z);
  }
  for (std::size_t i = 0; i < light_nodes; ++i) {
    const double inverse = static_cast<double>(i) / static_cast<double>(light_nodes - 1) / nearest_;
    const Lens set = focused(inverse);
    for (std::size_t k = 0; k < stop_nodes; ++k) {
      const Lens both = with_any_semi_diameter(set, *lens_.stop(), stop_radii_[k]);
      light.push_back(film_irradiance(both, {}) * std::exp2(k));
      shift.push_back(solve_focus(both, distance_from_vertex(inverse)).film_z - set.film_z());
    }
  }
  set_count("groups_move", moves ? 1 : 0);
  set_array("vertex", z);
  set_array("film", film);
  set_array("stop_size",
            table(stop_nodes, [&](std::size_t k) { return stop_radii_[k] * std::exp2(static_cast<double>(k) / 2); }));
  set_array("light", light);
  set_array("focus_shift", shift);
}

void OslCamera::set_boxes() {
  // Pupils change with wavelength monotonically, so that the first, the last and the primary wavelength give their
  // bounds.
  const auto nm = lens_.wavelengths_nm();
  const auto [first, last] = std::ranges::minmax(nm);
  const std::set<std::size_t> wavelengths{lens_.primary_wavelength(), lens_.wavelength_index(Wavelength::nm(first)),
                                          lens_.wavelength_index(Wavelength::nm(last))};
  std::vector<double> from, to, across;
  for (const double stop_radius : stop_radii_) {
    // Boxes at the rings and halfway between the rings.
    std::vector<Box> at(2 * rings + 1);
    for (const double inverse : {0.0, 1 / nearest_}) {
      const Lens set = with_any_semi_diameter(focused(inverse), *lens_.stop(), stop_radius);
      for (std::size_t k = 0; k < at.size(); ++k) {
        const double radius = film_radius_ * static_cast<double>(k) / static_cast<double>(at.size() - 1);
        for (const std::size_t w : wavelengths) at[k].take(box_at(set, radius, w));
      }
    }
    // Edges are interpolated linearly between rings, so they are moved outwards until the boxes halfway between rings
    // lie inside.
    const auto widen = [&](double Box::*edge, double sign) {
      for (std::size_t k = 1; k + 1 < at.size(); k += 2) {
        if (at[k].empty()) continue;
        for (const std::size_t end : {k - 1, k + 1}) {
          if (at[end].empty()) at[end] = at[k];
        }
        const double short_by = sign * (at[k].*edge - (at[k - 1].*edge + at[k + 1].*edge) / 2);
        if (!(short_by > 0)) continue;
        at[k - 1].*edge += sign * short_by;
        at[k + 1].*edge += sign * short_by;
      }
    };
    widen(&Box::from, -1);
    widen(&Box::to, 1);
    widen(&Box::across, 1);
    for (std::size_t k = 0; k < at.size(); k += 2) {
      const bool empty = at[k].empty();
      const double middle = empty ? 0 : (at[k].from + at[k].to) / 2, half = empty ? 0 : (at[k].to - at[k].from) / 2;
      from.push_back(middle - box_scale * half);
      to.push_back(middle + box_scale * half);
      across.push_back(empty ? 0 : box_scale * at[k].across);
    }
  }
  set_array("box_from", from);
  set_array("box_to", to);
  set_array("box_across", across);
}

/// The template below its first empty line, with values in place of the names between two @.
std::string OslCamera::text() const {
  const std::filesystem::path file = data_directory() / "osl" / "camera.osl";
  const std::string whole = read_file(file, "the template of the OSL camera");
  std::string result;
  std::size_t at = whole.find("\n\n");
  for (at = at == std::string::npos ? 0 : at + 2;;) {
    const std::size_t open = whole.find('@', at), close = whole.find('@', open + 1);
    if (open == std::string::npos || close == std::string::npos) return result + whole.substr(at);
    const std::string name = whole.substr(open + 1, close - open - 1);
    const auto value = values_.find(name);
    if (value == values_.end()) throw Error(file.string() + ": @" + name + "@; must be a name of the OSL camera");
    result += whole.substr(at, open - at) + value->second;
    at = close + 1;
  }
}

}  // namespace

std::string format_osl_camera(const Lens& lens, const std::optional<Film>& film) {
  return OslCamera(lens, film).text();
}

}  // namespace petzval
