// SPDX-License-Identifier: Apache-2.0
/// \file
/// A lens blur as the actions of an OpenFX node, without the headers of OpenFX. Comments name the actions, suites and
/// properties of ofxImageEffect.h that a plugin maps to these functions. The node uses the C interface only (C++17). It
/// throws std::bad_alloc only, which a plugin returns as kOfxStatErrMemory.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "petzval/petzval17.hpp"

namespace openfx_blur {

/// OfxRectI: pixels x1 <= x < x2 and y1 <= y < y2; y points up.
struct Rect {
  int x1 = 0, y1 = 0, x2 = 0, y2 = 0;
};
inline Rect grown(const Rect& r, int by) { return {r.x1 - by, r.y1 - by, r.x2 + by, r.y2 + by}; }
inline bool contains(const Rect& a, const Rect& b) {
  return a.x1 <= b.x1 && a.y1 <= b.y1 && b.x2 <= a.x2 && b.y2 <= a.y2 && b.x1 < b.x2 && b.y1 < b.y2;
}

enum class Status { ok, failed };   ///< kOfxStatOK, kOfxStatFailed
enum class Clip { colour, depth };  ///< RGBA premultiplied; depths along the axis. Both in float

struct Image {
  char* data = nullptr;          ///< kOfxImagePropData: the pixel (x1, y1)
  std::ptrdiff_t row_bytes = 0;  ///< kOfxImagePropRowBytes
  Rect bounds;                   ///< kOfxImagePropBounds

  float* at(int x, int y, int channels) const {
    return reinterpret_cast<float*>(data + (y - bounds.y1) * row_bytes) + std::ptrdiff_t{x - bounds.x1} * channels;
  }
};

/// The suites of the host.
class Host {
 public:
  virtual ~Host() = default;
  /// clipGetImage() of a region; the image may end at the edges of the source. It is valid until release().
  virtual Image image(Clip clip, double time, const Rect& region) = 0;
  virtual void release(const Image& image) = 0;       ///< clipReleaseImage()
  virtual bool abort() = 0;                           ///< abort()
  virtual void progress(double done) = 0;             ///< progressUpdate()
  virtual void message(const std::string& text) = 0;  ///< kOfxMessageError
  virtual int threads() = 0;                          ///< multiThreadNumCPUs()
};

struct Parameters {
  std::string lens;  ///< file
  double f_number = 2.8, focus_mm = 2000;
  double nearest_mm = 500, farthest_mm = 1e6, mm_per_unit = 1;  ///< depths of the scene; unit of the depth clip
  int columns = 1920, rows = 1080, rays = 100;                  ///< kOfxImageEffectPropProjectSize; rays of a pixel
  bool highlights = true;
};

/// The node. render() may be called by several threads (kOfxImageEffectRenderFullySafe); set() by one, with no render.
class BlurNode {
 public:
  explicit BlurNode(Host& host) : host_(host) {}

  /// kOfxActionInstanceChanged: makes the rays of the lens. After a failure the node keeps its parameters.
  Status set(const Parameters& parameters) {
    if (!(parameters.mm_per_unit > 0 && std::isfinite(parameters.mm_per_unit))) {
      return failed("mm_per_unit = " + std::to_string(parameters.mm_per_unit) + "; must be positive and finite");
    }
    if (parameters.columns < 1 || parameters.rows < 1) {
      return failed("columns x rows = " + std::to_string(parameters.columns) + " x " + std::to_string(parameters.rows) +
                    "; must be positive");
    }
    petzval_film film = petzval_film_init();
    film.columns = parameters.columns, film.rows = parameters.rows;
    film.height_mm = 36.0 * parameters.rows / parameters.columns;
    petzval17::Lens lens = petzval17::Lens::read(parameters.lens);
    lens.f_number(parameters.f_number).focus(parameters.focus_mm);
    petzval_camera_options exposed = petzval_camera_options_init();
    exposed.normalisation = PETZVAL_UNITY_ON_AXIS;  // a picture keeps its brightness
    const petzval17::Camera camera(lens, film, exposed);
    if (!camera) return failed(camera.message());
    petzval_lens_rays_options options = petzval_lens_rays_options_init();
    options.count = parameters.rays, options.over_pixels = 1, options.threads = host_.threads();
    petzval_lens_rays* rays = nullptr;
    petzval_lens_rays_info info = petzval_lens_rays_info_init();
    if (petzval_lens_rays_create(camera.get(), &options, &rays) != PETZVAL_OK) return failed(petzval_message());
    const std::shared_ptr<petzval_lens_rays> owner(rays, petzval_lens_rays_free);
    if (petzval_lens_rays_get_info(rays, parameters.nearest_mm, parameters.farthest_mm, &info) != PETZVAL_OK) {
      return failed(petzval_message());
    }
    parameters_ = parameters, info_ = info, rays_ = owner, frame_ = {};
    return Status::ok;
  }

  /// kOfxImageEffectActionGetRegionOfDefinition: the project, as the lens shows no more.
  Rect region_of_definition() const { return {0, 0, parameters_.columns, parameters_.rows}; }

