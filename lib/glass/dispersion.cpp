// SPDX-License-Identifier: Apache-2.0
#include "petzval/glass/glass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "core/text.hpp"
#include "formulas.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {
namespace {

// Tolerance for the ends of a range, which are rounded by the conversion from micrometres to nanometres.
constexpr double edge_nm = 1e-6;

constexpr std::array<std::pair<std::string_view, double>, 14> lines = {{
    {"i", 365.0146},
    {"h", 404.6561},
    {"g", 435.8343},
    {"F'", 479.9914},
    {"F", 486.1327},
    {"e", 546.0740},
    {"d", d_line_nm},
    {"D", 589.2938},
    {"C'", 643.8469},
    {"C", 656.2725},
    {"r", 706.5188},
    {"A'", 768.195},
    {"s", 852.11},
    {"t", 1013.98},
}};

void check_wavelength(const std::string& where, double nm, double shortest, double longest) {
  if (nm >= shortest - edge_nm && nm <= longest + edge_nm) return;
  throw Error(where + ": wavelength = " + to_text(nm) + " nm; must be " + to_text(shortest, 7) + " to " +
              to_text(longest, 7) + " nm");
}

/// first + the sum over pairs of (first number) * shape(second number).
template <class Shape>
double sum(std::span<const double> c, double first, Shape shape) {
  double total = first;
  for (std::size_t i = 1; i < c.size(); i += 2) total += c[i] * shape(c[i + 1]);
  return total;
}

/// One point of a table of indices over x = 1 / l^2; n of a glass is a nearly linear function of x.
struct TablePoint {
  double x, n;
};

double secant(const TablePoint& a, const TablePoint& b) { return (b.n - a.n) / (b.x - a.x); }

/// The slope at a point between two others: the mean of the secants that keeps the cubics monotonic; 0 at an extremum.
/// Source: Fritsch and Butland, A method for constructing local monotone piecewise cubic interpolants, 1984.
double slope_between(const TablePoint& before, const TablePoint& at, const TablePoint& after) {
  const double left = secant(before, at), right = secant(at, after);
  if (!(left * right > 0)) return 0;
  const double fraction = (1 + (after.x - at.x) / (after.x - before.x)) / 3;
  return left * right / (fraction * right + (1 - fraction) * left);
}

/// The index at wavelength l (micrometres) from a table l0, n0, l1, n1, ...
double interpolated(std::span<const double> table, double l) {
  const std::size_t count = table.size() / 2;
  const auto point = [&](std::size_t i) { return TablePoint{1 / (table[2 * i] * table[2 * i]), table[2 * i + 1]}; };
  std::size_t low = 0, high = count - 1;  // l lies between these two
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (table[2 * middle] <= l ? low : high) = middle;
  }
  const TablePoint a = point(low), b = point(high);
  const double chord = secant(a, b);
  const double slope_a = low > 0 ? slope_between(point(low - 1), a, b) : chord;
  const double slope_b = high + 1 < count ? slope_between(a, b, point(high + 1)) : chord;
  const double step = b.x - a.x, t = (1 / (l * l) - a.x) / step;
  return a.n + t * (chord + (1 - t) * ((slope_a - chord) * (1 - t) + (chord - slope_b) * t)) * step;
}

}  // namespace

double refractive_index(const Glass& glass, double wavelength_nm) {
  const std::string where = glass.catalogue + " " + glass.name;
  check_wavelength(where, wavelength_nm, glass.shortest_nm, glass.longest_nm);
  const std::span<const double> c = glass.coefficients;
  const auto& form = glass_detail::form_of(glass.formula);
  if (!form.takes(c.size())) {
    throw Error(where + ": formula has " + std::to_string(c.size()) + " coefficients; must be " +
                std::string(form.rule));
  }

  const double l = wavelength_nm * 1e-3, l2 = l * l;
  const auto power = [l](double exponent) { return std::pow(l, exponent); };
  double n = 0, n2 = 0;
  switch (glass.formula) {
    case DispersionFormula::sellmeier: n2 = sum(c, 1 + c[0], [l2](double pole) { return l2 / (l2 - pole); }); break;
    case DispersionFormula::sellmeier_squared:
      n2 = sum(c, 1 + c[0], [l2](double pole) { return l2 / (l2 - pole * pole); });
      break;
    case DispersionFormula::polynomial: n2 = sum(c, c[0], power); break;
    case DispersionFormula::cauchy:
      n = sum(c, c[0], power);
      n2 = n * std::abs(n);
      break;
    case DispersionFormula::rational:
      n2 = c[0];
      for (std::size_t i = 1; i < c.size(); i += 3) n2 += c[i] * power(c[i + 1]) / (l2 - c[i + 2]);
      break;
    case DispersionFormula::herzberger: {
      const double pole = 1 / (l2 - 0.028);
      n = c[0] + (c[1] + c[2] * pole) * pole + (c[3] + (c[4] + c[5] * l2) * l2) * l2;
      n2 = n * std::abs(n);
      break;
    }
    case DispersionFormula::tabulated:
      n = interpolated(c, l);
      n2 = n * std::abs(n);
      break;
    case DispersionFormula::buchdahl: {
      const double w = (l - 0.574) / (1 + 2.5 * (l - 0.574));
      n = c[0] + (c[1] + c[2] * w) * w;
      n2 = n * std::abs(n);
      break;
    }
  }
  // Near a pole the formula gives no physical index.
  if (!(n2 > 1e-6 && std::isfinite(n2))) {
    throw Error(where + ": square of the index at " + to_text(wavelength_nm) + " nm = " + to_text(n2) +
                "; must be above 1e-6");
  }
  return n > 0 ? n : std::sqrt(n2);
}

double abbe_index(double nd, double vd, double wavelength_nm) {
  const std::string where = "n_d " + to_text(nd) + ", V_d " + to_text(vd);
  if (!(nd > 0 && std::isfinite(nd))) throw Error(where + ": n_d = " + to_text(nd) + "; must be finite and positive");
  if (!(vd > 0 && std::isfinite(vd))) throw Error(where + ": V_d = " + to_text(vd) + "; must be finite and positive");
  check_wavelength(where, wavelength_nm, 365, 1014);
  const auto inverse_square = [](double nm) { return 1 / (nm * nm); };
  const double f_minus_c = inverse_square(spectral_line_nm("F")) - inverse_square(spectral_line_nm("C"));
  return nd + (nd - 1) / vd * (inverse_square(wavelength_nm) - inverse_square(d_line_nm)) / f_minus_c;
}

double spectral_line_nm(std::string_view symbol) {
  const auto line =
      std::find_if(lines.begin(), lines.end(), [symbol](const auto& entry) { return entry.first == symbol; });
  if (line != lines.end()) return line->second;
  std::string known;
  for (const auto& entry : lines) known += (known.empty() ? "" : " ") + std::string(entry.first);
  throw Error("spectral line \"" + std::string(symbol) + "\" is unknown; must be in: " + known);
}

}  // namespace petzval
