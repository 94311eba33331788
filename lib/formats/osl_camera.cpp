// SPDX-License-Identifier: Apache-2.0
#include "petzval/formats/osl_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/text.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil/pupil_boundary.hpp"
#include "text_file.hpp"

namespace petzval {
namespace {

constexpr std::size_t focus_nodes = 33, stop_nodes = 9, rings = 12, light_nodes = 5;
constexpr double box_scale = 1.02;  ///< enlarges boxes around pupils, because they are computed from samples

/// A number that reads back as the same float, with a point so that it is not an integer.
std::string number(double value) {
  std::string text = to_text(std::clamp(value, -3e38, 3e38), 9);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

/// `  float NAME[3] = { 1.0, 2.0, 3.0 };`, eight to a line.
std::string array(const std::string& name, std::span<const double> values) {
  std::string text = "  float " + name + "[" + std::to_string(values.size()) + "] = {";
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += (i > 0 ? "," : "") + std::string(i % 8 == 0 ? "\n    " : " ") + number(values[i]);
  }
  return text + " };\n";
}

/// Bounds of the exit pupil for a film point, in the plane of the last vertex. `from` and `to` are along the direction
/// of the film point from the axis, `across` is perpendicular to this direction.
struct Box {
  double from = std::numeric_limits<double>::infinity(), to = -std::numeric_limits<double>::infinity(), across = 0;

  bool empty() const { return !(from < to); }
  void take(const Box& other) {
    from = std::min(from, other.from), to = std::max(to, other.to), across = std::max(across, other.across);
  }
};

Box box_at(const Lens& lens, double radius) {
  Box box;
  const PupilBoundary pupil = exit_pupil_boundary(lens, {0, radius}, {}, radius == 0 ? 1 : 48);
  for (const PupilSpan& span : pupil.spans) {
    const double x = std::abs(span.to.x), y = span.to.y;
    box.take(radius == 0 ? Box{-std::hypot(x, y), std::hypot(x, y), std::hypot(x, y)} : Box{y, y, x});
    if (radius != 0) box.take({span.from.y, span.from.y, std::abs(span.from.x)});
  }
  return box;
}

Film usual_film(const Lens& lens) {
  Film film;
  const double diagonal = std::hypot(film.width_mm, film.height_mm);
  if (const double circle = image_circle_mm(lens, 0.1); circle < diagonal) {
    film.width_mm *= circle / diagonal;
    film.height_mm *= circle / diagonal;
  }
  return film;
}

class OslCamera {
 public:
  OslCamera(const Lens& lens, const std::optional<Film>& film);
  std::string text() const;

 private:
  void check() const;
  double distance_from_vertex(double inverse_distance) const;
  Lens focused(double inverse_distance) const;
  std::string header() const;
  std::string parameters() const;
  std::string tables() const;
  std::string surfaces() const;
  void boxes(std::string& text) const;

