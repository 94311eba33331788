// SPDX-License-Identifier: Apache-2.0
#include "svg.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/text.hpp"

namespace petzval::figure_detail {
namespace {

std::string attribute(std::string_view name, double value) {
  return " " + std::string(name) + "=\"" + svg_number(value) + "\"";
}

/// True if a UTF-8 character is allowed in XML 1.0 (production 2).
bool is_in_xml(std::string_view character) noexcept {
  if (character == "\xEF\xBF\xBE" || character == "\xEF\xBF\xBF") return false;  // U+FFFE, U+FFFF
  const auto first = static_cast<unsigned char>(character[0]);
  return first >= ' ' || first == '\t' || first == '\n' || first == '\r';
}

/// Escapes text as the content of an XML element. Invalid characters become U+FFFD, because programs refuse to show a
/// figure with a single invalid character.
std::string escaped_xml(std::string_view words) {
  std::string result;
  for (std::size_t i = 0; i < words.size();) {
    const std::size_t length = utf8_length(words, i);
    const std::string_view character = words.substr(i, std::max<std::size_t>(length, 1));
    i += character.size();
    if (length == 0 || !is_in_xml(character)) {
      result += "\xEF\xBF\xBD";
    } else if (character == "&") {
      result += "&amp;";
    } else if (character == "<") {
      result += "&lt;";
    } else if (character == ">") {
      result += "&gt;";
    } else {
      result += character;
    }
  }
  return result;
}

}  // namespace

std::string svg_number(double value) {
  const double rounded = std::round(value * 100) / 100;
  return to_text(rounded == 0 ? 0.0 : rounded);  // no "-0"
}

Svg::Svg(double width, double height) {
  out_ = "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", width) + attribute("height", height) +
         " viewBox=\"0 0 " + svg_number(width) + " " + svg_number(height) +
         "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n";
  rect(0, 0, width, height, "fill=\"#fff\"");
}

void Svg::element(std::string_view head, std::string_view attributes) {
  out_.append("<").append(head).append(attributes.empty() ? "" : " ").append(attributes).append("/>\n");
}

void Svg::rect(double x, double y, double width, double height, std::string_view attributes) {
  element("rect" + attribute("x", x) + attribute("y", y) + attribute("width", width) + attribute("height", height),
          attributes);
}

void Svg::circle(double x, double y, double radius, std::string_view attributes) {
  element("circle" + attribute("cx", x) + attribute("cy", y) + attribute("r", radius), attributes);
}

void Svg::ellipse(double x, double y, double half_width, double half_height, std::string_view attributes) {
  element(
      "ellipse" + attribute("cx", x) + attribute("cy", y) + attribute("rx", half_width) + attribute("ry", half_height),
      attributes);
}

void Svg::path(std::string_view d, std::string_view attributes) {
  element("path d=\"" + std::string(d) + "\"", attributes);
}

void Svg::text(double x, double y, std::string_view text, std::string_view attributes) {
  out_ += "<text" + attribute("x", x) + attribute("y", y);
  out_.append(attributes.empty() ? "" : " ").append(attributes).append(">");
  out_ += escaped_xml(text) + "</text>\n";
}

std::string Svg::finish() && {
  out_ += "</svg>\n";
  return std::move(out_);
}

}  // namespace petzval::figure_detail
