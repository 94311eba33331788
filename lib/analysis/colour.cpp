// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/colour.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;  // rows
constexpr double shortest_nm = 420, longest_nm = 680;

/// Parses a line of numbers. Throws Error if the line has any other form.
template <std::size_t columns>
std::array<double, columns> parse_line(std::string_view line, const std::string& where) {
  static_assert(columns == 2 || columns == 4);
  std::array<double, columns> values{};
  const char* at = line.data();
  const char* end = at + line.size();
  for (std::size_t i = 0; i < columns; ++i) {
    const auto [next, error] = std::from_chars(at, end, values[i]);
    const bool separated = i + 1 < columns ? next != end && *next == ',' : next == end;
    if (error != std::errc() || !separated || !std::isfinite(values[i])) {
      throw Error(where + ": \"" + std::string(line) + "\"; must be " +
                  (columns == 2 ? "two finite numbers with a comma" : "four finite numbers with commas") +
                  " between them");
    }
    at = next + (next == end ? 0 : 1);
  }
  return values;
}

/// Calls add(row, where) for each row of a table. The first number of a row is a wavelength; wavelengths must increase.
template <std::size_t columns, class Add>
void for_each_row(const std::filesystem::path& file, std::string_view header, const char* what, const Add& add) {
  std::istringstream in(read_file(file, std::string("the table of ") + what));
  double last = 0;
  std::string line;
  for (int count = 1; std::getline(in, line); ++count) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::string where = file.string() + ": line " + std::to_string(count);
    if (count == 1) {
      if (line != header) throw Error(where + ": header = \"" + line + "\"; must be \"" + std::string(header) + "\"");
      continue;
    }
    const auto row = parse_line<columns>(line, where);
    if (!(row[0] > last)) {
      throw Error(where + ": wavelength = " + to_text(row[0]) + " nm; must be above " +
                  (last == 0 ? "0" : "the " + to_text(last) + " of the previous line"));
    }
    last = row[0];
    add(row, where);
  }
}

/// A piecewise linear function, interpolated between the two samples around a wavelength in its range.
template <class Value, class Mix>
auto between(const std::vector<double>& nodes, const std::vector<Value>& values, double nm, const Mix& mix) {
  const auto upper = std::clamp(std::upper_bound(nodes.begin(), nodes.end(), nm), nodes.begin() + 1, nodes.end() - 1);
  const auto i = static_cast<std::size_t>(upper - nodes.begin());
  return mix(values[i - 1], values[i], (nm - nodes[i - 1]) / (nodes[i] - nodes[i - 1]));
}

Triple at(const ColourMatching& table, double nm) {
  return between(table.wavelengths_nm, table.xyz, nm, [](const Triple& a, const Triple& b, double t) {
    return Triple{std::lerp(a[0], b[0], t), std::lerp(a[1], b[1], t), std::lerp(a[2], b[2], t)};
  });
}

double at(const Spectrum& light, double nm) {
  return between(light.wavelengths_nm, light.power, nm,
                 [](double a, double b, double t) { return std::lerp(a, b, t); });
}

/// The tristimulus values of a band. Between adjacent samples of either function, the integrand is a parabola, for
/// which Simpson's rule is exact.
Triple integral(const Spectrum& light, const ColourMatching& table, double from, double to) {
  from = std::max({from, light.wavelengths_nm.front(), table.wavelengths_nm.front()});
  to = std::min({to, light.wavelengths_nm.back(), table.wavelengths_nm.back()});
  std::vector<double> nodes{from, to};
  for (const auto* list : {&light.wavelengths_nm, &table.wavelengths_nm}) {
    std::copy_if(list->begin(), list->end(), std::back_inserter(nodes),
                 [&](double nm) { return nm > from && nm < to; });
  }
  std::sort(nodes.begin(), nodes.end());
  Triple sum{};
  for (std::size_t i = 1; from < to && i < nodes.size(); ++i) {
    const double a = nodes[i - 1], b = nodes[i], third = (b - a) / 6;
    for (const auto& [nm, simpson_weight] : {std::pair{a, third}, {(a + b) / 2, 4 * third}, {b, third}}) {
      const double power = at(light, nm);
      const Triple xyz = at(table, nm);
      for (std::size_t k = 0; k < 3; ++k) sum[k] += simpson_weight * power * xyz[k];
    }
  }
  return sum;
}

Triple times(const Matrix& matrix, const Triple& v) {
  Triple result{};
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = matrix[i][0] * v[0] + matrix[i][1] * v[1] + matrix[i][2] * v[2];
  }
  return result;
}

/// From XYZ to linear light of the sRGB primaries (IEC 61966-2-1).
constexpr Matrix rgb_of_xyz{{{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}}};

