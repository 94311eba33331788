// SPDX-License-Identifier: Apache-2.0
#include "film_polygons.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/boundary_search.hpp"
#include "pupil/face.hpp"

namespace petzval::inline v0::pupil_table_detail {
namespace {

/// The pupils of some film points, by tracing their rays.
class FilmSide {
 public:
  FilmSide(const Lens& lens, const TwoPlanes& space, std::vector<FilmPoint> points)
      : lens_(lens), space_(space), points_(std::move(points)) {
    towards_ = towards_scene(lens, space);
  }

  std::vector<PupilRegion> pupils(std::size_t wavelength) {
    const bool symmetric = lens_.rotationally_symmetric();
    return pupil_detail::find_regions(
        guesses(wavelength), symmetric ? points_.size() : 1, region_directions, symmetric,
        [&](std::size_t count, const std::uint32_t* fields, const double* x, const double* y, std::uint8_t* passes) {
          test(wavelength, count, fields, x, y, passes);
        });
  }

 private:
  /// Rays pass the last surface: the pupil is no larger than what is seen through it.
  std::vector<pupil_detail::PupilGuess> guesses(std::size_t wavelength) const {
    const Pupils paraxial = petzval::pupils(lens_, wavelength);
    const std::size_t last = lens_.surface_count() - 1;
    const double last_z = lens_.surfaces()[last].vertex_z;
    const pupil_detail::Face face = pupil_detail::face_of(lens_, last, paraxial.entrance);
    const auto seen = [&](double film, double at, double z) {  // in the plane of the pupil
      return film + (at - film) * space_.depth() / (z - space_.film_z);
    };
    double radius = std::isfinite(paraxial.exit.z) && paraxial.exit.z != space_.film_z
                        ? std::abs(seen(0, paraxial.exit.diameter / 2, paraxial.exit.z))
                        : 0;
    const bool somewhere = radius > 0;
    if (!somewhere) radius = std::abs(seen(0, face.half, last_z)) / 8;
    const auto surfaces = lens_.surfaces();
    const bool ring = std::any_of(surfaces.begin(), surfaces.end(),
                                  [](const LensSurface& s) { return s.obscuration_semi_diameter > 0; });
    std::vector<pupil_detail::PupilGuess> result;
    for (const FilmPoint& p : points_) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const double z : {face.z_min, face.z_max, last_z}) {
        // A face that reaches to the film is met at any angle; one beyond the film counts as near it.
        const double least = 0.02 * std::abs(space_.film_z - last_z);
        const double from_film = z - space_.film_z;
        const double at = space_.film_z + std::copysign(std::max(std::abs(from_film), least), last_z - space_.film_z);
        for (const double edge : {-face.half, face.half}) {
          low = std::min(low, seen(p.y, edge, at));
          high = std::max(high, seen(p.y, edge, at));
        }
      }
      const double across = lens_.rotationally_symmetric() ? 0 : seen(p.x, 0, last_z), margin = 0.05 * (high - low);
      const double y = seen(p.y, 0, somewhere ? paraxial.exit.z : last_z);
      constexpr double radii = 16;
      result.push_back({across, low - margin, high + margin, radius, y, radii * radius, ring});
    }
    return result;
  }

  void test(std::size_t wavelength, std::size_t count, const std::uint32_t* fields, const double* x, const double* y,
            std::uint8_t* passes) {
    for (auto& a : memory_) a.resize(count);
    fates_.resize(count);
    const double depth = space_.depth();
    for (std::size_t i = 0; i < count; ++i) {
      const FilmPoint& film = points_[fields[i]];
      const double dx = x[i] - film.x, dy = y[i] - film.y;
      const double per_length = towards_ / std::sqrt(dx * dx + dy * dy + depth * depth);
      memory_[0][i] = x[i], memory_[1][i] = y[i], memory_[2][i] = space_.pupil_z;
      memory_[3][i] = dx * per_length, memory_[4][i] = dy * per_length, memory_[5][i] = depth * per_length;
    }
    const auto at = [&](std::size_t k) { return memory_[k].data(); };
    trace<double>(lens_, count, {at(0), at(1), at(2), at(3), at(4), at(5)}, {at(0), at(1), at(2), at(3), at(4), at(5)},
                  fates_.data(), nullptr, {.travel = Travel::to_scene, .wavelengths = {wavelength}});
    for (std::size_t i = 0; i < count; ++i) passes[i] = fates_[i] == RayFate::transmitted;
  }

