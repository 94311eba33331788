// SPDX-License-Identifier: Apache-2.0
#include "svg_page.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "cli.hpp"
#include "files.hpp"
#include "text.hpp"

namespace examples {
namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = i; k < i + 3; ++k)
      group = group << 8 | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) result += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
  }
  return result;
}

/// Escapes text for an XML element. Control characters become spaces, and invalid UTF-8 becomes U+FFFD.
std::string escaped(std::string_view text) {
  std::string clean = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  clean = Json::parse(clean).get<std::string>();
  std::replace_if(
      clean.begin(), clean.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return escaped_html(clean);
}

bool continues_character(char byte) { return (byte & 0xc0) == 0x80; }

/// "#0e0f12"
std::string hex(const Colour& colour) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string result = "#";
  for (const std::uint8_t value : colour) (result += digits[value >> 4]) += digits[value & 15];
  return result;
}

/// ' name="value"'; the value is rounded to 1/100 of a pixel.
std::string attribute(std::string_view name, double value) {
  return ' ' + std::string(name) + "=\"" + number(std::round(100 * value) / 100 + 0.0) + '"';
}

std::string box(double x, double y, double width, double height) {
  return attribute("x", x) + attribute("y", y) + attribute("width", width) + attribute("height", height);
}

std::string painted(std::string_view fill, std::string_view attributes) {
  return " fill=\"" + std::string(fill) + "\" " + std::string(attributes) + "/>\n";
}

/// The lines of a text that are at most about `width` wide.
std::vector<std::string> wrapped(std::string_view text, double width, double size) {
  const auto fitting = static_cast<std::size_t>(std::max(1.0, width / text_width("m", size)));
  std::vector<std::string> lines;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;) {
    if (!lines.empty() && text_width(lines.back() + ' ' + word, size) <= width) {
      lines.back() += ' ' + word;
      continue;
    }
    for (std::string_view rest = word; !rest.empty();) {
      std::size_t end = 0, characters = 0;
      while (end < rest.size() && (continues_character(rest[end]) || characters++ < fitting)) ++end;
      lines.emplace_back(rest.substr(0, end));
      rest.remove_prefix(end);
    }
  }
  return lines;
}

}  // namespace

double text_width(std::string_view text, double size) {
  return 0.6 * size *
         static_cast<double>(std::count_if(text.begin(), text.end(), [](char c) { return !continues_character(c); }));
}

void SvgPage::rect(double x, double y, double width, double height, std::string_view fill,
                   std::string_view attributes) {
  body_ += "<rect" + box(x, y, width, height) + painted(fill, attributes);
}

void SvgPage::disc(double x, double y, double radius, std::string_view fill, std::string_view attributes) {
  body_ += "<circle" + attribute("cx", x) + attribute("cy", y) + attribute("r", radius) + painted(fill, attributes);
}

void SvgPage::path(std::string_view d, std::string_view attributes) {
  body_ += "<path d=\"" + std::string(d) + '"' + painted("none", attributes);
}

void SvgPage::text(double x, double baseline, double size, std::string_view text, std::string_view fill,
                   std::string_view anchor) {
  body_ += "<text" + attribute("x", x) + attribute("y", baseline) + attribute("font-size", size) + " fill=\"" +
           std::string(fill) + "\" text-anchor=\"" + std::string(anchor) + "\">" + escaped(text) + "</text>\n";
}

double SvgPage::paragraph(double x, double top, double width, double size, std::string_view text,
                          std::string_view fill) {
  for (const std::string& line : wrapped(text, width, size)) {
    this->text(x, top + 1.1 * size, size, line, fill);
    top += 1.4 * size;
  }
  return top;
}

void SvgPage::picture(double x, double y, double width, double height, const petzval::Rgb8Image& picture) {
  body_ += "<image" + box(x, y, width, height) + " xlink:href=\"data:image/png;base64," +
           base64(petzval::to_png(picture)) + "\"/>\n";
}

void SvgPage::gradient(double x, double y, double width, double height, const std::vector<Colour>& colours) {
  const std::string id = "gradient" + std::to_string(++gradients_);
  body_ += "<linearGradient id=\"" + id + "\">\n";
  for (std::size_t i = 0; i < colours.size(); ++i) {
    body_ += "<stop" + attribute("offset", static_cast<double>(i) / static_cast<double>(colours.size() - 1)) +
             " stop-color=\"" + hex(colours[i]) + "\"/>\n";
  }
  body_ += "</linearGradient>\n";
  rect(x, y, width, height, "url(#" + id + ")");
}

std::string SvgPage::finish(double width, double height, std::string_view ground) const {
  SvgPage page;
  page.rect(0, 0, width, height, ground);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\"" +
         attribute("width", width) + attribute("height", height) + " viewBox=\"0 0 " + number(width) + ' ' +
         number(height) + "\" font-family=\"sans-serif\">\n" + page.body_ + body_ + "</svg>\n";
}

void write_svg(std::string svg, const std::filesystem::path& file) {
  std::string metadata;
  for (const auto& [key, value] : parameters()) metadata += escaped(key + ": " + value) + '\n';
  write_text(file, svg.insert(svg.find('\n') + 1, "<metadata>" + metadata + "</metadata>\n"));
}

}  // namespace examples
