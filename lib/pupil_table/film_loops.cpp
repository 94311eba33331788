// SPDX-License-Identifier: Apache-2.0
// Samples of the pupils of film points, compiled once for each instruction set.
#include "film_loops.hpp"

#include "core/lane_table.hpp"
#include "lens/look_up.hpp"
#include "pupil_kernel.hpp"

namespace petzval::pupil_table_detail {
namespace {

using core_detail::Lanes;
using core_detail::load;
using core_detail::Native;
using core_detail::store;

/// Rays that are evaluated together; sorting rays by their rule needs more than one register.
constexpr std::size_t bundle = 64;

/// Four numbers of each ray: film x, film y, then u and v or pupil x and y.
template <class V>
struct Line {
  V film_x, film_y, a, b;
};

/// Numbers of N rays, by number.
template <class R>
using Numbers = std::array<const R*, 4>;
template <class R>
PETZVAL_INLINE Line<Lanes<R>> line_at(const Numbers<R>& rays, std::size_t o) noexcept {
  return {load(rays[0] + o), load(rays[1] + o), load(rays[2] + o), load(rays[3] + o)};
}

/// Calls body(first, rays, n, numbers, outputs) for bundles of up to 64 of the N rays, from ray `first` on. n is the
/// number of rays up to a full register; rays after the last one hold zeros.
template <std::size_t outputs, class R, class Body>
void by_bundles(std::size_t count, const R* const (&lines)[4], R* const (&to)[outputs], const Body& body) noexcept {
  for (std::size_t o = 0; o < count; o += bundle) {
    const std::size_t rays = count - o < bundle ? count - o : bundle;
    Numbers<R> from;
    std::array<R*, outputs> out;
    for (std::size_t k = 0; k < 4; ++k) from[k] = lines[k] + o;
    for (std::size_t k = 0; k < outputs; ++k) out[k] = to[k] + o;
    if (rays == bundle) {
      body(o, rays, rays, from, out);
      continue;
    }
    alignas(64) R padded[4][bundle] = {}, results[outputs][bundle];
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < rays; ++i) padded[k][i] = from[k][i];
      from[k] = padded[k];
    }
    std::array<R*, outputs> local;
    for (std::size_t k = 0; k < outputs; ++k) local[k] = results[k];
    constexpr std::size_t width = Lanes<R>::width;
    body(o, rays, (rays + width - 1) / width * width, from, local);
    for (std::size_t k = 0; k < outputs; ++k) {
      for (std::size_t i = 0; i < rays; ++i) out[k][i] = results[k][i];
    }
  }
}

/// Rays of a bundle, and the first node of the wavelength of each, or -1.
template <class R>
struct Rays {
  using Bit = typename Native<R>::Bit;
  Numbers<R> numbers;
  const Bit* begins;

  template <class Grid>
  PETZVAL_INLINE CellOf<typename Grid::Chart, Lanes<R>> cell(const Grid& grid, std::size_t o) const noexcept {
    using V = Lanes<R>;
    using Table = kernel::Table<V>;
    const Line<V> line = line_at(numbers, o);
    Index<V> begin;
    __builtin_memcpy(&begin, begins + o, sizeof begin);
    const Index<V> covered = begin >= 0, known_begin = begin & covered;
    const Mask<V> sound = all_finite(line.film_x, line.film_y, line.a, line.b) & (Table::number(covered & 1) > V(0));
    return grid.chart.find(line.film_x, line.film_y, sound, known_begin);
  }
};

/// Calls body(n, rays, outputs) for bundles of the N rays.
template <std::size_t outputs, class Grid, class R, class Body>
void by_bundles(const Grid& grid, std::size_t count, const R* const (&lines)[4], const RayWavelengths& wavelengths,
                R* const (&to)[outputs], const Body& body) noexcept {
  using Bit = typename Native<R>::Bit;
  const auto begin_of = [&grid, nodes = grid.chart.nodes()](std::size_t w) {
    return w < static_cast<std::size_t>(grid.wavelengths) ? static_cast<Bit>(w) * nodes : Bit(-1);
  };
  alignas(64) Bit begins[bundle];
  const Bit shared = begin_of(wavelengths.all.index(static_cast<std::size_t>(grid.primary)));
  for (Bit& begin : begins) begin = shared;
  by_bundles(count, lines, to, [&](std::size_t first, std::size_t rays, std::size_t n, const auto& from, auto& out) {
    for (std::size_t i = 0; wavelengths.each && i < rays; ++i) begins[i] = begin_of(wavelengths.each[first + i]);
    body(n, Rays<R>{from, begins}, out);
  });
}

/// Computes outputs = rule(grid, cell, line) for N rays, or for more up to a full register.
template <std::size_t outputs, class Grid, class R, class Rule>
PETZVAL_INLINE void run(const Grid& grid, std::size_t count, const Rays<R>& rays, const std::array<R*, outputs>& to,
                        const Rule& rule) noexcept {
  for (std::size_t o = 0; o < count; o += Lanes<R>::width) {
    const auto result = rule(grid, rays.cell(grid, o), line_at(rays.numbers, o));
    for (std::size_t k = 0; k < outputs; ++k) store(to[k] + o, result[k]);
  }
}

