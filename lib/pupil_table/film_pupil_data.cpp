// SPDX-License-Identifier: Apache-2.0
#include "film_pupil_data.hpp"

#include "polygon_clearance.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;

/// The polygons at the corners of a cell: first row, then second row.
template <int dimensions>
using AtCorners = std::array<const PupilPolygon*, CellLayout<dimensions>::linear>;
template <int dimensions>
using Linear = std::array<double, CellLayout<dimensions>::linear>;
template <int dimensions>
using Area = std::array<double, CellLayout<dimensions>::area_terms>;

/// Adds the area of the triangle between the middle and two corners, minus the obscured fraction.
void add_sector(Area<1>& sum, const Linear<1>& ax, const Linear<1>& ay, const Linear<1>& bx, const Linear<1>& by,
                const Linear<1>& obscured) {
  const Point<double> a{ax[0], ay[0]}, a_change{ax[1], ay[1]}, b{bx[0], by[0]}, b_change{bx[1], by[1]};
  const double c[3] = {turn(a, b) / 2, (turn(a, b_change) + turn(a_change, b)) / 2, turn(a_change, b_change) / 2};
  const double left = 1 - obscured[0], change = -obscured[1];
  sum[0] += c[0] * left;
  sum[1] += c[1] * left + c[0] * change;
  sum[2] += c[2] * left + c[1] * change;
  sum[3] += c[2] * change;
}
void add_sector(Area<2>& sum, const Linear<2>& ax, const Linear<2>& ay, const Linear<2>& bx, const Linear<2>& by,
                const Linear<2>&) {
  const auto add_product = [&](double factor, const Linear<2>& p, const Linear<2>& q) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) sum[3 * (i / 2 + j / 2) + i % 2 + j % 2] += factor * p[i] * q[j];
    }
  };
  add_product(0.5, bx, ay);
  add_product(-0.5, ax, by);
}

template <int dimensions>
std::vector<double> cell_between(const AtCorners<dimensions>& at) {
  using L = CellLayout<dimensions>;
  std::vector<double> cell(L::size);
  const auto put = [&](std::int32_t sample, const auto& numbers) {
    std::copy(numbers.begin(), numbers.end(), cell.begin() + sample);
  };
  const auto of = [&](const auto& number) { return linear<dimensions>(at, number); };
  put(L::middle, of([](const PupilPolygon& p) { return p.middle.x; }));
  put(L::middle + L::linear, of([](const PupilPolygon& p) { return p.middle.y; }));
  const auto corner = [&](std::size_t k, int i) {
    return of([k, i](const PupilPolygon& p) { return p.corners[k % polygon_corners][i]; });
  };
  Area<dimensions> before{};
  for (std::size_t k = 0; k <= polygon_corners; ++k) {
    const auto ax = corner(k, 0), ay = corner(k, 1);
    const std::int32_t sector = L::sectors + L::sector * static_cast<std::int32_t>(k);
    put(sector, ax);
    put(sector + L::linear, ay);
    put(sector + L::area, before);
    if (k == polygon_corners) break;
    const auto obscured = of([k](const PupilPolygon& p) { return p.obscured[k]; });
    if constexpr (dimensions == 1) {
      const std::int32_t offset = L::obscured + 2 * L::linear * static_cast<std::int32_t>(k);
      put(offset, of([k](const PupilPolygon& p) { return p.obscured_from[k]; }));
      put(offset + L::linear, obscured);
    }
    add_sector(before, ax, ay, corner(k + 1, 0), corner(k + 1, 1), obscured);
  }
  put(L::total_area, before);
  return cell;
}

/// PolygonGrid::corrections of a cell.
template <int dimensions>
int corrections_in(const std::vector<double>& cell) {
  constexpr int steps = dimensions == 1 ? 8 : 4;
  int most = 0;
  for (int sample = 0; sample < (dimensions == 1 ? steps + 1 : (steps + 1) * (steps + 1)); ++sample) {
    const double t = sample % (steps + 1) / double{steps}, s = sample / (steps + 1) / double{steps};
    most = std::max(most, corrections_of(CellPolygon<dimensions, true, double, double>{cell.data(), 0, t, s}));
  }
  return most;
}

}  // namespace

void FilmPupilTable::Data::set(const FilmGrid& grid) {
  dimensions = 2;
  reach = film_radius;
  rows = grid.rows(), columns = grid.columns, height = grid.height;
  half_widths = grid.half_widths;
  half_widths_single.assign(half_widths.begin(), half_widths.end());
}

void FilmPupilTable::Data::add(const std::vector<PupilPolygon>& polygons) {
  ++wavelengths;
  const auto take = [this](const std::vector<double>& cell, int moves) {
    cells.insert(cells.end(), cell.begin(), cell.end());
    for (const double value : cell) cells_single.push_back(static_cast<float>(value));
    corrections = std::max(corrections, moves);
  };
  if (dimensions == 1) {
    rows = polygons.size() - 1;
    height = reach;
    for (const PupilPolygon& p : polygons) {
      obscured = obscured || std::any_of(p.obscured.begin(), p.obscured.end(), [](double width) { return width > 0; });
    }
    for (std::size_t i = 0; i < rows; ++i) {
      const auto cell = cell_between<1>({&polygons[i], &polygons[i + 1]});
      take(cell, corrections_in<1>(cell));
    }
    return;
  }
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      const PupilPolygon* first = &polygons[i * (columns + 1) + j];
      const auto cell = cell_between<2>({first, first + 1, first + columns + 1, first + columns + 2});
      take(cell, corrections_in<2>(cell));
    }
  }
}

FilmPoint FilmPupilTable::Data::node_point(std::size_t node) const noexcept {
  const std::size_t across = dimensions == 1 ? 1 : columns + 1, row = node / across, column = node % across;
  const double y = height * static_cast<double>(row) / static_cast<double>(rows);
  if (dimensions == 1) return {0, y};
  return {half_widths[row] * static_cast<double>(column) / static_cast<double>(columns), y};
}

PupilPolygon FilmPupilTable::Data::node(std::size_t wavelength, std::size_t node) const noexcept {
  const auto at = [&](const auto& polygon) {
    PupilPolygon result;
    result.middle = {polygon.middle().x, polygon.middle().y};
    for (std::size_t k = 0; k < polygon_corners; ++k) {
      const Point<double> corner = polygon.corner(static_cast<std::int32_t>(k));
      result.corners[k] = {corner.x, corner.y};
    }
    return result;
  };
  const std::size_t across = dimensions == 1 ? 1 : columns + 1, row = node / across, column = node % across;
  const std::size_t i = std::min(row, rows - 1), j = std::min(column, columns - 1);
  const double along = static_cast<double>(row - i), column_fraction = static_cast<double>(column - j);
  const auto begin = [&](std::int32_t size) {
    return static_cast<std::int32_t>((wavelength * rows + i) * columns + j) * size;
  };
  if (dimensions == 1) {
    return at(CellPolygon<1, false, double, double>{cells.data(), begin(CellLayout<1>::size), along, 0});
  }
  return at(CellPolygon<2, false, double, double>{cells.data(), begin(CellLayout<2>::size), column_fraction, along});
}

std::shared_ptr<FilmPupilTable::Data> FilmPupilTable::Data::without_pupils() const {
  auto data = std::make_shared<Data>();
  data->space = space;
  data->film_radius = film_radius;
  data->reach = images ? film_radius : reach;
  data->primary = primary;
  data->compiled = compiled;
  data->enclosing = enclosing;
  return data;
}

}  // namespace petzval
