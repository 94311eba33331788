// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "layers/lit_scene.hpp"
#include "petzval/blur/layers.hpp"
#include "renderer/scene_description.hpp"
#include "support/cli.hpp"

namespace lens_blur {

/// Command line of the source of layers.
struct InputFlags {
  std::string scene, image, deep, depth, depth_kind = "axial";
  std::string part, holdout, holdout_part;  ///< parts of deep files; empty: the first
  std::string depth_unit;                   ///< empty: mm, not given
  double near_mm = 0, far_mm = 0;           ///< depths of the ends of the values of --depth; 0: values are lengths
  std::string white;                        ///< "near" or "far"; empty: far, or near for inverse depths
  std::uint32_t width = 0, height = 0;      ///< 0: 800 x 600, or the size of the file
};

/// Adds the options of the source, --fov and --layers.
void add_input(examples::App& app, InputFlags& flags, double& fov_deg, std::uint32_t& layers);

/// Source of layers: a scene or files.
class LayerInput {
 public:
  /// Reads files or builds the scene. @throws petzval::Error that names the flag or the file
  explicit LayerInput(const InputFlags& flags);

  /// Size of the picture.
  int columns() const noexcept { return columns_; }
  int rows() const noexcept { return rows_; }
  const renderer::Pose& pose() const noexcept { return pose_; }
  /// The scene; null if the layers come from files.
  LitScene* scene() const noexcept { return scene_.get(); }
  /// The file of the depths, or the scene, for messages.
  std::string file() const;
  /// True if the layers come from a deep picture, which may be transparent.
  bool deep() const noexcept { return !flags_.deep.empty(); }
  /// The samples of a deep picture that its holdout leaves, with the depths of nearest_mm().
  petzval::FragmentLists held_out() const { return petzval::hold_out(lists_, holdout_); }

  /// Axial depth of the nearest surface in a pixel of a file (mm); infinity: the sky; 0: no surface. nearest_mm() must
  /// have been called.
  float depth_mm(int column, int row) const;
  /// Depth of the nearest surface, mm. Converts distances to depths. camera: the camera of the layers.
  double nearest_mm(const petzval::LayerCamera& camera, int threads);
  /// @throws petzval::Error  that asks for the unit, if depths of files are below the focal length of the lens and have
  ///         no --depth-unit; `failed`: also if they have one, because the blur failed
  void refuse_near(double nearest_mm, double focal_length_mm, bool failed = false) const;
  /// Divides each pixel of files into side x side equal pixels. nearest_mm() must not have been called.
  void refine(int side);
  /// Fills the layers of a plan. Files have a fixed set of layers, whatever the plan.
  /// @throws petzval::Cancelled if `stop` requests a stop before the last layer
  void fill(const petzval::PeelPlan& plan, int layers, int threads, petzval::LayerSet& set,
            const std::stop_token& stop = {});

 private:
  void read_picture();

  InputFlags flags_;
  int columns_ = 800, rows_ = 600;
  renderer::Pose pose_;
  std::unique_ptr<LitScene> scene_;
  petzval::FragmentLists lists_, holdout_;  ///< contents of files
  bool depths_are_axial_ = true;
};

}  // namespace lens_blur
