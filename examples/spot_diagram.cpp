// SPDX-License-Identifier: Apache-2.0
// Draws the spots of a lens: the film points of rays from distant lights, at three fields and three wavelengths.
//
//   spot_diagram [LENS.json [FOLDER]]
//
// Prints RMS radii and writes spots.svg.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <vector>

#include "petzval/analysis/spot.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/petzval.hpp"

int main(int argc, char** argv) try {
  using namespace petzval;
  const std::filesystem::path file = argc > 1 ? argv[1] : data_directory() / "lenses" / "cooke_triplet_50mm_f5.json";
  const std::filesystem::path folder = argc > 2 ? argv[2] : ".";

  // The Fraunhofer lines F (blue), d (yellow) and C (red). with_focus() and real_f_number() use the primary wavelength:
  // the d line, for which most lenses are designed.
  const std::array lines{"F", "d", "C"};
  const std::array wavelengths_nm{486.1327, d_line_nm, 656.2725};
  const Prescription prescription = read_prescription(file);
  const Lens wide_open = compile(prescription, wavelengths_nm, {.missing_glass = MissingGlass::abbe});

  // Moves the film to the least RMS radius of the axial spot.
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Lens lens = with_focus(wide_open, infinity);
  std::printf("%s\nf = %.2f mm, f/%.2f, film at z = %.3f mm\n\n", lens.name().c_str(),
              first_order(lens).effective_focal_length, real_f_number(lens), lens.film_z());

  // The axis, 0.7 of the field and its edge. Half of the picture's area lies within 0.7 of the field.
  const double edge = declared_half_field(prescription, lens).value_or(radians(10));
  const std::array fields{0.0, 0.7 * edge, edge};
  const Grid<Spot> spots = spot_diagram(lens, -infinity, fields);

  std::printf("field (deg)  line  RMS radius (um)  largest radius (um)  chief ray (mm)\n");
  for (const Spot& spot : spots.values) {
    std::printf("%11.1f  %4s  %15.2f  %19.2f  %14.4f\n", degrees(spot.point.field_rad), lines[spot.wavelength],
                1e3 * spot.size.rms_radius, 1e3 * spot.size.max_radius, spot.chief_ray_height.value_or(NAN));
  }
  std::printf("radius of the Airy disc %.2f um\n", 1e3 * airy_radius(lens));

  write_file(spot_figure(lens, spots), folder / "spots.svg");
  std::printf("%s\n", (folder / "spots.svg").c_str());
} catch (const petzval::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
