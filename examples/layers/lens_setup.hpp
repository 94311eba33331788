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
  double thin_lens_mm = 0;  ///< focal length; 0: no thin lens
  examples::LensInput lens_file;
  std::string singlet;
  double focus_mm = 0, fov_deg = 0;
  examples::FocusFlags focus;
  double tilt_deg = 0, swing_deg = 0;
  std::uint32_t rays = 0;  ///< 0: 256, or 512 for traced surfaces with jitter
  /// Numbers of rays that are compared with each other; `rays` is the last. Empty if --rays is not given.
  std::vector<std::uint32_t> ray_counts;
  std::uint32_t supersample = 1;  ///< 1, 2 or 4 subpixels per pixel in each direction
  std::string wavelengths = "d";
  bool jitter = false;
  examples::IrisSetup iris;
  examples::BokehFlags bokeh;
  examples::FocalSurfaceSetup surface;
  examples::ExpressiveFlags expressive;

  /// Diameter of the thin lens.
  double diameter_mm() const noexcept { return thin_lens_mm / iris.f_number; }
  /// True if the colours have rays of their own.
  bool coloured() const noexcept { return wavelengths == "rgb"; }
};

void add_lens(examples::App& app, LensFlags& flags);

/// The lens given on the command line, set up for one image size.
class BlurLens {
 public:
  /// keyed: true if focus points have keys over time. @throws petzval::Error that names the flag
  BlurLens(const LensFlags& flags, int columns, int rows, const renderer::Pose& pose, bool keyed);

  const petzval::LayerCamera& layers() const noexcept { return layers_; }
  const std::string& name() const noexcept { return name_; }
  /// Changes the number of rays per pixel.
  void set_rays(std::uint32_t rays) noexcept { flags_.rays = rays; }
  std::uint32_t ray_count() const noexcept { return flags_.rays; }
  /// The rays of the lens at a time (s). nearest_mm: depth of the nearest surface.
  petzval::LensRays rays(double nearest_mm, int threads, double time = 0);

 private:
  void load();
  double fov_deg() const;
  /// supersample: film pixels per picture pixel in each direction.
  petzval::Camera camera(const std::optional<petzval::FocalSurface>& surface, std::uint32_t supersample) const;
  std::optional<petzval::FocalSurface> surface_at(double time);

  LensFlags flags_;
  int columns_, rows_;
  renderer::Pose pose_;
  bool keyed_, thin_ = false;
  std::string name_;
  double focus_depth_mm_ = 0;  ///< distance of the subject in focus from the entrance pupil, mm
  /// For a thin lens: a thin singlet with the same first-order model.
  std::optional<petzval::Lens> lens_;
  petzval::Film film_;
  petzval::Film shown_;  ///< film_ with the pixels of the picture, the unit of focus points
  petzval::BokehControls controls_;
  petzval::LayerCamera layers_;
  std::vector<petzval::FocusPoint> points_;
  std::optional<petzval::FocalSurface> surface_;
};

}  // namespace lens_blur
