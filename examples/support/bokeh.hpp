// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>

#include "cli.hpp"
#include "contact_sheet.hpp"
#include "load_lens.hpp"
#include "petzval/analysis/colour.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/image/image.hpp"

namespace examples {

/// A point light and how the lens is focused.
struct BokehSetup {
  double light_mm = 1000;  ///< distance of the light from `origin`, may be infinite
  petzval::DistanceOrigin origin = petzval::DistanceOrigin::front_vertex;
  petzval::FocusCriterion criterion = petzval::FocusCriterion::min_rms;
  double field_rad = 0;
};

/// The focused lens and the light in front of it.
struct BokehScene {
  petzval::Lens lens;
  petzval::FieldPoint light;
};

/// Focuses at the primary wavelength. Throws petzval::Error for a focus out of reach and for a light that is not in
/// front of the lens.
BokehScene focused_scene(const petzval::Lens& lens, double focus_mm, const BokehSetup& setup);

/// A camera behind a focused lens whose square film holds the picture of a light. The rate of change of its controls is
/// that on a film of 36 x 24 mm. Throws petzval::Error where Camera does, and for a picture beyond 10 m.
petzval::Camera camera_of(const BokehScene& scene, petzval::CameraOptions options);

/// The light of a point, which looks white: D65, D50, A, E or a file "wavelength_nm,power" that ends in .csv. Throws
/// Error that names it.
petzval::Spectrum white_light(const std::string& white_point);

/// Option --white-point, for white_light().
void add_white_point(App& app, std::string& white_point);

/// The linear image of a PSF in such a light, in the units of petzval::render. The CIE 1931 functions weight
/// wavelengths to RGB.
petzval::RgbImage irradiance(const petzval::Psf& psf, const petzval::Spectrum& light = white_light("D65"));

/// Weights of wavelengths in such a light by the colour matching functions of the data directory. Throws Error for an
/// invalid set.
std::vector<std::array<double, 3>> rgb_weights(std::span<const double> wavelengths_nm, const petzval::Spectrum& light);

/// A displayable picture, and the irradiance that it shows as white: the 99th percentile of the lit pixels.
struct Exposed {
  petzval::Rgb8Image picture;
  double white_per_mm2 = 0;
};
Exposed expose(const petzval::RgbImage& image);

/// "focus 800 mm"; "focus infinity".
std::string focus_caption(double focus_mm);

/// A tile of a contact sheet: picture, focus distance, size of the blur, exposure.
Tile bokeh_tile(double focus_mm, const petzval::PointImage& image, const petzval::Spectrum& light = white_light("D65"));

/// Explains the lines below a tile.
std::vector<std::string> bokeh_notes();

}  // namespace examples
