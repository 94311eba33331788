// SPDX-License-Identifier: Apache-2.0
#include "film_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/dual.hpp"
#include "polygon_place.hpp"

namespace petzval::pupil_table_detail {
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

/// Adds the guide of BladedLayout: in the middle of the cell.
void add_guide(std::vector<double>& cell, std::size_t corners) {
  const InCell<double> polygon{cell.data(), 0.5, 0.5, corners, true};
  const double whole = polygon.area_before(polygon_corners);
  std::array<double, BladedLayout::guide_steps + 1> guide;
  for (std::size_t step = 0, k = 0; step <= BladedLayout::guide_steps; ++step) {
    const double wanted = whole * static_cast<double>(step) / BladedLayout::guide_steps;
    while (k + 1 < corners && polygon.area_before(k + 1) <= wanted) ++k;
    const double before = polygon.area_before(k), own = polygon.area_before(k + 1) - before;
    guide[step] = static_cast<double>(k) + (own > 0 ? std::clamp((wanted - before) / own, 0.0, 1.0) : 0);
  }
  cell.insert(cell.end(), guide.begin(), guide.end());
}

}  // namespace

/// Where a film point stands in the table, and where it lies: the signs of its coordinates, or its direction and fold.
struct FilmCells::Place {
  const double* cell = nullptr;  // null: nowhere
  double t = 0, s = 0, row = 0;
  double sign_x = 1, sign_y = 1;
  const double* fold = nullptr;  // of a bladed iris (BladedTable)
  double sine = 0, cosine = 1;
  std::size_t corners = polygon_corners;

  InCell<double> polygon() const noexcept { return {cell, t, s, corners, fold != nullptr}; }
  Vec2<double> middle() const noexcept {
    const Point<double> p = polygon().middle();
    return fold ? Vec2<double>{sine * p.y, cosine * p.y} : Vec2<double>{sign_x * p.x, sign_y * p.y};
  }
  /// A place of the plane, from the middle, as the table has it.
  Point<double> from_middle(double x, double y) const noexcept {
    const Vec2<double> own = middle();
    const double px = x - own.x, py = y - own.y;
    if (!fold) return {sign_x * px, sign_y * py};
    return {fold[0] * px + fold[2] * py, fold[1] * px + fold[3] * py};
  }
  /// Where u begins in the quadrant of the table, and which way it runs. Towards -y it is the share of the half at +x.
  template <class T>
  T first_share(const InCell<T>& polygon) const noexcept {
    if (fold) return polygon.area_before(static_cast<std::size_t>(fold[4])) / polygon.area_before(polygon_corners);
    const double across = sign_x < 0 ? 1 : 0;
    return sign_y < 0 ? polygon.right_share() - across : T(across);
  }
  double sense() const noexcept { return fold ? fold[5] : sign_x * sign_y; }
  template <class T>
  T share(const InCell<T>& polygon, double u) const noexcept {
    const T from = first_share(polygon) + sense() * u;
    return from < 0.0 ? T(from + 1.0) : from < 1.0 ? from : T(from - 1.0);
  }
};

FilmCells::FilmCells(const FilmGrid& grid, double film_radius, std::size_t primary)
    : grid_(grid), film_radius_(film_radius), primary_(primary), rows_(grid.rows()), columns_(grid.columns) {
  for (const double width : grid.half_widths) half_widths_single_.push_back(static_cast<float>(width));
}

