// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/colour.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numeric>
#include <string>
#include <string_view>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::inline v0 {
namespace {

using Triple = std::array<double, 3>;
constexpr double shortest_nm = 420, longest_nm = 680;

/// A line of four numbers. Throws Error for anything else.
std::array<double, 4> parse_line(std::string_view line, const std::string& where) {
  std::array<double, 4> values{};
  const char* at = line.data();
  const char* end = at + line.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [next, error] = std::from_chars(at, end, values[i]);
    const bool separated = i + 1 < values.size() ? next != end && *next == ',' : next == end;
    if (error != std::errc() || !separated || !std::isfinite(values[i])) {
      throw Error(where + ": found \"" + std::string(line) + "\", wanted four finite numbers with commas between them");
    }
    at = next + (next == end ? 0 : 1);
  }
  return values;
}

/// The matching functions at a wavelength, linear between the samples.
Triple at(const ColourMatching& table, double nm) {
  const auto& list = table.wavelengths_nm;
  const auto upper = std::clamp(std::upper_bound(list.begin(), list.end(), nm), list.begin() + 1, list.end() - 1);
  const auto i = static_cast<std::size_t>(upper - list.begin());
  const double t = (nm - list[i - 1]) / (list[i] - list[i - 1]);
  Triple xyz;
  for (std::size_t k = 0; k < 3; ++k) xyz[k] = (1 - t) * table.xyz[i - 1][k] + t * table.xyz[i][k];
  return xyz;
}

/// The integral of the linear functions over a band, exactly.
Triple integral(const ColourMatching& table, double from, double to) {
  std::vector<double> nodes{from};
  for (const double nm : table.wavelengths_nm) {
    if (nm > from && nm < to) nodes.push_back(nm);
  }
  nodes.push_back(to);
  Triple sum{};
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const Triple a = at(table, nodes[i - 1]), b = at(table, nodes[i]);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += (a[k] + b[k]) / 2 * (nodes[i] - nodes[i - 1]);
  }
  return sum;
}

/// To linear light of the sRGB primaries (IEC 61966-2-1).
Triple rgb(const Triple& xyz) {
  const auto [x, y, z] = xyz;
  return {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
          0.0557 * x - 0.2040 * y + 1.0570 * z};
}

}  // namespace

ColourMatching ColourMatching::load(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw Error(file.string() + ": cannot be read, wanted the table of the colour matching functions");
  constexpr std::string_view header = "wavelength_nm,xbar,ybar,zbar";
  ColourMatching table;
  std::string line;
  for (int count = 1; std::getline(in, line); ++count) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::string where = file.string() + ": line " + std::to_string(count);
    if (count == 1) {
      if (line != header) throw Error(where + ": found \"" + line + "\", wanted \"" + std::string(header) + "\"");
      continue;
    }
    const auto [nm, x, y, z] = parse_line(line, where);
    if (!table.wavelengths_nm.empty() && !(nm > table.wavelengths_nm.back())) {
      throw Error(where + ": wavelength is " + to_text(nm) + " nm, wanted more than the " +
                  to_text(table.wavelengths_nm.back()) + " of the line before");
    }
    table.wavelengths_nm.push_back(nm);
    table.xyz.push_back({x, y, z});
  }
  if (table.wavelengths_nm.empty() || table.wavelengths_nm.front() > shortest_nm ||
      table.wavelengths_nm.back() < longest_nm) {
    throw Error(file.string() + ": the table ends early, wanted one from " + to_text(shortest_nm) + " nm or less to " +
                to_text(longest_nm) + " or more");
  }
  return table;
}

std::vector<Triple> rgb_weights(std::span<const double> wavelengths_nm, const ColourMatching& table) {
  const std::size_t count = wavelengths_nm.size();
  if (count == 0) throw Error("rgb_weights: no wavelength, wanted one at least");
  if (count == 1) return {Triple{1, 1, 1}};

  for (const double nm : wavelengths_nm) {
    if (nm >= shortest_nm && nm <= longest_nm) continue;
    throw Error("rgb_weights: wavelength is " + to_text(nm) + " nm, wanted " + to_text(shortest_nm) + " to " +
                to_text(longest_nm));
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return wavelengths_nm[a] < wavelengths_nm[b]; });

  std::vector<Triple> weights(count);
  const Triple white = rgb(integral(table, shortest_nm, longest_nm));
  for (std::size_t i = 0; i < count; ++i) {
    const double nm = wavelengths_nm[order[i]];
    if (i > 0 && nm == wavelengths_nm[order[i - 1]]) {
      throw Error("rgb_weights: wavelength " + to_text(nm) + " nm stands twice, wanted once");
    }
    const double from = i == 0 ? shortest_nm : (wavelengths_nm[order[i - 1]] + nm) / 2;
    const double to = i + 1 == count ? longest_nm : (nm + wavelengths_nm[order[i + 1]]) / 2;
    const Triple colour = rgb(integral(table, from, to));
    for (std::size_t k = 0; k < 3; ++k) weights[order[i]][k] = colour[k] / white[k];
  }
  return weights;
}

}  // namespace petzval::inline v0
