// SPDX-License-Identifier: Apache-2.0
#include "figure_elements.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval::figure_detail {
namespace {

/// Approximate width of text, px, to place the next text.
double width_of(std::string_view text) { return 6.4 * static_cast<double>(text.size()); }

/// Approximate x of the end of a key from x.
double key_end(double x, std::string_view words) { return x + 23 + width_of(words); }

/// Calls place(x, distance below the first row, key) for each key.
template <class Place>
void for_keys(double x, double right, std::span<const Key> keys, Place place) {
  double at = x, below = 0;
  for (const Key& key : keys) {
    if (at > x && key_end(at, key.words) > right) at = x, below += key_row;
    place(at, below, key);
    at = 24 + key_end(at, key.words);
  }
}

std::string focal_length_text(const Lens& lens, std::size_t wavelength) {
  const auto in = [&](Meridian meridian) {
    const FirstOrder data = first_order(lens, wavelength, meridian);
    return data.afocal ? std::string("infinite") : length_text(data.effective_focal_length);
  };
  return with_iris(lens, {}).rotationally_symmetric()
             ? "EFL " + in(Meridian::y)
             : "EFL " + in(Meridian::y) + " in y, " + in(Meridian::x) + " in x";
}

}  // namespace

double round_length(double x) {
  const double power = std::pow(10, std::floor(std::log10(x)));
  return power * (x >= 5 * power ? 5 : x >= 2 * power ? 2 : 1);
}

double round_range(double largest, double least) {
  const double wanted = std::max(largest, least), ten = std::pow(10, std::floor(std::log10(wanted)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * ten >= wanted) return step * ten;
  }
  return 10 * ten;
}

std::string curve_style(std::string_view colour, std::string_view more) {
  return "fill=\"none\" stroke-width=\"1.6\" stroke-linejoin=\"round\" stroke=\"" + std::string(colour) + "\" " +
         std::string(more);
}

std::string error_text(std::span<const MtfPoint> points) {
  double error = 0;
  for (const MtfPoint& point : points) error = std::max(error, point.sampling_error);
  return to_text(std::ceil(error * 1e4) * 1e-4, 2);
}

std::string sampling_error_text(std::span<const MtfPoint> points) {
  return "Sampling error " + error_text(points) + " (from quarters of the rays)";
}

std::string length_text(double mm) {
  const double size = std::abs(mm);
  if (size >= 9999.5) return to_text(mm * 1e-3, 4) + " m";  // telescopes
  if (size >= 0.9995 || size == 0) return to_text(mm, 4) + " mm";
  return to_text(std::round(mm * 1e6) * 1e-3, 3) + " \u00b5m";  // rounding, below a nanometre
}

std::string field_text(double field_rad) { return to_text(degrees(field_rad), 4) + "\u00b0"; }

std::string_view field_colour(std::size_t field) {
  constexpr std::array<std::string_view, 7> palette{"#1f5fc4", "#1a8f3c", "#d0331f", "#b97a00",
                                                    "#7b3fb5", "#00858f", "#8a4b2a"};
  return palette[field % palette.size()];
}

std::vector<Look> looks(std::span<const double> wavelengths_nm) {
  constexpr std::array<std::string_view, 7> palette{"#7b3fb5", "#2459c9", "#00808a", "#1b8a3a",
                                                    "#b06f00", "#d03020", "#7a1f1f"};
  const std::size_t count = wavelengths_nm.size();
  const std::size_t first = count <= 3 ? 1 : 0, last = count <= 3 ? 5 : 6;
  std::vector<Look> result;
  for (const double nm : wavelengths_nm) {
    const auto rank = static_cast<std::size_t>(
        std::count_if(wavelengths_nm.begin(), wavelengths_nm.end(), [nm](double other) { return other < nm; }));
    const std::size_t step = count == 1 ? 0 : (2 * rank * (last - first) + count - 1) / (2 * (count - 1));
    result.push_back({palette[first + step], rank});
  }
  return result;
}

std::string glass_colour(double index) {
  const double t = std::clamp((index - 1.4) / 0.55, 0.0, 1.0);
  const auto mixed = [t](double pale, double deep) { return std::to_string(std::lround(pale + t * (deep - pale))); };
  return "rgb(" + mixed(232, 152) + "," + mixed(243, 190) + "," + mixed(251, 224) + ")";
}