  const Lens& lens_;
  TwoPlanes space_;
  std::vector<FilmPoint> points_;
  double towards_;
  std::array<std::vector<double>, 6> memory_;
  std::vector<RayFate> fates_;
};

}  // namespace

PupilsAt traced_pupils(const Lens& lens, const TwoPlanes& space, std::size_t wavelength) {
  return [&lens, space, wavelength](std::span<const double> heights) {
    std::vector<FilmPoint> points;
    for (const double height : heights) points.push_back({0, height});
    return FilmSide(lens, space, std::move(points)).pupils(wavelength);
  };
}

double lit_radius(double film_radius, const PupilsAt& pupils_at) {
  // The index of the last of some heights at which a pupil, of any row, has light; their number where none has.
  const auto last_lit = [&](const std::vector<double>& heights) {
    const std::vector<PupilRegion> pupils = pupils_at(heights);
    std::size_t last = heights.size();
    for (std::size_t i = 0; i < pupils.size(); ++i) {
      const std::size_t at = i % heights.size();
      if (!pupils[i].empty() && (last == heights.size() || at > last)) last = at;
    }
    return last;
  };
  if (last_lit({film_radius}) == 0) return film_radius;
  double low = 0, high = film_radius;
  for (int round = 0; round < 4; ++round) {
    constexpr int parts = 16;
    std::vector<double> heights;
    for (int i = 0; i < parts; ++i) heights.push_back(low + (high - low) * i / parts);
    const std::size_t at = last_lit(heights);
    if (at == heights.size()) return film_radius;
    low = heights[at];
    if (at + 1 < heights.size()) high = heights[at + 1];
  }
  return high;
}

std::vector<PupilPolygon> film_polygons(double film_radius, PolygonFit fit, const PupilsAt& pupils_at) {
  // Heights by half film_strips.
  std::vector<double> heights;
  for (std::size_t i = 0; i <= 2 * film_strips; ++i) {
    heights.push_back(film_radius * static_cast<double>(i) / (2 * film_strips));
  }
  const std::vector<PupilRegion> pupils = pupils_at(heights);
  const auto first_lit = [&](std::size_t height) -> const PupilRegion* {
    for (std::size_t i = height; i < pupils.size(); i += heights.size()) {
      if (!pupils[i].empty()) return &pupils[i];
    }
    return nullptr;
  };
  std::vector<PupilPolygon> polygons(film_strips + 1);
  for (std::size_t i = 0; i <= film_strips; ++i) {
    const std::size_t at = 2 * i;
    if (const PupilRegion* lit = first_lit(at)) {
      polygons[i] = polygon_of(*lit, fit);
      continue;
    }
    // The light ends within a strip: an enclosing pupil continues to its end, one of equal area shrinks to a point.
    for (const std::size_t beside : {at - 1, at + 1, at - 2, at + 2}) {
      const PupilRegion* lit = beside < heights.size() ? first_lit(beside) : nullptr;
      if (!lit) continue;
      polygons[i] = polygon_of(*lit, fit);
      if (fit == PolygonFit::equal_area) polygons[i].corners = {};
      break;
    }
  }
  if (fit == PolygonFit::equal_area) return polygons;
  std::vector<InterpolationCheck> checks;
  const auto check = [&](const PupilRegion& pupil, double strip) {
    const auto i = static_cast<std::size_t>(strip);
    const double t = strip - static_cast<double>(i);
    checks.push_back({&pupil, {{i, std::min(i + 1, film_strips), 0, 0}, {1 - t, t, 0, 0}}});
  };
  for (std::size_t j = 0; j < pupils.size(); ++j) check(pupils[j], static_cast<double>(j % heights.size()) / 2);
  // Where the light ends pupils shrink fast.
  std::vector<PupilRegion> shrinking;
  if (pupils.back().empty()) {
    constexpr std::size_t parts = 16;
    std::vector<double> last;
    for (std::size_t i = 1; i < parts; ++i) {
      last.push_back(film_radius * (1 - static_cast<double>(i) / (parts * film_strips)));
    }
    shrinking = pupils_at(last);
    for (std::size_t i = 0; i < shrinking.size(); ++i) {
      check(shrinking[i], static_cast<double>(film_strips) - static_cast<double>(i % last.size() + 1) / parts);
    }
  }
  expand_to_cover(polygons, checks);
  return polygons;
}

