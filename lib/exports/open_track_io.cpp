// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/lens_metadata.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "io/json.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/exports/distortion.hpp"

namespace petzval {
namespace {

using io_detail::json_number;
using io_detail::json_text;

constexpr double metres = 1e-3;  // per mm

/// A JSON object, written on one line or on several indented lines.
class Object {
 public:
  void add(std::string_view key, const std::string& json) { members_.emplace_back(key, json); }
  void add(std::string_view key, double value) { add(key, json_number(value)); }
  /// Adds a text unless it is empty. Texts of the standard have at most 1023 bytes.
  void add_text(std::string_view key, const std::string& text) {
    if (text.size() > 1023) {
      throw Error("OpenTrackIO: " + std::string(key) + " has " + std::to_string(text.size()) +
                  " bytes; must be at most 1023");
    }
    if (!text.empty()) add(key, json_text(text));
  }
  std::string on_one_line() const { return text("", ", ", ""); }
  std::string on_lines(const std::string& indent) const {
    return text("\n" + indent + "  ", ",\n" + indent + "  ", "\n" + indent);
  }

 private:
  std::string text(const std::string& first, const std::string& next, const std::string& last) const {
    std::string result = "{";
    for (const auto& [key, json] : members_) {
      result += (result.size() == 1 ? first : next) + '"' + key + "\": " + json;
    }
    return result + last + "}";
  }
  std::vector<std::pair<std::string, std::string>> members_;
};

std::string size_of(double width, double height, bool whole) {
  Object object;
  object.add("height", whole ? to_text(height) : json_number(height));
  object.add("width", whole ? to_text(width) : json_number(width));
  return object.on_one_line();
}

/// The coefficients in the order of OpenLensIO, for radii in mm.
std::string radial(const BrownConrady& fit) {
  const double f2 = fit.pinhole.focal_length_mm.y * fit.pinhole.focal_length_mm.y;
  std::string list;
  for (std::size_t power = 0; power < 3; ++power) {
    const double unit = std::pow(f2, static_cast<double>(power + 1));
    list += (power > 0 ? ", " : "") + json_number(fit.k[power] / unit) + ", " + json_number(fit.k[power + 3] / unit);
  }
  return "[" + list + "]";
}

std::string distortion(const BrownConrady& fit, double size) {
  Object object;
  object.add_text("model", std::string(name(fit.direction)));
  object.add("radial", radial(fit));
  object.add("overscan", size);
  return object.on_one_line();
}

std::string how_well(const BrownConrady& in, const BrownConrady& out, const ExposureFalloff& falloff,
                     const Film& film) {
  const double rises_to = std::min(in.rises_to_rad, out.rises_to_rad);
  return "Computed from a prescription. In " + std::to_string(film.columns) + " x " + std::to_string(film.rows) +
         " pixels the largest error (px) of D-U is " + to_text(in.largest_px, 2) + ", of U-D " +
         to_text(out.largest_px, 2) + ", up to a field of " + to_text(degrees(in.field_rad), 3) +
         " degrees. Beyond this field the fits extrapolate; from " + to_text(degrees(rises_to), 3) +
         " degrees they fold the picture. The largest error of exposureFalloff is " +
         to_text(falloff.largest_error, 2) + ".";
}

}  // namespace

std::string format_open_track_io(const Lens& lens, const Film& film, const LensIdentity& identity) {
  const LensDistortion picture(Camera(lens, film, {.model = ModelKind::exact_double}));
  const BrownConrady in = fit_brown_conrady(picture, BrownConradyDirection::to_undistorted);
  const BrownConrady out = fit_brown_conrady(picture, BrownConradyDirection::to_distorted);
  const double size = overscan(picture);
  const ExposureFalloff falloff = fit_exposure_falloff(picture.camera().lens(), film);
  const LensState state = lens_state(picture);

  Object camera;
  camera.add("activeSensorPhysicalDimensions", size_of(film.width_mm, film.height_mm, false));
  camera.add("activeSensorResolution", size_of(film.columns, film.rows, true));
  Object fixed;
  fixed.add_text("make", identity.make);
  fixed.add_text("model", identity.model);
  fixed.add_text("serialNumber", identity.serial_number);
  if (identity.nominal_focal_length_mm) fixed.add("nominalFocalLength", *identity.nominal_focal_length_mm);
  fixed.add("distortionOverscanMax", size);
  fixed.add("calibrationHistory", "[" + json_text(how_well(in, out, falloff, film)) + "]");
  Object statics;
  statics.add("camera", camera.on_lines("    "));
  statics.add("lens", fixed.on_lines("    "));

  Object offset, light, sample;
  offset.add("x", picture.pinhole().centre_mm.x);
  offset.add("y", picture.pinhole().centre_mm.y);
  for (std::size_t i = 0; i < 3; ++i) light.add("a" + std::to_string(i + 1), falloff.coefficients[i]);
  sample.add("distortion", "[\n      " + distortion(in, size) + ",\n      " + distortion(out, size) + "\n    ]");
  sample.add("pinholeFocalLength", state.pinhole_focal_length_mm);
  sample.add("projectionOffset", offset.on_one_line());
  sample.add("entrancePupilOffset", state.entrance_pupil_offset_mm * metres);
  if (std::isfinite(state.focus_distance_mm)) sample.add("focusDistance", state.focus_distance_mm * metres);
  if (std::isfinite(state.f_number)) sample.add("fStop", state.f_number);
  if (state.t_number && std::isfinite(*state.t_number)) sample.add("tStop", *state.t_number);
  sample.add("exposureFalloff", light.on_one_line());

  Object protocol, file;
  protocol.add_text("name", "OpenTrackIO");
  protocol.add("version", "[1, 0, 1]");
  file.add("static", statics.on_lines("  "));
  file.add("lens", sample.on_lines("  "));
  file.add("protocol", protocol.on_one_line());
  return file.on_lines("") + "\n";
}

void write_open_track_io(const Lens& lens, const Film& film, const LensIdentity& identity,
                         const std::filesystem::path& file) {
  write_file(format_open_track_io(lens, film, identity), file);
}

}  // namespace petzval
