// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "petzval/blur/lens_rays.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus_point.hpp"
#include "renderer/scene_description.hpp"
#include "support/bokeh_flags.hpp"
#include "support/cli.hpp"
#include "support/expressive_flags.hpp"
#include "support/focal_surface_setup.hpp"
#include "support/iris_setup.hpp"
#include "support/load_lens.hpp"

namespace lens_blur {

/// Command line of a lens that blurs layers.
struct LensFlags {
  double thin_lens_mm = 0, lens_diameter_mm = 0;
  examples::LensInput lens_file;
  std::string singlet;
  double focus_mm = 0, fov_deg = 0;
  examples::FocusFlags focus;
  double tilt_deg = 0, swing_deg = 0;
  std::uint32_t rays = 0;         ///< 0: 256 of a thin lens; 512 with jitter through surfaces
  std::uint32_t supersample = 1;  ///< 1, 2 or 4: columns and rows per column and row of the result
  bool chroma = false, jitter = false;
  examples::IrisSetup iris;
  examples::BokehFlags bokeh;
  examples::FocalSurfaceSetup surface;
  examples::ExpressiveFlags expressive;
};

void add_lens(examples::App& app, LensFlags& flags);

/// The lens of a command line before a picture of some size.
class BlurLens {
 public:
  /// keyed: whether the points of the focal surface have keys over time. Throws petzval::Error that names the flag.
  BlurLens(const LensFlags& flags, int columns, int rows, const renderer::Pose& pose, bool keyed);

  const petzval::LayerCamera& layers() const noexcept { return layers_; }
  const std::string& name() const noexcept { return name_; }
  /// The rays at a moment, s. nearest_mm: depth of the nearest surface.
  petzval::LensRays rays(double nearest_mm, int threads, double time = 0);

 private:
  void load();
  double fov_deg() const;
  /// supersample: pixels of the film for each one of the picture, in each direction.
  petzval::Camera camera(const std::optional<petzval::FocalSurface>& surface, std::uint32_t supersample) const;
  std::optional<petzval::FocalSurface> surface_at(double time);

  LensFlags flags_;
  int columns_, rows_;
  renderer::Pose pose_;
  bool keyed_, thin_ = false;
  std::string name_;
  double focus_depth_mm_ = 0;  ///< distance of the subject in focus from the entrance pupil
  /// Of thin lenses as well: a thin singlet, whose first-order model it is.
  std::optional<petzval::Lens> lens_;
  petzval::Film film_;
  petzval::Film shown_;  ///< with the pixels of the picture, in which focus points count
  petzval::BokehControls controls_;
  petzval::LayerCamera layers_;
  std::vector<petzval::FocusPoint> points_;
  std::optional<petzval::FocalSurface> surface_;
};

}  // namespace lens_blur
