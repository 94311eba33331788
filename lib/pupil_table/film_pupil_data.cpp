// SPDX-License-Identifier: Apache-2.0
#include "film_pupil_data.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;

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
  if (dimensions == 1) rows = polygons.size() - 1, height = reach;
  for (const PupilPolygon& p : polygons) {
    p.append_to(numbers);
    obscured = obscured || p.is_obscured();
  }
  numbers_single.insert(numbers_single.end(), numbers.begin() + static_cast<std::ptrdiff_t>(numbers_single.size()),
                        numbers.end());
}

FilmPoint FilmPupilTable::Data::node_point(std::size_t node) const noexcept {
  const std::size_t across = dimensions == 1 ? 1 : columns + 1, row = node / across, column = node % across;
  const double y = height * static_cast<double>(row) / static_cast<double>(rows);
  if (dimensions == 1) return {0, y};
  return {half_widths[row] * static_cast<double>(column) / static_cast<double>(columns), y};
}

PupilPolygon FilmPupilTable::Data::node(std::size_t wavelength, std::size_t node) const noexcept {
  return PupilPolygon::of(numbers.data() + (wavelength * nodes() + node) * NodeLayout::size);
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
