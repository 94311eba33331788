// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>

#include "layers/layer_picture.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/camera/bokeh.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/image/image.hpp"
#include "petzval/io/json.hpp"
#include "petzval/lens/lens.hpp"

namespace lens_blur {

/// Number and arrangement of the rays of a pixel.
struct RayPattern {
  std::uint32_t rays = 256;       ///< per pixel of the picture
  std::uint32_t supersample = 1;  ///< 1, 2 or 4 subpixels in each direction, which share the rays
  bool jitter = false;            ///< 16 sets of rays, alternating over the pixels
  bool over_pixels = false;       ///< as LensRaysOptions; for layers with one sample per pixel, such as files
};

/// A lens in front of layers: the rays of `petzval blur` and `petzval view`.
struct LensView {
  petzval::Lens lens;  ///< focused; for a thin lens thin_elements(). Colours: red, green, blue after the primary
  petzval::CameraSetup setup = {};  ///< with the size and the pixels of the film; camera.model is not used
  double vertical_angle_rad = 0;    ///< vertical angle of the picture, for a thin lens
  double focus_depth_mm = 0;        ///< distance in focus on the axis from the entrance pupil
  bool coloured = false;            ///< rays of their own for red, green and blue
  std::optional<petzval::FocalSurface> surface = {};
  bool first_order_only = false;  ///< a preview of a real lens
  /// Returns the camera of this lens, film and options; empty: camera() makes the camera.
  std::function<const petzval::Camera&()> made = {};

  bool thin() const noexcept { return setup.lens.thin_mm > 0; }
  double thin_radius_mm() const { return setup.lens.thin_mm / *setup.f_number / 2; }
  petzval::ModelKind model() const noexcept;
  petzval::Camera camera() const;
  /// The camera of the layers, without overscan.
  petzval::LayerCamera layers(std::uint32_t supersample) const;
  /// The rays of the lens through the layers. nearest_mm: depth of the nearest surface.
  /// @throws petzval::Cancelled if `stop` requests a stop
  petzval::LensRays rays(const petzval::LayerCamera& layers, const RayPattern& pattern, double nearest_mm, int threads,
                         const std::stop_token& stop = {}) const;
  /// The ghosts of bright parts of a picture of `layers`, in its unit, by the surfaces of the lens. Not of a thin lens.
  petzval::RgbImage ghosts(std::span<const BrightPart> parts, const petzval::LayerCamera& layers,
                           const petzval::GhostOptions& options) const;

 private:
  /// Inverse distance in focus of a thin lens without a focal surface at raster positions, 1/mm. It is linear over the
  /// picture; the picture of a tilted film keeps its frame.
  std::function<double(const petzval::Vec2<double>&)> thin_focus(const petzval::LayerCamera& layers) const;
  petzval::Camera sharp_at_focus(const petzval::LayerCamera& layers) const;
};

}  // namespace lens_blur
