// SPDX-License-Identifier: Apache-2.0
// Renders a point light out of focus, through a round iris and through six blades.
//
//   bokeh_psf [FOLDER]
//
// Prints the light on the film and writes bokeh_round.png, bokeh_blades.png and bokeh_blades.exr.
#include <array>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "petzval/analysis/colour.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/image/image.hpp"
#include "petzval/image/psf.hpp"
#include "petzval/petzval.hpp"

namespace {

using namespace petzval;

/// Nine wavelengths (nm) resolve the coloured rim of the blur.
constexpr std::array wavelengths_nm{440.0, 470.0, 500.0, 530.0, 560.0, 590.0, 620.0, 650.0, 680.0};

/// The light: white, 3 m in front of the lens and 5 degrees above the axis.
constexpr FieldPoint light{.field_rad = radians(5), .z = -3000};

Psf image_of(const Lens& lens, double half_width_mm) {
  return point_image(
      lens, light,
      {.samples = 1u << 18, .pixels = 256, .half_width_mm = half_width_mm, .threads = processor_threads()});
}

}  // namespace

int main(int argc, char** argv) try {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";

  // Stop down before focusing: spherical aberration moves the sharpest film with the size of the stop.
  const Prescription prescription = read_prescription(data_directory() / "lenses/double_gauss_100mm_f2_28deg.json");
  const Lens round = with_focus(with_f_number(compile(prescription, wavelengths_nm), 4), 1000);  // mm
  // The corners of the blades lie on the rim of the round stop; the stop keeps its size.
  const Lens blades = with_iris(round, {.blades = 6, .rotation_rad = radians(10)});

  // The first image has the width of its blur, and sets the scale of both.
  const double half_width_mm = 1.2 * image_of(round, 0).size.max_radius;
  const Psf disc = image_of(round, half_width_mm), hexagon = image_of(blades, half_width_mm);
  std::printf("%s at f/%.1f, focused at 1 m, light at 3 m\n", round.name().c_str(), real_f_number(round));
  std::printf("blur diameter: %.3f mm round, %.3f mm with blades\n", 2 * disc.size.max_radius,
              2 * hexagon.size.max_radius);
  std::printf("light on the film relative to the paraxial entrance pupil: %.4f round, %.4f with blades\n",
              disc.mean_throughput, hexagon.mean_throughput);
  std::printf("ratio %.4f, area of the hexagon in its circle %.4f\n", hexagon.mean_throughput / disc.mean_throughput,
              iris_area(blades.iris()) / iris_area(round.iris()));

  // Colours: the spectrum of daylight over the bands around the wavelengths, seen by the CIE observer.
  const std::filesystem::path tables = data_directory() / "glass";
  const Spectrum d65 = illuminant("D65", tables / "cie_daylight_10nm.csv");
  const auto weights = rgb_weights(wavelengths_nm, ColourMatching::load(tables / "cie1931_2deg_5nm.csv"), d65, d65);
  const RgbImage disc_picture = render(disc, weights), hexagon_picture = render(hexagon, weights);

  // Both pictures have the same exposure: the mean irradiance of the disc is a light grey.
  const double disc_area_mm2 = std::numbers::pi * disc.size.max_radius * disc.size.max_radius;
  const float exposure = static_cast<float>(0.6 * disc_area_mm2 / disc.mean_throughput);
  write_png(to_srgb8(disc_picture, exposure), folder / "bokeh_round.png");
  write_png(to_srgb8(hexagon_picture, exposure), folder / "bokeh_blades.png");
  write_exr(hexagon_picture, folder / "bokeh_blades.exr");  // linear, without exposure
  for (const char* name : {"bokeh_round.png", "bokeh_blades.png", "bokeh_blades.exr"}) {
    std::printf("%s\n", (folder / name).c_str());
  }
} catch (const petzval::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
