// SPDX-License-Identifier: Apache-2.0
#include "petzval/ghosts/ghosts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <string>

#include "area_raster.hpp"
#include "core/text.hpp"
#include "footprint.hpp"
#include "ghost_paths.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "starburst.hpp"

namespace petzval {
namespace ghosts_detail {

GhostPaths::GhostPaths(const Lens& lens, const ScenePoint& light, const GhostOptions& options) : entrance(lens, light) {
  const auto check = [&](bool valid, const char* name, double value, const char* rule) {
    if (!valid) throw Error(std::string("ghosts: ") + name + " = " + to_text(value) + "; must be " + rule);
  };
  check(options.film_reflectance >= 0 && options.film_reflectance <= 1, "film_reflectance", options.film_reflectance,
        "0 to 1");
  check(options.tolerance > 0, "tolerance", options.tolerance, "positive");
  check(options.threads >= 1, "threads", options.threads, "at least 1");

  const std::size_t count = lens.surface_count();
  const Surfaces surfaces(lens, options.wavelength, options.film_reflectance);
  std::vector<double> reflectances(count + 1);
  for (std::size_t i = 0; i <= count; ++i) reflectances[i] = surfaces.reflectance(i);
  std::vector<std::size_t> order;
  // A film that reflects nothing, and a surface without a change of the index, form no pairs at any angle.
  for (std::size_t i = 0; i <= count; ++i) {
    if (reflectances[i] > 0) order.push_back(i);
  }
  std::ranges::stable_sort(order, std::ranges::greater(), [&](std::size_t i) { return reflectances[i]; });
  const auto products = [&](std::size_t kept) {
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < kept; ++k) {
      sum += reflectances[order[k]], squares += reflectances[order[k]] * reflectances[order[k]];
    }
    return (sum * sum - squares) / 2;
  };
  std::size_t kept = order.size();
  // The time of a pair grows with the number of surfaces.
  constexpr std::size_t most_passages = 200'000;
  const std::size_t most = std::min(options.max_pairs, most_passages / std::max<std::size_t>(count, 1));
  while (kept > 1 && kept * (kept - 1) / 2 > most) --kept;
  left_out = order.size() * (order.size() - std::min<std::size_t>(order.size(), 1)) / 2 -
             (kept > 0 ? kept * (kept - 1) / 2 : 0);
  left_out_energy = left_out > 0 ? products(order.size()) - products(kept) : 0;
  order.resize(kept);
  std::ranges::sort(order);
  for (std::size_t b = 0; b < order.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) pairs.push_back({order[a], order[b]});
  }
  for (const auto& [first, second] : options.only) {
    if (first < second && second <= count) continue;
    throw Error("ghosts: only = (" + std::to_string(first) + ", " + std::to_string(second) +
                "); must be two surfaces in order, up to " + std::to_string(count));
  }
  if (!options.only.empty()) {
    std::erase_if(pairs, [&](const Pair& pair) {
      return std::ranges::find(options.only, std::array{pair.first, pair.second}) == options.only.end();
    });
  }
  entering = LightPath(lens, {{0, false}}).entering(entrance, entrance.box(), 256, options.wavelength);
  if (!(entering > 0)) {
    throw Error(lens.name() + ": light: no light enters surface 0; must be in front of the lens");
  }
}

LightPath path_of(const Lens& lens, const GhostPaths::Pair& pair) {
  return LightPath(lens, lens_detail::path_of_pair(lens, pair.first, pair.second));
}

