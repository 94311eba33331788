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
#include "petzval/analysis/wavefront.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/image/image.hpp"

namespace examples {

/// The axes of pictures of point lights, for the key "frame" of reports.
inline constexpr const char* picture_frame =
    "rows from the top; rotated by 180 degrees against the film, as a photograph: right is -x, up is -y; positions in "
    "mm are on the film";

/// A point light and how the lens is focused.
struct BokehSetup {
  /// Distance of the light from focus.origin, mm; may be infinite. At fields of 90 degrees and more, along the ray from
  /// the entrance pupil.
  double light_mm = 1000;
  petzval::FocusOptions focus = {};
  double field_rad = 0;
};

/// The focused lens and a light in its object space.
struct BokehScene {
  petzval::Lens lens;
  petzval::FieldPoint light;
};

/// Focuses the lens at its primary wavelength.
/// @throws petzval::Error if the focus is out of reach or the light is not in front of the lens
BokehScene focused_scene(const petzval::Lens& lens, double focus_mm, const BokehSetup& setup);

/// A camera with the focused lens and a square film that holds the image of the light.
///
/// @param options  the camera; its rate of change refers to a film of 36 x 24 mm
/// @throws petzval::Error if Camera does, or if the image is larger than 10 m
petzval::Camera camera_of(const BokehScene& scene, petzval::CameraOptions options);

/// The spectrum of the light that is shown as white.
///
/// @param white_point  D65, D50, A, E or a file "wavelength_nm,power" whose name ends in .csv
/// @throws petzval::Error if the name is unknown or the file is invalid
petzval::Spectrum white_light(const std::string& white_point);

/// Adds --white-point, for white_light().
void add_white_point(App& app, std::string& white_point);

/// The linear image of a PSF under the light, in the units of petzval::render. The CIE 1931 functions weight
/// wavelengths to RGB.
petzval::RgbImage irradiance(const petzval::Psf& psf, const petzval::Spectrum& light = white_light("D65"));
petzval::RgbImage irradiance(const petzval::DiffractionPsf& psf, const petzval::Spectrum& light = white_light("D65"));

/// RGB weights of wavelengths under the light, by the colour matching functions of the data directory.
/// @throws petzval::Error if the wavelengths are invalid
std::vector<std::array<double, 3>> rgb_weights(std::span<const double> wavelengths_nm, const petzval::Spectrum& light);

/// Irradiance on the axis of the film for a sky of radiance 1.
/// @throws petzval::Error if no light reaches the axis
double irradiance_on_axis(const petzval::Camera& camera);

/// The ghosts of a light: petzval::add_ghosts() at each wavelength of the lens, times its weights for R, G and B.
petzval::RgbImage ghost_picture(const petzval::Lens& lens, const petzval::ScenePoint& light, const petzval::Film& film,
                                std::span<const std::array<double, 3>> weights, const petzval::GhostOptions& options);

/// A displayable picture and its white level: the irradiance at the 99th percentile of the lit pixels, divided by
/// `exposure`. With an exposure above 1, overexposed pixels fade to white.
struct Exposed {
  petzval::Rgb8Image picture;
  double white_per_mm2 = 0;
};
Exposed expose(const petzval::RgbImage& image, double exposure = 1);

/// "focus 800 mm" or "focus infinity".
std::string focus_caption(double focus_mm);

/// A tile of a contact sheet: picture, focus distance, size of the blur, exposure.
Tile bokeh_tile(double focus_mm, const petzval::Psf& image, Exposed exposed);

/// Notes that explain the lines below a tile.
std::vector<std::string> bokeh_notes();

}  // namespace examples
