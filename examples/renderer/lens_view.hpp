// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/lens_camera.hpp"
#include "renderer/path_colours.hpp"
#include "renderer/scene.hpp"
#include "renderer/splats.hpp"

namespace renderer {

/// A film sample and the weights of its lanes: radiance times weight is the contribution to a pixel, by lane.
struct FilmSample {
  WorldRay ray;
  float u = 0, v = 0;  ///< pupil sample
  Lanes weight{0};
  LanePixels pixels{no_pixel, no_pixel, no_pixel, no_pixel};
  double by_film = 0;  ///< as in SeenRay, if requested

  explicit operator bool() const noexcept { return weight != Lanes(0); }
};

/// A ray of the scene, seen by the lens at the wavelengths of a path.
///
/// A ray is sampled from the film or by a connection, at the hero wavelength. Any lane may be the hero, so that the
/// densities are means over the lanes (Wilkie et al. 2014), and all lanes share one path.
struct SeenRay {
  glm::vec3 direction{0, 0, 1};  ///< towards the lens
  glm::vec3 on_front{0, 0, 0};   ///< end point of the shadow ray of a connection
  Lanes we{0};                   ///< importance, 1/mm^2
  LanePixels pixels{no_pixel, no_pixel, no_pixel, no_pixel};
  double by_film = 0;        ///< density of film samples in the measure cos dA dw of the scene, 1/(mm^2 sr)
  double by_connection = 0;  ///< density of connections, 1/sr at their point; for the sky 1/mm^2

  explicit operator bool() const noexcept { return we != Lanes(0); }
};

/// The lens as used by one path.
class LensView {
 public:
  /// seconds: accumulates the time spent in the lens.
  LensView(const LensCamera& lens, const PathColours& colours, double& seconds) noexcept
      : lens_(lens), colours_(colours), seconds_(seconds) {}

  const PathColours& colours() const noexcept { return colours_; }

  /// A sample of a batch in a pixel, drawn at the hero wavelength. seen: importances of its ray at the wavelengths of
  /// the lanes; may be empty.
  FilmSample film_sample(const LensCamera::Batch& batch, std::size_t index, std::uint32_t pixel,
                         std::span<const std::vector<petzval::Importance>> seen) const noexcept;
  /// Densities of a sample's ray from its start in the scene: a surface, or the sky if `from` is null.
  struct Densities {
    double by_film = 0, by_connection = 0;  ///< as in SeenRay
  };
  Densities densities(const FilmSample& sample, const SurfacePoint* from) const noexcept;
  /// Evaluates a connection, made at the hero wavelength, at all lanes. point: null for light from the sky.
  SeenRay at_all_lanes(const LensCamera::Connection& hero, const glm::vec3* point) const noexcept;
  petzval::Wavelength hero() const noexcept { return wavelength(colours_.hero); }

 private:
  petzval::Wavelength wavelength(int lane) const noexcept;
  std::uint32_t pixel_of(const petzval::Importance& seen) const noexcept;
  bool same_tile(std::uint32_t a, std::uint32_t b) const noexcept;
  void add(SeenRay& ray, int lane, const petzval::Importance& seen, double by_connection) const noexcept;

  const LensCamera& lens_;
  const PathColours& colours_;
  double& seconds_;
};

/// Adds its lifetime to a sum of seconds.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) noexcept : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace renderer
