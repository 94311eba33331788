// SPDX-License-Identifier: Apache-2.0
// Prints the brightest ghosts of the sun through a double Gauss, without coatings and with one layer of magnesium
// fluoride on each surface between air and glass.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <limits>
#include <span>

#include "petzval/core/files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/apertures.hpp"

int main() try {
  const auto data = petzval::data_directory() / "lenses/double_gauss_100mm_f2.0.json";
  petzval::Lens lens = petzval::compile(petzval::read_prescription(data));
  const auto sun =
      petzval::scene_point(lens, {.field_rad = petzval::radians(10), .z = -std::numeric_limits<double>::infinity()});
  for (const char* const coating : {"uncoated", "magnesium fluoride"}) {
    const petzval::Ghosts ghosts = petzval::ghost_pairs(lens, sun);
    std::printf("%s: fraction of the light, centre (mm), radius (mm)\n", coating);
    for (const petzval::GhostPair& pair :
         std::span(ghosts.pairs).first(std::min<std::size_t>(5, ghosts.pairs.size()))) {
      std::printf("  surfaces %2zu, %2zu: %.2e  (%6.2f, %6.2f)  %6.2f\n", pair.second, pair.first, pair.energy,
                  pair.centre.x, pair.centre.y, pair.rms_radius_mm);
    }
    lens = petzval::with_coating(lens, petzval::Coating::quarter_wave());
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "hello_ghosts: %s\n", error.what());
  return 1;
}
