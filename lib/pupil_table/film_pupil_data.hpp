// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "bladed_polygons.hpp"
#include "core/quadrature.hpp"
#include "film_cells.hpp"
#include "film_pupil_table_loops.hpp"
#include "iris_images.hpp"
#include "lens/between_wavelengths.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "polygon_place.hpp"

namespace petzval {
namespace pupil_table_detail {

/// The projected solid angle of a pupil from uniform samples of it: place_at(u, v).
template <class PlaceAt>
double solid_angle(const TwoPlanes& space, const FilmPoint& film, double area, const PlaceAt& place_at) noexcept {
  constexpr int around = 16;
  static const auto outwards = core_detail::gauss_legendre<4>();
  const double depth2 = space.depth() * space.depth();
  double sum = 0;
  for (int k = 0; k < around; ++k) {
    for (const auto& [v, weight] : outwards) {
      const Vec2<double> place = place_at((k + 0.5) / around, v);
      const double dx = place.x - film.x, dy = place.y - film.y, length2 = dx * dx + dy * dy + depth2;
      sum += weight / (length2 * length2);
    }
  }
  return area * depth2 * sum / around;
}

}  // namespace pupil_table_detail

/// What a table holds: strips, cells or images of an iris.
struct FilmPupilTable::Data {
  TwoPlanes space;
  double film_radius = 0;
  std::size_t wavelengths = 0, primary = 0;
  lens_detail::CompiledWavelengths compiled;             // for samples by nm
  std::optional<pupil_table_detail::IrisImages> images;  // instead of strips
  // Instead of strips; of a bladed iris, strips are those of the round stop.
  std::optional<pupil_table_detail::FilmCells> cells;
  Iris iris;
  std::vector<std::vector<pupil_table_detail::StopMap>> maps;  // of a bladed iris, by wavelength
  double lit_radius = 0;                                       // to which the strips reach: beyond it is dark
  std::size_t strips_each = 0;
  double strips_per_mm = 0;
  bool obscured = false;
  int corrections = 0;
  std::vector<double> twice;  // strips by StripLayout
  std::vector<float> single;
  std::shared_ptr<const Data> whole;  // the pupils that a rim has cut; null: none has

  bool bladed() const noexcept { return cells && cells->bladed(); }

  /// The same film, planes and wavelengths, and no pupils yet.
  std::shared_ptr<Data> alike() const;
  /// Adds a wavelength.
  void add(const std::vector<pupil_table_detail::PupilPolygon>& polygons);

  template <class R>
  pupil_table_detail::StripTable<R> table() const noexcept {
    pupil_table_detail::StripTable<R> result;
    if constexpr (sizeof(R) == sizeof(float)) {
      result.strips = single.data();
    } else {
      result.strips = twice.data();
    }
    result.count = strips_each;
    result.wavelengths = wavelengths;
    result.primary = primary;
    // The corner itself, rounded, still belongs to the film.
    result.lit_radius = static_cast<R>(lit_radius * (1 + 1e-6));
    result.strips_per_mm = static_cast<R>(strips_per_mm);
    result.obscured = obscured;
    result.corrections = corrections;
    return result;
  }

  /// The polygon at the side of a strip, as add() took it, without obscurations.
  pupil_table_detail::PupilPolygon node(std::size_t wavelength, std::size_t i) const noexcept;

  /// Where a film point stands in the table.
  struct Place {
    const double* strip = nullptr;  // null: nowhere
    double t = 0, cosine = 1, sine = 0;

    pupil_table_detail::InStrip<double> polygon() const noexcept { return {strip, t}; }
  };
  /// That of the table to use; none has it for a wavelength that is not covered.
  std::size_t position(Wavelength at) const noexcept {
    const auto nm = at.in_nm();
    return !nm ? at.position(primary) : compiled.covers(*nm) ? compiled.nearest(*nm) : wavelengths;
  }
  /// Calls body(begin, count, positions) for parts of N rays whose wavelengths are in nm.
  template <class Body>
  void by_nearest(std::size_t count, const RayWavelengths& by_nm, const Body& body) const noexcept {
    if (!by_nm.each_nm) {
      body(0, count, RayWavelengths{position(by_nm.all)});
      return;
    }
    constexpr std::size_t block = 256;
    std::array<std::uint16_t, block> positions;
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t n = std::min(block, count - begin);
      pupil_table_detail::film_pupil_table().find_nearest(compiled.nearest_position(), n, by_nm.each_nm + begin,
                                                          positions.data());
      body(begin, n, RayWavelengths{.each = positions.data()});
    }
  }
  Place find(const FilmPoint& film, Wavelength at_wavelength) const noexcept {
    const std::size_t wavelength = position(at_wavelength);
    const double r2 = film.x * film.x + film.y * film.y, r = std::sqrt(r2);
    if (!(r <= lit_radius * (1 + 1e-6)) || wavelength >= wavelengths) return {};
    const double at = r * strips_per_mm;
    const std::size_t strip = std::min(static_cast<std::size_t>(at), strips_each - 1);
    const bool turn = r2 > pupil_table_detail::axis_r2<double>;
    return {&twice[(wavelength * strips_each + strip) * pupil_table_detail::StripLayout::size],
            at - static_cast<double>(strip), turn ? film.y / r : 1, turn ? film.x / r : 0};
  }
};

}  // namespace petzval