FilmCells::FilmCells(const BladedGrid& grid, std::size_t primary)
    : film_radius_(grid.film_radius),
      primary_(primary),
      rows_(grid.rows),
      columns_(grid.columns),
      corners_(grid.corners),
      blades_(grid.iris.blades) {
  constexpr double full_turn = 2 * std::numbers::pi;
  const auto blades = static_cast<std::size_t>(grid.iris.blades);
  first_blade_ = grid.iris.rotation_rad / full_turn * blades_;
  first_blade_ -= blades_ * std::floor(first_blade_ / blades_);
  const std::size_t each = corners_ / blades;
  for (std::size_t blade = 0; blade < blades; ++blade) {
    const double angle = full_turn * static_cast<double>(blade) / blades_ - grid.iris.rotation_rad;
    for (const double sign : {1.0, -1.0}) {
      const std::size_t first = sign > 0 ? (blades - blade) % blades : blade;
      folds_.insert(folds_.end(), {sign * std::cos(angle), std::sin(angle), -sign * std::sin(angle), std::cos(angle),
                                   static_cast<double>(first * each), sign});
    }
  }
  for (const double value : folds_) folds_single_.push_back(static_cast<float>(value));
}

void FilmCells::add(const std::vector<PupilPolygon>& polygons) {
  ++wavelengths_;
  const std::size_t corners = bladed() ? corners_ : polygon_corners;
  for (std::size_t i = 0; i < rows_; ++i) {
    for (std::size_t j = 0; j < columns_; ++j) {
      const auto node = [&](std::size_t row, std::size_t column) { return &polygons[row * (columns_ + 1) + column]; };
      const auto numbers = cell_between({node(i, j), node(i, j + 1), node(i + 1, j), node(i + 1, j + 1)});
      std::vector<double> cell(numbers.begin(), numbers.end());
      if (bladed()) add_guide(cell, corners);
      twice_.insert(twice_.end(), cell.begin(), cell.end());
      for (const double value : cell) single_.push_back(static_cast<float>(value));
      constexpr int steps = 4;
      for (int place = 0; place < (steps + 1) * (steps + 1); ++place) {
        const double t = place % (steps + 1) / double{steps}, s = place / (steps + 1) / double{steps};
        corrections_ = std::max(corrections_, corrections_of(InCell<double>{cell.data(), t, s, corners, bladed()}));
      }
    }
  }
}

PupilPolygon FilmCells::node(std::size_t wavelength, std::size_t i) const noexcept {
  const std::size_t row = i / (columns_ + 1), column = i % (columns_ + 1);
  const std::size_t r = std::min(row, rows_ - 1), c = std::min(column, columns_ - 1);
  const std::size_t size = bladed() ? BladedLayout::size : L::size;
  const double* cell = twice_.data() + ((wavelength * rows_ + r) * columns_ + c) * size;
  const InCell<double> polygon{cell, static_cast<double>(column - c), static_cast<double>(row - r), corners_, bladed()};
  PupilPolygon result;
  result.middle = {polygon.middle().x, polygon.middle().y};
  for (std::size_t k = 0; k < polygon_corners; ++k) result.corners[k] = {polygon.corner(k).x, polygon.corner(k).y};
  return result;
}

FilmCells::Place FilmCells::find_bladed(const FilmPoint& film, std::size_t wavelength) const noexcept {
  const double r = std::hypot(film.x, film.y);
  const BladedTable<double> own = bladed_table<double>();
  if (!(r <= own.lit_radius)) return {};
  const bool off_axis = r * r > axis_r2<double>;
  const double sine = off_axis ? film.x / r : 0, cosine = off_axis ? film.y / r : 1, row = r * own.rows_per_mm;
  const std::size_t i = std::min(static_cast<std::size_t>(row), rows_ - 1);
  const double turn = blades_ * (turn_of(sine, cosine) + 1) + first_blade_;
  const auto nearest = static_cast<std::size_t>(turn + 0.5);
  const double beside = turn - static_cast<double>(nearest);
  const double column = 2 * std::abs(beside) * static_cast<double>(columns_);
  const std::size_t j = std::min(static_cast<std::size_t>(column), columns_ - 1);
  const std::size_t fold = 2 * (nearest % static_cast<std::size_t>(blades_)) + (beside < 0 ? 1 : 0);
  Place place;
  place.cell = own.cells + ((wavelength * rows_ + i) * columns_ + j) * BladedLayout::size;
  place.t = column - static_cast<double>(j), place.s = row - static_cast<double>(i);
  place.fold = own.folds + fold * BladedLayout::fold;
  place.sine = sine, place.cosine = cosine;
  place.corners = corners_;
  return place;
}

