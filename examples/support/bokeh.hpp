// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>

#include "contact_sheet.hpp"
#include "load_lens.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/image.hpp"
#include "petzval/psf/psf.hpp"

namespace examples {

/// A point light and the way in which the lens is focused elsewhere.
struct BokehSetup {
  double light_mm = 1000;  ///< distance of the light, may be infinite; from `origin`, as the focus distance
  petzval::DistanceOrigin origin = petzval::DistanceOrigin::front_vertex;
  petzval::FocusCriterion criterion = petzval::FocusCriterion::paraxial;
  double field_rad = 0;
};

/// The lens with its film where the focus distance puts it, and the light before it.
struct BokehScene {
  petzval::Lens lens;
  petzval::FieldPoint light;
};

/// Focuses at the primary wavelength. Throws petzval::Error for a focus out of reach and a light that is not in front
/// of the lens.
BokehScene focused_scene(const petzval::Lens& lens, double focus_mm, const BokehSetup& setup);

/// The picture of a PSF, linear, in the units of petzval::render; several wavelengths are weighted to RGB by the CIE
/// 1931 functions.
petzval::RgbImage irradiance(const petzval::Psf& psf);

/// Weights of wavelengths by the colour matching functions in the data directory; throws Error for a set without a
/// meaning.
std::vector<std::array<double, 3>> rgb_weights(std::span<const double> wavelengths_nm);

/// A picture for the eye, and the irradiance that it shows as white: the 99th percentile of the lit pixels.
struct Exposed {
  petzval::Rgb8Image picture;
  double white_per_mm2 = 0;
};
Exposed expose(const petzval::RgbImage& image);

/// "focus 800 mm"; "focus infinity".
std::string focus_caption(double focus_mm);

/// The tile of a contact sheet: the picture, the focus distance, the size of the blur and the exposure.
Tile bokeh_tile(double focus_mm, const petzval::PointImage& image);

/// What the lines below a tile mean.
std::vector<std::string> bokeh_notes();

}  // namespace examples
