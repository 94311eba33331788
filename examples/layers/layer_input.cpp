// SPDX-License-Identifier: Apache-2.0
#include "layers/layer_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

#include "layers/blur_scenes.hpp"
#include "layers/jpeg.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/error.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"
#include "support/camera_setup.hpp"
#include "support/text.hpp"

namespace lens_blur {
namespace {

using petzval::Error;
using petzval::FragmentLists;

const std::vector<float>* channel(const petzval::ExrPart& part, const std::string& name) {
  const auto found = part.channels.find(name);
  return found == part.channels.end() ? nullptr : &found->second;
}

const std::vector<float>& required_channel(const petzval::ExrPart& part, const std::string& name,
                                           const std::string& file) {
  if (const auto* const values = channel(part, name)) return *values;
  if (name == "Z") throw Error(file + ": has no channel Z; must have depths, unless --depth gives them");
  throw Error(file + ": has no channel " + name + "; must have R, G, B and optionally A and Z");
}

/// The ending of a file name in small letters, with its dot.
std::string ending(const std::string& file) {
  std::string text = std::filesystem::path(file).extension().string();
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// Reads the parts of an EXR file, or a picture of another format as one part with channels R, G and B.
std::vector<petzval::ExrPart> read_parts(const std::string& file) {
  const std::string kind = ending(file);
  if (kind == ".exr") return petzval::read_exr_parts(file, petzval::ExrWindow::display);
  const petzval::RgbImage image = [&] {
    if (kind == ".png") return petzval::read_png(file);
    if (kind == ".pfm") return petzval::read_pfm(file);
    if (kind == ".jpg" || kind == ".jpeg") return read_jpeg(file);
    throw Error("--image = " + file + "; must end in .exr, .jpg, .jpeg, .pfm or .png");
  }();
  petzval::ExrPart part{.width = image.width, .height = image.height};
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float>& values = part.channels[std::string(1, "RGB"[c])];
    for (std::size_t i = c; i < image.pixels.size(); i += 3) values.push_back(image.pixels[i]);
  }
  return {part};
}

/// Reads a file with one value for each pixel into a channel Z: channel Z or the only channel of an EXR, a PFM, or a
/// grey PNG with values from 0 to 1.
petzval::ExrPart read_values(const std::string& file) {
  const std::string kind = ending(file);
  if (kind == ".exr") {
    petzval::ExrPart part = petzval::read_exr_parts(file, petzval::ExrWindow::display).front();
    const bool single = part.channels.size() == 1;
    part.channels = {{"Z", single ? part.channels.begin()->second : required_channel(part, "Z", file)}};
    return part;
  }
  if (kind != ".pfm" && kind != ".png") throw Error("--depth = " + file + "; must end in .exr, .pfm or .png");
  const petzval::RgbImage image = kind == ".pfm" ? petzval::read_pfm(file) : petzval::read_png(file);
  petzval::ExrPart part{.width = image.width, .height = image.height};
  std::vector<float>& depths = part.channels["Z"];
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    const float* const p = &image.pixels[i];
    if (std::memcmp(p, p + 1, 2 * sizeof(float)) != 0) throw Error(file + ": has colours; must be grey");
    depths.push_back(*p);
  }
  // Depths are not colours: without sRGB.
  if (kind == ".png") depths = petzval::read_iris_map(file).values;
  return part;
}

void note_ignored(std::size_t samples, const char* which, const std::string& file) {
  if (samples > 0) examples::note(file + ": " + std::to_string(samples) + " samples " + which + " are ignored");
}

FragmentLists read_deep(const std::string& file, const std::string& part) {
  petzval::DeepPicture deep = petzval::read_deep_exr(file, 1, part);
  note_ignored(deep.without_depth, "without a depth", file);
  note_ignored(deep.outside, "outside the display window", file);
  return std::move(deep.lists);
}

/// Reads --depth: mm, along the axis or along rays.
petzval::ExrPart read_depths(const InputFlags& flags) {
  const bool inverse = flags.depth_kind == "inverse", scaled = flags.near_mm > 0;
  if (!scaled && ending(flags.depth) == ".png") {
    throw Error("--depth = " + flags.depth + ": a PNG has no lengths; must be given with --near and --far");
  }
  if (scaled && !(flags.near_mm < flags.far_mm)) {
    throw Error("--near = " + examples::number(flags.near_mm) + "; must be less than --far, " +
                examples::number(flags.far_mm));
  }
  if (scaled && !inverse && std::isinf(flags.far_mm)) {
    throw Error("--far = inf; must be finite unless --depth-kind is inverse");
  }
  petzval::ExrPart part = read_values(flags.depth);
  const bool white_is_near = flags.white.empty() ? inverse : flags.white == "near";
  const auto end = [&](bool near) {
    const double mm = near ? flags.near_mm : flags.far_mm;
    return inverse ? 1 / mm : mm;
  };
  const double black = end(!white_is_near), white = end(white_is_near);
  for (float& value : part.channels.at("Z")) {
    double result = static_cast<double>(value);
    if (scaled) {
      if (!(result >= 0 && result <= 1)) {
        throw Error(flags.depth + ": value = " + examples::number(result) + "; must be 0 to 1 with --near and --far");
      }
      result = (1 - result) * black + result * white;
    }
    // An inverse depth of 0 is infinity.
    value = static_cast<float>(inverse && result >= 0 ? 1 / result : result);
  }
  return part;
}

}  // namespace

