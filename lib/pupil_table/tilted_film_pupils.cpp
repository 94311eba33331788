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

namespace petzval::pupil_table_detail {
namespace {

/// Range of `excess` (FilmTilt) over the film points that belong to a virtual film point or its mirror images.
struct ExcessRange {
  double low, high;

  /// @param along largest value of slope . v over the mirror images, or over all azimuths
  ExcessRange(const FilmTilt& tilt, double along) noexcept {
    const auto at_end = [&](double value) { return (value - tilt.travel) / (1 + tilt.travel); };
    low = std::clamp(std::min(-along, at_end(-along)), tilt.min_excess, tilt.max_excess);
    high = std::clamp(std::max(along, at_end(along)), tilt.min_excess, tilt.max_excess);
  }
  double at(double fraction) const noexcept { return low + fraction * (high - low); }
};

/// A virtual film point of a tilted film, with the value of `excess` for one of its film points (see FilmTilt).
struct VirtualFilmPoint {
  FilmPoint at;
  double excess = 0;

  /// Intersection of the upright film with the ray from that film point through (x, y) in the pupil plane.
  FilmPoint on_upright(double x, double y) const noexcept { return {at.x - excess * x, at.y - excess * y}; }
};

/// Predicts the pupil of a virtual film point from a pupil of the upright film; if that pupil is empty, the film point
/// is moved towards the axis.
pupil_detail::PupilGuess guess_of(const FilmPupilTable& upright, const VirtualFilmPoint& virtual_point,
                                  std::size_t wavelength) {
  FilmPoint at;
  Vec2<double> position{0, 0};
  double area = 0;
  for (int round = 0; round < 4; ++round) {
    at = virtual_point.on_upright(position.x, position.y);
    for (int step = 0; step < 32 && !(area = upright.area(at, wavelength)); ++step) at = {0.95 * at.x, 0.95 * at.y};
    position = upright.middle(at, wavelength);
  }
  const double radius = std::sqrt(area / std::numbers::pi), near = 3 * radius, far = 12 * radius;
  const bool ring = area > 0 && !upright.contains(at, position.x, position.y, wavelength);
  return {position.x, position.y - far, position.y + far, radius, position.y, near, ring};
}

}  // namespace

FilmPolygons tilted_polygons(const FilmPupilTable& upright, bool of_revolution, const FilmTilt& tilt, int threads) {
  const auto virtual_points = [&](FilmPupils::Points points) {
    std::vector<VirtualFilmPoint> result;
    for (const auto& [film, layer] : points) {
      const double along = of_revolution ? std::hypot(tilt.slope_x, tilt.slope_y) * film.y
                                         : std::abs(tilt.slope_x) * film.x + std::abs(tilt.slope_y) * film.y;
      result.push_back({film, ExcessRange(tilt, along).at(layer)});
    }
    return result;
  };
  FilmPupils pupils{.of_revolution = of_revolution, .layers = 5, .wavelengths = upright.wavelengths()};
  pupils.guesses = [&](FilmPupils::Points points, std::size_t w) {
    std::vector<pupil_detail::PupilGuess> guesses;
    for (const VirtualFilmPoint& point : virtual_points(points)) guesses.push_back(guess_of(upright, point, w));
    return guesses;
  };
  pupils.clearances = [&](FilmPupils::Points points, std::size_t w) -> pupil_detail::PositionClearances {
    return [&upright, w, from = virtual_points(points)](std::size_t count, const std::uint32_t* which, const double* x,
                                                        const double* y, double* clearances) {
      constexpr std::size_t block = 256;
      std::array<double, block> film_x, film_y;
      for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t size = std::min(block, count - begin);
        for (std::size_t i = 0; i < size; ++i) {
          const std::size_t k = begin + i;
          const FilmPoint film = from[which[k]].on_upright(x[k], y[k]);
          film_x[i] = film.x, film_y[i] = film.y;
        }
        upright.clearances(size, {film_x.data(), film_y.data(), x + begin, y + begin}, w, clearances + begin);
      }
    };
  };
  return film_polygons(pupils, tilt.radius, PolygonFit::enclosing, threads);
}

}  // namespace petzval::pupil_table_detail
