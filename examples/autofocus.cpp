// SPDX-License-Identifier: Apache-2.0
// Focuses on three weighted points at once, with the ideal lens and with exact rays.
//
//   autofocus
//
// Prints the films, the blur of each point and the depth of field.
#include <array>
#include <cstdio>
#include <string>

#include "petzval/petzval.hpp"

namespace {

using namespace petzval;

constexpr std::array names{"face", "hand", "lamp"};

void print(const char* title, const Autofocus& focus) {
  std::printf("%s: %s, film at z = %.4f mm\n", title, std::string(name(focus.status)).c_str(), focus.film.z());
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::printf("  %s: blur %+.1f um, requested %+.1f um\n", names[i], 1e3 * focus.blurs[i].blur_mm,
                1e3 * focus.blurs[i].target_mm);
  }
  std::printf("  weighted RMS error %.1f um\n", 1e3 * focus.rms_mm);
}

}  // namespace

int main() try {
  const Lens lens =
      with_f_number(compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f2.0.json")), 2.8);

  // Positions in the lens frame (mm): x to the right, y up, and the scene at negative z. The face has 20 times the
  // weight of the hand. The lamp should have a blur of 0.8 mm; the positive sign places it beyond the plane of focus.
  const std::array<FocusTarget, 3> targets{FocusTarget{.point = {{-60, 150, -2000}}, .weight = 20},
                                           FocusTarget{.point = {{120, -100, -1850}}, .weight = 1},
                                           FocusTarget{.point = {{300, 300, -4000}}, .blur_mm = 0.8, .weight = 0.1}};

  // The ideal lens needs its cardinal points and pupils only, and is solved in closed form.
  const Autofocus ideal = autofocus(thick_lens(lens), targets);
  print("ideal lens", ideal);

  // Exact rays include aberrations: the sharpest film of a point differs from its paraxial image.
  const Autofocus exact = autofocus(lens, targets);
  print("exact rays", exact);
  if (!exact) return 1;
  std::printf("exact rays move the film by %+.1f um\n", 1e3 * (exact.film.z() - ideal.film.z()));

  // Distances on the axis, as engraved on lens barrels: from the film.
  const Lens focused = with_film(lens, exact.film.z());
  const FocusOptions from_film{.origin = DistanceOrigin::film};
  constexpr double blur_mm = 0.03;  // usual limit for pictures of 36 x 24 mm
  const DepthOfField depth = depth_of_field(focused, blur_mm, from_film);
  std::printf("in focus: %.1f mm from the film\n", solve_subject(focused, focused.film_z(), from_film).distance);
  std::printf("sharp within %.2f mm: from %.1f to %.1f mm\n", blur_mm, depth.near_distance, depth.far_distance);
} catch (const petzval::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
