// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <regex>
#include <string>
#include <utility>
#include <vector>

/// Reads the parts of a figure.
namespace petzval::testing {

using Points = std::vector<std::pair<double, double>>;

inline std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// The corners of each path whose attributes contain `style`, px.
inline std::vector<Points> paths(const std::string& svg, const std::string& style) {
  std::vector<Points> result;
  const std::string begin = "<path d=\"";
  const std::regex corner("[ML](-?[0-9.]+) (-?[0-9.]+)");
  for (std::size_t at = svg.find(begin); at != std::string::npos; at = svg.find(begin, at)) {
    at += begin.size();
    const std::size_t quote = svg.find('"', at), end = svg.find("/>", quote);
    if (svg.substr(quote, end - quote).find(style) == std::string::npos) continue;
    const std::string d = svg.substr(at, quote - at);
    Points points;
    for (std::sregex_iterator c(d.begin(), d.end(), corner), none; c != none; ++c) {
      points.push_back({std::stod((*c)[1]), std::stod((*c)[2])});
    }
    result.push_back(points);
  }
  return result;
}

/// Pixels per millimetre, by the scale bar.
inline double scale(const std::string& svg) {
  std::smatch bar, words;
  if (!std::regex_search(svg, bar, std::regex("M([0-9.]+) [0-9.]+v6m0-3H([0-9.]+)")) ||
      !std::regex_search(svg, words, std::regex(">([0-9.]+) mm[<,]"))) {
    return 0;
  }
  return (std::stod(bar[2]) - std::stod(bar[1])) / std::stod(words[1]);
}

}  // namespace petzval::testing