void draw_head(Svg& svg, const Lens& lens, std::string_view kind, double subject_z, std::size_t wavelength) {
  svg.text(sheet_margin, 26, lens.name(), "font-size=\"17\" font-weight=\"bold\"");
  const double f_number = has_pupils(lens) ? real_f_number(lens, wavelength) : 0;
  svg.text(sheet_margin, 46,
           std::string(kind) + ".  " + focal_length_text(lens, wavelength) +
               (f_number > 0 && std::isfinite(f_number) ? ",  f/" + to_text(f_number, 3) : "") + ",  subject at " +
               (std::isinf(subject_z) ? "infinity" : "z = " + to_text(subject_z, 6) + " mm") + ",  film at z = " +
               to_text(lens.film_z(), 6) + " mm,  " + to_text(lens.wavelengths_nm()[wavelength], 6) + " nm");
}

std::vector<double> checked_weights(std::string_view where, const Lens& lens, std::span<const double> weights) {
  const std::size_t count = lens.wavelengths_nm().size();
  if (weights.empty()) return std::vector<double>(count, 1);
  double sum = 0;
  for (const double weight : weights) {
    if (!(weight >= 0 && std::isfinite(weight))) {
      throw Error(std::string(where) + ": wavelength weight = " + to_text(weight) + "; must be finite, 0 or more");
    }
    sum += weight;
  }
  if (weights.size() != count || !(sum > 0)) {
    throw Error(std::string(where) + ": " + std::to_string(weights.size()) + " wavelength weights of sum " +
                to_text(sum) + "; must be " + std::to_string(count) + ", one per compiled wavelength, not all 0");
  }
  return {weights.begin(), weights.end()};
}

std::string weights_text(std::span<const double> weights) {
  if (std::ranges::all_of(weights, [&](double w) { return w == weights.front(); })) return "equal weight";
  std::string text;
  for (const double weight : weights) text += (text.empty() ? "weights " : ", ") + to_text(weight, 3);
  return text;
}

RayBundle weighted(RayBundle bundle, double weight) {
  if (weight == 0) bundle.x.clear(), bundle.y.clear();  // the largest radius ignores weights
  bundle.weights.assign(bundle.x.size(), weight);
  return bundle;
}

double draw_scale_bar(Svg& svg, double x, double y, double px_per_mm, double longest, std::string_view remark) {
  const double length = round_length(longest / px_per_mm), right = x + length * px_per_mm;
  svg.path("M" + svg_number(x) + " " + svg_number(y - 3) + "v6m0-3H" + svg_number(right) + "m0-3v6",
           "fill=\"none\" stroke=\"#222\" stroke-width=\"1.2\"");
  const std::string words = (length < 1000 ? length_text(length) : to_text(length * 1e-3) + " m") + std::string(remark);
  svg.text(right + 8, y + 4, words);
  return right + 8 + width_of(words);
}

std::string ray_marker(std::size_t kind, double x, double y) {
  const auto at = [](double px, double py) { return "M" + svg_number(px) + " " + svg_number(py); };
  switch (kind % 5) {
    case 0: return at(x - 2, y) + "h4" + at(x, y - 2) + "v4";
    case 1: return at(x - 1.5, y - 1.5) + "l3 3" + at(x - 1.5, y + 1.5) + "l3-3";
    case 2: return at(x - 1.5, y - 1.5) + "h3v3h-3z";
    case 3: return at(x, y - 2) + "l1.8 3.2h-3.6z";
    default: return at(x, y - 2) + "l2 2-2 2-2-2z";
  }
}

double draw_key(Svg& svg, double x, double y, std::string_view colour, std::string_view words) {
  svg.path("M" + svg_number(x) + " " + svg_number(y) + "h18",
           "stroke=\"" + std::string(colour) + "\" stroke-width=\"2\"");
  svg.text(x + 23, y + 4, words);
  return key_end(x, words);
}

double draw_keys(Svg& svg, double x, double y, double right, std::span<const Key> keys) {
  for_keys(x, right, keys,
           [&](double at, double below, const Key& key) { draw_key(svg, at, y + below, key.colour, key.words); });
  return y + key_rows(x, right, keys);
}

double key_rows(double x, double right, std::span<const Key> keys) {
  double height = 0;
  for_keys(x, right, keys, [&](double, double below, const Key&) { height = below; });
  return height;
}

}  // namespace petzval::figure_detail
