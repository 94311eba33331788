// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "layers/lit_scene.hpp"
#include "petzval/blur/layers.hpp"
#include "renderer/scene_description.hpp"
#include "support/cli.hpp"

namespace lens_blur {

/// Command line of where layers come from.
struct InputFlags {
  std::string scene, image, deep, rgb, depth, depth_kind = "axial";
  std::uint32_t width = 0, height = 0;  ///< 0: 800 x 600, or the file's
};

void add_input(examples::App& app, InputFlags& flags);

/// Layers of a scene, or of files.
class LayerInput {
 public:
  /// Reads files and builds the scene. Throws petzval::Error that names the flag or the file.
  explicit LayerInput(const InputFlags& flags);

  /// Of the picture.
  int columns() const noexcept { return columns_; }
  int rows() const noexcept { return rows_; }
  const renderer::Pose& pose() const noexcept { return pose_; }
  /// The scene; null for files.
  LitScene* scene() const noexcept { return scene_.get(); }

  /// Depth of the nearest surface, mm. camera: as layers are seen, which turns distances into depths.
  double nearest_mm(const petzval::LayerCamera& camera, int threads);
  /// What a plan asks for; files have what they have.
  void fill(const petzval::PeelPlan& plan, int layers, int threads, petzval::LayerSet& set);

 private:
  void read_picture(const std::string& rgb, const std::string& depth);
  void read_layers(const std::string& file);

  InputFlags flags_;
  int columns_ = 800, rows_ = 600;
  renderer::Pose pose_;
  std::unique_ptr<LitScene> scene_;
  petzval::FragmentLists lists_;  ///< of files
  bool depths_are_axial_ = true;
};

}  // namespace lens_blur