PupilPolygon polygon_for_all(const Lens& lens, const TwoPlanes& space, double film_radius, std::size_t wavelength) {
  const auto pupils_at = [&](double radius, int rings, int spokes) {
    std::vector<FilmPoint> points{{}};
    for (int ring = 1; ring <= rings; ++ring) {
      for (int spoke = 0; spoke < spokes; ++spoke) {
        const double angle = 2 * std::numbers::pi * spoke / spokes, r = radius * ring / rings;
        points.push_back({r * std::sin(angle), r * std::cos(angle)});
      }
    }
    return FilmSide(lens, space, std::move(points)).pupils(wavelength);
  };
  const auto lit_one = [](const PupilRegion& pupil) { return !pupil.empty(); };
  // The part of the film that gets any light, within an eighth of it.
  double lit = film_radius;
  for (int round = 0; round < 8; ++round) {
    constexpr int rings = 8, spokes = 8;
    const std::vector<PupilRegion> pupils = pupils_at(lit, rings, spokes);
    const auto last = std::find_if(pupils.rbegin(), pupils.rend(), lit_one);
    if (last == pupils.rend()) return {};
    const auto ring = (pupils.rend() - last - 1 + spokes - 1) / spokes;
    if (ring >= rings - 1) break;
    lit *= static_cast<double>(ring + 1) / rings;
  }
  const std::vector<PupilRegion> pupils = pupils_at(lit, 12, 24);
  PupilPolygon polygon = polygon_of(*std::find_if(pupils.begin(), pupils.end(), lit_one), PolygonFit::enclosing);
  // All pupils together are as symmetric as the lens: about the axis.
  for (auto& corner : polygon.corners) corner[0] += polygon.middle[0];
  polygon.middle[0] = 0;
  std::vector<InterpolationCheck> checks;
  for (const PupilRegion& pupil : pupils) checks.push_back({&pupil, {{0, 0, 0, 0}, {1, 0, 0, 0}}});
  expand_to_cover({&polygon, 1}, checks);
  constexpr double between_points = 1.02;
  for (auto& corner : polygon.corners) corner = {between_points * corner[0], between_points * corner[1]};
  polygon.obscured.fill(0);  // perhaps that of one point only
  return polygon;
}

std::vector<PupilPolygon> disc_polygons(std::span<const PupilDisc> discs, double film_radius) {
  std::vector<PupilPolygon> polygons;
  for (std::size_t i = 0; i <= film_strips; ++i) {
    const double height = film_radius * static_cast<double>(i) / film_strips;
    // All discs overlap where the one that ends first does.
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (const PupilDisc& disc : discs) {
      low = std::max(low, disc.shift * height - disc.radius);
      high = std::min(high, disc.shift * height + disc.radius);
    }
    PupilRegion overlap{.directions = region_directions};
    if (low < high) {
      overlap.middle = {0, (low + high) / 2};
      // The nearest of the places where a line from the middle leaves a disc.
      const auto leaves = [&](double x, double y) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const PupilDisc& disc : discs) {
          const double from_centre = overlap.middle[1] - disc.shift * height, square = x * x + y * y;
          const double b = y * from_centre, c = disc.radius * disc.radius - from_centre * from_centre;
          nearest = std::min(nearest, (std::sqrt(b * b + square * c) - b) / square);
        }
        return nearest;
      };
      overlap.half_axes = {leaves(1, 0), (high - low) / 2};
      for (std::size_t k = 0; k < overlap.directions; ++k) {
        const Vec2<double> p = overlap.unit(k);
        const double radius = leaves(overlap.half_axes[0] * p.x, overlap.half_axes[1] * p.y);
        const auto rim = overlap.at(k, radius);
        overlap.spans.push_back({k, 0, radius, {overlap.middle[0], overlap.middle[1]}, {rim[0], rim[1]}});
      }
    }
    polygons.push_back(polygon_of(overlap, PolygonFit::equal_area));
  }
  return polygons;
}

}  // namespace petzval::inline v0::pupil_table_detail
