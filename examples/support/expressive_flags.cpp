// SPDX-License-Identifier: Apache-2.0
#include "expressive_flags.hpp"

#include <string_view>
#include <utility>

#include "petzval/core/error.hpp"

namespace examples {
namespace {

/// Splits "radius:power" or "x,y:offset" at a character.
std::pair<std::string_view, std::string_view> parts(const std::string& where, std::string_view text, char between,
                                                    const char* rule) {
  const std::size_t at = text.find(between);
  if (at == std::string_view::npos) {
    throw petzval::Error(where + " = \"" + std::string(text.substr(0, 60)) + "\"; must be " + rule);
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

}  // namespace

bool ExpressiveFlags::change_nothing() const noexcept {
  return power_spline.empty() && curvature_points.empty() && dispersion == 1 && from_lens == 0;
}

void add_expressive(App& app, ExpressiveFlags& flags) {
  app.add_option(
         "--power-spline", flags.power_spline,
         "refractive power of the pupil's rings, relative to the lens: a spline through radius:power, radii from 0 "
         "(axis) to 1 (rim), as 0:1 0.7:1.01 1:0.98")
      ->type_name("R:POWER");
  app.add_option("--curvature-points", flags.curvature_points,
                 "shift of film points away from the lens, all in mm: a surface through x,y:offset, as 0,0:0 18,12:0.3 "
                 "-18,12:0.3")
      ->type_name("X,Y:OFFSET");
  add_number(app, "--dispersion", flags.dispersion, {-1e6, 1e6, "a number from -1e6 to 1e6"},
             "factor of the lens's axial colour: 0 removes it, 1 keeps it");
  add_number(app, "--from-lens", flags.from_lens, {-1e6, 1e6, "a number from -1e6 to 1e6"},
             "factor of the real lens's spherical aberration and curvature of field to start from (1: unchanged); "
             "--power-spline and --curvature-points replace them");
}

petzval::ExpressiveLens expressive_of(const ExpressiveFlags& flags, const petzval::Lens& lens,
                                      const petzval::Film& film) {
  petzval::ExpressiveLens result;
  if (flags.from_lens != 0) {
    result = petzval::fit_expressive_lens(lens, film);
    for (petzval::PowerKnot& knot : result.power) knot.power = 1 + flags.from_lens * (knot.power - 1);
    for (petzval::FilmOffset& offset : result.film_offsets) offset.offset_mm *= flags.from_lens;
  }
  if (!flags.power_spline.empty()) result.power.clear();
  for (const std::string& text : flags.power_spline) {
    const std::string where = "--power-spline";
    const auto [radius, power] = parts(where, text, ':', "radius:power");
    result.power.push_back({parse_number(where, radius, finite_number), parse_number(where, power, finite_number)});
  }
  if (!flags.curvature_points.empty()) result.film_offsets.clear();
  for (const std::string& text : flags.curvature_points) {
    const std::string where = "--curvature-points";
    const auto [position_text, offset] = parts(where, text, ':', "x,y:offset");
    const auto [x, y] = parts(where, position_text, ',', "x,y:offset");
    result.film_offsets.push_back({{parse_number(where, x, finite_number), parse_number(where, y, finite_number)},
                                   parse_number(where, offset, finite_number)});
  }
  if (flags.dispersion != 1) result.dispersion = {flags.dispersion};
  return result;
}

}  // namespace examples
