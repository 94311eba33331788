// SPDX-License-Identifier: Apache-2.0
#include "film_cells.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "polygon_place.hpp"

namespace petzval::inline v0::pupil_table_detail {
namespace {

using L = CellLayout;

/// A number that is bilinear in a cell: by 1, t, s and st.
using Bilinear = std::array<double, 4>;

/// From the polygons at the corners of a cell: the first row's, then the second's.
using AtCorners = std::array<const PupilPolygon*, 4>;

template <class Number>
Bilinear bilinear(const AtCorners& at, const Number& number) {
  const double a = number(*at[0]), b = number(*at[1]), c = number(*at[2]), d = number(*at[3]);
  return {a, b - a, c - a, (d - c) - (b - a)};
}

/// Adds a multiple of the product of two such numbers: by 1, t, t^2, s, st, st^2, s^2, s^2 t, s^2 t^2.
void add_product(std::array<double, 9>& sum, double factor, const Bilinear& p, const Bilinear& q) noexcept {
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) sum[3 * (i / 2 + j / 2) + i % 2 + j % 2] += factor * p[i] * q[j];
  }
}

std::array<double, L::size> cell_between(const AtCorners& at) {
  std::array<double, L::size> cell;
  const auto put = [&](std::size_t place, const auto& numbers) {
    std::copy(numbers.begin(), numbers.end(), &cell[place]);
  };
  put(L::middle_x, bilinear(at, [](const PupilPolygon& p) { return p.middle.x; }));
  put(L::middle_y, bilinear(at, [](const PupilPolygon& p) { return p.middle.y; }));
  const auto corner = [&](std::size_t k, int i) {
    return bilinear(at, [k, i](const PupilPolygon& p) { return p.corners[k % polygon_corners][i]; });
  };
  std::array<double, 9> before{};
  for (std::size_t k = 0; k <= polygon_corners; ++k) {
    const Bilinear ax = corner(k, 0), ay = corner(k, 1), bx = corner(k + 1, 0), by = corner(k + 1, 1);
    const std::size_t sector = L::sectors + L::sector * k;
    put(sector, ax);
    put(sector + 4, ay);
    put(sector + 8, before);
    if (k == polygon_corners) break;
    add_product(before, 0.5, bx, ay);  // turn(a, b) / 2
    add_product(before, -0.5, ax, by);
  }
  put(L::whole, before);
  return cell;
}

}  // namespace

/// Where a film point stands in the table, and where it lies: the signs of its coordinates.
struct FilmCells::Place {
  const double* cell = nullptr;  // null: nowhere
  double t = 0, s = 0, row = 0;
  double sign_x = 1, sign_y = 1;

  InCell<double> polygon() const noexcept { return {cell, t, s}; }
  /// u in the quadrant of the table. Towards -y it is the share of the half at +x.
  template <class T>
  T share(const InCell<T>& polygon, double u) const noexcept {
    const double across = sign_x < 0 ? 1 - u : u;
    const T from = sign_y < 0 ? polygon.right_share() - across : T(across);
    return from < 0.0 ? T(from + 1.0) : from < 1.0 ? from : T(from - 1.0);
  }
};

FilmCells::FilmCells(const FilmGrid& grid, double film_radius, std::size_t primary)
    : grid_(grid), film_radius_(film_radius), primary_(primary) {
  for (const double width : grid.half_widths) half_widths_single_.push_back(static_cast<float>(width));
}

void FilmCells::add(const std::vector<PupilPolygon>& polygons) {
  ++wavelengths_;
  for (std::size_t i = 0; i < grid_.rows(); ++i) {
    for (std::size_t j = 0; j < grid_.columns; ++j) {
      const auto node = [&](std::size_t row, std::size_t column) {
        return &polygons[row * (grid_.columns + 1) + column];
      };
      const auto cell = cell_between({node(i, j), node(i, j + 1), node(i + 1, j), node(i + 1, j + 1)});
      twice_.insert(twice_.end(), cell.begin(), cell.end());
      for (const double value : cell) single_.push_back(static_cast<float>(value));
      constexpr int steps = 4;
      for (int place = 0; place < (steps + 1) * (steps + 1); ++place) {
        const double t = place % (steps + 1) / double{steps}, s = place / (steps + 1) / double{steps};
        corrections_ = std::max(corrections_, corrections_of(InCell<double>{cell.data(), t, s}));
      }
    }
  }
}