  Lens lens_;
  Film film_;
  double origin_z_ = 0;
  double f_number_ = 0;     ///< wide open
  double nearest_ = 0;      ///< distance from the origin of the last focus node, mm
  double film_radius_ = 0;  ///< half diagonal of the largest film, mm
  std::vector<Lens> stopped_;
};

OslCamera::OslCamera(const Lens& lens, const std::optional<Film>& film) : lens_(with_iris(lens, Iris{})) {
  check();
  film_ = film.value_or(usual_film(lens_));
  if (!(film_.width_mm > 0 && film_.height_mm > 0))
    throw Error(lens.name() + ": film without area; area must be positive");
  const FirstOrder first = first_order(lens_);
  const Pupils p = pupils(lens_);
  origin_z_ = std::isfinite(p.entrance.z) ? p.entrance.z : 0;
  f_number_ = real_f_number(lens_);
  film_radius_ = std::hypot(film_.width_mm, film_.height_mm) / 2;
  focused(0);  // throws Error if the lens cannot be focused
  const auto& moves = lens_.focus_positions();
  const FocusSolution near = nearest_focus(lens_);
  const double least = moves.empty() ? std::max(1.25 * near.distance, 6 * std::abs(first.effective_focal_length))
                                     : 1 / moves.back().inverse_distance;
  nearest_ = least + origin_z_;
  for (std::size_t k = 0; k < stop_nodes; ++k) {
    stopped_.push_back(k == 0 ? lens_ : with_f_number(lens_, f_number_ * std::exp2(static_cast<double>(k) / 2)));
  }
}

void OslCamera::check() const {
  const std::string& where = lens_.name();
  for (std::size_t i = 0; i < lens_.surface_count(); ++i) {
    const LensSurface& s = lens_.surfaces()[i];
    const std::string here = where + ": surface " + std::to_string(i);
    if (s.mirror) throw Error(here + " is a mirror; must be refracting for an OSL camera");
    if (s.curved_in != Section::both) throw Error(here + " is a cylinder; must be a surface of revolution");
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

std::string OslCamera::header() const {
  const FirstOrder first = first_order(lens_);
  return "// " + formats_detail::one_line(lens_.name()) + "\n" + "// focal length " +
         to_text(first.effective_focal_length, 5) + " mm, f/" + to_text(f_number_, 3) + ", " +
         std::to_string(lens_.surface_count()) + " surfaces, at " +
         to_text(lens_.wavelengths_nm()[lens_.primary_wavelength()], 7) +
         " nm\n"
         "//\n"
         "// A camera for Blender's Cycles. For Octane, replace camera_shader_raster_position() and\n"
         "// camera_shader_random_sample() in the first two statements of the shader by Octane's film position\n"
         "// (0 to 1, upwards) and random numbers.\n"
         "//\n"
         "// Lengths inside are in mm. z runs from the scene to the film; the first surface is at 0.\n\n";
}

std::string OslCamera::parameters() const {
  const double far = 1000 * std::max(nearest_ / 1000 * 4, 3.0);
  return "shader petzval_camera(\n"
         "  float sensor_width = " +
         number(film_.width_mm) +
         " [[ string label = \"Sensor width (mm)\" ]],\n"
         "  float sensor_height = " +
         number(film_.height_mm) +
         " [[ string label = \"Sensor height (mm)\" ]],\n"
         "  float focus_distance = " +
         number(far / 1000) +
         " [[ string label = \"Focus distance\" ]],\n"
         "  float f_number = " +
         number(f_number_) +
         " [[ string label = \"f-number\" ]],\n"
         "  int blades = 0 [[ string label = \"Blades (0: round)\" ]],\n"
         "  float roundness = 0.0 [[ string label = \"Roundness of the blades\" ]],\n"
         "  float rotation = 0.0 [[ string label = \"Rotation of the blades (degrees)\" ]],\n"
         "  float units_per_mm = 0.001 [[ string label = \"Units per mm\" ]],\n"
         "  output point position = 0.0,\n"
         "  output vector direction = 0.0,\n"
         "  output color throughput = 1.0)\n{\n";
}

/// Arrays of the surfaces, without their positions, which may vary with focus.
std::string OslCamera::surfaces() const {
  const std::size_t count = lens_.surface_count();
  std::vector<double> curvature, conic, radius, inner, ahead, behind;
  int highest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const LensSurface& s = lens_.surfaces()[i];
    curvature.push_back(s.curvature);
    conic.push_back(s.conic);
    radius.push_back(std::isfinite(s.semi_diameter) ? s.semi_diameter : 1e30);
    inner.push_back(s.obscuration_semi_diameter);
    ahead.push_back(lens_.index(i));
    behind.push_back(lens_.index(i + 1));
    for (const AsphereTerm& term : s.aspheric) highest = std::max(highest, term.order);
  }
  std::string text = "  // the surfaces, from the scene to the film\n";
  text += array("curvature", curvature) + array("conic", conic) + array("rim", radius) + array("inner_rim", inner) +
          array("index_in_front", ahead) + array("index_behind", behind);
  if (highest > 0) {
    // Terms of order 2, 3, ... of all surfaces.
    std::vector<double> terms(count * static_cast<std::size_t>(highest - 1), 0.0);
    std::vector<double> aspheric(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      for (const auto& [order, coefficient] : lens_.surfaces()[i].aspheric) {
        terms[i * static_cast<std::size_t>(highest - 1) + static_cast<std::size_t>(order - 2)] = coefficient;
        aspheric[i] = 1;
      }
    }
    text += "  // sag added: sum of term[surface][order - 2] r^order\n" + array("aspheric", aspheric) +
            array("term", terms);
  }
  text += "  int surfaces = " + std::to_string(count) +
          ";\n  int orders = " + std::to_string(std::max(highest - 1, 0)) +
          ";\n  int stop = " + std::to_string(*lens_.stop()) + ";\n";
  return text;
}

void OslCamera::boxes(std::string& text) const {
  std::vector<double> from, to, across;
  for (const Lens& stopped : stopped_) {
    // Boxes at the rings and halfway between the rings.
    std::vector<Box> at(2 * rings + 1);
    for (const double inverse : {0.0, 1 / nearest_}) {
      const Lens set =
          with_any_semi_diameter(focused(inverse), *lens_.stop(), stopped.surfaces()[*lens_.stop()].semi_diameter);
      for (std::size_t k = 0; k < at.size(); ++k) {
        at[k].take(box_at(set, film_radius_ * static_cast<double>(k) / static_cast<double>(at.size() - 1)));
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
  text +=
      "  // boxes about exit pupils, in the plane of the last vertex: by f-number, then by distance from the axis\n" +
      array("box_from", from) + array("box_to", to) + array("box_across", across);
}

std::string OslCamera::tables() const {
  std::vector<double> film, stop_size, light, shift, z;
  const bool moves = !lens_.focus_positions().empty();
  for (std::size_t k = 0; k < focus_nodes; ++k) {
    const Lens set = focused(static_cast<double>(k) / static_cast<double>(focus_nodes - 1) / nearest_);
    film.push_back(set.film_z());
    for (const LensSurface& s : set.surfaces()) z.push_back(s.vertex_z);
  }
  if (!moves) z.resize(lens_.surface_count());
  for (std::size_t k = 0; k < stop_nodes; ++k) {
    stop_size.push_back(stopped_[k].surfaces()[*lens_.stop()].semi_diameter * std::exp2(static_cast<double>(k) / 2));
  }
  for (std::size_t k = 0; k < light_nodes; ++k) {
    const double inverse = static_cast<double>(k) / static_cast<double>(light_nodes - 1) / nearest_;
    const Lens set = focused(inverse);
    for (const Lens& stopped : stopped_) {
      const Lens both = with_any_semi_diameter(set, *lens_.stop(), stopped.surfaces()[*lens_.stop()].semi_diameter);
      const double f_number = std::exp2(static_cast<double>(light.size() % stop_nodes));
      light.push_back(film_irradiance(both, {}) * f_number);
      shift.push_back(solve_focus(both, distance_from_vertex(inverse)).film_z - set.film_z());
    }
  }
  std::string text = array("vertex", z);
  text +=
      "  // by inverse focus distance, from infinity to " + to_text(nearest_ / 1000, 4) + " m\n" + array("film", film);
  text += "  // by f-number, from f/" + to_text(f_number_, 3) +
          " in stops: radius of the stop and irradiance of the film, divided by their nominal change\n" +
          array("stop_size", stop_size) + array("light", light);
  text += "  // focus shift from stopping down (spherical aberration): by focus, then by f-number\n" +
          array("focus_shift", shift);
  boxes(text);
  return text;
}

/// The shader code common to all lenses. Its statements are also C++, except for `point`, `vector` and `color`.
constexpr const char* body = R"OSL(
  vector raster = camera_shader_raster_position();
  vector places = camera_shader_random_sample();
  throughput = 0.0;

  // Focus: between two nodes of inverse distance.
  float inverse = 0.0;
  if (focus_distance > 0.0) inverse = units_per_mm / focus_distance;
  float at_focus = min(inverse * nearest, 1.0) * (focus_nodes - 1);
  int focus = int(min(at_focus, focus_nodes - 2.0));
  float focus_part = at_focus - focus;
  float film_z = film[focus] + focus_part * (film[focus + 1] - film[focus]);

  // The stop: between two nodes a stop apart.
  float stops = clamp(2.0 * log2(max(f_number, 0.0001) / widest), 0.0, stop_nodes - 1.0);
  int wider = int(min(stops, stop_nodes - 2.0));
  float wider_part = stops - wider;
  float at_light = min(inverse * nearest, 1.0) * (light_nodes - 1);
  int lit = int(min(at_light, light_nodes - 2.0));
  float lit_part = at_light - lit;
  int from = lit * stop_nodes + wider;
  int to = from + stop_nodes;
  float far_shift = focus_shift[from] + wider_part * (focus_shift[from + 1] - focus_shift[from]);
  float near_shift = focus_shift[to] + wider_part * (focus_shift[to + 1] - focus_shift[to]);
  film_z += far_shift + lit_part * (near_shift - far_shift);
  float stop_radius = (stop_size[wider] + wider_part * (stop_size[wider + 1] - stop_size[wider])) / pow(2.0, 0.5 * stops);

  // The film point. The image is inverted: the right of the scene is imaged on the left of the film.
  float film_x = (0.5 - raster[0]) * sensor_width;
  float film_y = (0.5 - raster[1]) * sensor_height;
  float film_r = sqrt(film_x * film_x + film_y * film_y);
  float along_x = 0.0;
  float along_y = 1.0;
  if (film_r > 0.0) {
    along_x = film_x / film_r;
    along_y = film_y / film_r;
  }

  // A point in the box about the exit pupil of this film point, in the plane of the last vertex.
  float at_ring = min(film_r / film_radius, 1.0) * rings;
  int ring = int(min(at_ring, rings - 1.0));
  float ring_part = at_ring - ring;
  int box = wider * (rings + 1) + ring;
  float box_low = box_from[box] + ring_part * (box_from[box + 1] - box_from[box]);
  float box_high = box_to[box] + ring_part * (box_to[box + 1] - box_to[box]);
  float box_half = box_across[box] + ring_part * (box_across[box + 1] - box_across[box]);
  int move = groups_move * surfaces;
  int last = surfaces - 1;
  float last_z = vertex[focus * move + last];
  if (groups_move == 1) last_z += focus_part * (vertex[(focus + 1) * surfaces + last] - last_z);
  float a = box_low + places[0] * (box_high - box_low);
  float b = (2.0 * places[1] - 1.0) * box_half;
  float rear_x = a * along_x + b * along_y;
  float rear_y = a * along_y - b * along_x;
  float depth = film_z - last_z;

  // The ray from the film to the scene: a point p and its direction d.
  float px = rear_x;
  float py = rear_y;
  float pz = last_z;
  float dx = rear_x - film_x;
  float dy = rear_y - film_y;
  float dz = -depth;
  float reach = sqrt(dx * dx + dy * dy + dz * dz);
  dx /= reach;
  dy /= reach;
  dz /= reach;

  int passes = 1;
  if (film_r > film_radius * 1.0001 || box_high <= box_low) passes = 0;
  for (int k = 0; k < surfaces; ++k) {
    if (passes == 1) {
      int i = last - k;
      float z = vertex[focus * move + i];
      if (groups_move == 1) z += focus_part * (vertex[(focus + 1) * surfaces + i] - z);

      // To the plane of the vertex, then to the conic; z is now relative to the vertex.
      float t = (z - pz) / dz;
      float x = px + t * dx;
      float y = py + t * dy;
      float h = 0.0;
      float c = curvature[i];
      float q = 1.0 + conic[i];
      float nx = 0.0;
      float ny = 0.0;
      float nz = 1.0;
      if (c != 0.0) {
        float quadratic = c * (1.0 + conic[i] * dz * dz);
        float half_linear = dz - c * (x * dx + y * dy);
        float constant = c * (x * x + y * y);
        float root = half_linear * half_linear - quadratic * constant;
        if (root < 0.0) {
          passes = 0;
        } else {
          t = constant / (half_linear - sqrt(root));
          x += t * dx;
          y += t * dy;
          h = t * dz;
          nx = -c * x;
          ny = -c * y;
          nz = 1.0 - c * q * h;
        }
      }
ASPHERE
      float r2 = x * x + y * y;
      float limit = rim[i];
      if (i == stop) limit = min(limit, stop_radius);
      // r2 is NaN if the ray misses an asphere.
      if (!(r2 <= limit * limit && r2 >= inner_rim[i] * inner_rim[i])) passes = 0;
      if (i == stop && blades > 2) {
        // The middle of the nearest blade's edge lies on the first axis.
        float sector = 6.28318531 / blades;
        float angle = atan2(-x, y) - rotation * 0.0174532925;
        float turned = angle - sector * (floor(angle / sector) + 0.5);
        float s = sqrt(r2) / stop_radius;
        float su = s * cos(turned);
        float sv = s * sin(turned);
        float most = 0.5 * sector;
        if (roundness < 0.0) most = min(most, 0.5 * (1.57079633 - most));
        float bend = clamp(roundness, -1.0, 1.0) * most;
        float edge = cos(0.5 * sector);
        if (fabs(bend) < 0.0001) {
          if (su > edge) passes = 0;
        } else {
          float arc = sin(0.5 * sector) / sin(bend);
          float centre = edge - arc * cos(bend);
          float outside = (su - centre) * (su - centre) + sv * sv - arc * arc;
          if (bend > 0.0 && su > centre && outside > 0.0) passes = 0;
          if (bend < 0.0 && (su > centre || outside < 0.0)) passes = 0;
        }
      }

      // Snell's law, backwards.
      float length_n = sqrt(nx * nx + ny * ny + nz * nz);
      nx /= length_n;
      ny /= length_n;
      nz /= length_n;
      float ratio = index_behind[i] / index_in_front[i];
      float cosine = nx * dx + ny * dy + nz * dz;
      float below = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
      if (below < 0.0) {
        passes = 0;
      } else {
        float bent = -sqrt(below) - ratio * cosine;
        dx = ratio * dx + bent * nx;
        dy = ratio * dy + bent * ny;
        dz = ratio * dz + bent * nz;
      }
      px = x;
      py = y;
      pz = z + h;
    }
  }

  if (passes == 1) {
    // Irradiance from the area and the solid angle of the box, divided by the irradiance at the film centre.
    float near_light = light[to] + wider_part * (light[to + 1] - light[to]);
    float far_light = light[from] + wider_part * (light[from + 1] - light[from]);
    float middle = (far_light + lit_part * (near_light - far_light)) / pow(2.0, stops);
    float share = 1.0;
    if (blades > 2) {
      float half_sector = 3.14159265 / blades;
      float most = half_sector;
      if (roundness < 0.0) most = min(most, 0.5 * (1.57079633 - most));
      float bend = clamp(roundness, -1.0, 1.0) * most;
      float segment = 0.0;
      if (fabs(bend) >= 0.0001) {
        float arc = sin(half_sector) / sin(bend);
        segment = arc * arc * (bend - sin(bend) * cos(bend));
      }
      share = blades * (sin(half_sector) * cos(half_sector) + segment) / 3.14159265;
    }
    float box_area = 2.0 * (box_high - box_low) * box_half;
    float weight = box_area * depth * depth / (reach * reach * reach * reach);
    throughput = color(weight / (middle * share));
    position = point(px * units_per_mm, py * units_per_mm, (origin - pz) * units_per_mm);
    direction = vector(dx, dy, -dz);
  }
}
)OSL";

constexpr const char* newton = R"OSL(
      if (aspheric[i] > 0.5 && passes == 1) {
        // Newton steps along the ray, from the conic to the asphere.
        float miss = 1.0;
        for (int n = 0; n < 12; ++n) {
          float rr = x * x + y * y;
          float r = sqrt(rr);
          float inside = 1.0 - q * c * c * rr;
          float bow = sqrt(max(inside, 0.000001));
          float sag = c * rr / (1.0 + bow);
          float slope = c / bow;
          float power = 1.0;
          for (int o = 0; o < orders; ++o) {
            sag += term[i * orders + o] * power * rr;
            slope += (o + 2) * term[i * orders + o] * power;
            power *= r;
          }
          nx = -slope * x;
          ny = -slope * y;
          nz = 1.0;
          miss = h - sag;
          float advance = -miss / (nx * dx + ny * dy + nz * dz);
          x += advance * dx;
          y += advance * dy;
          h += advance * dz;
          if (inside <= 0.0) miss = 1.0;
        }
        if (fabs(miss) > 0.001) passes = 0;
      }
)OSL";

std::string OslCamera::text() const {
  std::string code = body;
  const std::string mark = "ASPHERE\n";
  const bool aspheric = std::ranges::any_of(lens_.surfaces(), [](const LensSurface& s) { return !s.aspheric.empty(); });
  code.replace(code.find(mark), mark.size(), aspheric ? newton + 1 : "");
  const auto constant = [](const char* type, const char* name, const std::string& value) {
    return std::string("  ") + type + " " + name + " = " + value + ";\n";
  };
  return header() + parameters() + surfaces() + tables() +
         constant("int", "groups_move", lens_.focus_positions().empty() ? "0" : "1") +
         constant("int", "focus_nodes", std::to_string(focus_nodes)) +
         constant("int", "stop_nodes", std::to_string(stop_nodes)) +
         constant("int", "light_nodes", std::to_string(light_nodes)) + constant("int", "rings", std::to_string(rings)) +
         constant("float", "nearest", number(nearest_)) + constant("float", "widest", number(f_number_)) +
         constant("float", "film_radius", number(film_radius_)) + constant("float", "origin", number(origin_z_)) + code;
}

}  // namespace

std::string format_osl_camera(const Lens& lens, const std::optional<Film>& film) {
  return OslCamera(lens, film).text();
}

}  // namespace petzval
