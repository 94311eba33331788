// SPDX-License-Identifier: Apache-2.0
#include "film_pupil_data.hpp"

namespace petzval {
namespace {

using namespace pupil_table_detail;
using L = StripLayout;

/// A strip from the polygons at its sides.
std::array<double, L::size> strip_between(const PupilPolygon& p, const PupilPolygon& q) {
  std::array<double, L::size> strip{};  // some are not used
  const auto put = [&](std::size_t at, const Point<double>& from, const Point<double>& change) {
    strip[at] = from.x, strip[at + 1] = from.y, strip[at + 2] = change.x, strip[at + 3] = change.y;
  };
  strip[L::middle_y] = p.middle[1], strip[L::middle_y + 1] = q.middle[1] - p.middle[1];
  std::array<double, 4> before{0, 0, 0, 0};
  for (std::size_t k = 0; k <= polygon_corners; ++k) {
    const Sector<double> from = p.sector(k % polygon_corners), to = q.sector(k % polygon_corners);
    const Point<double> a_change = to.a - from.a, b_change = to.b - from.b;
    put(L::sectors + L::sector * k, from.a, a_change);
    std::copy(before.begin(), before.end(), &strip[L::sectors + L::sector * k + 4]);
    if (k == polygon_corners) break;
    put(L::obscured + 4 * k, {from.obscured_from, from.obscured},
        {to.obscured_from - from.obscured_from, to.obscured - from.obscured});
    // Half of turn(a + t a', b + t b'), times what is not obscured.
    const double c[3] = {turn(from.a, from.b) / 2, (turn(from.a, b_change) + turn(a_change, from.b)) / 2,
                         turn(a_change, b_change) / 2};
    const double left = 1 - from.obscured, change = from.obscured - to.obscured;
    before[0] += c[0] * left;
    before[1] += c[1] * left + c[0] * change;
    before[2] += c[2] * left + c[1] * change;
    before[3] += c[2] * change;
  }
  std::copy(before.begin(), before.end(), &strip[L::whole]);
  return strip;
}

}  // namespace

void FilmPupilTable::Data::add(const std::vector<PupilPolygon>& polygons) {
  ++wavelengths;
  strips_each = polygons.size() - 1;
  strips_per_mm = steps_per_mm(strips_each, lit_radius);
  for (std::size_t i = 0; i < strips_each; ++i) {
    const PupilPolygon &a = polygons[i], &b = polygons[i + 1];
    const auto strip = strip_between(a, b);
    twice.insert(twice.end(), strip.begin(), strip.end());
    for (const double value : strip) single.push_back(static_cast<float>(value));
    for (std::size_t k = 0; k < polygon_corners; ++k) obscured = obscured || a.obscured[k] > 0 || b.obscured[k] > 0;
    for (int step = 0; step <= 8; ++step) {
      corrections = std::max(corrections, corrections_of(InStrip<double>{strip.data(), step / 8.0}));
    }
  }
}

PupilPolygon FilmPupilTable::Data::node(std::size_t wavelength, std::size_t i) const noexcept {
  const std::size_t strip = std::min(i, strips_each - 1);
  const InStrip<double> at{&twice[(wavelength * strips_each + strip) * L::size], static_cast<double>(i - strip)};
  PupilPolygon polygon;
  polygon.middle = {at.middle().x, at.middle().y};
  for (std::size_t k = 0; k < polygon_corners; ++k) polygon.corners[k] = {at.corner(k).x, at.corner(k).y};
  return polygon;
}

std::shared_ptr<FilmPupilTable::Data> FilmPupilTable::Data::alike() const {
  auto data = std::make_shared<Data>();
  data->space = space;
  data->film_radius = film_radius;
  data->lit_radius = images ? film_radius : lit_radius;
  data->primary = primary;
  data->compiled = compiled;
  return data;
}

}  // namespace petzval
