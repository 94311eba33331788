// SPDX-License-Identifier: Apache-2.0
#include "renderer/path_colours.hpp"

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "petzval/analysis/colour.hpp"
#include "petzval/core/geometry.hpp"
#include "support/bokeh.hpp"

namespace renderer {
namespace {

constexpr double first_nm = 420, band_nm = 5;
constexpr int band_count = 53;  // up to 680 nm

using Row = std::array<double, 3>;

/// Reflectances of the three primaries in each band. They are from 0 to 1, add up to 1, and give the colours of the
/// primaries under the weights. Found by Dykstra's alternating projections onto these sets, starting with three soft
/// bands.
std::vector<Row> primaries(const std::vector<Row>& weights) {
  const std::size_t n = weights.size();
  std::vector<Row> b(n), held(n, Row{});
  const auto edge = [](double nm, double at) { return 1 / (1 + std::exp((at - nm) / 8)); };
  for (std::size_t i = 0; i < n; ++i) {
    const double nm = first_nm + band_nm * static_cast<double>(i), blue = 1 - edge(nm, 490), red = edge(nm, 585);
    b[i] = {red, 1 - red - blue, blue};
  }
  glm::dmat3 gram(0);
  for (const Row& w : weights) gram += glm::outerProduct(glm::dvec3(w[0], w[1], w[2]), glm::dvec3(w[0], w[1], w[2]));
  const glm::dmat3 inverse = glm::inverse(gram);
  const auto project = [&] {  // onto the colours, then onto the sum; the first condition stays valid
    for (int c = 0; c < 3; ++c) {
      glm::dvec3 missing(0);
      missing[c] = 1;
      for (std::size_t i = 0; i < n; ++i)
        for (int k = 0; k < 3; ++k) missing[k] -= weights[i][k] * b[i][c];
      const glm::dvec3 step = inverse * missing;
      for (std::size_t i = 0; i < n; ++i)
        for (int k = 0; k < 3; ++k) b[i][c] += weights[i][k] * step[k];
    }
    for (Row& row : b) {
      const double over = (row[0] + row[1] + row[2] - 1) / 3;
      for (double& x : row) x -= over;
    }
  };
  for (int turn = 0; turn < 2000; ++turn) {
    project();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        const double x = b[i][c] + held[i][c];
        b[i][c] = std::clamp(x, 0.0, 1.0);
        held[i][c] = x - b[i][c];
      }
  }
  return b;
}

}  // namespace

std::optional<ColourMode> colour_mode_named(std::string_view name) noexcept {
  if (name == "d") return ColourMode::d;
  if (name == "rgb") return ColourMode::rgb;
  if (name == "hero" || name == "visible") return ColourMode::hero;
  return {};
}

PathColourSource::PathColourSource(ColourMode mode) : mode_(mode), rgb_nm_(petzval::rgb_triple_nm) {
  if (mode == ColourMode::rgb) compiled_nm_.assign(petzval::rgb_triple_nm.begin(), petzval::rgb_triple_nm.end());
  if (mode == ColourMode::hero) make_bands();
  compiled_nm_.push_back(petzval::d_line_nm);
}

PathColourSource::PathColourSource(double nm)
    : mode_(nm == petzval::d_line_nm ? ColourMode::d : ColourMode::rgb), rgb_nm_{nm, nm, nm}, compiled_nm_{nm} {
  if (mode_ == ColourMode::rgb) compiled_nm_.push_back(petzval::d_line_nm);
}

void PathColourSource::make_bands() {
  std::vector<double> middles;
  for (int i = 0; i < band_count; ++i) middles.push_back(first_nm + band_nm * i);
  const double low = middles.front() - band_nm / 2, high = middles.back() + band_nm / 2;
  for (int i = 0; i < 8; ++i) compiled_nm_.push_back(low + (high - low) * i / 7);
  const auto weights = examples::rgb_weights(middles, examples::white_light("D65"));
  const auto mix = primaries(weights);
  double sum = 0;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const Row &w = weights[i], &m = mix[i];
    sum += std::abs(w[0]) + std::abs(w[1]) + std::abs(w[2]);
    bands_.push_back({{m[0], m[1], m[2]}, {w[0], w[1], w[2]}, sum});
  }
  for (Band& band : bands_) band.end /= sum;
}

PathColours PathColourSource::draw(float u) const noexcept {
  PathColours result;
  if (mode_ != ColourMode::hero) {
    for (int c = 0; c < 3; ++c) result.from_rgb[c][c] = result.to_rgb[c][c] = 1;
    result.one_wavelength = mode_ == ColourMode::d;
    for (std::size_t c = 0; c < 3; ++c)
      result.nm[c] = static_cast<float>(result.one_wavelength ? petzval::d_line_nm : rgb_nm_[c]);
    result.hero = result.one_wavelength ? 0 : std::min(static_cast<int>(3 * u), 2);
    return result;
  }
  // Stratified: four positions a quarter apart. Each has the density of a single draw, and any lane could be the hero.
  result.lanes = 4;
  for (int lane = 0; lane < 4; ++lane) {
    double stratified = double{u} + lane / 4.0;
    stratified -= std::floor(stratified);
    const auto band = std::min(
        std::upper_bound(bands_.begin(), bands_.end(), stratified, [](double x, const Band& b) { return x < b.end; }),
        bands_.end() - 1);
    const double begin = band == bands_.begin() ? 0 : (band - 1)->end, band_width = band->end - begin;
    const double middle = first_nm + band_nm * static_cast<double>(band - bands_.begin());
    result.nm[static_cast<std::size_t>(lane)] =
        static_cast<float>(middle + band_nm * (std::clamp((stratified - begin) / band_width, 0.0, 1.0) - 0.5));
    for (int c = 0; c < 3; ++c) result.from_rgb[c][lane] = band->primaries[c];
    result.to_rgb[lane] = band->weight / static_cast<float>(4 * band_width);
  }
  return result;
}

}  // namespace renderer
