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

/// What a path carries at its wavelengths, one in each lane.
using Lanes = glm::vec4;

/// The wavelengths of a path and what they mean in colour. Lights and surfaces are given in RGB.
struct PathColours {
  glm::mat3x4 from_rgb{};       ///< radiance and reflectance in the lanes
  glm::mat4x3 to_rgb{};         ///< the picture's RGB by the radiance in the lanes
  std::array<float, 4> nm{};    ///< of the lanes
  int lanes = 3, hero = 0;      ///< the lane at whose wavelength the path leaves the lens; drawn evenly among them
  bool one_wavelength = false;  ///< all lanes have the same one
};

/// How a picture gets its colours.
enum class ColourMode : std::uint8_t {
  d,    ///< RGB, seen through the lens at the d line
  rgb,  ///< RGB, each channel seen at a wavelength of its own: petzval::rgb_triple_nm
  hero  ///< four wavelengths of a path, drawn anew for each, from 420 to 680 nm
};
std::optional<ColourMode> colour_mode_named(std::string_view name) noexcept;

/// Draws the wavelengths of paths.
///
/// The light of hero wavelengths is D65, which is white, and colours are mixtures of three reflectances that add up to
/// 1 at every wavelength and have the colours of the primaries.
/// Sources: Wilkie et al., Hero wavelength spectral sampling, 2014; Mallett, Yuksel, Spectral primary decomposition for
/// rendering with sRGB reflectance, 2019 (the idea of such primaries; these are the ones nearest to three soft bands).
class PathColourSource {
 public:
  explicit PathColourSource(ColourMode mode);

  /// What a lens has to be compiled for; the d line, for which it is focused, is among them.
  std::span<const double> compiled_nm() const noexcept { return compiled_nm_; }
  /// u: uniform from 0 to 1.
  PathColours draw(float u) const noexcept;

 private:
  struct Band {                   // of the spectrum, drawn with a density that follows what the picture sees of it
    glm::vec3 primaries, weight;  ///< of the primaries' light; RGB of the band
    double end = 0;               ///< of its share among the draws, from the band before on
  };
  void make_bands();

  ColourMode mode_;
  std::vector<double> compiled_nm_;
  std::vector<Band> bands_;
};

}  // namespace renderer
