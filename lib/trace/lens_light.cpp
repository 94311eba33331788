// SPDX-License-Identifier: Apache-2.0
#include "lens_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/chebyshev.hpp"
#include "lens/lens_view.hpp"
#include "petzval/core/error.hpp"
#include "petzval/prescription/coating.hpp"

namespace petzval::trace_detail {
namespace {

/// Nodes for wavelengths in nm: two registers of floats.
constexpr std::size_t spectral_nodes = 32;
constexpr std::size_t samples = 24;    // Chebyshev nodes of a polynomial
constexpr std::size_t max_terms = 16;  // coefficients that are kept
constexpr double tolerance = 1e-4;     // of one surface

using Series = std::array<double, samples>;

/// A surface at one wavelength: its transmittance over the variable of its polynomial.
struct SurfaceAt {
  bool mirror;
  double before, behind;  // indices
  double nm;
  Coating coating;  // from the side of the lower index; on a mirror from the side of the light

  SurfaceAt(const LensSurface& surface, double index_before, double index_behind, double wavelength_nm)
      : mirror(surface.mirror), before(index_before), behind(index_behind), nm(wavelength_nm) {
    if (surface.coating) coating = mirror || before <= behind ? *surface.coating : reversed(*surface.coating);
  }

  double low() const noexcept { return std::min(before, behind); }
  double high() const noexcept { return std::max(before, behind); }
  /// @param cosine in the medium of the lower index
  double light(double cosine) const {
    const SurfaceLight found = surface_light(coating, low(), high(), cosine, nm);
    return mirror ? found.reflectance() : found.transmittance();
  }
  /// @param value ratio of the components along the normal, low to high
  double light_at_ratio(double value) const {
    // Fresnel's equations also hold for equal indices, where the ratio does not determine the angle.
    const double squares = low() * low() / (high() * high());
    if (bare()) {
      return 2 * value / ((1 + value) * (1 + value)) + 2 * squares * value / ((squares + value) * (squares + value));
    }
    const double slant = (high() * high() - low() * low()) * value * value / (1 - value * value);
    return light(std::min(std::sqrt(slant) / low(), 1.0));
  }
  bool bare() const noexcept { return coating == Coating{}; }
};

/// The variable of a polynomial, and its pole.
struct Argument {
  LightVariable variable;
  double pole = 0;