FilmCells::Place FilmCells::find(const FilmPoint& film, std::size_t wavelength) const noexcept {
  const double x = std::abs(film.x), y = std::abs(film.y);
  constexpr double end = 1 + 1e-6;  // as in the loops
  const CellTable<double> own = table<double>();
  const double row = y * own.rows_per_mm, rows = static_cast<double>(own.rows);
  if (!(x * x + y * y <= own.film_radius * own.film_radius) || !(row <= end * rows) || wavelength >= wavelengths_) {
    return {};
  }
  const std::size_t i = std::min(static_cast<std::size_t>(row), own.rows - 1);
  const double s = row - static_cast<double>(i);
  const double width = own.half_widths[i] + s * (own.half_widths[i + 1] - own.half_widths[i]);
  if (!(x <= end * width)) return {};
  const double column = x / (width > 0 ? width : 1) * static_cast<double>(own.columns);
  const std::size_t j = std::min(static_cast<std::size_t>(column), own.columns - 1);
  return {own.cells + ((wavelength * own.rows + i) * own.columns + j) * L::size,
          column - static_cast<double>(j),
          s,
          static_cast<double>(i),
          film.x < 0 ? -1.0 : 1.0,
          film.y < 0 ? -1.0 : 1.0};
}

template <class R>
CellTable<R> FilmCells::table() const noexcept {
  CellTable<R> result;
  if constexpr (sizeof(R) == sizeof(float)) {
    result.cells = single_.data();
    result.half_widths = half_widths_single_.data();
  } else {
    result.cells = twice_.data();
    result.half_widths = grid_.half_widths.data();
  }
  result.rows = grid_.rows();
  result.columns = grid_.columns;
  result.wavelengths = wavelengths_;
  result.primary = primary_;
  // The corner itself, rounded, still belongs to the film.
  result.film_radius = static_cast<R>(film_radius_ * (1 + 1e-6));
  constexpr double smallest = 1e-30;  // a lower film counts as one on the axis y = 0, so that this is finite
  result.rows_per_mm = static_cast<R>(grid_.height > smallest ? static_cast<double>(grid_.rows()) / grid_.height : 0);
  result.corrections = corrections_;
  return result;
}

void FilmCells::put(FilmPupilArrays& arrays) const {
  static_assert(L::size == FilmPupilArrays::cell_size && L::whole == 8 && L::sectors == 17 && L::sector == 17);
  arrays.kind = FilmPupilArrays::Kind::cells;
  arrays.pupils = single_;
  arrays.columns = grid_.columns;
  arrays.height = grid_.height;
  arrays.half_widths = half_widths_single_;
}

double FilmCells::area(const FilmPoint& film, std::size_t wavelength) const noexcept {
  const Place at = find(film, wavelength);
  return at.cell ? std::max(at.polygon().area_before(polygon_corners), 0.0) : 0;
}

Vec2<double> FilmCells::middle(const FilmPoint& film, std::size_t wavelength) const noexcept {
  const Place at = find(film, wavelength);
  if (!at.cell) return {0, 0};
  const Point<double> p = at.polygon().middle();
  return {at.sign_x * p.x, at.sign_y * p.y};
}

bool FilmCells::contains(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept {
  const Place at = find(film, wavelength);
  return at.cell && contains_place(at.polygon(), {at.sign_x * x, at.sign_y * y});
}

double FilmCells::clearance(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept {
  const Place at = find(film, wavelength);
  return at.cell ? clearance_of_place(at.polygon(), {at.sign_x * x, at.sign_y * y}) : -1;
}

FilmPupilTable::Derivatives FilmCells::derivatives(const FilmPoint& film, double u, double v,
                                                   std::size_t wavelength) const noexcept {
  using Jet = ceres::Jet<double, 2>;
  const Place at = find(film, wavelength);
  if (!at.cell || !(u - u == 0 && v - v == 0)) return {};
  if (!(at.polygon().area_before(polygon_corners) > 0)) return {};
  // s by y; t by x and, where the rows around have different widths, by s.
  const auto i = static_cast<std::size_t>(at.row);
  const double widening = grid_.half_widths[i + 1] - grid_.half_widths[i];
  Jet s(at.s), t(at.t);
  s.v[1] = at.sign_y * table<double>().rows_per_mm;
  const Jet width = grid_.half_widths[i] + s * widening;
  if (width.a > 0) {
    const Jet column = at.sign_x * Jet(film.x, 0) / width * static_cast<double>(grid_.columns);
    t.v = column.v;
  }
  const InCell<Jet> polygon{at.cell, t, s};
  const Jet share = at.share(polygon, std::clamp(u, 0.0, 1.0));
  const std::size_t k = sector_with(at.polygon(), share.a * at.polygon().area_before(polygon_corners));
  const Point<Jet> p = sample_place(polygon, k, share, std::clamp(v, 0.0, 1.0));
  const Jet x = at.sign_x * p.x, y = at.sign_y * p.y;
  return {{x.v[0], y.v[0]}, {x.v[1], y.v[1]}};
}

template CellTable<float> FilmCells::table() const noexcept;
template CellTable<double> FilmCells::table() const noexcept;

}  // namespace petzval::inline v0::pupil_table_detail