/// The cone responses of the Bradford transform and their inverse.
constexpr Matrix cones_of_xyz{{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
constexpr Matrix xyz_of_cones{
    {{0.9869929, -0.1470543, 0.1599627}, {0.4323053, 0.5183603, 0.0492912}, {-0.0085287, 0.0400428, 0.9684867}}};

/// XYZ of the white point of sRGB, D65.
constexpr Triple srgb_white{0.9505, 1, 1.089};

/// Checks the wavelengths of a table with `count` values.
/// @param whose the type of the table
/// @param values the name of its values
void validate(const std::vector<double>& wavelengths_nm, std::size_t count, const std::string& whose,
              const std::string& values) {
  if (wavelengths_nm.size() < 2 || wavelengths_nm.size() != count) {
    throw Error(whose + ": number of wavelengths = " + std::to_string(wavelengths_nm.size()) + ", of " + values +
                " = " + std::to_string(count) + "; must be at least 2, with as many " + values);
  }
  double last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double nm = wavelengths_nm[i];
    if (!(nm > last) || !std::isfinite(nm)) {
      throw Error(whose + ": wavelength " + std::to_string(i) + " = " + to_text(nm) +
                  " nm; must be finite, above 0 and increasing");
    }
    last = nm;
  }
}

/// Applies the checks of load() to any light.
void validate(const Spectrum& light) {
  validate(light.wavelengths_nm, light.power.size(), "Spectrum", "powers");
  for (std::size_t i = 0; i < light.power.size(); ++i) {
    if (!(light.power[i] >= 0) || !std::isfinite(light.power[i])) {
      throw Error("Spectrum: power " + std::to_string(i) + " = " + to_text(light.power[i]) +
                  "; must be finite and at least 0");
    }
  }
}

/// Applies the checks of load() to any table; the table may cover only a part of the visible wavelengths.
void validate(const ColourMatching& table) {
  validate(table.wavelengths_nm, table.xyz.size(), "ColourMatching", "triples");
  for (std::size_t i = 0; i < table.xyz.size(); ++i) {
    for (const double value : table.xyz[i]) {
      if (std::isfinite(value)) continue;
      throw Error("ColourMatching: a value of triple " + std::to_string(i) + " = " + to_text(value) +
                  "; must be finite");
    }
  }
}

double luminance(const Triple& xyz, const char* whose) {
  if (xyz[1] > 0 && std::isfinite(xyz[1])) return xyz[1];
  throw Error(std::string("rgb_weights: luminance of the ") + whose + " = " + to_text(xyz[1]) +
              "; must be above 0, from power at visible wavelengths");
}

}  // namespace

ColourMatching ColourMatching::load(const std::filesystem::path& file) {
  ColourMatching table;
  for_each_row<4>(file, "wavelength_nm,xbar,ybar,zbar", "the colour matching functions",
                  [&](const std::array<double, 4>& row, const std::string&) {
                    table.wavelengths_nm.push_back(row[0]);
                    table.xyz.push_back({row[1], row[2], row[3]});
                  });
  if (table.wavelengths_nm.empty() || table.wavelengths_nm.front() > shortest_nm ||
      table.wavelengths_nm.back() < longest_nm) {
    throw Error(file.string() + ": the table ends early; must extend from " + to_text(shortest_nm) + " nm or less to " +
                to_text(longest_nm) + " or more");
  }
  return table;
}

Spectrum Spectrum::load(const std::filesystem::path& file) {
  Spectrum light;
  for_each_row<2>(file, "wavelength_nm,power", "a light's power",
                  [&](const std::array<double, 2>& row, const std::string& where) {
                    if (row[1] < 0) throw Error(where + ": power = " + to_text(row[1]) + "; must be at least 0");
                    light.wavelengths_nm.push_back(row[0]);
                    light.power.push_back(row[1]);
                  });
  if (light.power.size() < 2) {
    throw Error(file.string() + ": number of rows = " + std::to_string(light.power.size()) +
                "; must be at least 2 below \"wavelength_nm,power\"");
  }
  return light;
}

Spectrum illuminant(std::string_view name, const std::filesystem::path& daylight_components) {
  if (name == "E") return {{300, 830}, {1, 1}};
  Spectrum light;
  if (name == "A") {
    const auto planck = [](double nm) { return std::pow(nm, -5) / std::expm1(1.435e7 / (2848 * nm)); };
    for (int nm = 300; nm <= 830; nm += 5) {
      light.wavelengths_nm.push_back(nm);
      light.power.push_back(100 * planck(nm) / planck(560));
    }
    return light;
  }
  if (name != "D65" && name != "D50") {
    throw Error("illuminant: name = \"" + std::string(name) + "\"; must be D65, D50, A or E");
  }
  // From the chromaticity of the nominal temperature, which was defined with the radiation constant c2 = 14380.
  const double kelvin = (name == "D65" ? 6500 : 5000) * 1.4388 / 1.4380;
  const double x = 0.244063 + 0.09911e3 / kelvin + 2.9678e6 / std::pow(kelvin, 2) - 4.6070e9 / std::pow(kelvin, 3);
  const double y = -3 * x * x + 2.870 * x - 0.275;
  const double m = 0.0241 + 0.2562 * x - 0.7341 * y;
  const double m1 = std::round(1000 * (-1.3515 - 1.7703 * x + 5.9114 * y) / m) / 1000;
  const double m2 = std::round(1000 * (0.0300 - 31.4424 * x + 30.0717 * y) / m) / 1000;
  for_each_row<4>(daylight_components, "wavelength_nm,s0,s1,s2", "the components of daylight",
                  [&](const std::array<double, 4>& row, const std::string&) {
                    light.wavelengths_nm.push_back(row[0]);
                    light.power.push_back(row[1] + m1 * row[2] + m2 * row[3]);
                  });
  if (light.power.size() < 2) throw Error(daylight_components.string() + ": the table ends early; must have rows");
  return light;
}