FilmCells::Place FilmCells::find(const FilmPoint& film, std::size_t wavelength) const noexcept {
  if (wavelength >= wavelengths_) return {};
  if (bladed()) return find_bladed(film, wavelength);
  const double x = std::abs(film.x), y = std::abs(film.y);
  constexpr double end = 1 + 1e-6;  // as in the loops
  const CellTable<double> own = table<double>();
  const double row = y * own.rows_per_mm, rows = static_cast<double>(own.rows);
  if (!(x * x + y * y <= own.film_radius * own.film_radius) || !(row <= end * rows)) return {};
  const std::size_t i = std::min(static_cast<std::size_t>(row), own.rows - 1);
  const double s = row - static_cast<double>(i);
  const double width = own.half_widths[i] + s * (own.half_widths[i + 1] - own.half_widths[i]);
  if (!(x <= end * width)) return {};
  const double column = x / (width > 0 ? width : 1) * static_cast<double>(own.columns);
  const std::size_t j = std::min(static_cast<std::size_t>(column), own.columns - 1);
  return {.cell = own.cells + ((wavelength * own.rows + i) * own.columns + j) * L::size,
          .t = column - static_cast<double>(j),
          .s = s,
          .row = static_cast<double>(i),
          .sign_x = film.x < 0 ? -1.0 : 1.0,
          .sign_y = film.y < 0 ? -1.0 : 1.0};
}

template <class R>
BladedTable<R> FilmCells::bladed_table() const noexcept {
  BladedTable<R> result;
  if constexpr (sizeof(R) == sizeof(float)) {
    result.cells = single_.data();
    result.folds = folds_single_.data();
  } else {
    result.cells = twice_.data();
    result.folds = folds_.data();
  }
  result.rows = rows_;
  result.columns = columns_;
  result.wavelengths = wavelengths_;
  result.primary = primary_;
  result.corners = corners_;
  result.blades = static_cast<R>(blades_);
  result.first_blade = static_cast<R>(first_blade_);
  result.lit_radius = static_cast<R>(film_radius_ * (1 + 1e-6));  // the corner itself, rounded
  result.rows_per_mm = static_cast<R>(steps_per_mm(rows_, film_radius_));
  result.corrections = corrections_;
  return result;
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
  result.rows_per_mm = static_cast<R>(steps_per_mm(grid_.rows(), grid_.height));
  result.corrections = corrections_;
  return result;
}

void FilmCells::put(FilmPupilArrays& arrays) const {
  static_assert(L::size == FilmPupilArrays::cell_size && L::whole == 8 && L::sectors == 17 && L::sector == 17);
  static_assert(BladedLayout::size == FilmPupilArrays::bladed_size);
  arrays.pupils = single_;
  arrays.columns = columns_;
  if (bladed()) {
    arrays.kind = FilmPupilArrays::Kind::bladed;
    arrays.rows = rows_;
    arrays.blades = folds_.size() / (2 * BladedLayout::fold);
    arrays.blade_corners = corners_;
    arrays.first_blade = first_blade_;
    return;
  }
  arrays.kind = FilmPupilArrays::Kind::cells;
  arrays.height = grid_.height;
  arrays.half_widths = half_widths_single_;
}

double FilmCells::area(const FilmPoint& film, std::size_t wavelength) const noexcept {
  const Place at = find(film, wavelength);
  return at.cell ? std::max(at.polygon().area_before(polygon_corners), 0.0) : 0;
}

Vec2<double> FilmCells::middle(const FilmPoint& film, std::size_t wavelength) const noexcept {
  const Place at = find(film, wavelength);
  return at.cell ? at.middle() : Vec2<double>{0, 0};
}

