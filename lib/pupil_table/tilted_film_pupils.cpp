// SPDX-License-Identifier: Apache-2.0
// Pupils of a tilted film. A virtual film point stands for a line through the centre of the pupil plane, and the
// position of the film point on this line depends on the azimuth. The pupil of the virtual film point is the union over
// all these positions.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "film_polygons.hpp"
#include "pupil/boundary_search.hpp"
#include "virtual_film_point.hpp"

namespace petzval::pupil_table_detail {
namespace {

/// Properties of the upright pupils that guide the search for the tilted pupils.
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
    const Vec2<double> middle = upright.middle(film, wavelength);
    result.lit = film.y;
    result.radius = std::max(result.radius, std::sqrt(area / std::numbers::pi));
    result.ring = result.ring || !upright.contains(film, middle.x, middle.y, wavelength);
  }
  return result;
}

}  // namespace

FilmPupils tilted_film_pupils(const FilmPupilTable& upright, const FilmTilt& tilt, std::size_t wavelength) {
  const Expected expected = expected_of(upright, wavelength);
  // Calls find(guesses, clearances) for the points at some heights, row by row.
  const auto search = [upright, tilt, wavelength, expected](std::span<const double> heights, const auto& find) {
    const double steepest = std::hypot(tilt.slope_x, tilt.slope_y);
    std::vector<VirtualFilmPoint> fields;
    // The middle position is the first, because its pupil is the least likely to be empty. Five positions are needed,
    // because pupils in a plane far from the limiting aperture, as for a thin lens, move by more than their size.
    for (const double fraction : {0.5, 0.0, 0.25, 0.75, 1.0}) {
      for (const double height : heights) {
        const auto within = [&](double value) { return std::clamp(value, tilt.min_excess, tilt.max_excess); };
        const auto excess = [&](double along) { return std::array{along, (along - tilt.travel) / (1 + tilt.travel)}; };
        const auto [first_low, last_low] = excess(-steepest * height);
        const auto [first_high, last_high] = excess(steepest * height);
        const double low = within(std::min(first_low, last_low)), high = within(std::max(first_high, last_high));
        fields.push_back({{0, height}, low + fraction * (high - low)});
      }
    }
    std::vector<pupil_detail::PupilGuess> guesses;
    for (const VirtualFilmPoint& field : fields) {
      double y = 0;
      for (int round = 0; round < 2; ++round) {
        y = upright.middle({0, std::min(field.on_upright(0, y).y, expected.lit)}, wavelength)[1];
      }
      const double near = 3 * expected.radius, far = 12 * expected.radius;
      guesses.push_back({0, y - far, y + far, expected.radius, y, near, expected.ring});
    }
    return find(guesses, [&](std::size_t count, const std::uint32_t* which, const double* x, const double* y,
                             double* clearances) {
      const auto from = [&](std::size_t i) { return fields[which[i]]; };
      upright_clearances(upright, wavelength, count, from, x, y, clearances);
    });
  };
  return {[=](std::span<const double> heights) {
            return search(heights, [&](const auto& guesses, const auto& clearances) {
              const auto order = pupil_detail::SearchOrder::rows(guesses.size(), heights.size());
              return pupil_detail::find_regions(guesses, order, region_directions, true, clearances);
            });
          },
          [=](std::span<const double> heights) {
            const std::vector<bool> points = search(heights, [](const auto& guesses, const auto& clearances) {
              return pupil_detail::lit_points(guesses, clearances);
            });
            std::vector<bool> lit(heights.size(), false);
            for (std::size_t i = 0; i < points.size(); ++i) {
              if (points[i]) lit[i % heights.size()] = true;
            }
            return lit;
          }};
}

}  // namespace petzval::pupil_table_detail
