// SPDX-License-Identifier: Apache-2.0
#include "rays_csv.hpp"

#include <algorithm>
#include <array>

#include "cli.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"

namespace examples {
namespace {

constexpr std::string_view header = "x_mm,y_mm,z_mm,dx,dy,dz";
constexpr std::array<const char*, 6> columns{"x_mm", "y_mm", "z_mm", "dx", "dy", "dz"};

/// Takes a line off the text; the last one may lack its end.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::array<double, 6> parse_ray(std::string_view line, const std::string& here) {
  const auto commas = std::count(line.begin(), line.end(), ',');
  if (commas != 5) {
    throw petzval::Error(here + ": found " + std::to_string(line.empty() ? 0 : commas + 1) +
                         " values, wanted 6: " + std::string(header));
  }
  std::array<double, 6> values{};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t end = std::min(line.find(','), line.size());
    values[i] = parse_number(here + ", column " + columns[i], trimmed(line.substr(0, end)), finite_number);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  if (values[3] == 0 && values[4] == 0 && values[5] == 0) {
    throw petzval::Error(here + ": found direction 0,0,0, wanted one that is not zero");
  }
  return values;
}

}  // namespace

RayTable parse_rays(std::string_view csv, const std::string& where) {
  if (csv.starts_with("\xEF\xBB\xBF")) csv.remove_prefix(3);
  if (const auto first = next_line(csv); first != header) {
    throw petzval::Error(where + ": line 1: found \"" + std::string(first.substr(0, 60)) + "\", wanted \"" +
                         std::string(header) + "\"");
  }
  // Editors and spreadsheets leave empty lines behind the last row.
  csv = csv.substr(0, csv.find_last_not_of(" \t\r\n") + 1);
  RayTable rays;
  for (std::size_t line = 2; !csv.empty(); ++line) {
    const auto values = parse_ray(next_line(csv), where + ": line " + std::to_string(line));
    rays.x.push_back(values[0]);
    rays.y.push_back(values[1]);
    rays.z.push_back(values[2]);
    rays.dx.push_back(values[3]);
    rays.dy.push_back(values[4]);
    rays.dz.push_back(values[5]);
  }
  return rays;
}

std::string digits17(double value) { return petzval::number(value, 17); }

}  // namespace examples