  /// Pixels of the source that may change a tile. For highlights twice as far: surfaces hide parts of their discs, and
  /// highlights in cells of 16 pixels share a disc. As the layers of a frame are built once, for all tiles,
  /// kOfxImageEffectActionGetRegionsOfInterest returns the region of interest of the region of definition.
  Rect region_of_interest(const Rect& tile) const {
    const int look = static_cast<int>(std::ceil(info_.offset_px)) + 2;
    return grown(tile, parameters_.highlights ? 2 * look + 32 : look);
  }

  /// kOfxImageEffectActionRender: writes a tile, or nothing if it fails or the host aborts (which is no failure).
  Status render(double time, const Rect& tile, const Image& output) {
    if (!contains(region_of_definition(), tile) || !contains(output.bounds, tile)) return failed("tile outside");
    Status status = Status::ok;
    const Layers layers = layers_at(time, status);
    if (!layers) return status;
    petzval_gather_options options = petzval_gather_options_init();
    options.left = tile.x1, options.columns = tile.x2 - tile.x1, options.threads = host_.threads();
    options.top = parameters_.rows - tile.y2, options.rows = tile.y2 - tile.y1;
    if (!parameters_.highlights) options.highlights_above = HUGE_VAL;
    options.user = &host_;
    options.progress = [](double done, void* host) -> int32_t {
      static_cast<Host*>(host)->progress(done);
      return static_cast<Host*>(host)->abort() ? 1 : 0;
    };
    const Blur blur = take_blur();
    const petzval_status found = petzval_gather(layers.get(), rays_.get(), &options, blur.get(),
                                                output.at(tile.x1, tile.y2 - 1, 4), -output.row_bytes, nullptr);
    if (found != PETZVAL_OK && found != PETZVAL_CANCELLED) status = failed(petzval_message());
    const std::lock_guard<std::mutex> guard(mutex_);
    blurs_.push_back(blur);
    return status;
  }

 private:
  using Layers = std::shared_ptr<petzval_layers>;
  using Blur = std::shared_ptr<petzval_blur>;

  Status failed(const std::string& message) const { return host_.message(message), Status::failed; }

  /// The layers of a frame, built by the first tile; null if that fails or the host aborts.
  Layers layers_at(double time, Status& status) {
    const std::lock_guard<std::mutex> guard(mutex_);
    if (frame_.second && frame_.first == time) return frame_.second;
    if (host_.abort()) return nullptr;
    const Rect layer = grown(region_of_definition(), info_.overscan);
    const std::vector<float> rgba = fetched(Clip::colour, time, layer, 4);
    std::vector<float> depth_mm = fetched(Clip::depth, time, layer, 1);
    if (rgba.empty() || depth_mm.empty()) return status = failed("a clip has no pixels"), nullptr;
    for (float& depth : depth_mm) depth *= static_cast<float>(parameters_.mm_per_unit);
    const float *const colours = rgba.data(), *const depths = depth_mm.data();
    petzval_layers* made = nullptr;
    const int columns = layer.x2 - layer.x1, rows = layer.y2 - layer.y1;
    if (petzval_layers_create(columns, rows, 1, &colours, &depths, &made) != PETZVAL_OK) {
      return status = failed(petzval_message()), nullptr;
    }
    frame_ = {time, Layers(made, petzval_layers_free)};
    return frame_.second;
  }

  /// The pixels of a region from the top row down; beyond the edges of the image, its edge pixels. Empty if the
  /// image has no pixels.
  std::vector<float> fetched(Clip clip, double time, const Rect& region, int channels) {
    const Image image = host_.image(clip, time, region);
    const Rect& b = image.bounds;
    const bool empty = !image.data || b.x1 >= b.x2 || b.y1 >= b.y2;
    std::vector<float> pixels;
    for (int y = region.y2 - 1; !empty && y >= region.y1; --y) {
      for (int x = region.x1; x < region.x2; ++x) {
        const float* const pixel = image.at(std::clamp(x, b.x1, b.x2 - 1), std::clamp(y, b.y1, b.y2 - 1), channels);
        pixels.insert(pixels.end(), pixel, pixel + channels);
      }
    }
    host_.release(image);
    return pixels;
  }

  /// Memory that no other thread uses.
  Blur take_blur() {
    const std::lock_guard<std::mutex> guard(mutex_);
    petzval_blur* made = nullptr;
    if (blurs_.empty() && petzval_blur_create(&made) != PETZVAL_OK) throw std::bad_alloc();
    if (made) blurs_.emplace_back(made, petzval_blur_free);
    const Blur blur = std::move(blurs_.back());
    blurs_.pop_back();
    return blur;
  }

  Host& host_;
  Parameters parameters_;
  petzval_lens_rays_info info_ = petzval_lens_rays_info_init();
  std::shared_ptr<petzval_lens_rays> rays_;
  std::mutex mutex_;                 ///< of the members below
  std::pair<double, Layers> frame_;  ///< time and layers
  std::vector<Blur> blurs_;
};

}  // namespace openfx_blur
