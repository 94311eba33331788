// SPDX-License-Identifier: Apache-2.0
#include "layers/layer_input.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <limits>
#include <utility>
#include <vector>

#include "layers/blur_scenes.hpp"
#include "petzval/core/error.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"
#include "support/camera_setup.hpp"

namespace lens_blur {
namespace {

using petzval::Error;
using petzval::FragmentLists;

const std::vector<float>* channel(const petzval::ExrPart& part, const std::string& name) {
  const auto found =
      std::find_if(part.channels.begin(), part.channels.end(), [&](const auto& c) { return c.name == name; });
  return found == part.channels.end() ? nullptr : &found->values;
}

const std::vector<float>& required_channel(const petzval::ExrPart& part, const std::string& name,
                                           const std::string& file) {
  if (const auto* const values = channel(part, name)) return *values;
  throw Error(file + ": has no channel " + name + "; must have R, G, B, Z and optionally A");
}

bool ends_with(const std::string& name, const std::string& ending) {
  return std::filesystem::path(name).extension() == ending;
}

/// Reads a file with one depth for each pixel: channel Z or the only channel of an EXR, or a PFM.
std::vector<float> read_depths(const std::string& file, int& columns, int& rows) {
  if (ends_with(file, ".pfm")) {
    const petzval::RgbImage image = petzval::read_pfm(file);
    columns = image.width, rows = image.height;
    std::vector<float> depths;
    for (std::size_t i = 0; i < image.pixels.size(); i += 3) depths.push_back(image.pixels[i]);
    return depths;
  }
  const petzval::ExrPart part = petzval::read_exr_parts(file).front();
  columns = part.width, rows = part.height;
  return part.channels.size() == 1 ? part.channels[0].values : required_channel(part, "Z", file);
}

}  // namespace

void add_input(examples::App& app, InputFlags& flags) {
  app.add_option("--scene", flags.scene, "built-in scene to blur")
      ->one_of({"town", "statues", "knot", "leaves", "street"});
  app.add_option("--image", flags.image,
                 "picture with channels R, G, B, Z and optionally A; several parts are layers from near to far")
      ->type_name("RGBAZ.exr");
  app.add_option("--deep", flags.deep, "deep picture")->type_name("DEEP.exr");
  app.add_option("--rgb", flags.rgb, "picture: PNG (sRGB) or PFM (linear); needs --depth")->type_name("A.png");
  app.add_option("--depth", flags.depth,
                 "depths of --rgb (mm): EXR, or PFM with one channel (Pf) and rows from the bottom")
      ->type_name("D.exr");
  app.add_option("--depth-kind", flags.depth_kind,
                 "meaning of depths in files: along the axis (axial) or along rays (distance)")
      ->one_of({"axial", "distance"})
      ->capture_default_str();
  examples::add_picture_size(app, flags.width, flags.height, 800);
}

LayerInput::LayerInput(const InputFlags& flags) : flags_(flags), depths_are_axial_(flags.depth_kind == "axial") {
  const int given = !flags.scene.empty() + !flags.image.empty() + !flags.deep.empty() + !flags.rgb.empty();
  if (given != 1) {
    throw Error("layers: " + std::to_string(given) + " of --scene, --image, --deep and --rgb are given; must be 1");
  }
  if (flags.rgb.empty() != flags.depth.empty()) throw Error("--rgb and --depth must be given together");
  if (!flags.scene.empty()) {
    if (!depths_are_axial_) {
      throw Error("--depth-kind = " + flags.depth_kind + ": must not be used with --scene, whose depths are axial");
    }
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
    petzval::DeepPicture deep = petzval::read_deep_exr(flags.deep);
    if (deep.without_depth > 0) std::cerr << "note: " << deep.without_depth << " samples without a depth are ignored\n";
    if (deep.volumes > 0)
      std::cerr << "note: " << deep.volumes << " volume samples are treated as surfaces at their front\n";
    lists_ = std::move(deep.lists);
  } else if (!flags.image.empty()) {
    read_layers(flags.image);
  } else {
    read_picture(flags.rgb, flags.depth);
  }
  columns_ = lists_.columns, rows_ = lists_.rows;
}

void LayerInput::read_layers(const std::string& file) {
  const std::vector<petzval::ExrPart> parts = petzval::read_exr_parts(file);
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
  for (std::size_t i = 0; i < planes[0].r->size(); ++i) {
    for (const auto& [r, g, b, z, a] : planes) {
      if ((*z)[i] > 0) lists_.fragments.push_back({(*z)[i], (*r)[i], (*g)[i], (*b)[i], a ? (*a)[i] : 1.0f});
    }
    lists_.offsets.push_back(lists_.fragments.size());
  }
}

void LayerInput::read_picture(const std::string& rgb, const std::string& depth) {
  const petzval::RgbImage picture = ends_with(rgb, ".pfm") ? petzval::read_pfm(rgb) : petzval::read_png(rgb);
  int columns = 0, rows = 0;
  const std::vector<float> depths = read_depths(depth, columns, rows);
  if (columns != picture.width || rows != picture.height) {
    throw Error(depth + ": size = " + std::to_string(columns) + " x " + std::to_string(rows) +
                "; must be the size of " + rgb + ", " + std::to_string(picture.width) + " x " +
                std::to_string(picture.height));
  }
  lists_ = {.columns = columns, .rows = rows, .offsets = {0}, .fragments = {}};
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const float* const p = &picture.pixels[3 * i];
    if (depths[i] > 0) lists_.fragments.push_back({depths[i], p[0], p[1], p[2], 1});
    lists_.offsets.push_back(lists_.fragments.size());
  }
}

double LayerInput::nearest_mm(const petzval::LayerCamera& camera, int threads) {
  if (scene_) return scene_->nearest_mm(camera, threads);
  if (!std::exchange(depths_are_axial_, true)) petzval::axial_depths(camera, lists_);
  float nearest = std::numeric_limits<float>::infinity();
  for (const FragmentLists::Fragment& f : lists_.fragments) nearest = std::min(nearest, f.depth_mm);
  return static_cast<double>(nearest);
}

void LayerInput::fill(const petzval::PeelPlan& plan, int layers, int threads, petzval::LayerSet& set) {
  if (scene_) {
    set.peel(plan, layers, scene_->peel(plan.camera, threads));
  } else {
    set.peel_fragments(lists_, plan.bias, layers);
  }
}

}  // namespace lens_blur
