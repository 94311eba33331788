// SPDX-License-Identifier: Apache-2.0
#include "camera_setup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "cli.hpp"
#include "files.hpp"
#include "json_input.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/pupil/f_number.hpp"
#include "text.hpp"

namespace examples {
namespace {

/// The key of a set-up that has the value of a flag.
constexpr std::pair<std::string_view, const char*> keys_of_flags[] = {
    {"--blades", "iris.blades"},
    {"--roundness", "iris.roundness"},
    {"--iris-rotation", "iris.rotation_rad"},
    {"--f-number", "f_number"},
    {"--focus", "focus_mm"},
    {"--model", "camera.model"},
    {"--keep-light", "camera.bokeh.keep_light"},
    {"--weight-strength", "camera.bokeh.weight_strength"},
    {"--configuration", "lens.configuration"},
    {"--thin-lens", "lens.thin_mm"},
    {"--wavelengths", "lens.wavelengths_nm"}};

/// The text of a set-up or a report. Of several lenses, the report of the lens.
std::string report_of(const std::string& file, const std::vector<std::string>& lens) {
  const std::string text = read_text(file, largest_json);
  const Json all = Json::parse(text, nullptr, false);
  if (!all.is_object() || !all.contains("lenses")) return text;
  const Json document = read_json(file);
  const JsonEntry reports{"--setup = " + file, document};
  if (!document["lenses"].is_array()) reports.refuse("lenses", "a list of reports");
  const Json::json_pointer name_of_lens("/setup/lens/file");
  std::string names;
  for (const Json& report : document["lenses"]) {
    if (!report.contains(name_of_lens) || !report[name_of_lens].is_string()) {
      refuse(reports.where + ": lenses", report, "reports with setup.lens.file");
    }
    const std::string name = report[name_of_lens];
    if (lens == std::vector{name}) return report.dump();
    names += (names.empty() ? "" : ", ") + name;
  }
  if (names.empty()) reports.refuse("lenses", "a list of one or more reports");
  throw petzval::Error(reports.where + ": has several lenses; LENS must be one of " + names);
}

}  // namespace

petzval::Film CameraFlags::sized_film(std::uint32_t columns, std::uint32_t rows, std::uint32_t usual_columns) const {
  constexpr double max_side_px = 16384;
  petzval::Film result = film;
  if (pixels_given && columns == 0 && rows == 0) return result;
  double across = columns, down = rows;
  double &width = result.width_mm, &height = result.height_mm;
  if (!film_given && across > 0 && down > 0) {
    if (down > across) std::swap(width, height);
    (across * height > down * width) ? height = width* down / across : width = height * across / down;
  }
  if (across == 0 && down == 0) across = usual_columns;
  if (across == 0) across = std::max(1.0, std::round(down * width / height));
  if (down == 0) down = std::max(1.0, std::round(across * height / width));
  if ((columns == 0 || rows == 0) && std::max(across, down) > max_side_px) {
    throw petzval::Error("--film = " + number(width) + 'x' + number(height) + ": a picture of " + number(across) +
                         " x " + number(down) + " pixels; must have at most " + number(max_side_px) +
                         " along each side");
  }
  result.columns = static_cast<int>(across), result.rows = static_cast<int>(down);
  return result;
}

std::uint32_t CameraFlags::frame_count() const {
  const auto& [keys, text, origin, frames, frames_per_s] = pull;
  if (frames_per_s > 0 && points_file.empty() && !text.ends_with(".json")) {
    throw petzval::Error("--fps = " + number(frames_per_s) + ": must be used with --focus KEYS.json or --points");
  }
  if (!pull.moves()) return std::max(frames, 1u);
  const std::string given = "--focus = " + text;
  if (!points_file.empty() || !focal_points.empty()) {
    throw petzval::Error(given + " with " + (points_file.empty() ? "the focal points of " + file : "--points") +
                         "; must be one distance");
  }
  if (!origin.empty() && origin != name(focus.origin)) {
    throw petzval::Error(text + ": distance_from = " + origin + "; must be the value of --from, " +
                         std::string(name(focus.origin)));
  }
  if (!text.ends_with(".json")) {
    if (frames < 2) throw petzval::Error(given + ": must be used with --frames of 2 or more");
    return frames;
  }
  const double all = std::floor((keys.back().time_s - keys.front().time_s) / pull.time_s(1) + 1e-6) + 1;
  if (frames == 0 && !(all <= FocusPull::frame_counts.most)) {
    throw petzval::Error(text + ": frames = " + number(all) + "; must be at most " +
                         number(FocusPull::frame_counts.most) + " or limited by --frames");
  }
  return frames > 0 ? frames : static_cast<std::uint32_t>(all);
}

void add_setup(App& app, CameraFlags& flags) {
  const auto read = [&app, &flags](const std::string& file) {
    const auto fail = [&](const std::string& why) { throw petzval::Error("--setup = " + file + ": " + why); };
    const petzval::CameraOptions usual = flags.camera;
    const std::string text = report_of(file, app.values("LENS"));
    static_cast<petzval::CameraSetup&>(flags) = for_flag("--setup", [&] { return petzval::camera_setup(text, file); });
    const Json json = Json::parse(text), &setup = json.contains("setup") ? json["setup"] : json;
    const auto has = [&](const char* key) { return setup.contains(Json::json_pointer(key)); };
    if (!has("/camera/model")) flags.camera.model = usual.model;
    if (!has("/camera/normalisation")) flags.camera.normalisation = usual.normalisation;
    flags.file = file, flags.film_given = has("/film");
    flags.pixels_given = has("/film/columns") && has("/film/rows");
    for (const char* replaced : {"LENS", "--focus"}) {
      if (Option* const option = app.get_option(replaced)) option->required(false);
    }
    const std::string& lens = flags.lens.file;
    const bool other_lens = (app.given("LENS") && app.values("LENS") != std::vector{lens}) ||
                            app.given("--thin-lens") || app.given("--singlet");
    if (!other_lens && !lens.empty() && !petzval::find_lens(lens)) {
      fail("lens: file = \"" + lens + "\"; must be an existing file or the name of a shipped lens");
    }
    if (other_lens) flags.lens = {.wavelengths_nm = flags.lens.wavelengths_nm};
    const auto given = [&app](const char* flag) { return app.given(flag); };
    if (other_lens || std::ranges::any_of(std::array{"--focus", "--from", "--criterion"}, given)) {
      flags.film.z_mm.reset(), flags.focal_surface.default_inverse_distance.reset();
    }
    if (app.values("--iris-area") == std::vector<std::string>{"equal"} && !app.given("--f-number")) {
      fail("--iris-area = equal needs --f-number: the f-number of a set-up is of the corners");
    }
    if (!flags.focus_mm && app.get_option("--focus") && !app.given("--focus")) {
      fail("focus_mm is missing; must be in the file or given by --focus");
    }
  };
  app.add_option("--setup", read,
                 "set-up of the camera instead of LENS and flags; a report of render, blur or psf, or a file with its "
                 "setup. LENS and the flags that are given replace single values")
      ->type_name("REPORT.json");
  app.set_words([&app, &flags](const std::string& message) {
    for (const auto& [flag, key] : keys_of_flags) {
      const std::size_t end = message.find_first_of(" :=");
      if (flags.file.empty() || message.substr(0, end) != flag || app.given(std::string(flag))) continue;
      return flags.file + ": " + key + message.substr(flag.size());
    }
    return message;
  });
}

void add_camera(App& app, CameraFlags& flags, const std::string& frames_help) {
  add_iris(app, flags);
  if (frames_help.empty()) {
    add_length(app, "--focus", *flags.focus_mm, positive_length,
               "distance of the subject in focus (mm), or inf; at the primary wavelength: the one nearest to the d "
               "line, unless the lens states a reference");
  } else {
    add_focus_pull(app, flags.pull, flags.focus_mm, frames_help);
  }
  add_focus(app, flags.focus);
  add_film(app, flags);
}

void add_film(App& app, CameraFlags& flags, const std::string& help) {
  app.add_option(
         "--film",
         [&flags](const std::string& text) {
           constexpr Range side{std::numeric_limits<double>::min(), 1e6, "a length above 0, at most 1e6 mm"};
           const std::size_t x = text.find('x');
           if (x == text.npos) {
             throw petzval::Error("--film = \"" + text.substr(0, 60) + "\"; must be a size like 36x24");
           }
           const double width = flags.film.width_mm = parse_length("--film", text.substr(0, x), side);
           const double height = flags.film.height_mm = parse_length("--film", text.substr(x + 1), side);
           flags.film_given = true;
           const double rows = std::round(flags.film.columns * height / width);
           if (flags.pixels_given) flags.film.rows = static_cast<int>(std::clamp(rows, 1.0, 16384.0));
         },
         help)
      ->type_name("WxH")
      ->default_str(number(flags.film.width_mm) + 'x' + number(flags.film.height_mm));
}

void add_tilt(App& app, CameraFlags& flags, const Range& degrees) {
  add_angle(
      app, "--tilt", flags.film.tilt_rad, degrees,
      "tilt of the film about +x (degrees); its normal is Ry(swing) Rx(tilt) e_z, and film points are in its axes");
  add_angle(app, "--swing", flags.film.swing_rad, degrees, "swing of the film about +y (degrees)");
}

void add_f_number(App& app, CameraFlags& flags) {
  add_number(app, "--f-number", flags.f_number, positive_number, "f-number to stop the lens down to (by exact rays)")
      ->default_str("wide open");
}

void add_iris(App& app, CameraFlags& flags) {
  add_f_number(app, flags);
  add_iris_shape(app, flags);
}

void add_iris_shape(App& app, CameraFlags& flags) {
  constexpr Range blades{0, 20, "3 to 20, or 0 for a round iris"};
  add_count(app, "--blades", flags.iris.blades, blades, "blades of the iris, 3 to 20; 0: round");
  add_number(app, "--roundness", flags.iris.roundness, {-1, 1, "a number from -1 to 1"},
             "edges of the blades; 0: straight; 1: round; below 0: hollow");
  add_angle(app, "--iris-rotation", flags.iris.rotation_rad, finite_number,
            "rotation of the first corner from straight up (degrees); anticlockwise seen from behind the camera");
  app.add_option("--iris-area", flags.iris_area,
                 "meaning of the f-number with blades. circumscribed: their corners lie on the round iris; equal: they "
                 "pass as much light as the round iris")
      ->one_of({"circumscribed", "equal"})
      ->capture_default_str();
}

namespace {

constexpr Range any_factor{-1e6, 1e6, "a number from -1e6 to 1e6"};

/// Parses "radius:power" or "x,y:offset".
std::vector<double> parts_of(const std::string& flag, std::string text, const std::string& rule) {
  const auto count = static_cast<std::size_t>(std::ranges::count(rule, ',')) + 2;
  const std::string refused = flag + " = \"" + text.substr(0, 60) + "\"; must be " + rule;
  if (text.find(':') != text.find_last_of(",:")) throw petzval::Error(refused);
  std::ranges::replace(text, ':', ',');
  std::istringstream in(text);
  std::vector<double> numbers;
  for (std::string part; std::getline(in, part, ',');) numbers.push_back(parse_number(flag, part, finite_number));
  if (numbers.size() != count) throw petzval::Error(refused);
  return numbers;
}

}  // namespace

void add_expressive(App& app, CameraFlags& flags) {
  petzval::ExpressiveLens& lens = flags.camera.expressive;
  const auto add = [&app](const std::string& flag, const char* rule, auto& list, const auto& item, const char* help) {
    const auto set = [=, &list](const std::vector<std::string>& texts) {
      list.clear();
      for (const std::string& text : texts) list.push_back(item(parts_of(flag, text, rule)));
    };
    app.add_option(flag, set, help)->type_name(rule);
  };
  // First, because the options below replace what it clears.
  const auto start = [&flags, &lens](const std::string& text) {
    flags.from_lens = parse_number("--from-lens", text, any_factor);
    lens.power.clear(), lens.film_offsets.clear();
  };
  app.add_option("--from-lens", start,
                 "factor of the real lens's spherical aberration and curvature of field to start from (1: unchanged); "
                 "--power-spline and --curvature-points replace them")
      ->type_name("NUMBER")
      ->default_str("0");
  add(
      "--power-spline", "radius:power", lens.power,
      [](const auto& n) {
        return petzval::PowerKnot{n[0], n[1]};
      },
      "refractive power of the pupil's rings, relative to the lens: a spline through radius:power, radii from 0 (axis) "
      "to 1 (rim), as 0:1 0.7:1.01 1:0.98");
  add(
      "--curvature-points", "x,y:offset", lens.film_offsets,
      [](const auto& n) {
        return petzval::FilmOffset{{n[0], n[1]}, n[2]};
      },
      "shift of film points away from the lens, all in mm: a surface through x,y:offset, as 0,0:0 18,12:0.3 "
      "-18,12:0.3");
  const auto disperse = [&lens](const std::string& text) {
    lens.dispersion = {parse_number("--dispersion", text, any_factor)};
    if (lens.dispersion.front() == 1) lens.dispersion.clear();
  };
  app.add_option("--dispersion", disperse, "factor of the lens's axial colour: 0 removes it, 1 keeps it")
      ->type_name("NUMBER")
      ->default_str("1");
}

petzval::ExpressiveLens expressive_of(const CameraFlags& flags, const petzval::Lens& lens, const petzval::Film& film) {
  petzval::ExpressiveLens result = flags.camera.expressive;
  if (flags.from_lens == 0) return result;
  petzval::ExpressiveLens own = petzval::fit_expressive_lens(lens, film);
  for (petzval::PowerKnot& knot : own.power) knot.power = 1 + flags.from_lens * (knot.power - 1);
  for (petzval::FilmOffset& offset : own.film_offsets) offset.offset_mm *= flags.from_lens;
  if (result.power.empty()) result.power = own.power;
  if (result.film_offsets.empty()) result.film_offsets = own.film_offsets;
  return result;
}

void add_picture_size(App& app, std::uint32_t& width, std::uint32_t& height, std::uint32_t usual_width) {
  constexpr Range side{1, 16384, "a whole number from 1 to 16384"};
  width = height = 0;
  app.add_option(
         "--size",
         [&width, &height, side](const std::string& text) {
           const auto count = [&](std::string_view part) {
             const double value = parse_number("--size", part, side);
             if (value != std::floor(value)) throw petzval::Error("--size = \"" + text + "\"; must be whole numbers");
             return static_cast<std::uint32_t>(value);
           };
           const std::size_t x = text.find('x');
           width = count(std::string_view(text).substr(0, x));
           height = x == std::string::npos ? 0 : count(std::string_view(text).substr(x + 1));
         },
         "pixels across and down, or across only; without --film the film takes the picture's shape within 36 x 24 mm")
      ->type_name("WxH")
      ->default_str(std::to_string(usual_width) + " across, square pixels");
}

Option* add_model(App& app, petzval::ModelKind& model) {
  std::vector<std::string> names;
  for (const petzval::ModelKind m : petzval::models()) names.emplace_back(petzval::name(m));
  return app
      .add_option(
          "--model", [&model](const std::string& text) { model = *petzval::model_named(text); }, "model of the lens")
      ->one_of(names)
      ->default_str(std::string(petzval::name(model)));
}

namespace {

/// The given f-number; if it is faster than the lens by at most 4 %, the f-number of the lens wide open.
double reachable(const petzval::Lens& lens, double f_number) {
  // Lens names are rounded: an "f/1.8" lens may open only to f/1.85.
  constexpr double name_tolerance = 1.04, rounding_tolerance = 1.005;
  const double fastest = f_number > 0 ? petzval::fastest_f_number(lens) : 0;
  if (!(f_number < fastest && fastest <= name_tolerance * f_number)) return f_number;
  if (fastest > rounding_tolerance * f_number) {
    note(lens.name() + ": the lens opens to f/" + number(fastest, 4) + ", which is used instead of f/" +
         number(f_number));
  }
  return fastest;
}

/// The f-number of the circle through the corners of the blades.
double corner_f_number(const CameraFlags& flags) {
  return flags.iris_area == "equal" ? petzval::equal_area_f_number(flags.iris, *flags.f_number) : *flags.f_number;
}

}  // namespace

petzval::CameraSetup CameraFlags::used_with(const petzval::Lens& compiled) const {
  petzval::CameraSetup result = *this;
  result.lens.primary_nm = primary_among(compiled.wavelengths_nm(), lens.primary_nm);
  if (f_number && lens.thin_mm == 0) {
    result.f_number = reachable(petzval::with_iris(compiled, iris), corner_f_number(*this));
  }
  return result;
}

petzval::Lens stopped_down(const petzval::Lens& lens, const CameraFlags& flags) {
  const petzval::Iris& iris = flags.iris;
  if (iris.blades == 0) {
    const auto refuse = [](const std::string& found, const std::string& why) {
      throw petzval::Error(found + " needs --blades: a round iris has " + why);
    };
    if (iris.roundness != 0) refuse("--roundness", "no edges");
    if (iris.rotation_rad != 0) refuse("--iris-rotation", "no corners");
    if (flags.iris_area == "equal") refuse("--iris-area = equal", "only one area");
  }
  if (flags.iris_area == "equal" && flags.lens.thin_mm > 0) {
    throw petzval::Error("--iris-area = equal with --thin-lens; must be circumscribed");
  }
  const petzval::Lens shaped = for_flag("--blades", [&] { return petzval::with_iris(lens, iris); });
  if (flags.f_number && flags.lens.thin_mm == 0) {
    return for_flag("--f-number",
                    [&] { return petzval::with_f_number(shaped, reachable(shaped, corner_f_number(flags))); });
  }
  if (flags.iris_area == "equal" && !iris.round() && !flags.f_number) {
    throw petzval::Error("--iris-area = equal needs --f-number: wide open, blades cannot open further");
  }
  return shaped;
}

petzval::Lens focused(const LoadedLens& loaded, const CameraFlags& flags) {
  const petzval::Lens lens = stopped_down(loaded.lens, flags);
  return for_flag("--focus", [&] { return petzval::with_focus(lens, *flags.focus_mm, flags.focus); });
}

void say_what_does_not_fit(const petzval::Lens& lens, const petzval::Film& film, const std::string& pixel_flags) {
  for (const petzval::Finding& finding : petzval::lint(lens, film)) {
    if (finding.kind == petzval::FindingKind::film_size) note(finding.message);
    if (finding.kind == petzval::FindingKind::pixel_shape && !pixel_flags.empty()) {
      note("--film and " + pixel_flags + " have different shapes: " + finding.message);
    }
  }
}

}  // namespace examples