void add_input(examples::App& app, InputFlags& flags, double& fov_deg, std::uint32_t& layers) {
  app.add_option("--scene", flags.scene, "built-in scene to blur")
      ->one_of({"town", "miniature", "lights", "statues", "knot", "leaves", "street"});
  auto* image =
      app.add_option("--image", flags.image,
                     "picture: PNG or JPEG (sRGB), PFM or EXR (linear). An EXR may have depths (Z) and alpha (A); "
                     "several parts are layers from near to far")
          ->type_name("PICTURE");
  auto* deep = app.add_option("--deep", flags.deep, "deep picture")->type_name("DEEP.exr");
  auto* holdout = app.add_option("--holdout", flags.holdout,
                                 "deep picture of the same size that hides --deep where it is in front, and stays "
                                 "invisible: with --highlights-above 0, the two pictures with --deep and --holdout "
                                 "exchanged add up to the whole")
                      ->type_name("DEEP.exr")
                      ->needs(deep);
  const auto want_text = [&](const char* flag, const std::string& text, auto* option) {
    app.add_check([=, &text] {
      if (option->given() && text.empty()) throw Error(std::string(flag) + " = \"\"; must not be empty");
    });
  };
  want_text("--holdout", flags.holdout, holdout);
  const auto add_part = [&](const char* flag, std::string& part, auto* of) {
    auto* option = app.add_option(flag, part, "name of the part of the deep file")
                       ->type_name("NAME")
                       ->default_str("the first deep part")
                       ->needs(of);
    want_text(flag, part, option);
  };
  add_part("--part", flags.part, deep), add_part("--holdout-part", flags.holdout_part, holdout);
  auto* depth = app.add_option("--depth", flags.depth,
                               "depths of --image: EXR, PFM with one channel (Pf) and rows from the bottom, or grey "
                               "PNG with 8 or 16 bits, which needs --near and --far")
                    ->type_name("DEPTHS")
                    ->needs(image);
  app.add_option(
         "--depth-kind", flags.depth_kind,
         "values of files: depths along the axis (axial), distances along rays (distance), or 1/depth along the "
         "axis (inverse), as in disparity maps of phones and neural networks")
      ->one_of({"axial", "distance", "inverse"})
      ->capture_default_str();
  app.add_option("--depth-unit", flags.depth_unit, "unit of the depths of files; inverse depths are 1/unit")
      ->one_of({"m", "cm", "mm", "in"})
      ->default_str("mm");
  auto* near = add_length(app, "--near", flags.near_mm, examples::positive_number,
                          "depth at the near end of the values of --depth, which go from 0 (black) to 1 (white)")
                   ->default_str("values are not scaled")
                   ->needs(depth);
  auto* far = add_length(app, "--far", flags.far_mm, examples::positive_length, "depth at the far end of the values")
                  ->default_str("")
                  ->needs(near);
  near->needs(far);
  app.add_option("--white", flags.white, "end of the depths that is white")
      ->one_of({"near", "far"})
      ->default_str("far; near for --depth-kind inverse")
      ->needs(near);
  examples::add_picture_size(app, flags.width, flags.height, 800);
  add_number(
      app, "--fov", fov_deg, {1e-3, 120, "more than 0 and at most 120"},
      "vertical angle of the picture (degrees); default: 30 for a thin lens, else the angle of a film 24 mm high")
      ->default_str("");
  add_count(app, "--layers", layers, {1, 64, "a whole number from 1 to 64"},
            "largest number of surfaces behind each other");
}