/// Evaluates a function of rays and cells.
template <std::size_t outputs, class Grid, class R, class Rule>
void evaluate(const Grid& given, std::size_t count, const R* const (&lines)[4], const RayWavelengths& wavelengths,
              R* const (&to)[outputs], const Rule& rule) noexcept {
  const Grid grid = given;  // a copy that no output can alias
  by_bundles(grid, count, lines, wavelengths, to,
             [&](std::size_t n, const Rays<R>& rays, const auto& out) { run(grid, n, rays, out, rule); });
}

/// Evaluates `iris` for the rays whose cells sample the iris and `polygon` for the others. In bundles with both, rays
/// are sorted, so that each is evaluated by one rule.
template <std::size_t outputs, class Grid, class R, class Polygon, class Iris>
void evaluate_by_rule(const Grid& given, std::size_t count, const R* const (&lines)[4],
                      const RayWavelengths& wavelengths, R* const (&to)[outputs], const Polygon& polygon,
                      const Iris& iris) noexcept {
  using V = Lanes<R>;
  const Grid grid = given;
  by_bundles(grid, count, lines, wavelengths, to, [&](std::size_t n, Rays<R> rays, auto out) {
    alignas(64) R of_iris[bundle];
    run(grid, n, rays, std::array<R*, 1>{of_iris},
        [](const Grid& own, const auto& cell, const auto&) { return std::array<V, 1>{samples_iris<V>(own, cell)}; });
    std::size_t by_iris = 0;
    for (std::size_t i = 0; i < n; ++i) by_iris += of_iris[i] > R(0) ? 1 : 0;
    const std::size_t by_polygon = n - by_iris;
    if (by_iris == 0 || by_polygon == 0) {
      run(grid, by_polygon, rays, out, polygon);
      run(grid, by_iris, rays, out, iris);
      return;
    }
    // The rays of the polygon first, then, in a new register, the rays of the iris.
    constexpr std::size_t width = V::width, room = bundle + width;
    const std::size_t first_of_iris = (by_polygon + width - 1) / width * width;
    alignas(64) R sorted[4][room] = {}, results[outputs][room];
    alignas(64) typename Native<R>::Bit begins[room] = {};
    std::array<std::size_t, bundle> place;
    for (std::size_t i = 0, p = 0, q = first_of_iris; i < n; ++i) {
      place[i] = of_iris[i] > R(0) ? q++ : p++;
      for (std::size_t k = 0; k < 4; ++k) sorted[k][place[i]] = rays.numbers[k][i];
      begins[place[i]] = rays.begins[i];
    }
    const auto from = [&](std::size_t o) {
      return Rays<R>{{sorted[0] + o, sorted[1] + o, sorted[2] + o, sorted[3] + o}, begins + o};
    };
    const auto into = [&](std::size_t o) {
      std::array<R*, outputs> own;
      for (std::size_t k = 0; k < outputs; ++k) own[k] = results[k] + o;
      return own;
    };
    run(grid, by_polygon, from(0), into(0), polygon);
    run(grid, by_iris, from(first_of_iris), into(first_of_iris), iris);
    for (std::size_t k = 0; k < outputs; ++k) {
      for (std::size_t i = 0; i < n; ++i) out[k][i] = results[k][place[i]];
    }
  });
}

/// Evaluates `polygon`, or `iris` for the rays whose cells sample the iris.
/// @param polygon called with the kind of the grid, as in with_kind()
template <std::size_t outputs, class Grid, class R, class Polygon, class Iris>
void evaluate_kind(const Grid& grid, std::size_t count, const R* const (&lines)[4], const RayWavelengths& wavelengths,
                   R* const (&to)[outputs], const Polygon& polygon, const Iris& iris) noexcept {
  with_kind(grid, [&](auto obscured, auto stopped) {
    const auto own = [&](const Grid& same, const auto& cell, const Line<Lanes<R>>& line) {
      return polygon(same, cell, line, obscured, stopped);
    };
    if constexpr (stopped.value) {
      evaluate_by_rule(grid, count, lines, wavelengths, to, own, iris);
    } else {
      evaluate(grid, count, lines, wavelengths, to, own);
    }
  });
}

template <class V>
PETZVAL_INLINE std::array<V, 3> numbers(const PupilPoint<V>& p) noexcept {
  return {p.x, p.y, p.area};
}

template <class Grid, class R>
void sample(const Grid& grid, std::size_t count, const R* const (&lines)[4], const RayWavelengths& wavelengths,
            R* const (&to)[3]) noexcept {
  using V = Lanes<R>;
  using Cell = CellOf<typename Grid::Chart, V>;
  evaluate_kind(
      grid, count, lines, wavelengths, to,
      [](const Grid& own, const Cell& cell, const Line<V>& line, auto obscured, auto stopped) {
        return numbers(in_polygon<obscured.value, stopped.value, V>(own, cell, line.a, line.b));
      },
      [](const Grid& own, const Cell& cell, const Line<V>& line) {
        return numbers(in_iris<V>(own, cell, line.a, line.b));
      });
}