Triple tristimulus(const Spectrum& light, const ColourMatching& table) {
  validate(light);
  validate(table);
  return integral(light, table, table.wavelengths_nm.front(), table.wavelengths_nm.back());
}

std::optional<double> correlated_colour_temperature(const std::array<double, 2>& xy, const ColourMatching& table) {
  validate(table);
  using Point = std::array<double, 2>;
  const auto uv = [](double x, double y, double z) {
    const double sum = x + 15 * y + 3 * z;
    return Point{4 * x / sum, 6 * y / sum};
  };
  const double per_kelvin = 1e6;  // temperatures are searched in mired, 10^6 / K, along which the locus is smooth
  const auto black_body = [&](double mired) {
    constexpr double c2 = 1.438776877e7;  // nm K
    Spectrum light{table.wavelengths_nm, {}};
    for (const double nm : table.wavelengths_nm) {
      light.power.push_back(std::pow(nm / 560, -5) * std::exp(-c2 * mired / per_kelvin / nm) /
                            -std::expm1(-c2 * mired / per_kelvin / nm));
    }
    const Triple xyz = integral(light, table, table.wavelengths_nm.front(), table.wavelengths_nm.back());
    return uv(xyz[0], xyz[1], xyz[2]);
  };
  const Point own = uv(xy[0], xy[1], 1 - xy[0] - xy[1]);
  const auto distance = [&](double mired) {
    const Point at = black_body(mired);
    return std::hypot(at[0] - own[0], at[1] - own[1]);
  };
  constexpr double least = 10, most = 1000, step = 10, largest_distance = 0.05;
  double best = least, nearest = distance(least);
  for (double mired = least + step; mired <= most; mired += step) {
    const double here = distance(mired);
    if (here < nearest) best = mired, nearest = here;
  }
  if (!(nearest < 2 * largest_distance)) return {};
  // Golden section: the distance has one minimum within a step.
  double from = std::max(best - step, least), to = std::min(best + step, most);
  constexpr double ratio = 0.6180339887498949;
  while (to - from > 1e-5 * best) {
    const double a = to - ratio * (to - from), b = from + ratio * (to - from);
    distance(a) < distance(b) ? to = b : from = a;
  }
  const double mired = (from + to) / 2;
  if (distance(mired) > largest_distance || mired < least + 1e-3 || mired > most - 1e-3) return {};
  return per_kelvin / mired;
}

std::vector<Triple> rgb_weights(std::span<const double> wavelengths_nm, const ColourMatching& table,
                                const Spectrum& light, const Spectrum& white) {
  const std::size_t count = wavelengths_nm.size();
  if (count == 0) throw Error("rgb_weights: no wavelength; must be at least one");
  if (count == 1) return {Triple{1, 1, 1}};

  for (const double nm : wavelengths_nm) {
    if (nm >= shortest_nm && nm <= longest_nm) continue;
    throw Error("rgb_weights: wavelength = " + to_text(nm) + " nm; must be " + to_text(shortest_nm) + " to " +
                to_text(longest_nm));
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return wavelengths_nm[a] < wavelengths_nm[b]; });

  const Triple white_xyz = tristimulus(white, table);
  const double white_level = luminance(white_xyz, "white");
  const double level = luminance(tristimulus(light, table), "light");
  const Triple from_cones = times(cones_of_xyz, white_xyz), to_cones = times(cones_of_xyz, srgb_white);
  const auto colour = [&](const Triple& xyz) {
    Triple cones = times(cones_of_xyz, xyz);
    for (std::size_t k = 0; k < 3; ++k) cones[k] *= to_cones[k] / from_cones[k] * white_level / level;
    return times(rgb_of_xyz, times(xyz_of_cones, cones));
  };
  // The constants have only four digits or more; scale the result so that white is exactly (1, 1, 1).
  Triple neutral = colour(white_xyz);
  for (double& channel : neutral) channel *= level / white_level;

  std::vector<Triple> weights(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double nm = wavelengths_nm[order[i]];
    if (i > 0 && nm == wavelengths_nm[order[i - 1]]) {
      throw Error("rgb_weights: wavelength " + to_text(nm) + " nm occurs twice; must occur once");
    }
    const double from = i == 0 ? table.wavelengths_nm.front() : (wavelengths_nm[order[i - 1]] + nm) / 2;
    const double to = i + 1 == count ? table.wavelengths_nm.back() : (nm + wavelengths_nm[order[i + 1]]) / 2;
    const Triple own = colour(integral(light, table, from, to));
    for (std::size_t k = 0; k < 3; ++k) weights[order[i]][k] = own[k] / neutral[k];
  }
  return weights;
}

}  // namespace petzval