LayerInput::LayerInput(const InputFlags& flags) : flags_(flags), depths_are_axial_(flags.depth_kind != "distance") {
  const int given = !flags.scene.empty() + !flags.image.empty() + !flags.deep.empty();
  if (given != 1) {
    throw Error("layers: " + std::to_string(given) + " of --scene, --image and --deep are given; must be 1");
  }
  if (flags.deep.empty() && !(flags.part.empty() && flags.holdout.empty())) {
    throw Error("layers: part and holdout are given without deep; must be left out");
  }
  if (flags.holdout.empty() && !flags.holdout_part.empty()) {
    throw Error("layers: holdout_part is given without holdout; must be left out");
  }
  if (flags.depth_kind == "inverse" && flags.depth.empty())
    throw Error("--depth-kind = inverse: must be used with --depth");
  if (!flags.depth_unit.empty() && flags.near_mm > 0) {
    throw Error("--depth-unit must not be used with --near and --far, which have their own units");
  }
  if (!flags.scene.empty()) {
    if (!depths_are_axial_) {
      throw Error("--depth-kind = " + flags.depth_kind + ": must not be used with --scene, whose depths are axial");
    }
    if (!flags.depth_unit.empty()) throw Error("--depth-unit must not be used with --scene");
    const auto description = blur_scene(flags.scene);
    if (!description) throw Error("--scene = " + flags.scene + "; must be " + std::string(blur_scene_names));
    pose_ = description->pose;
    scene_ = std::make_unique<LitScene>(*description);
    columns_ = flags.width > 0 ? static_cast<int>(flags.width) : 800;
    rows_ = flags.height > 0 ? static_cast<int>(flags.height) : columns_ * 3 / 4;
    return;
  }
  if (flags.width > 0 || flags.height > 0) throw Error("--size must not be used with files, which have their own size");
  if (!flags.deep.empty()) {
    lists_ = read_deep(flags.deep, flags.part);
    if (!flags.holdout.empty()) holdout_ = read_deep(flags.holdout, flags.holdout_part);
    if (!flags.holdout.empty() && (holdout_.columns != lists_.columns || holdout_.rows != lists_.rows)) {
      throw Error(flags.holdout + ": size = " + std::to_string(holdout_.columns) + " x " +
                  std::to_string(holdout_.rows) + "; must be the size of " + flags.deep + ", " +
                  std::to_string(lists_.columns) + " x " + std::to_string(lists_.rows));
    }
  } else {
    read_picture();
  }
  columns_ = lists_.columns, rows_ = lists_.rows;
  petzval::check_fragments(lists_, flags.deep.empty() ? flags.image : flags.deep);
  if (!flags.holdout.empty()) petzval::check_fragments(holdout_, flags.holdout, false);
  if (flags.depth_unit.empty()) return;
  const auto unit =
      static_cast<float>(examples::parse_length("--depth-unit", "1" + flags.depth_unit, examples::positive_number));
  for (FragmentLists* const lists : {&lists_, &holdout_}) {
    for (FragmentLists::Fragment& f : lists->fragments) f.depth_mm *= unit, f.back_mm *= unit;
  }
}

std::string LayerInput::file() const {
  return scene_                  ? "--scene = " + flags_.scene
         : !flags_.depth.empty() ? flags_.depth
         : !flags_.deep.empty()  ? flags_.deep
                                 : flags_.image;
}

void LayerInput::refuse_near(double nearest_mm, double focal_length_mm, bool failed) const {
  const bool unit_given = !flags_.depth_unit.empty() || flags_.near_mm > 0;
  if (scene_ || (unit_given && !failed) || nearest_mm >= std::abs(focal_length_mm)) return;
  // Names the file of the holdout if its depths are nearer.
  float nearest = std::numeric_limits<float>::infinity();
  for (const FragmentLists::Fragment& f : lists_.fragments) nearest = std::min(nearest, f.depth_mm);
  const bool by_holdout = !flags_.holdout.empty() && static_cast<double>(nearest) > nearest_mm;
  throw Error((by_holdout ? flags_.holdout : file()) + ": nearest depth = " + examples::number(nearest_mm, 3) +
              " mm; must be " + (unit_given ? "" : "at least ") + "the focal length of the lens, " +
              examples::number(focal_length_mm, 3) +
              (unit_given ? " mm, or more: the blur of nearer surfaces is too wide to compute"
                          : " mm: are the depths in metres? --depth-unit m (mm: keep them as they are)"));
}

void LayerInput::refine(int side) {
  if (side == 1) return;
  for (FragmentLists* const lists : {&lists_, &holdout_}) {
    FragmentLists fine{.columns = side * lists->columns, .rows = side * lists->rows, .offsets = {0}, .fragments = {}};
    for (int row = 0; row < fine.rows; ++row) {
      for (int column = 0; column < fine.columns; ++column) {
        const auto pixel = static_cast<std::size_t>(row / side * lists->columns + column / side);
        const auto at = [&](std::size_t i) {
          return lists->fragments.begin() + static_cast<std::ptrdiff_t>(lists->offsets[i]);
        };
        fine.fragments.insert(fine.fragments.end(), at(pixel), at(pixel + 1));
        fine.offsets.push_back(fine.fragments.size());
      }
    }
    *lists = std::move(fine);
  }
}

