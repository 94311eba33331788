// SPDX-License-Identifier: Apache-2.0
// Pulls focus over time: points with keyframes give a film position for every frame, as a table and a plot.
//
//   petzval pull data/lenses/double_gauss_100mm_f2_28deg.json --keys examples/scenes/rack.json --out out
//   petzval pull --thin-lens 50 --f-number 2 --keys keys.json --json --out out
#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/focus_points.hpp"
#include "support/focus_pull.hpp"
#include "support/movement_setup.hpp"
#include "support/text.hpp"

namespace {

using examples::finite_or_null;
using examples::Json;
using examples::number;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t max_frames = 100000;

struct Options : examples::MovementOptions {
  std::string keys_file, out_folder;
  petzval::FocusOptions focus;
  double frames_per_s = 24;
  bool tilt = false, json = false;
};

struct Frame {
  double time = 0;
  petzval::Film film = {};
  double distance_mm = infinity, rms_um = none, breathing = none;
  std::size_t targets = 0;
  std::string status = {};
};

struct Times {
  double from = infinity, to = -infinity;
};

/// From the start of the first point to the end of the last point. Unbounded intervals are replaced by the keys.
Times span_of(const std::vector<petzval::FocusPoint>& points) {
  Times times;
  for (const petzval::FocusPoint& p : points) {
    const bool begins = std::isfinite(p.from), ends = std::isfinite(p.until);
    const double from = begins ? p.from : std::min(p.keys.front().time, p.until);
    times.from = std::min(times.from, from);
    times.to = std::max(times.to, ends ? p.until : std::max(p.keys.back().time, from));
  }
  return times;
}

class Pull {
 public:
  Pull(const Options& options, const examples::MovingLens& lens, const std::vector<petzval::FocusPoint>& points)
      : options_(options), lens_(lens), points_(points), film_(lens.film) {
    film_.z_mm = lens.ideal.rear_focal_z;
  }

  Frame at(double time) {
    petzval::FocusTime moment;
    moment.time = time;
    if (options_.setup.film_given) moment.film = film_;
    const auto targets = petzval::focus_targets(lens_.ideal, points_, moment);
    Frame frame{.time = time, .targets = targets.size()};
    options_.tilt ? tilt(targets, frame) : focus(targets, frame);
    frame.film = film_;
    frame.distance_mm = distance();
    frame.breathing = breathing();
    return frame;
  }

 private:
  static constexpr std::size_t rays = 4096;  // blurs within 2 %

  petzval::FocusCriterion criterion() const { return options_.focus.criterion; }

  template <class Fit>
  void use(const Fit& found, Frame& frame) {
    frame.status = petzval::name(found.status);
    if (found) film_ = found.film, frame.rms_um = 1e3 * found.rms_mm;
  }

  void focus(const std::vector<petzval::FocusTarget>& targets, Frame& frame) {
    lens_.exact ? use(petzval::autofocus(*lens_.lens, targets, film_, criterion(), rays), frame)
                : use(petzval::autofocus(lens_.ideal, targets, film_), frame);
  }

  void tilt(const std::vector<petzval::FocusTarget>& targets, Frame& frame) {
    const petzval::TiltOptions tilt{.film = film_, .rays = rays};
    lens_.exact ? use(petzval::fit_tilt(*lens_.lens, targets, tilt), frame)
                : use(petzval::fit_tilt(lens_.ideal, targets, tilt), frame);
  }

  /// Distance in focus on the axis, by rays for the real model; infinite if no finite distance is in focus.
  double distance() const {
    if (lens_.exact) return petzval::solve_subject(*lens_.lens, film_.z(), options_.focus).distance;
    const petzval::ScenePoint conjugate = lens_.ideal.scene_of({0, 0, film_.z()});
    const bool real = !conjugate.at_infinity && conjugate.position.z < lens_.ideal.front_focal_z;
    return real ? origin_z() - conjugate.position.z : infinity;
  }
  /// z of the origin of distances for an ideal lens, whose front vertex is at z = 0.
  double origin_z() const {
    switch (options_.focus.origin) {
      case petzval::DistanceOrigin::film: return film_.z();
      case petzval::DistanceOrigin::entrance_pupil: return lens_.ideal.pupils.entrance.z;
      case petzval::DistanceOrigin::front_principal: return lens_.ideal.front_principal_z();
      case petzval::DistanceOrigin::front_vertex: break;
    }
    return 0;
  }

