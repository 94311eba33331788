// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "layers/lens_view.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/focus/autofocus.hpp"
#include "renderer/scene_description.hpp"
#include "support/bokeh_flags.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/focus_points.hpp"
#include "support/focus_pull.hpp"
#include "support/load_lens.hpp"

namespace lens_blur {

/// Command line of a lens that blurs layers.
struct LensFlags {
  examples::CameraFlags setup;
  std::string singlet;
  double fov_deg = 0;
  RayPattern pattern{.rays = 0};  ///< 0 rays: 256, or 512 for traced surfaces with jitter
  /// Numbers of rays that are compared with each other; the pattern has the last. Empty if --rays is not given.
  std::vector<std::uint32_t> ray_counts;
  std::string wavelengths;  ///< "d" or "rgb"; empty: as in --setup, else "d"

  bool thin() const noexcept { return setup.lens.thin_mm > 0; }
  /// True if the colours have rays of their own.
  bool coloured() const noexcept {
    return wavelengths.empty() ? setup.lens.wavelengths_nm.size() > 2 : wavelengths == "rgb";
  }
};

/// Values of --ghosts.
inline constexpr examples::Range ghost_counts{0, 576, "a whole number from 0 to 576"};

/// Adds --ghosts: the number of bright parts of the picture whose ghosts are added.
void add_ghosts(examples::App& app, std::uint32_t& ghosts, const std::string& more);

/// Adds --setup and the flags of the lens.
/// @param frames_help  names of the results of --frames
void add_lens(examples::App& app, LensFlags& flags, const std::string& frames_help);

/// The lens given on the command line, set up for one image size.
class BlurLens {
 public:
  /// @param columns, rows  pixels of the picture, without subpixels
  /// @param keyed          true: focus points have keys over time
  /// @throws petzval::Error that names the flag
  BlurLens(const LensFlags& flags, int columns, int rows, const renderer::Pose& pose, bool keyed);

  const petzval::LayerCamera& layers() const noexcept { return layers_; }
  const std::string& name() const noexcept { return view_.lens.name(); }
  petzval::ModelKind model() const noexcept { return view_.model(); }
  double focal_length_mm() const;
  /// The set-up of the picture, for reports.
  petzval::CameraSetup setup() const;
  /// Focuses at another distance. keep_film: the film keeps its size, otherwise the picture keeps its angle (--fov).
  void focus_at(double focus_mm, bool keep_film);
  /// Changes the number of rays per pixel.
  void set_rays(std::uint32_t rays) noexcept { flags_.pattern.rays = rays; }
  std::uint32_t ray_count() const noexcept { return flags_.pattern.rays; }
  /// The rays of the lens at a time (s). nearest_mm: depth of the nearest surface. travelled_mm: distance that the
  /// camera has moved to the right; focus points over time stay in the world.
  petzval::LensRays rays(double nearest_mm, int threads, double time = 0, double travelled_mm = 0);

  /// LensView::ghosts() of a picture.
  petzval::RgbImage ghosts(std::span<const BrightPart> parts, int threads) const {
    return view_.ghosts(parts, layers_, {.threads = threads});
  }

 private:
  examples::WorldToLens world_to_lens(const petzval::Camera& camera) const;
  std::optional<petzval::FocalSurface> surface_at(double time, double travelled_mm);

  LensFlags flags_;
  renderer::Pose pose_;
  bool keyed_;
  petzval::Lens unfocused_;
  LensView view_;
  petzval::LayerCamera layers_;
  std::vector<petzval::FocusPoint> points_;
};

}  // namespace lens_blur