namespace {

/// Most cells along a side of the region of a pair.
constexpr std::size_t most_cells = 256;
/// Rows of a picture that are drawn by one thread.
constexpr std::size_t band = 16;

/// Moments, peak and caustic of a footprint.
GhostPair measured(const GhostPaths::Pair& of, const Footprint& light, double entering) {
  GhostPair result{.first = of.first, .second = of.second, .energy = light.energy / entering};
  if (!(light.energy > 0)) return result;
  Vec2<double> mean{0, 0}, low{1e300, 1e300}, high{-1e300, -1e300};
  double square = 0;
  bool mirrored = false, upright = false;
  for (const Deposit& deposit : light.deposits) {
    const Box bounds = deposit.bounds();
    low = glm::min(low, bounds.low), high = glm::max(high, bounds.high);
    // Moments of triangles about the first corner.
    const std::span<const Vec2<double>> corners = deposit.polygon();
    const Vec2<double> origin = corners[0];
    double area = 0, squares = 0;
    Vec2<double> sum{0, 0};
    for (std::size_t k = 2; k < corners.size(); ++k) {
      const Vec2<double> a = corners[k - 1] - origin, b = corners[k] - origin;
      const double own = cross(a, b);
      area += own, sum += (a + b) * (own / 3);
      squares += (glm::dot(a, a) + glm::dot(a, b) + glm::dot(b, b)) * (own / 6);
    }
    if (area != 0) sum /= area, squares /= area;
    mean += (origin + sum) * deposit.energy;
    square += (glm::dot(origin, origin + 2.0 * sum) + squares) * deposit.energy;
    (deposit.mirrored ? mirrored : upright) |= deposit.energy > 0;
  }
  mean /= light.energy;
  result.centre = {mean.x, mean.y};
  result.rms_radius_mm = std::sqrt(std::max(square / light.energy - glm::dot(mean, mean), 0.0));
  result.caustic = mirrored && upright;

  constexpr std::size_t side = 64;
  const double width = std::max({high.x - low.x, high.y - low.y, side * 1e-3}), scale = side / width;
  const Vec2<double> corner = (low + high - Vec2<double>(width, width)) / 2.0;
  AreaRaster raster(side, side);
  for (const Deposit& deposit : light.deposits) {
    Deposit own = deposit;
    for (Vec2<double>& p : own.polygon()) p = (p - corner) * scale;
    raster.add(own.polygon(), own.energy, 0, side);
  }
  std::array<double, side> row;
  for (std::size_t k = 0; k < side; ++k) {
    raster.read(k, row);
    result.peak_per_mm2 = std::max(result.peak_per_mm2, *std::ranges::max_element(row) * scale * scale / entering);
  }
  return result;
}

/// A part of the entrance plane and a number of cells along its sides.
struct Cells {
  Box box;
  std::size_t count = 0;  ///< 0: no light reaches the frame
  double energy = 0;      ///< in the frame, estimated

  /// Adds the cells of another wavelength.
  void include(const Cells& other) {
    if (other.count == 0) return;
    box = count == 0 ? other.box : Box{glm::min(box.low, other.box.low), glm::max(box.high, other.box.high)};
    count = std::max(count, other.count), energy += other.energy;
  }
};

/// Cells with which the edges of deposits are wrong by at most 0.2 pixels, from a coarse footprint of a region.
Cells cells_for(const Footprint& coarse, const Box& region, std::size_t cells, double pixel_mm, const Box& frame) {
  Cells result{coarse.lit};
  for (const Deposit& deposit : coarse.deposits) {
    const auto [low, high] = deposit.bounds();
    const Vec2<double> size = high - low, seen = glm::min(high, frame.high) - glm::max(low, frame.low);
    if (seen.x < 0 || seen.y < 0) continue;
    result.energy += deposit.energy * (size.x > 0 ? seen.x / size.x : 1) * (size.y > 0 ? seen.y / size.y : 1);
  }
  if (!(result.energy > 0)) return result;
  const double tolerance_mm = 0.2 * pixel_mm;
  // A circle that is drawn with chords of length c is wrong by c^2 / (8 radius).
  const double by_edge = std::sqrt(static_cast<double>(cells) * coarse.cell_mm / (4 * tolerance_mm));
  // The mismatch of adjacent cells falls with the third power.
  const double by_mismatch = static_cast<double>(cells) * std::cbrt(coarse.mismatch_mm / tolerance_mm);
  const Vec2<double> part = (coarse.lit.high - coarse.lit.low) / (region.high - region.low);
  const double wanted = std::max({by_edge, by_mismatch, static_cast<double>(cells)}) * std::max(part.x, part.y);
  result.count = static_cast<std::size_t>(std::clamp(wanted, 16.0, static_cast<double>(most_cells)));
  return result;
}

/// Draws footprints on a film. Each deposit is drawn in bands of rows, by one thread at a time.
void draw(AreaRaster& raster, const Film& film, std::size_t count, int threads,
          const std::function<Footprint(std::size_t)>& footprint_of) {
  const auto rows = static_cast<std::size_t>(film.rows);
  std::vector<Footprint> footprints(count);
  std::vector<std::vector<std::vector<std::uint32_t>>> lists(count);  // deposits by band
  parallel_for(count, 1, threads, [&](std::size_t k, std::size_t) {
    footprints[k] = footprint_of(k);
    lists[k].resize((rows + band - 1) / band);
    for (std::uint32_t m = 0; m < footprints[k].deposits.size(); ++m) {
      Deposit& deposit = footprints[k].deposits[m];
      for (Vec2<double>& corner : deposit.polygon()) corner = film.raster({corner.x, corner.y});
      const Box bounds = deposit.bounds();
      // A narrow deposit is widened by less than a pixel.
      const double first = std::max(bounds.low.y - 1, 0.0),
                   last = std::min(bounds.high.y + 1, static_cast<double>(rows) - 0.5);
      if (!(first <= last)) continue;
      for (std::size_t b = static_cast<std::size_t>(first) / band; b <= static_cast<std::size_t>(last) / band; ++b) {
        lists[k][b].push_back(m);
      }
    }
  });
  parallel_for(rows, band, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = 0; k < count; ++k) {
      for (const std::uint32_t m : lists[k][first / band]) {
        const Deposit& deposit = footprints[k].deposits[m];
        raster.add(deposit.polygon(), deposit.energy, first, last);
      }
    }
  });
}

}  // namespace
}  // namespace ghosts_detail

