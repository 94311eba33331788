// SPDX-License-Identifier: Apache-2.0
// Pupils of a film that leans: of each key, a line from the centre of the pupil's plane, those of the film points that
// azimuths put at different places along it.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "film_polygons.hpp"

namespace petzval::inline v0::pupil_detail {
namespace {

/// A film point on +y by its key, and slope . key there.
struct Field {
  double key = 0, lean = 0;
};

/// What is known of the pupils before they are looked for, from those of an upright film.
struct Expected {
  double lit = 0, radius = 0;
  bool ring = false;
};

Expected expected_of(const FilmPupilTable& upright, std::size_t wavelength) {
  Expected result;
  constexpr int heights = 64;
  for (int i = 0; i <= heights; ++i) {
    const FilmPoint film{0, upright.film_radius() * i / heights};
    const double area = upright.area(film, wavelength);
    if (!(area > 0)) continue;
    const auto [x, y] = upright.middle(film, wavelength);
    result.lit = film.y;
    result.radius = std::max(result.radius, std::sqrt(area / std::numbers::pi));
    result.ring = result.ring || !upright.contains(film, x, y, wavelength);
  }
  return result;
}

}  // namespace

EdgesAt leaning_edges(const FilmPupilTable& upright, const FilmTilt& lean, std::size_t wavelength) {
  const Expected expected = expected_of(upright, wavelength);
  return [upright, lean, wavelength, expected](std::span<const double> heights) {
    const double steepest = std::hypot(lean.slope_x, lean.slope_y);
    std::vector<Field> fields;
    // The middle first, where there is light if anywhere. More between: the pupils of a plane far from the one in which
    // light is limited, a thin lens's, move by more than their size.
    for (const double part : {0.5, 0.0, 0.25, 0.75, 1.0}) {
      for (const double key : heights) {
        const auto within = [&](double value) { return std::clamp(value, lean.low, lean.high); };
        const double low = within(-steepest * key), high = within(steepest * key);
        fields.push_back({key, low + part * (high - low)});
      }
    }
    std::vector<PupilGuess> guesses;
    for (const auto& [key, leaning] : fields) {
      double y = 0;
      for (int round = 0; round < 2; ++round) {
        y = upright.middle({0, std::min(key - leaning * y, expected.lit)}, wavelength)[1];
      }
      const double near = 3 * expected.radius, far = 12 * expected.radius;
      guesses.push_back({0, y - far, y + far, expected.radius, y, near, expected.ring});
    }
    std::array<std::vector<double>, 2> film;
    return find_edges(
        guesses, heights.size(), edge_directions, true,
        [&](std::size_t count, const std::uint32_t* which, const double* x, const double* y, std::uint8_t* passes) {
          for (auto& values : film) values.resize(count);
          for (std::size_t i = 0; i < count; ++i) {
            const auto& [key, leaning] = fields[which[i]];
            film[0][i] = -leaning * x[i];
            film[1][i] = key - leaning * y[i];
          }
          upright.contains<double>(count, {film[0].data(), film[1].data(), x, y}, {.all = wavelength}, passes);
        });
  };
}

}  // namespace petzval::inline v0::pupil_detail
