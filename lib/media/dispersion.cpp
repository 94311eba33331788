// SPDX-License-Identifier: Apache-2.0
#include "petzval/media/glass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/units.hpp"

namespace petzval::inline v0 {
namespace {

// The ends of a range belong to it; converting micrometres to nanometres rounds them.
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
  throw Error(where + ": wavelength is " + to_text(nm) + " nm, wanted " + to_text(shortest, 7) + " to " +
              to_text(longest, 7) + " nm");
}

/// first + the sum over pairs of the first number times `shape` of the second.
template <class Shape>
double sum(std::span<const double> c, double first, Shape shape) {
  double total = first;
  for (std::size_t i = 1; i < c.size(); i += 2) total += c[i] * shape(c[i + 1]);
  return total;
}

}  // namespace

double refractive_index(const Glass& glass, double wavelength_nm) {
  const std::string where = glass.catalogue + " " + glass.name;
  check_wavelength(where, wavelength_nm, glass.shortest_nm, glass.longest_nm);
  const std::span<const double> c = glass.coefficients;
  const bool right_count = glass.formula == DispersionFormula::buchdahl ? c.size() == 3 : c.size() % 2 == 1;
  if (!right_count)
    throw Error(where + ": formula has " + std::to_string(c.size()) +
                " coefficients, wanted c0 and pairs (buchdahl: 3)");

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
    case DispersionFormula::buchdahl: {
      const double w = (l - 0.574) / (1 + 2.5 * (l - 0.574));
      n = c[0] + (c[1] + c[2] * w) * w;
      n2 = n * std::abs(n);
      break;
    }
  }
  // Near a pole the formula gives no physical index.
  if (!(n2 > 1e-6 && std::isfinite(n2))) {
    throw Error(where + ": square of the index at " + to_text(wavelength_nm) + " nm is " + to_text(n2) +
                ", wanted above 1e-6");
  }
  return n > 0 ? n : std::sqrt(n2);
}

double abbe_index(double nd, double vd, double wavelength_nm) {
  const std::string where = "n_d " + to_text(nd) + ", V_d " + to_text(vd);
  if (!(nd > 0 && std::isfinite(nd)))
    throw Error(where + ": n_d is " + to_text(nd) + ", wanted a finite number above 0");
  if (!(vd > 0 && std::isfinite(vd)))
    throw Error(where + ": V_d is " + to_text(vd) + ", wanted a finite number above 0");
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
  throw Error("spectral line \"" + std::string(symbol) + "\" is unknown, wanted one of " + known);
}

}  // namespace petzval::inline v0