void LayerInput::read_picture() {
  const std::string& file = flags_.image;
  std::vector<petzval::ExrPart> parts = read_parts(file);
  if (!flags_.depth.empty()) {
    if (parts.size() > 1) {
      throw Error(file + ": parts = " + std::to_string(parts.size()) + "; must be 1 with --depth");
    }
    petzval::ExrPart depths = read_depths(flags_);
    if (depths.width != parts[0].width || depths.height != parts[0].height) {
      throw Error(flags_.depth + ": size = " + std::to_string(depths.width) + " x " + std::to_string(depths.height) +
                  "; must be the size of " + file + ", " + std::to_string(parts[0].width) + " x " +
                  std::to_string(parts[0].height));
    }
    parts[0].channels["Z"] = std::move(depths.channels.at("Z"));
  }
  lists_ = {.columns = parts[0].width, .rows = parts[0].height, .offsets = {0}, .fragments = {}};
  struct Planes {
    const std::vector<float>*r, *g, *b, *z, *a;
  };
  std::vector<Planes> planes;
  for (const petzval::ExrPart& part : parts) {
    if (part.width != lists_.columns || part.height != lists_.rows) {
      throw Error(file + ": part " + part.name + ": size = " + std::to_string(part.width) + " x " +
                  std::to_string(part.height) + "; must be the size of the first part, " +
                  std::to_string(lists_.columns) + " x " + std::to_string(lists_.rows));
    }
    planes.push_back({&required_channel(part, "R", file), &required_channel(part, "G", file),
                      &required_channel(part, "B", file), &required_channel(part, "Z", file), channel(part, "A")});
  }
  std::size_t without = 0;
  for (std::size_t i = 0; i < planes[0].r->size(); ++i) {
    for (const auto& [r, g, b, z, a] : planes) {
      if (!((*z)[i] > 0)) {
        without += (*r)[i] != 0 || (*g)[i] != 0 || (*b)[i] != 0;
        continue;
      }
      const float values[] = {(*r)[i], (*g)[i], (*b)[i], a ? (*a)[i] : 1.0f};
      FragmentLists::Fragment* const front =
          lists_.fragments.size() > lists_.offsets.back() ? &lists_.fragments.back() : nullptr;
      if (!front || front->depth_mm != (*z)[i]) {
        lists_.fragments.push_back({(*z)[i], values[0], values[1], values[2], values[3]});
        continue;
      }
      // Parts come from near to far, also at equal depths.
      const float through = 1 - front->alpha;
      front->red += through * values[0], front->green += through * values[1], front->blue += through * values[2];
      front->alpha += through * values[3];
    }
    lists_.offsets.push_back(lists_.fragments.size());
  }
  note_ignored(without, "without a depth above 0", file);
}

float LayerInput::depth_mm(int column, int row) const {
  const auto pixel =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  float nearest = 0;
  for (std::size_t i = lists_.offsets[pixel]; i < lists_.offsets[pixel + 1]; ++i) {
    const float depth = lists_.fragments[i].depth_mm;
    if (depth > 0 && (nearest == 0 || depth < nearest)) nearest = depth;
  }
  return nearest;
}

double LayerInput::nearest_mm(const petzval::LayerCamera& camera, int threads) {
  if (scene_) return scene_->nearest_mm(camera, threads);
  const bool convert = !std::exchange(depths_are_axial_, true);
  float nearest = std::numeric_limits<float>::infinity();
  for (FragmentLists* const lists : {&lists_, &holdout_}) {
    if (convert && lists->columns > 0) petzval::axial_depths(camera, *lists);
    for (const FragmentLists::Fragment& f : lists->fragments) nearest = std::min(nearest, f.depth_mm);
  }
  return static_cast<double>(nearest);
}

void LayerInput::fill(const petzval::PeelPlan& plan, int layers, int threads, petzval::LayerSet& set,
                      const std::stop_token& stop) {
  if (scene_) {
    set.peel(plan, layers,
             [&, peel = scene_->peel(plan.camera, threads, plan.bias)](int layer, std::span<const float> below,
                                                                       const petzval::LayerPlanes& out) {
               if (stop.stop_requested()) throw petzval::Cancelled("layers");
               return peel(layer, below, out);
             });
  } else {
    set.peel_fragments(lists_, plan.bias, layers, holdout_);
  }
}

}  // namespace lens_blur