  /// The range of the variable at one wavelength, from normal to grazing incidence or back.
  std::array<double, 2> range(const SurfaceAt& at) const noexcept {
    if (variable == LightVariable::cosine) return {0, at.low()};
    return {at.high() / (at.low() + pole * at.high()), 1 / pole};
  }
  double light(const SurfaceAt& at, double value) const {
    if (variable == LightVariable::cosine) return at.light(std::min(value / at.low(), 1.0));
    return at.light_at_ratio(std::max(1 / value - pole, 0.0));
  }
};

/// Chebyshev coefficients of the transmittance over the range of an argument.
Series chebyshev(const SurfaceAt& at, const Argument& argument) {
  const auto range = argument.range(at);
  return core_detail::chebyshev_series<samples>(
      [&](double x) { return argument.light(at, std::lerp(range[0], range[1], (x + 1) / 2)); });
}

double tail(const Series& series, std::size_t terms) noexcept {
  double sum = 0;
  for (std::size_t k = terms; k < samples; ++k) sum += std::abs(series[k]);
  return sum;
}

/// A wavelength of the tables: a compiled wavelength, or a node between two.
struct Node {
  double nm;
  std::vector<double> indices, absorptions;  // by space
};

struct Polynomial {
  Argument argument{LightVariable::ratio};
  LowerIndex lower = LowerIndex::varies;
  double from = 0, to = 1, error = 0;             ///< range of the argument over all nodes
  std::vector<std::vector<double>> coefficients;  ///< [node][term], from the highest power on; empty: all light passes
};

/// True if a surface passes all light: a mirror of unknown coating, or an uncoated surface without refraction.
bool plain(const std::vector<SurfaceAt>& at) {
  const auto same = [](const SurfaceAt& own) { return own.mirror || own.before == own.behind; };
  return at.front().bare() && std::ranges::all_of(at, same);
}

/// The surface at each node.
std::vector<SurfaceAt> at_nodes(const Lens& lens, std::size_t i, const std::vector<Node>& nodes) {
  std::vector<SurfaceAt> at;
  for (const Node& node : nodes) at.emplace_back(lens.surfaces()[i], node.indices[i], node.indices[i + 1], node.nm);
  return at;
}

Polynomial fit(const std::vector<SurfaceAt>& at) {
  Polynomial result;
  if (plain(at)) return result;
  std::size_t fewest = 0;
  std::vector<Series> best;
  const Argument cosine{LightVariable::cosine}, ratio{LightVariable::ratio, at.front().low() / at.front().high()};
  // Without refraction the ratio does not determine the angle of incidence, which matters for layers.
  const bool bends = std::ranges::all_of(at, [](const SurfaceAt& own) { return own.high() > 1.001 * own.low(); });
  const bool has_ratio = !at.front().mirror && (bends || at.front().bare());
  for (const Argument& argument : {cosine, ratio}) {
    if (argument.variable == LightVariable::ratio && !has_ratio) continue;
    std::vector<Series> series;
    for (const SurfaceAt& own : at) series.push_back(chebyshev(own, argument));
    const auto error = [&](std::size_t terms) {
      double worst = 0;
      for (const Series& own : series) worst = std::max(worst, tail(own, terms));
      return worst;
    };
    std::size_t terms = 1;
    while (terms < max_terms && error(terms) > tolerance) ++terms;
    // The division of a ratio takes as long as about two terms.
    const std::size_t cost = terms + (argument.variable == LightVariable::ratio ? 2 : 0);
    if (!best.empty() && (error(terms) > tolerance || (cost >= fewest && result.error <= tolerance))) continue;
    fewest = cost;
    result.argument = argument;
    result.error = error(terms);
    best = std::move(series);
    result.coefficients.assign(at.size(), std::vector<double>(terms));
  }
  if (std::ranges::all_of(at, [](const SurfaceAt& own) { return own.before <= own.behind; })) {
    result.lower = LowerIndex::before;
  } else if (std::ranges::all_of(at, [](const SurfaceAt& own) { return own.before >= own.behind; })) {
    result.lower = LowerIndex::behind;
  }
  result.from = std::numeric_limits<double>::infinity(), result.to = 0;
  for (const SurfaceAt& own : at) {
    const auto [from, to] = result.argument.range(own);
    result.from = std::min(result.from, from), result.to = std::max(result.to, to);
  }
  for (std::size_t n = 0; n < at.size(); ++n) {
    auto& own = result.coefficients[n];
    // The ranges of single nodes are mapped to -1 to 1 as well.
    const auto [from, to] = result.argument.range(at[n]);
    const double factor = (result.to - result.from) / (to - from);
    const double shift = factor + (2 * result.from - from - to) / (to - from);
    const Series powers = core_detail::by_powers(best[n], own.size(), factor, shift);
    std::ranges::reverse_copy(powers.begin(), powers.begin() + static_cast<std::ptrdiff_t>(own.size()), own.begin());
  }
  return result;
}

}  // namespace

/// Tables for one storage type.
template <class R>
struct LightTables {
  std::vector<SurfacePolynomial<R>> surfaces;
  std::vector<R> compiled, between, differences;
  LightView<R> view;
};

struct LensLight::Data {
  LightTables<float> in_float;
  LightTables<double> in_double;
  double error = 0;

  explicit Data(const Lens& lens) {
    std::vector<Node> nodes;  // compiled wavelengths, then nodes of the spectrum
    const auto add = [&](double nm, Wavelength wavelength) {
      Node node{nm, {}, {}};
      for (std::size_t space = 0; space <= lens.surface_count(); ++space) {
        node.indices.push_back(lens.index(space, wavelength));
        node.absorptions.push_back(lens.absorption(space, wavelength));
      }
      nodes.push_back(std::move(node));
    };
    const std::size_t compiled = lens.wavelengths_nm().size();
    for (std::size_t w = 0; w < compiled; ++w) add(lens.wavelengths_nm()[w], w);
    const auto& coordinate = kernel::view<double>(lens).sequence_to_film.coordinate;
    if (std::isfinite(lens.index_error()) && coordinate.scale != 0) {
      const auto [shortest, longest] = std::ranges::minmax(lens.wavelengths_nm());
      for (std::size_t k = 0; k < spectral_nodes; ++k) {
        const double t = 2 * static_cast<double>(k) / (spectral_nodes - 1) - 1;
        const double nm = std::clamp(coordinate.scale / (t + coordinate.offset), shortest, longest);
        add(nm, Wavelength::nm(nm));
      }
    } else if (std::isfinite(lens.index_error())) {  // one wavelength
      for (int k = 0; k < 2; ++k) add(lens.wavelengths_nm()[0], 0);
    }

    std::vector<Polynomial> surfaces;
    for (std::size_t i = 0; i < lens.surface_count(); ++i) {
      const std::vector<SurfaceAt> at = at_nodes(lens, i, nodes);
      try {
        surfaces.push_back(fit(at));
      } catch (const Error& found) {
        throw Error(lens.name() + ": surface " + std::to_string(i) + ": " + found.what());
      }
      error += surfaces.back().error + error_between(lens, i, at, compiled);
    }
    error = std::min(error, 1.0);
    build(surfaces, nodes, compiled, in_float);
    build(surfaces, nodes, compiled, in_double);
  }