  /// Growth of the image by the chief ray through the exit pupil, compared with a film focused at infinity.
  double breathing() const {
    if (lens_.exact) {
      return petzval::breathing(*lens_.lens, film_.z(), {.criterion = criterion()}).value_or(none);
    }
    return lens_.ideal.magnification_change(film_.z(), lens_.ideal.rear_focal_z);
  }

  const Options& options_;
  const examples::MovingLens& lens_;
  const std::vector<petzval::FocusPoint>& points_;
  petzval::Film film_;  // film of the previous frame
};

std::vector<Frame> frames(const Options& options, const examples::MovingLens& lens,
                          const std::vector<petzval::FocusPoint>& points) {
  const Times times = span_of(points);
  const double count = std::floor((times.to - times.from) * options.frames_per_s + 1e-6) + 1;
  if (!(count <= max_frames)) {
    throw petzval::Error(options.keys_file + ": frames = " + number(count) + " from " + number(times.from) + " s to " +
                         number(times.to) + " s; must be at most " + std::to_string(max_frames));
  }
  Pull pull(options, lens, points);
  std::vector<Frame> result;
  for (double k = 0; k < count; ++k) result.push_back(pull.at(times.from + k / options.frames_per_s));
  if (std::ranges::none_of(result, [](const Frame& f) { return std::isfinite(f.rms_um); })) {
    throw petzval::Error(options.keys_file + ": no frame has a point to focus on (status of the first frame: " +
                         result.front().status + "); at least one point must be in front of the lens");
  }
  return result;
}

std::string to_csv(const std::vector<Frame>& all) {
  const auto cell = [](double value) { return std::isnan(value) ? std::string() : number(value); };
  std::string csv = "time_s,film_z_mm,subject_distance_mm,tilt_deg,swing_deg,rms_blur_um,breathing,targets,status\n";
  for (const Frame& f : all) {
    csv += number(f.time) + "," + number(f.film.z()) + "," + number(f.distance_mm) + "," +
           number(petzval::degrees(f.film.tilt_rad)) + "," + number(petzval::degrees(f.film.swing_rad)) + "," +
           cell(f.rms_um) + "," + cell(f.breathing) + "," + std::to_string(f.targets) + "," + f.status + "\n";
  }
  return csv;
}

Json to_json(const std::vector<Frame>& all) {
  Json rows = Json::array();
  for (const Frame& f : all) {
    rows.push_back({{"time_s", f.time},
                    {"film_z_mm", f.film.z()},
                    {"subject_distance_mm", finite_or_null(f.distance_mm)},
                    {"tilt_deg", petzval::degrees(f.film.tilt_rad)},
                    {"swing_deg", petzval::degrees(f.film.swing_rad)},
                    {"rms_blur_um", finite_or_null(f.rms_um)},
                    {"breathing", finite_or_null(f.breathing)},
                    {"targets", f.targets},
                    {"status", f.status}});
  }
  return rows;
}

/// The distance in focus on the axis in each frame, for --focus of blur and render.
std::string to_keys(const std::vector<Frame>& all, const std::string& from) {
  std::vector<examples::FocusPull::Key> keys;
  for (const Frame& f : all) keys.push_back({f.time, 1 / f.distance_mm});
  return examples::to_json(keys, from);
}

std::string plot(const Options& options, const examples::MovingLens& lens,
                 const std::vector<petzval::FocusPoint>& points, const std::vector<Frame>& all) {
  std::vector<petzval::FocusPullFrame> shown;
  for (const Frame& f : all) {
    shown.push_back({f.time, f.film, f.distance_mm, f.rms_um / 1e3});
  }
  std::set<double> keys;
  for (const auto& point : points) {
    for (const auto& key : point.keys) keys.insert(key.time);
  }
  const std::string remark = lens.conditions + ", " + std::to_string(points.size()) +
                             (points.size() == 1 ? " focus point, " : " focus points, ") +
                             number(options.frames_per_s) + " frames per second";
  return petzval::focus_pull_figure(lens.title, remark, shown, std::vector<double>(keys.begin(), keys.end()),
                                    examples::in_words(options.focus.origin));
}

/// Table rows: one frame per second, and the last frame.
std::string to_text(const std::vector<Frame>& all, double frames_per_s) {
  const auto cell = [](double value, int digits) {
    const std::string text = std::isnan(value) ? "-" : number(value, digits);
    return std::string(text.size() < 12 ? 12 - text.size() : 1, ' ') + text;
  };
  std::string text = "    time, s  film z, mm in focus, mm    tilt, deg   swing, deg  RMS, um   breathing  status\n";
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(frames_per_s)));
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % step != 0 && i + 1 != all.size()) continue;
    const Frame& f = all[i];
    text += cell(f.time, 5) + cell(f.film.z(), 7) + cell(f.distance_mm, 6) +
            cell(petzval::degrees(f.film.tilt_rad) + 0.0, 4) + cell(petzval::degrees(f.film.swing_rad) + 0.0, 4) +
            cell(f.rms_um, 4) + cell(f.breathing, 3) + "  " + f.status + "\n";
  }
  return text;
}

}  // namespace