using namespace ghosts_detail;

Ghosts ghost_pairs(const Lens& lens, const ScenePoint& light, const GhostOptions& options) {
  const GhostPaths paths(lens, light, options);
  const Surfaces surfaces(lens, options.wavelength, options.film_reflectance);
  Film film;
  film.z_mm = lens.film_z();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Box everywhere{{-infinity, -infinity}, {infinity, infinity}};
  Ghosts result{std::vector<GhostPair>(paths.pairs.size()), paths.entering, paths.left_out, paths.left_out_energy};
  parallel_for(paths.pairs.size(), 1, options.threads, [&](std::size_t k, std::size_t) {
    const LightPath path = path_of(lens, paths.pairs[k]);
    const Box box = path.region(paths.entrance, options.wavelength);
    if (options.model == GhostModel::paraxial) {
      const Footprint first_order = path.paraxial(paths.entrance, surfaces, options.wavelength, film);
      const Footprint exact = path.footprint(paths.entrance, box, 32, surfaces, options.wavelength, film, everywhere);
      result.pairs[k] = measured(paths.pairs[k], first_order, paths.entering);
      result.pairs[k].error =
          first_order.energy > 0 ? std::abs(first_order.energy - exact.energy) / first_order.energy : 0;
      return;
    }
    if (!(box.high.x > box.low.x)) return;
    const auto at = [&](std::size_t cells) {
      return path.footprint(paths.entrance, box, cells, surfaces, options.wavelength, film, everywhere);
    };
    Footprint coarse = at(16);
    double error = 0;
    for (std::size_t cells = 32; cells <= most_cells; cells *= 2) {
      Footprint fine = at(cells);
      // The error falls with the square of the spacing, or with the spacing where rays are totally reflected.
      error = fine.energy > 0 ? std::abs(fine.energy - coarse.energy) / fine.energy : 1;
      coarse = std::move(fine);
      if (error < options.tolerance) break;
    }
    result.pairs[k] = measured(paths.pairs[k], coarse, paths.entering);
    result.pairs[k].error = error + coarse.weight_error;
  });
  std::erase_if(result.pairs, [](const GhostPair& pair) { return !(pair.energy > 0); });
  std::ranges::stable_sort(result.pairs, std::ranges::greater(), &GhostPair::energy);
  return result;
}