bool FilmCells::contains(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept {
  const Place at = find(film, wavelength);
  return at.cell && contains_place(at.polygon(), at.from_middle(x, y));
}

double FilmCells::clearance(const FilmPoint& film, double x, double y, std::size_t wavelength,
                            std::size_t& sector) const noexcept {
  const Place at = find(film, wavelength);
  return at.cell ? clearance_of_place(at.polygon(), at.from_middle(x, y), sector) : -1;
}

Vec2<double> FilmCells::position(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept {
  const Place at = find(film, wavelength);
  if (!at.cell) return {0, 2};
  const auto [share, v] = position_of_place(at.polygon(), at.from_middle(x, y));
  const double u = at.sense() * (share - at.first_share(at.polygon()));
  return {u - std::floor(u), v};
}

FilmPupilTable::Derivatives FilmCells::derivatives(const FilmPoint& film, double u, double v,
                                                   std::size_t wavelength) const noexcept {
  using kernel::Dual;
  const Place at = find(film, wavelength);
  if (!at.cell || !(u - u == 0 && v - v == 0)) return {};
  if (!(at.polygon().area_before(polygon_corners) > 0)) return {};
  if (bladed()) return bladed_derivatives(at, film, u, v);
  // s by y; t by x and, where the rows around have different widths, by s.
  const auto i = static_cast<std::size_t>(at.row);
  const double widening = grid_.half_widths[i + 1] - grid_.half_widths[i];
  Dual s(at.s), t(at.t);
  s.v[1] = at.sign_y * table<double>().rows_per_mm;
  const Dual width = grid_.half_widths[i] + s * widening;
  if (width.a > 0) {
    const Dual column = at.sign_x * Dual(film.x, 0) / width * static_cast<double>(grid_.columns);
    t.v = column.v;
  }
  const InCell<Dual> polygon{at.cell, t, s};
  const Dual share = at.share(polygon, std::clamp(u, 0.0, 1.0));
  const std::size_t k = sector_with(at.polygon(), share.a * at.polygon().area_before(polygon_corners));
  const Point<Dual> p = polygon.middle() + sample_place(polygon, k, share, std::clamp(v, 0.0, 1.0));
  const Dual x = at.sign_x * p.x, y = at.sign_y * p.y;
  return {{x.v[0], y.v[0]}, {x.v[1], y.v[1]}};
}

FilmPupilTable::Derivatives FilmCells::bladed_derivatives(const Place& at, const FilmPoint& film, double u,
                                                          double v) const noexcept {
  using kernel::Dual;
  const BladedTable<double> own = bladed_table<double>();
  // On the axis the directions around it meet: beside it is near enough.
  const double beside = 1e-4 * film_radius_;
  if (!(std::hypot(film.x, film.y) >= beside)) return {};
  const Dual x(film.x, 0), y(film.y, 1), r = sqrt(x * x + y * y), sine = x / r, cosine = y / r;
  Dual s = r * own.rows_per_mm, t = 2.0 * at.fold[5] * static_cast<double>(columns_) * blades_ * turn_of(sine, cosine);
  s.a = at.s, t.a = at.t;
  const InCell<Dual> polygon{at.cell, t, s, corners_, true};
  const Dual share = at.share(polygon, std::clamp(u, 0.0, 1.0));
  const std::size_t k = sector_with(at.polygon(), share.a * at.polygon().area_before(polygon_corners));
  const Point<Dual> p = sample_place(polygon, k, share, std::clamp(v, 0.0, 1.0));
  const Dual middle = polygon.middle().y;
  const Dual qx = sine * middle + at.fold[0] * p.x + at.fold[1] * p.y;
  const Dual qy = cosine * middle + at.fold[2] * p.x + at.fold[3] * p.y;
  return {{qx.v[0], qy.v[0]}, {qx.v[1], qy.v[1]}};
}

template BladedTable<float> FilmCells::bladed_table() const noexcept;
template BladedTable<double> FilmCells::bladed_table() const noexcept;
template CellTable<float> FilmCells::table() const noexcept;
template CellTable<double> FilmCells::table() const noexcept;

}  // namespace petzval::pupil_table_detail
