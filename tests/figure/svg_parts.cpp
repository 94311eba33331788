// SPDX-License-Identifier: Apache-2.0
#include "svg_parts.hpp"

#include <gtest/gtest.h>

#include <regex>

namespace petzval::testing {

std::vector<Match> matches(const std::string& text, const std::string& expression) {
  const std::regex pattern(expression);
  std::vector<Match> result;
  for (std::sregex_iterator m(text.begin(), text.end(), pattern), end; m != end; ++m) {
    result.push_back({static_cast<std::size_t>(m->position()), {m->begin(), m->end()}});
  }
  return result;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

Points marks(const std::string& svg) {
  Points result;
  const std::string circle = "<circle cx=\"([0-9.]+)\" cy=\"([0-9.]+)\" r=\"4\" fill=\"#(d0331f|fff)\"";
  for (const Match& mark : matches(svg, circle)) result.push_back({mark.number(1), mark.number(2)});
  return result;
}

std::size_t expect_marks_within_cells(const std::string& svg) {
  std::size_t found = 0;
  const std::string frame =
      "<rect x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"([0-9.]+)\" height=\"[0-9.]+\" fill=\"none\"";
  for (const Match& cell : matches(svg, frame)) {
    const double x = cell.number(1), y = cell.number(2), side = cell.number(3);
    const std::string content = svg.substr(cell.position, svg.find("<text", cell.position) - cell.position);
    for (const Match& mark : matches(content, "M([-0-9.]+) ([-0-9.]+)h4")) {
      ++found;
      EXPECT_TRUE(mark.number(1) + 2 >= x && mark.number(1) + 2 <= x + side) << mark[0];
      EXPECT_TRUE(mark.number(2) >= y && mark.number(2) <= y + side) << mark[0];
    }
  }
  return found;
}

std::vector<Points> paths(const std::string& svg, const std::string& style) {
  std::vector<Points> result;
  const std::string begin = "<path d=\"";
  for (std::size_t at = svg.find(begin); at != std::string::npos; at = svg.find(begin, at)) {
    at += begin.size();
    const std::size_t quote = svg.find('"', at), end = svg.find("/>", quote);
    if (svg.substr(quote, end - quote).find(style) == std::string::npos) continue;
    Points points;
    for (const Match& corner : matches(svg.substr(at, quote - at), "[ML](-?[0-9.]+) (-?[0-9.]+)")) {
      points.push_back({corner.number(1), corner.number(2)});
    }
    result.push_back(points);
  }
  return result;
}

double scale(const std::string& svg) {
  const auto bar = matches(svg, "M([0-9.]+) [0-9.]+v6m0-3H([0-9.]+)"), words = matches(svg, ">([0-9.]+) mm[<,]");
  if (bar.empty() || words.empty()) return 0;
  return (bar[0].number(2) - bar[0].number(1)) / words[0].number(1);
}

}  // namespace petzval::testing