 private:
  /// Error of linear interpolation midway between nodes, at three angles.
  static double error_between(const Lens& lens, std::size_t i, const std::vector<SurfaceAt>& at, std::size_t compiled) {
    double worst = 0;
    for (std::size_t n = compiled; !plain(at) && n + 1 < at.size() && at[n].nm != at[n + 1].nm; ++n) {
      const double nm = 2 / (1 / at[n].nm + 1 / at[n + 1].nm);
      const Wavelength middle = Wavelength::nm(nm);
      const SurfaceAt own(lens.surfaces()[i], lens.index(i, middle), lens.index(i + 1, middle), nm);
      for (const double cosine : {1.0, 0.7, 0.4}) {
        worst = std::max(worst, std::abs(own.light(cosine) - (at[n].light(cosine) + at[n + 1].light(cosine)) / 2));
      }
    }
    return worst;
  }

  template <class R>
  static void build(const std::vector<Polynomial>& surfaces, const std::vector<Node>& nodes, std::size_t compiled,
                    LightTables<R>& tables) {
    LightView<R>& view = tables.view;
    const std::size_t between = nodes.size() - compiled;
    view.compiled.count = compiled, view.compiled.length = kernel::row_length<R>(compiled);
    view.between.count = between, view.between.length = kernel::row_length<R>(between);
    const auto add_row = [&](const auto& value_at) {
      const std::size_t row = tables.compiled.size() / view.compiled.length;
      tables.compiled.resize((row + 1) * view.compiled.length);
      for (std::size_t w = 0; w < compiled; ++w) {
        tables.compiled[row * view.compiled.length + w] = static_cast<R>(value_at(w));
      }
      tables.between.resize((row + 1) * view.between.length);
      tables.differences.resize(tables.between.size());
      for (std::size_t k = 0; k < between; ++k) {
        const std::size_t to = row * view.between.length + k;
        tables.between[to] = static_cast<R>(value_at(compiled + k));
        if (k + 1 < between) {
          tables.differences[to] = static_cast<R>(value_at(compiled + k + 1) - value_at(compiled + k));
        }
      }
      return static_cast<std::uint32_t>(row);
    };
    for (const Polynomial& own : surfaces) {
      const std::size_t terms = own.coefficients.empty() ? 0 : own.coefficients[0].size();
      const double scale = 2 / (own.to - own.from);
      SurfacePolynomial<R> surface{.variable = own.argument.variable,
                                   .lower = own.lower,
                                   .pole = static_cast<R>(own.argument.pole),
                                   .scale = static_cast<R>(scale),
                                   .offset = static_cast<R>(-1 - scale * own.from),
                                   .terms = static_cast<std::uint32_t>(terms)};
      for (std::size_t k = 0; k < terms; ++k) {
        const auto row = add_row([&](std::size_t n) { return own.coefficients[n][k]; });
        if (k == 0) surface.first = row;
      }
      tables.surfaces.push_back(surface);
    }
    // Rays are whole lines: outside the lens they have no length.
    const std::size_t spaces = surfaces.size() + 1;
    for (std::size_t space = 0; space < spaces; ++space) {
      const auto row = add_row([&](std::size_t n) {
        const bool inside = space > 0 && space + 1 < spaces;
        return inside ? nodes[n].absorptions[space] * nodes[n].indices[space] : 0;
      });
      if (space == 0) view.first_depth = row;
      const auto absorbs = [&](const Node& node) { return node.absorptions[space] > 0; };
      view.absorbs |= space > 0 && space + 1 < spaces && std::ranges::any_of(nodes, absorbs);
    }
    view.surfaces = tables.surfaces.data();
    view.compiled.values = tables.compiled.data();
    view.between.values = tables.between.data(), view.between.differences = tables.differences.data();
  }
};

LensLight::LensLight(const Lens& lens) : data_(std::make_shared<const Data>(lens)) {}
double LensLight::error() const noexcept { return data_->error; }

template <>
PETZVAL_API const LightView<float>& LensLight::view() const noexcept {
  return data_->in_float.view;
}
template <>
PETZVAL_API const LightView<double>& LensLight::view() const noexcept {
  return data_->in_double.view;
}

}  // namespace petzval::trace_detail