int commands::pull(int argc, char** argv) {
  Options options;
  examples::App app(
      "Moves the film to focus on scene points with keyframes, frame by frame.\n"
      "Points are in the lens frame, the scene at negative z; a point is used within its interval.\n"
      "The film starts at the focus for infinity. It does not move in a frame without points (no_targets), with points "
      "out of reach (unreachable) or without a solution (not_converged). subject_distance_mm: distance in focus on the "
      "axis.\n"
      "Writes NAME_focus_pull.csv, .svg and, without --fit-tilt, .json into DIR. The .json has the distances over time "
      "for 'petzval blur LENS --focus FILE' and 'petzval render LENS --focus FILE'.",
      "petzval pull");
  examples::add_movement_options(app, options);
  app.add_option("--keys", options.keys_file, "JSON file of points and keys (petzval help files: format)")
      ->type_name("FILE")
      ->required();
  examples::add_out_folder(app, options.out_folder, "folder for the table and the plot")->required();
  examples::add_distance_origin(app, options.focus.origin);
  const auto* criterion = examples::add_criterion(app, options.focus.criterion, {"min_rms", "min_max"});
  examples::add_number(app, "--fps", options.frames_per_s, examples::positive_number, "frames per second");
  app.add_flag("--fit-tilt", options.tilt, "also tilt and swing the film");
  app.add_flag("--json", options.json, "print one JSON object instead of text");

  return examples::run(app, argc, argv, [&] {
    if (criterion->given() && options.model_name() != "real") {
      throw petzval::Error("--criterion with --model " + options.model_name() +
                           "; must be --model real, because other models have only one focus");
    }
    if (criterion->given() && options.tilt) {
      throw petzval::Error("--criterion cannot be combined with --fit-tilt: tilted films always minimize the RMS blur");
    }
    const examples::MovingLens lens = examples::moving_lens(options);
    const auto points = examples::read_focus_points(options.keys_file);
    const std::vector<Frame> all = frames(options, lens, points);
    const std::string svg = plot(options, lens, points, all);
    const std::filesystem::path folder = options.out_folder;
    examples::make_folder(folder);
    const std::string csv_file = (folder / (lens.id + "_focus_pull.csv")).string(),
                      svg_file = (folder / (lens.id + "_focus_pull.svg")).string(),
                      keys_file = (folder / (lens.id + "_focus_pull.json")).string();
    examples::write_text(csv_file, to_csv(all));
    examples::write_text(svg_file, svg);
    std::vector<std::string> files{csv_file, svg_file};
    const double at_infinity =
        lens.exact ? petzval::with_focus(*lens.lens, infinity, options.focus).film_z() : lens.ideal.rear_focal_z;
    const auto beyond = std::ranges::count_if(all, [&](const Frame& f) {
      constexpr double tolerance_mm = 1e-3;
      return std::isinf(f.distance_mm) && std::abs(f.film.z() - at_infinity) > tolerance_mm;
    });
    if (beyond > 0 && !options.tilt) {
      std::cerr << "note: " << beyond << " of " << all.size() << " frames are focused beyond infinity; in " << keys_file
                << " they are at infinity\n";
    }
    if (!options.tilt) {
      examples::write_text(keys_file, to_keys(all, std::string(petzval::name(options.focus.origin))));
      files.push_back(keys_file);
    }
    if (options.json) {
      const Json json{{"lens", lens.title},
                      {"model", options.model_name()},
                      {"distance_from", petzval::name(options.focus.origin)},
                      {"frames", to_json(all)},
                      {"files", files}};
      std::cout << json.dump(1) << '\n';
      return;
    }
    std::cout << lens.title << ", " << lens.conditions << "\n\n" << to_text(all, options.frames_per_s) << '\n';
    for (const std::string& file : files) std::cout << file << '\n';
  });
}