void add_ghosts(const Lens& lens, const ScenePoint& light, const Film& film, std::span<const Wavelength> wavelengths,
                std::span<float> pictures, const GhostOptions& options) {
  const Film at = [&] {
    Film result = film;
    if (!result.z_mm) result.z_mm = lens.film_z();
    return result;
  }();
  if (!(at.columns > 0 && at.rows > 0 && at.width_mm > 0 && at.height_mm > 0)) {
    throw Error("add_ghosts: film: columns = " + std::to_string(at.columns) + ", rows = " + std::to_string(at.rows) +
                ", width_mm = " + to_text(at.width_mm) + ", height_mm = " + to_text(at.height_mm) +
                "; must be positive");
  }
  const auto columns = static_cast<std::size_t>(at.columns), rows = static_cast<std::size_t>(at.rows);
  if (pictures.size() != columns * rows * wavelengths.size()) {
    throw Error("add_ghosts: pictures: size = " + std::to_string(pictures.size()) + "; must be " +
                std::to_string(columns * rows * wavelengths.size()) + ", one number for each wavelength and pixel");
  }
  const Box frame{{at.shift_x_mm - at.width_mm / 2, at.shift_y_mm - at.height_mm / 2},
                  {at.shift_x_mm + at.width_mm / 2, at.shift_y_mm + at.height_mm / 2}};
  const double pixel_mm = std::min(at.width_mm / at.columns, at.height_mm / at.rows);
  if (wavelengths.empty()) return;
  const auto by_nm = [&](const Wavelength& w) {
    return w.in_nm() ? *w.in_nm() : lens.wavelengths_nm()[lens.wavelength_index(w)];
  };
  const auto [shortest, longest] = std::ranges::minmax(wavelengths, {}, by_nm);
  GhostOptions own = options;
  own.wavelength = shortest;
  const GhostPaths paths(lens, light, own);
  // The cells of each pair, from coarse footprints of the outer wavelengths.
  std::vector<Cells> cells(paths.pairs.size());
  std::vector<Wavelength> outer{shortest};
  if (by_nm(longest) > by_nm(shortest)) outer.push_back(longest);
  const bool exact = options.model == GhostModel::exact;
  for (const Wavelength& w : outer) {
    if (!exact) break;
    const Surfaces surfaces(lens, w, options.film_reflectance);
    parallel_for(cells.size(), 1, options.threads, [&](std::size_t k, std::size_t) {
      const LightPath path = path_of(lens, paths.pairs[k]);
      const Box box = path.region(paths.entrance, w);
      // Thin rings need finer cells to be seen at all.
      for (std::size_t coarse = 24; coarse <= most_cells && box.high.x > box.low.x; coarse *= 2) {
        const Footprint footprint = path.footprint(paths.entrance, box, coarse, surfaces, w, at, frame);
        cells[k].include(cells_for(footprint, box, coarse, pixel_mm, frame));
        if (footprint.cells > 0) break;
      }
    });
  }
  // Few cells suffice for pairs that spread their light far beyond the frame.
  double energy = 0;
  for (const Cells& c : cells) energy += c.energy;
  for (Cells& c : cells) {
    if (c.energy < 1e-4 * energy) c.count = std::min<std::size_t>(c.count, 48);
  }
  for (std::size_t w = 0; w < wavelengths.size(); ++w) {
    const Surfaces surfaces(lens, wavelengths[w], options.film_reflectance);
    AreaRaster raster(columns, rows);
    // Groups limit the memory; the order of deposits does not depend on threads. The starburst is a group of its own.
    constexpr std::size_t group = 64;
    for (std::size_t begin = 0; begin < paths.pairs.size(); begin += group) {
      draw(raster, at, std::min(group, paths.pairs.size() - begin), options.threads, [&](std::size_t k) {
        const LightPath path = path_of(lens, paths.pairs[begin + k]);
        if (!exact) return path.paraxial(paths.entrance, surfaces, wavelengths[w], at);
        const Cells& c = cells[begin + k];
        if (c.count == 0) return Footprint{};
        return path.footprint(paths.entrance, c.box, c.count, surfaces, wavelengths[w], at, frame);
      });
    }
    if (options.starburst) {
      draw(raster, at, 1, options.threads,
           [&](std::size_t) { return starburst(lens, paths.entrance, light, surfaces, wavelengths[w], at, frame); });
    }
    const double per_pixel = static_cast<double>(columns * rows) / at.area_mm2();
    parallel_for(rows, band, options.threads, [&](std::size_t first, std::size_t last) {
      std::vector<double> energies(columns);
      for (std::size_t row = first; row < last; ++row) {
        raster.read(row, energies);
        float* const to = pictures.data() + (w * rows + row) * columns;
        for (std::size_t k = 0; k < columns; ++k) to[k] += static_cast<float>(std::max(energies[k], 0.0) * per_pixel);
      }
    });
  }
}

}  // namespace petzval
