// SPDX-License-Identifier: Apache-2.0
#include "viewer/session.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

#include <glm/geometric.hpp>

#include "layers/layer_picture.hpp"
#include "layers/lens_setup.hpp"
#include "layers/lit_scene.hpp"
#include "petzval/analysis/colour.hpp"
#include "petzval/core/error.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "support/json_input.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace viewer {
namespace {

using examples::Json;
using petzval::Error;
using petzval::Vec3;

/// Part of the radius by which a pupil may grow off the axis.
constexpr double pupil_growth = 1.15;
/// Part of the picture by which layers extend further for the breathing and the distortion of a real lens.
constexpr double breathing = 0.05;

std::string exact(double value) { return std::isinf(value) ? "inf" : Json(value).dump(); }

/// Quotes a word of a command line if it has characters that are special in a shell.
std::string quoted(const std::string& word) {
  if (word.find_first_of(" \t'\"\\$`&|;<>()*?[]#~!{}") == std::string::npos) return word;
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

/// A file for a command line; "./" keeps a name from being read as a flag.
std::string as_file(const std::string& file) { return file.starts_with('-') ? "./" + file : file; }

using Input = lens_blur::InputFlags;
/// Texts of a log, with their keys.
constexpr std::pair<const char*, std::string Input::*> texts[] = {
    {"scene", &Input::scene},           {"image", &Input::image},
    {"depth", &Input::depth},           {"deep", &Input::deep},
    {"depth_kind", &Input::depth_kind}, {"depth_unit", &Input::depth_unit},
    {"white", &Input::white},           {"part", &Input::part},
    {"holdout", &Input::holdout},       {"holdout_part", &Input::holdout_part}};

/// Memory of layers, with the depths of the last layer, and of a blurred picture, MB.
double memory_of(const petzval::LayerSet& layers, const petzval::BlurredImage& picture) {
  const std::size_t numbers = picture.rgba.size() + picture.missed.size();
  return 1e-6 * static_cast<double>(layers.memory_bytes() + sizeof(float) * numbers);
}

/// The words of a status of the editor.
constexpr std::pair<std::string_view, const char*> words[] = {
    {"no_targets", "no point can be focused; the focus stays"},
    {"unreachable", "the lens cannot focus at this distance"},
    {"afocal", "the lens has no focus"},
    {"too_blurred", "the lens is never sharp at this point"},
    {"least_tilt", "smallest tilt: the points allow others"},
    {"limited", "the film cannot tilt further"},
    {"not_converged", "no tilt was found for these points"},
    {"no_depth", "no depth"},
    {"hidden", "outside the picture"},
    {"no_weight", "shown only"},
    {"not_finite", "not a place"},
    {"no_image", "the point has no image"},
    {"outlier", "left out"},
    {"no_rays", "no ray passes the lens"}};

std::string words_of(std::string_view status) {
  const auto* const found = std::ranges::find(words, status, &std::pair<std::string_view, const char*>::first);
  return found == std::end(words) ? "" : found->second;
}

}  // namespace

std::string in_words(const petzval::FocusEditorState& state) { return words_of(state.status); }
std::string in_words(const petzval::FocusMark& mark) { return words_of(mark.status); }

const std::string& lens_name(const petzval::FocusEditorState& state) {
  const std::string& file = state.setup.lens.file;
  return file.empty() ? state.lens.name() : file;
}
std::string lens_key(const petzval::FocusEditorState& state) {
  const petzval::LensSource& lens = state.setup.lens;
  return state.thin() ? "" : lens.file + '/' + lens.configuration + '/' + state.lens.name();
}

std::string no_picture(const Session& session, const Error& why) {
  const petzval::FocusEditorState& state = session.editor().state();
  const std::string reason = why.what();
  const bool too_wide = reason.find(" reach ") != std::string::npos;  // of layers or of their gathering
  return "no picture through " + lens_name(state) + ": " +
         (too_wide ? "its blur is too wide for this scene; stop down, focus elsewhere or choose another lens" : reason);
}

Session::Session(const SessionOptions& options) : options_(options), input_(options.input) {
  if (options.file_columns > 0 && (input_.columns() != options.file_columns || input_.rows() != options.file_rows)) {
    throw Error("size = " + std::to_string(options.file_columns) + " x " + std::to_string(options.file_rows) +
                "; must be the size of the files, " + std::to_string(input_.columns()) + " x " +
                std::to_string(input_.rows()));
  }
  const renderer::Pose& pose = input_.pose();
  const glm::dvec3 back = glm::normalize(pose.position - pose.look_at),
                   right = glm::normalize(glm::cross(-back, pose.up));
  const double fov_deg = options.fov_deg > 0 ? options.fov_deg : options.setup.lens.thin_mm > 0 ? 30 : 0;
  petzval::FocusScene scene{.columns = input_.columns(),
                            .rows = input_.rows(),
                            .vertical_angle_rad = petzval::radians(fov_deg),
                            .position = pose.position,
                            .right = right,
                            .up = glm::cross(back, right),
                            .back = back};
  scene.lens = [this](const petzval::CameraSetup& setup) { return load(setup); };
  scene.place = [this](const petzval::Ray<double>& ray, double) { return place(ray); };
  if (input_.scene()) {
    scene.vertex = [this](std::size_t vertex, double) { return input_.scene()->vertex(vertex); };
  }
  if (options_.setup.lens.wavelengths_nm.empty()) options_.setup.lens.wavelengths_nm = {petzval::d_line_nm};
  editor_.emplace(scene, options_.setup);
  update_camera();
  input_.refuse_near(nearest_mm_, petzval::first_order(editor_->state().lens).effective_focal_length);
}

petzval::Lens Session::load(const petzval::CameraSetup& setup) {
  const petzval::LensSource& source = setup.lens;
  if (source.file.empty()) return petzval::compile(setup);
  const std::string key = petzval::to_json({.lens = source});
  if (const auto known = lenses_.find(key); known != lenses_.end()) return known->second;
  return lenses_.emplace(key, examples::load_lens(source, source.wavelengths_nm).lens).first->second;
}

std::optional<petzval::FocusPlace> Session::place(const petzval::Ray<double>& ray) const {
  if (const lens_blur::LitScene* const scene = input_.scene()) {
    const auto hit = scene->first_hit(ray);
    if (!hit) return petzval::FocusPlace{.point = {ray.direction, true}};
    return petzval::FocusPlace{.point = {hit->position}, .triangle = hit->triangle};
  }
  // Files are in the lens frame with the pinhole in the origin.
  const petzval::Vec2<double> slope{ray.direction.x / -ray.direction.z, ray.direction.y / -ray.direction.z};
  const petzval::Vec2<double> raster = camera_.axis + petzval::Vec2<double>{slope.x, -slope.y} * camera_.focal_px;
  const float depth = depth_mm(static_cast<int>(std::floor(raster.x)), static_cast<int>(std::floor(raster.y)));
  if (!(depth > 0)) return {};
  if (std::isinf(depth)) return petzval::FocusPlace{.point = {ray.direction, true}};
  return petzval::FocusPlace{.point = {Vec3<double>(slope.x, slope.y, -1) * static_cast<double>(depth)}};
}

float Session::depth_mm(int column, int row) const {
  column = std::clamp(column, 0, camera_.columns - 1), row = std::clamp(row, 0, camera_.rows - 1);
  if (!input_.scene()) return input_.depth_mm(column, row);
  if (layers_.count() == 0) return 0;
  const int overscan = (layers_.columns() - camera_.columns) / 2;
  const float w =
      layers_.inverse_depth(0)[static_cast<std::size_t>((row + overscan) * layers_.columns() + column + overscan)];
  return w < 0 ? 0 : 1 / w;
}

lens_blur::LensView Session::view() const {
  const petzval::FocusEditorState& state = editor_->state();
  lens_blur::LensView view{.lens = state.lens,
                           .setup = state.setup,
                           .coloured = state.setup.lens.wavelengths_nm.size() == 4,
                           .surface = state.surface,
                           .made = state.camera};
  view.vertical_angle_rad = petzval::radians(options_.fov_deg > 0 ? options_.fov_deg : 30);
  view.focus_depth_mm = state.focus_mm + petzval::pupils(state.lens).entrance.z;
  return view;
}

/// Radius of the pupil of the state, with room for pupils off the axis and for negative extents.
double Session::widest_radius(const lens_blur::LensView& view) const {
  const double radius = view.thin() ? view.thin_radius_mm() : petzval::pupils(view.lens).entrance.diameter / 2;
  const double extent = view.surface ? std::exp2(std::max(0.0, -view.surface->least_extent()) / 2) : 1;
  return radius * extent * (view.thin() ? 1 : pupil_growth);
}

void Session::update_camera() {
  const std::string lens = lens_key(editor_->state());
  if (camera_.columns > 0 && camera_lens_ == lens) return;
  radius_mm_ = 0;
  camera_ = view().layers(1);
  camera_lens_ = lens;
  nearest_mm_ = input_.nearest_mm(camera_, options_.threads);
  if (!std::isfinite(nearest_mm_)) throw Error("layers: all depths are infinite; must have at least one finite depth");
}

bool Session::layers_are_too_small() const {
  return layers_.count() == 0 || camera_lens_ != lens_key(editor_->state()) ||
         widest_radius(view()) > radius_mm_ * (1 + 1e-9);
}

double Session::make_layers() {
  if (!layers_are_too_small()) return 0;
  const auto start = std::chrono::steady_clock::now();
  update_camera();
  const lens_blur::LensView lens = view();
  const double radius = widest_radius(lens);
  radius_mm_ = 0;  // without layers until they are filled
  // With focus at infinity, the rays reach farthest: R f / depth for the nearest surface.
  const petzval::ThinLens widest{.radius_mm = radius};
  const std::vector<petzval::PupilPoint> points = petzval::vogel_points(64);
  const petzval::LensRays rays = petzval::LensRays::thin(
      camera_, widest, points, {.nearest_mm = lens_blur::least_depth(nearest_mm_), .threads = options_.threads});
  petzval::PeelPlan plan = lens_blur::plan_of(input_, rays, nearest_mm_);
  if (input_.scene() && !lens.thin()) {
    plan.camera.overscan += static_cast<int>(breathing * std::max(camera_.columns, camera_.rows));
  }
  input_.fill(plan, static_cast<int>(options_.layers), options_.threads, layers_);
  threshold_ = lens_blur::threshold_of(layers_, !input_.scene());
  radius_mm_ = radius;
  return examples::ms_since(start);
}

void Session::add_ghosts(petzval::RgbImage& picture, const lens_blur::LensView& lens, const petzval::LayerSet& layers,
                         const petzval::LayerCamera& camera, double threshold, petzval::GhostModel model) const {
  if (options_.ghosts == 0 || lens.thin()) return;
  const auto parts = lens_blur::bright_parts(layers, camera, threshold, options_.ghosts);
  const petzval::RgbImage ghosts = lens.ghosts(parts, camera, {.model = model, .threads = options_.threads});
  std::ranges::transform(picture.pixels, ghosts.pixels, picture.pixels.begin(), std::plus());
}

Frame Session::frame(std::uint32_t rays, bool first_order, const std::stop_token& stop) {
  const auto start = std::chrono::steady_clock::now();
  lens_blur::LensView lens = view();
  lens.first_order_only = first_order && !lens.thin();
  if (lens.first_order_only) lens.made = {};
  const petzval::LensRays table = lens.rays(camera_, {.rays = rays, .over_pixels = !input_.scene()},
                                            lens_blur::least_depth(nearest_mm_), options_.threads, stop);
  petzval::gather(layers_, table, {.threads = options_.threads, .highlights_above = threshold_, .stop = stop},
                  blurred_);
  Frame result{.picture = lens_blur::colours_of(blurred_), .rays = rays, .first_order = lens.first_order_only};
  add_ghosts(result.picture, lens, layers_, camera_, threshold_, petzval::GhostModel::paraxial);
  result.memory_mb = memory_of(layers_, blurred_);
  result.milliseconds = examples::ms_since(start);
  return result;
}

Frame Session::still(const std::stop_token& stop) {
  const auto start = std::chrono::steady_clock::now();
  const lens_blur::LensView lens = view();
  const bool thin = lens.thin();
  const std::uint32_t side = input_.scene() ? 2 : 1;
  const lens_blur::RayPattern pattern{
      .rays = thin ? 256u : 512u, .supersample = side, .jitter = !thin, .over_pixels = !input_.scene()};
  const petzval::LayerCamera camera = lens.layers(side);
  const double nearest = input_.nearest_mm(camera, options_.threads);
  const petzval::LensRays rays = lens.rays(camera, pattern, lens_blur::least_depth(nearest), options_.threads, stop);
  const petzval::PeelPlan plan = lens_blur::plan_of(input_, rays, nearest);
  petzval::LayerSet layers;
  input_.fill(plan, static_cast<int>(options_.layers), options_.threads, layers, stop);
  const double threshold = lens_blur::threshold_of(layers, !input_.scene());
  const petzval::BlurredImage blurred =
      petzval::gather(layers, rays, {.threads = options_.threads, .highlights_above = threshold, .stop = stop});
  Frame result{.picture = lens_blur::averaged(lens_blur::colours_of(blurred), static_cast<int>(side)),
               .rays = pattern.rays,
               .memory_mb = memory_of(layers, blurred),
               .still = true};
  add_ghosts(result.picture, lens, layers, camera, threshold, petzval::GhostModel::exact);
  result.milliseconds = examples::ms_since(start);
  return result;
}

std::vector<float> Session::blur_map() const {
  const petzval::FocusEditorState& state = editor_->state();
  const double entrance_z = petzval::pupils(state.lens).entrance.z;
  std::vector<petzval::ScenePoint> points;
  points.reserve(static_cast<std::size_t>(camera_.rows) * static_cast<std::size_t>(camera_.columns));
  for (int row = 0; row < camera_.rows; ++row) {
    for (int column = 0; column < camera_.columns; ++column) {
      const double depth = static_cast<double>(depth_mm(column, row));
      const petzval::Vec2<double> run =
          (petzval::Vec2<double>{column + 0.5, row + 0.5} - camera_.axis) / camera_.focal_px;
      if (depth > 0) {
        points.push_back(std::isfinite(depth) ? petzval::ScenePoint{{run.x * depth, -run.y * depth, entrance_z - depth}}
                                              : petzval::ScenePoint{{run.x, -run.y, -1}, true});
      } else {
        points.push_back({{0, 0, std::numeric_limits<double>::quiet_NaN()}});  // no image
      }
    }
  }
  const std::vector<double> blurs = state.first_order_blurs_px(points);
  return {blurs.begin(), blurs.end()};
}

std::vector<std::optional<petzval::Vec2<double>>> Session::handles() const {
  const petzval::FocusEditorState& state = editor_->state();
  std::vector<std::optional<petzval::Vec2<double>>> result;
  const petzval::Camera& camera = state.camera();
  for (const petzval::FocusMark& mark : state.targets) {
    result.emplace_back();
    if (!mark.place_mm) continue;
    if (state.thin() || mark.at_infinity) {
      result.back() = mark.raster;
      continue;
    }
    const petzval::Projection seen = camera.project(editor_->to_lens(*mark.place_mm));
    if (seen.status != petzval::AimStatus::no_ray) result.back() = state.setup.film.raster(seen.film);
  }
  return result;
}

petzval::RgbImage Session::sharp() const { return lens_blur::sharp_of(layers_, camera_); }

Json Session::state_json(const Frame& frame) const {
  const petzval::FocusEditorState& state = editor_->state();
  Json json{{"film",
             {{"z_mm", state.setup.film.z()},
              {"tilt_deg", examples::exact_degrees(state.setup.film.tilt_rad)},
              {"swing_deg", examples::exact_degrees(state.setup.film.swing_rad)}}},
            {"lens", state.thin() ? Json{{"thin_mm", state.setup.lens.thin_mm}, {"f_number", state.f_number}}
                                  : Json(lens_name(state))},
            {"f_number", state.f_number},
            {"focus_mm", examples::finite_or_null(state.focus_mm)},
            {"serve", name(state.serve)},
            {"status", state.status},
            {"time_s", state.time_s},
            {"targets", Json::array()}};
  for (const petzval::FocusMark& mark : state.targets) {
    Json target;
    target["id"] = mark.id_is_number ? Json::parse(mark.id) : Json(mark.id);
    target["place_mm"] = mark.place_mm ? Json{mark.place_mm->x, mark.place_mm->y, mark.place_mm->z} : Json(nullptr);
    if (mark.at_infinity) target["at_infinity"] = true;
    target["status"] = mark.status;
    target["blur_px"] = mark.blur_px ? Json(*mark.blur_px) : Json(nullptr);
    target["weight"] = mark.weight;
    target["fade"] = mark.fade;
    json["targets"].push_back(std::move(target));
  }
  json["frame_ms"] = frame.milliseconds;
  json["rays"] = frame.rays;
  json["memory_mb"] = frame.memory_mb;
  return json;
}

Json Session::log() const {
  const lens_blur::InputFlags& input = options_.input;
  Json json;
  for (const auto& [key, member] : texts) {
    if (input.*member != Input().*member) json[key] = input.*member;
  }
  if (input.near_mm > 0) {
    json["near_mm"] = input.near_mm;
    json["far_mm"] = examples::finite_or_null(input.far_mm);
  }
  json["setup"] = Json::parse(petzval::to_json(options_.setup));
  json["size"] = {input_.columns(), input_.rows()};
  if (options_.fov_deg > 0) json["fov_deg"] = options_.fov_deg;
  if (options_.ghosts > 0) json["ghosts"] = options_.ghosts;
  json["events"] = Json::parse(editor_->log());
  return json;
}

std::string Session::blur_command(const std::string& setup_file) const {
  const lens_blur::InputFlags& input = options_.input;
  std::string command = "petzval blur";
  const auto add = [&](std::string flag, const std::string& value) {
    std::ranges::replace(flag, '_', '-');
    command += " --" + flag + ' ' + quoted(value);
  };
  for (const auto& [key, member] : texts) {
    if (input.*member != Input().*member) add(key, as_file(input.*member));
  }
  if (input.near_mm > 0) add("near", exact(input.near_mm)), add("far", exact(input.far_mm));
  if (options_.layers != 4) add("layers", std::to_string(options_.layers));
  if (options_.fov_deg > 0) add("fov", exact(options_.fov_deg));
  if (options_.ghosts > 0 && !view().thin()) add("ghosts", std::to_string(options_.ghosts));
  petzval::CameraSetup setup = editor_->state().setup;
  setup.focus_mm = editor_->state().focus_mm;
  examples::write_text(setup_file, petzval::to_json(setup) + '\n');
  add("setup", as_file(setup_file));
  return command + " --out out";
}

examples::Json events_of(const Json& log, const std::string& where) {
  if (log.contains("events") && log["events"].is_array()) return log["events"];
  throw Error(where + ": events is missing; must be a list");
}

SessionOptions options_of(const Json& log, const std::string& where) {
  const examples::JsonEntry entry{where, log};
  entry.keys({"scene", "image", "depth", "deep", "part", "holdout", "holdout_part", "depth_kind", "depth_unit",
              "near_mm", "far_mm", "white", "lens", "setup", "size", "fov_deg", "ghosts", "events"});
  SessionOptions options;
  for (const auto& [key, member] : texts) {
    if (!log.contains(key)) continue;
    if (!log[key].is_string()) entry.refuse(key, "a text");
    options.input.*member = log[key].get<std::string>();
  }
  if (const auto near = entry.number("near_mm", examples::positive_number)) {
    options.input.near_mm = *near;
    options.input.far_mm = std::numeric_limits<double>::infinity();
    if (log.contains("far_mm") && !log["far_mm"].is_null()) {
      options.input.far_mm = *entry.number("far_mm", examples::positive_number);
    }
  }
  Json setup = log.value("setup", Json{{"format", "petzval-camera 2"}});
  if (log.contains("lens") && log["lens"].is_object()) {
    const Json& thin = log["lens"];
    examples::JsonEntry{where + ": lens", thin}.keys({"thin_mm", "f_number"});
    setup["lens"] = {{"thin_mm", thin.value("thin_mm", Json())}};
    setup["f_number"] = thin.value("f_number", Json());
  } else if (log.contains("lens")) {
    setup["lens"] = {{"file", log["lens"]}};
  }
  try {
    options.setup = petzval::camera_setup(setup.dump(), "");
  } catch (const Error& error) {
    const std::string message = error.what();  // begins with a position in `setup`
    throw Error(where + message.substr(message.find(": ")));
  }
  if (const std::vector<double> size = entry.numbers("size", 2, "two whole numbers, [width, height]"); !size.empty()) {
    for (const double side : size) {
      if (!(side >= 1 && side <= 16384 && side == std::floor(side))) {
        entry.refuse("size", "two whole numbers from 1 to 16384");
      }
    }
    if (options.input.scene.empty()) {
      options.file_columns = static_cast<int>(size[0]), options.file_rows = static_cast<int>(size[1]);
    } else {
      options.input.width = static_cast<std::uint32_t>(size[0]);
      options.input.height = static_cast<std::uint32_t>(size[1]);
    }
  }
  options.fov_deg = entry.number("fov_deg", {1e-3, 120, "more than 0 and at most 120"}).value_or(0);
  const double ghosts = entry.number("ghosts", lens_blur::ghost_counts).value_or(0);
  if (ghosts != std::floor(ghosts)) entry.refuse("ghosts", lens_blur::ghost_counts.words);
  options.ghosts = static_cast<std::uint32_t>(ghosts);
  return options;
}

}  // namespace viewer
