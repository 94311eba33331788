// SPDX-License-Identifier: Apache-2.0
// Tilts the film of a view camera so that a table top is sharp from its front edge to its back edge.
//
//   tilt_fit [FOLDER]
//
// Prints the tilt, the plane of focus, its hinge line and the blurs, and writes tilt.svg.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "petzval/figure/figures.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "petzval/petzval.hpp"

int main(int argc, char** argv) try {
  using namespace petzval;
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  const Lens lens =
      with_f_number(compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f2_28deg.json")), 8);

  // Five points of a table that is seen from above: the farther a point, the higher it lies in the picture. Lens frame
  // (mm), y up, scene at negative z.
  std::vector<FocusTarget> targets;
  for (const auto& [x, depth] : {std::array{-80.0, 720.0}, {90, 760}, {0, 900}, {-150, 1100}, {160, 1150}}) {
    targets.push_back({.point = {{x, 0.4 * (depth - 900), -depth}}});
  }

  // An upright film can only focus at the middle of the table.
  const Film frame{.width_mm = 36, .height_mm = 24};
  const Autofocus upright = autofocus(lens, targets, frame);
  const TiltFit tilted = fit_tilt(lens, targets, {.film = upright.film});
  if (!upright || !tilted || !tilted.focus || !tilted.focus->hinge) {
    std::fprintf(stderr, "no tilted film: %s\n", std::string(name(tilted.status)).c_str());
    return 1;
  }
  // A positive tilt moves the lower edge of the film towards the lens.
  std::printf("film: tilt %+.3f deg, swing %+.3f deg, z = %.3f mm\n", degrees(tilted.film.tilt_rad),
              degrees(tilted.film.swing_rad), tilted.film.z());

  // The plane of focus contains the points p with dot(normal, p) = offset. It rotates about its hinge line, in the
  // front focal plane, if the film moves along the axis.
  const Plane& plane = tilted.focus->plane;
  std::printf("plane of focus: normal (%.4f, %.4f, %.4f), offset %.1f mm\n", plane.normal.x, plane.normal.y,
              plane.normal.z, plane.offset);
  const Line3& hinge = *tilted.focus->hinge;
  std::printf("hinge line: y = %.1f mm, z = %.1f mm, %.2f deg from the x axis\n", hinge.point.y, hinge.point.z,
              degrees(std::acos(std::min(1.0, hinge.direction.x))));

  // The rest of the blur is the curvature of field: the images of plane points do not lie in a plane.
  for (std::size_t i = 0; i < targets.size(); ++i) {
    std::printf("point %zu: blur %+7.1f um upright, %+5.1f um tilted\n", i + 1, 1e3 * upright.blurs[i].blur_mm,
                1e3 * tilted.blurs[i].blur_mm);
  }

  const std::string svg = tilt_figure({.title = lens.name(),
                                       .remark = "f/8, a table seen from above",
                                       .lens = thick_lens(lens),
                                       .glass = &lens,
                                       .before = upright.film,
                                       .after = tilted.film,
                                       .focus = tilted.focus,
                                       .points = targets});
  write_file(svg, folder / "tilt.svg");
  std::printf("%s\n", (folder / "tilt.svg").c_str());
} catch (const petzval::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
