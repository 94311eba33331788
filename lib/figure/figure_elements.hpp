// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/analysis/aberrations.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil/ray_bundle.hpp"
#include "svg.hpp"

/// Shared elements of figures: head line, colours of fields, scale bar, lengths as text.
namespace petzval::figure_detail {

inline constexpr double sheet_margin = 14;  ///< px, left of all text
inline constexpr std::string_view small_text = "font-size=\"11\" fill=\"#555\"";
inline constexpr std::string_view small_centred = "font-size=\"11\" fill=\"#555\" text-anchor=\"middle\"";

/// Rounds down to 1, 2 or 5 times a power of ten.
double round_length(double x);

/// Half of the range of an axis that contains the values: 1, 2 or 5 times a power of ten, not smaller than `least`.
double round_range(double largest, double least);

/// Attributes of a curve in a diagram. `more` is appended.
std::string curve_style(std::string_view colour, std::string_view more = {});

/// The largest error of the points, rounded up to 0.0001.
std::string error_text(std::span<const MtfPoint> points);

/// "Sampling error 0.002 (from quarters of the rays)", for the largest error of the points.
std::string sampling_error_text(std::span<const MtfPoint> points);

/// A length with a suitable unit, for example "20 um" (with the Greek letter), "5 mm" or "2 m".
std::string length_text(double mm);

/// A field angle in degrees, with the degree sign.
std::string field_text(double field_rad);

/// Colour of a field by its index; the same in every figure of a lens.
std::string_view field_colour(std::size_t field);

/// Colour and marker of a wavelength. Up to three wavelengths are blue, green and red, as is customary for F, d and C;
/// more wavelengths have colours from violet to brown, in ascending order.
struct Look {
  std::string_view colour;
  std::size_t marker;
};
std::vector<Look> looks(std::span<const double> wavelengths_nm);

/// Colour of glass in a section: from pale to deep as the index goes from 1.4 to 1.95.
std::string glass_colour(double index);

/// Draws the name of the lens, and a line with the kind of figure, focal length, f-number, subject, film and
/// wavelength, in the top 56 px.
void draw_head(Svg& svg, const Lens& lens, std::string_view kind, double subject_z, std::size_t wavelength);

/// Weights of the compiled wavelengths: the given weights, or equal weights if `weights` is empty.
///
/// @param where   name of the figure, for messages
/// @throws Error  if the weights are negative, not finite, all 0 or of the wrong number
std::vector<double> checked_weights(std::string_view where, const Lens& lens, std::span<const double> weights);

/// "equal weight", or "weights 1, 0.5, 1" in the order of the compiled wavelengths.
std::string weights_text(std::span<const double> weights);

/// Gives every ray of a bundle the weight of its wavelength.
RayBundle weighted(RayBundle bundle, double weight);

/// Draws a bar of round length, at most `longest` px, with its left end at (x, y) and its length as text.
///
/// @return approximate x of the end of the text
double draw_scale_bar(Svg& svg, double x, double y, double px_per_mm, double longest, std::string_view remark = {});

/// Path commands of the marker of a ray: plus, cross, square, triangle or diamond.
std::string ray_marker(std::size_t kind, double x, double y);

/// Draws a coloured stroke and its meaning from (x, y).
///
/// @return approximate x of the end of the text
double draw_key(Svg& svg, double x, double y, std::string_view colour, std::string_view words);

/// The colour of a curve and its meaning.
struct Key {
  std::string_view colour;
  std::string words;
};
inline constexpr double key_row = 18;  ///< px

/// Draws keys from (x, y) in rows that end before `right`.
///
/// @return y of the last row
double draw_keys(Svg& svg, double x, double y, double right, std::span<const Key> keys);
/// Height of the rows of draw_keys() below the first row, px.
double key_rows(double x, double right, std::span<const Key> keys);

}  // namespace petzval::figure_detail
