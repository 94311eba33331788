// SPDX-License-Identifier: Apache-2.0
#include "film_polygons.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "face.hpp"
#include "petzval/paraxial/pupils.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0::pupil_detail {
namespace {

/// The rays of film points on the y axis at some heights, tested by tracing them.
class FilmSide {
 public:
  FilmSide(const Lens& lens, const TwoPlanes& space, std::vector<FilmPoint> points)
      : lens_(lens), space_(space), points_(std::move(points)) {
    towards_ = towards_scene(lens, space);
  }

  std::vector<PupilEdges> edges(std::size_t wavelength) {
    const bool symmetric = lens_.rotationally_symmetric();
    return find_edges(guesses(wavelength), symmetric ? points_.size() : 1, edge_directions, symmetric,
                      [&](std::size_t count, const std::uint32_t* fields, const double* x, const double* y,
                          std::uint8_t* passes) { test(wavelength, count, fields, x, y, passes); });
  }

 private:
  /// Rays have to get through the last surface; the pupil is no larger than what is seen through it.
  std::vector<PupilGuess> guesses(std::size_t wavelength) const {
    const Pupils paraxial = pupils(lens_, wavelength);
    const std::size_t last = lens_.surface_count() - 1;
    const double last_z = lens_.surfaces()[last].vertex_z;
    const Face face = face_of(lens_, last, paraxial.entrance);
    const auto seen = [&](double film, double at, double z) {  // in the plane of the pupil
      return film + (at - film) * space_.depth() / (z - space_.film_z);
    };
    double radius = std::isfinite(paraxial.exit.z) && paraxial.exit.z != space_.film_z
                        ? std::abs(seen(0, paraxial.exit.diameter / 2, paraxial.exit.z))
                        : 0;
    const bool somewhere = radius > 0;
    if (!somewhere) radius = std::abs(seen(0, face.half, last_z)) / 8;
    const auto surfaces = lens_.surfaces();
    const bool ring =
        std::any_of(surfaces.begin(), surfaces.end(), [](const LensSurface& s) { return s.inner_semi_diameter > 0; });
    std::vector<PupilGuess> result;
    for (const FilmPoint& p : points_) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const double z : {face.z_min, face.z_max, last_z}) {
        // What reaches to the film is met at any angle; what lies beyond counts as near it.
        const double gap = 0.02 * std::abs(space_.film_z - last_z);
        const double from_film = z - space_.film_z;
        const double at = space_.film_z + std::copysign(std::max(std::abs(from_film), gap), last_z - space_.film_z);
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

EdgesAt traced_edges(const Lens& lens, const TwoPlanes& space, std::size_t wavelength) {
  return [&lens, space, wavelength](std::span<const double> heights) {
    std::vector<FilmPoint> points;
    for (const double height : heights) points.push_back({0, height});
    return FilmSide(lens, space, std::move(points)).edges(wavelength);
  };
}

double lit_radius(double film_radius, const EdgesAt& edges_at) {
  // The last of some heights at which a pupil, of any row, has light; none: their number.
  const auto last_lit = [&](const std::vector<double>& heights) {
    const auto edges = edges_at(heights);
    std::size_t last = heights.size();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const std::size_t at = i % heights.size();
      if (!edges[i].empty() && (last == heights.size() || at > last)) last = at;
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

std::vector<PupilPolygon> film_polygons(double film_radius, bool covering, const EdgesAt& edges_at) {
  // Heights by half film_strips.
  std::vector<double> heights;
  for (std::size_t i = 0; i <= 2 * film_strips; ++i) {
    heights.push_back(film_radius * static_cast<double>(i) / (2 * film_strips));
  }
  const auto edges = edges_at(heights);
  const auto first_lit = [&](std::size_t height) -> const PupilEdges* {
    for (std::size_t i = height; i < edges.size(); i += heights.size()) {
      if (!edges[i].empty()) return &edges[i];
    }
    return nullptr;
  };
  std::vector<PupilPolygon> stars(film_strips + 1);
  for (std::size_t i = 0; i <= film_strips; ++i) {
    const std::size_t at = 2 * i;
    if (const PupilEdges* lit = first_lit(at)) {
      stars[i] = polygon_of(*lit, covering);
      continue;
    }
    // The film darkens within a strip: the last pupil goes on to its end, or, as one of no size, is where it ends.
    for (const std::size_t beside : {at - 1, at + 1, at - 2, at + 2}) {
      const PupilEdges* lit = beside < heights.size() ? first_lit(beside) : nullptr;
      if (!lit) continue;
      stars[i] = polygon_of(*lit, covering);
      if (!covering) stars[i].corners = {};
      break;
    }
  }
  if (!covering) return stars;
  std::vector<InterpolationCheck> between;
  const auto add = [&](const PupilEdges& e, double place) {
    const auto i = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(i);
    between.push_back({&e, {i, std::min(i + 1, film_strips), 0, 0}, {1 - t, t, 0, 0}});
  };
  for (std::size_t j = 0; j < edges.size(); ++j) add(edges[j], static_cast<double>(j % heights.size()) / 2);
  // Where the light ends pupils shrink fast.
  std::vector<PupilEdges> shrinking;
  if (edges.back().empty()) {
    constexpr std::size_t parts = 16;
    std::vector<double> last;
    for (std::size_t i = 1; i < parts; ++i) {
      last.push_back(film_radius * (1 - static_cast<double>(i) / (parts * film_strips)));
    }
    shrinking = edges_at(last);
    for (std::size_t i = 0; i < shrinking.size(); ++i) {
      add(shrinking[i], static_cast<double>(film_strips) - static_cast<double>(i % last.size() + 1) / parts);
    }
  }
  expand_to_cover(stars, between);
  return stars;
}

PupilPolygon star_for_all(const Lens& lens, const TwoPlanes& space, double film_radius, std::size_t wavelength) {
  const auto edges_at = [&](double radius, int rings, int spokes) {
    std::vector<FilmPoint> points{{}};
    for (int ring = 1; ring <= rings; ++ring) {
      for (int spoke = 0; spoke < spokes; ++spoke) {
        const double angle = 2 * std::numbers::pi * spoke / spokes, r = radius * ring / rings;
        points.push_back({r * std::sin(angle), r * std::cos(angle)});
      }
    }
    return FilmSide(lens, space, std::move(points)).edges(wavelength);
  };
  // What of the film is lit at all, within an eighth of it.
  double lit = film_radius;
  for (int round = 0; round < 8; ++round) {
    constexpr int rings = 8, spokes = 8;
    const auto edges = edges_at(lit, rings, spokes);
    const auto last = std::find_if(edges.rbegin(), edges.rend(), [](const PupilEdges& e) { return !e.empty(); });
    if (last == edges.rend()) return {};
    const auto ring = (edges.rend() - last - 1 + spokes - 1) / spokes;
    if (ring >= rings - 1) break;
    lit *= static_cast<double>(ring + 1) / rings;
  }
  const auto edges = edges_at(lit, 12, 24);
  const auto seed = std::find_if(edges.begin(), edges.end(), [](const PupilEdges& e) { return !e.empty(); });
  std::vector<PupilPolygon> stars{polygon_of(*seed, true)};
  // All pupils together are as symmetric as the lens: about the axis.
  for (auto& corner : stars[0].corners) corner[0] += stars[0].middle[0];
  stars[0].middle[0] = 0;
  std::vector<InterpolationCheck> all;
  for (const PupilEdges& e : edges) all.push_back({&e, {0, 0, 0, 0}, {1, 0, 0, 0}});
  expand_to_cover(stars, all);
  constexpr double between_points = 1.02;
  for (auto& corner : stars[0].corners) corner = {between_points * corner[0], between_points * corner[1]};
  for (double& gap : stars[0].gap) gap = 0;  // of one point, perhaps
  return stars.front();
}

std::vector<PupilPolygon> disc_stars(std::span<const PupilDisc> discs, double film_radius) {
  std::vector<PupilGuess> guesses;
  std::vector<double> heights;
  for (std::size_t i = 0; i <= film_strips; ++i) {
    const double height = film_radius * static_cast<double>(i) / film_strips;
    // All discs overlap where the one that ends first does.
    PupilGuess guess{.low = -std::numeric_limits<double>::infinity(), .high = std::numeric_limits<double>::infinity()};
    for (const PupilDisc& disc : discs) {
      guess.low = std::max(guess.low, disc.shift * height - disc.radius);
      guess.high = std::min(guess.high, disc.shift * height + disc.radius);
    }
    if (!(guess.low < guess.high)) guess.low = guess.high = 0;
    const double margin = 0.01 * (guess.high - guess.low);
    guess.low -= margin, guess.high += margin;
    guess.radius = (guess.high - guess.low) / 2;
    guesses.push_back(guess);
    heights.push_back(height);
  }
  const auto edges = find_edges(
      guesses, guesses.size(), edge_directions, true,
      [&](std::size_t count, const std::uint32_t* fields, const double* x, const double* y, std::uint8_t* passes) {
        for (std::size_t i = 0; i < count; ++i) {
          passes[i] = std::all_of(discs.begin(), discs.end(), [&](const PupilDisc& disc) {
            return std::hypot(x[i], y[i] - disc.shift * heights[fields[i]]) < disc.radius;
          });
        }
      });
  std::vector<PupilPolygon> stars;
  for (const PupilEdges& e : edges) stars.push_back(polygon_of(e, false));
  return stars;
}

}  // namespace petzval::inline v0::pupil_detail
