// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/mat3x4.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec4.hpp>

#include "renderer/scene_description.hpp"

namespace renderer {

/// Values of a path at its wavelengths, one per lane.
using Lanes = glm::vec4;

/// The wavelengths of a path and their conversion to colour. Lights and surfaces are given in RGB.
struct PathColours {
  glm::mat3x4 from_rgb{};       ///< RGB radiance or reflectance to lanes
  glm::mat4x3 to_rgb{};         ///< radiance in the lanes to RGB of the picture
  std::array<float, 4> nm{};    ///< wavelengths of the lanes
  int lanes = 3, hero = 0;      ///< hero: the lane whose wavelength the path has in the lens; all equally likely
  bool one_wavelength = false;  ///< true if all lanes have the same wavelength
};

/// Use of wavelengths for the colours of a picture.
enum class ColourMode : std::uint8_t {
  d,    ///< RGB, seen through the lens at the d line
  rgb,  ///< RGB, each channel at its own wavelength: petzval::rgb_triple_nm
  hero  ///< four wavelengths per path, from 420 to 680 nm
};
std::optional<ColourMode> colour_mode_named(std::string_view name) noexcept;

/// Draws the wavelengths of paths.
///
/// With hero wavelengths the light is D65, which is white. Colours are mixtures of three reflectances, which have the
/// colours of the primaries and add up to 1 at every wavelength. Sources: Wilkie et al., Hero wavelength spectral
/// sampling, 2014; Mallett, Yuksel, Spectral primary decomposition for rendering with sRGB reflectance, 2019 (the idea;
/// these primaries are the nearest to three soft bands).
class PathColourSource {
 public:
  explicit PathColourSource(ColourMode mode);
  /// RGB, seen through the lens at one wavelength (nm).
  explicit PathColourSource(double nm);

  /// Wavelengths for which the lens must be compiled, including the d line for focusing.
  std::span<const double> compiled_nm() const noexcept { return compiled_nm_; }
  /// u: uniform from 0 to 1.
  PathColours draw(float u) const noexcept;

 private:
  struct Band {                   // a band of the spectrum, drawn with a density close to its share of the picture
    glm::vec3 primaries, weight;  ///< light of the primaries in the band; RGB of the band
    double end = 0;               ///< cumulative fraction of the draws, including this band
  };
  void make_bands();

  ColourMode mode_;
  std::array<double, 3> rgb_nm_;  ///< wavelengths of the channels without hero wavelengths
  std::vector<double> compiled_nm_;
  std::vector<Band> bands_;
};

}  // namespace renderer