template <class Grid, class R>
void areas(const Grid& grid, std::size_t count, const R* const (&lines)[4], const RayWavelengths& wavelengths,
           R* const (&to)[1]) noexcept {
  using V = Lanes<R>;
  using Cell = CellOf<typename Grid::Chart, V>;
  evaluate_kind(
      grid, count, lines, wavelengths, to,
      [](const Grid& own, const Cell& cell, const Line<V>& line, auto obscured, auto stopped) {
        return std::array<V, 1>{locate<obscured.value, stopped.value, V>(own, cell, {line.a, line.b}).area};
      },
      [](const Grid& own, const Cell& cell, const Line<V>& line) {
        return std::array<V, 1>{area_in_iris<V>(own, cell, {line.a, line.b})};
      });
}

template <class Grid, class R>
void stop_points(const Grid& grid, std::size_t count, const R* const (&lines)[4], const RayWavelengths& wavelengths,
                 R* const (&to)[2]) noexcept {
  using V = Lanes<R>;
  using Cell = CellOf<typename Grid::Chart, V>;
  evaluate(grid, count, lines, wavelengths, to, [](const Grid& own, const Cell& cell, const Line<V>& line) {
    const auto stop = stop_at<V>(own, cell);
    const PupilPoint<V> p = stop_point<V>(own, cell, stop, {line.a, line.b});
    return std::array<V, 2>{stop.scale() * p.x, stop.scale() * p.y};
  });
}

/// Evaluates a function of rays and images: outputs = rule(table, image of the wavelength, line).
template <std::size_t outputs, class R, class Rule>
void evaluate_images(const IrisImageTable<R>& given, std::size_t count, const R* const (&lines)[4],
                     const RayWavelengths& wavelengths, R* const (&to)[outputs], const Rule& rule) noexcept {
  using V = Lanes<R>;
  const IrisImageTable<R> table = given;
  const auto& all = table.image;
  const ImageSections<V> shared{V(all.shift_x), V(all.shift_y), V(all.radius_x), V(all.radius_y), V(all.area)};
  const std::size_t y = table.equal_sections ? 0 : 2;
  by_bundles(count, lines, to, [&](std::size_t first, std::size_t rays, std::size_t n, const auto& from, auto& out) {
    R seen[4][bundle];
    if (!wavelengths.shared()) lens_detail::look_up(table.images, wavelengths, first, rays, seen, y + 2);
    for (std::size_t o = 0; o < n; o += V::width) {
      const auto own = [&] {
        const V radius_x = load(seen[1] + o), radius_y = load(seen[y + 1] + o);
        return ImageSections<V>{load(seen[0] + o), load(seen[y] + o), radius_x, radius_y,
                                V(table.area) * (radius_x * radius_y)};
      };
      const auto result = rule(table, wavelengths.shared() ? shared : own(), line_at(from, o));
      for (std::size_t k = 0; k < outputs; ++k) store(out[k] + o, result[k]);
    }
  });
}

template <class R>
void sample_images(const IrisImageTable<R>& table, std::size_t count, const R* const (&lines)[4],
                   const RayWavelengths& wavelengths, R* const (&to)[3]) noexcept {
  using V = Lanes<R>;
  evaluate_images(table, count, lines, wavelengths, to,
                  [](const auto& own, const ImageSections<V>& image, const Line<V>& line) {
                    return numbers(in_image(own, image, line.film_x, line.film_y, line.a, line.b));
                  });
}

template <class R>
void areas_in_images(const IrisImageTable<R>& table, std::size_t count, const R* const (&lines)[4],
                     const RayWavelengths& wavelengths, R* const (&to)[1]) noexcept {
  using V = Lanes<R>;
  evaluate_images(table, count, lines, wavelengths, to,
                  [](const auto& own, const ImageSections<V>& image, const Line<V>& line) {
                    return std::array<V, 1>{area_in_image(own, image, line.film_x, line.film_y, line.a, line.b)};
                  });
}

PupilSample image_sample(const IrisImageTable<double>& table, const ImageSections<double>& image, double film_x,
                         double film_y, double u, double v) noexcept {
  const auto [x, y, area] = in_image(table, image, film_x, film_y, u, v);
  return {x, y, area};
}

template <class Grid>
constexpr FilmLoopsOf<Grid> of{sample<Grid>, areas<Grid>, stop_points<Grid>};
template <class R>
constexpr FilmLoopsOf<IrisImageTable<R>> of_images{sample_images<R>, areas_in_images<R>, nullptr};

}  // namespace

const FilmLoops PETZVAL_LOOPS{{of<PupilGrid<FilmRadius<float>, float>>, of<PupilGrid<FilmRadius<double>, double>>,
                               of<PupilGrid<FilmQuadrant<float>, float>>, of<PupilGrid<FilmQuadrant<double>, double>>,
                               of_images<float>, of_images<double>},
                              image_sample,
                              lens_detail::find_nearest};

}  // namespace petzval::pupil_table_detail
