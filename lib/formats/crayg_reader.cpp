// SPDX-License-Identifier: Apache-2.0
// crayg's .fx: sections [Metadata], [Surfaces] (or [Elements]) with rows of seven columns, [Aspheric Coefficients] and
// [Variable Distances]. Surfaces are counted from 0. "#" begins a comment.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "io/json.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "table_lens.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using io_detail::in_quotes;

constexpr std::array<const char*, 7> columns = {"Radius",  "Thickness", "IOR",     "Housing-Radius",
                                                "Abbe-No", "Material",  "Geometry"};
constexpr const char* all_columns = "Radius, Thickness, IOR, Housing-Radius, Abbe-No, Material, Geometry";
constexpr std::array<std::string_view, 4> sections = {"[metadata]", "[surfaces]", "[aspheric coefficients]",
                                                      "[variable distances]"};

/// The texts on both sides of the first colon.
std::pair<std::string_view, std::string_view> split(std::string_view line) {
  const std::size_t colon = std::min(line.find(':'), line.size());
  return {trimmed(line.substr(0, colon)), trimmed(line.substr(std::min(colon + 1, line.size())))};
}

class CraygReader {
 public:
  explicit CraygReader(Import& in) : in_(in) {}
  void read(std::string_view text);

 private:
  void metadata(std::string_view line);
  void surface(std::vector<std::string_view> cells, std::string_view remark);
  Medium medium(std::string_view name, double index, double abbe);
  void asphere(std::string_view line);
  void distances(std::string_view line);
  std::pair<SurfaceRow&, std::size_t> indexed(std::string_view word);
  double number(std::string_view parameter, std::string_view word) const {
    if (const auto value = formats_detail::number(word)) return *value;
    in_.must_be(line_, parameter, in_quotes(word), "a finite number with a decimal point");
  }

  Import& in_;
  int line_ = 0;
  std::vector<int> aspheric_lines_;  ///< line of each surface that still needs coefficients; 0 for the others
};

void CraygReader::metadata(std::string_view line) {
  const auto [name, value] = split(line);
  if (value.empty()) return;
  if (same(name, "name")) {
    in_.lens.imported->title = std::string(beginning(value, 4096));
    if (!in_.lens.f_number) in_.lens.f_number = f_number_in(value);
  } else if (same(name, "focal length")) {
    in_.lens.focal_length_mm = focal_length_in(std::string(value) + "mm");
  } else if (same(name, "maximum f number")) {
    in_.lens.f_number = number(name, value);
    if (!(*in_.lens.f_number > 0)) in_.must_be(line_, name, in_quotes(value), "a positive number");
  } else if (same(name, "patent")) {
    in_.lens.source_design = std::string(beginning(value, 4096));
  } else {
    in_.note(line);
  }
}

/// A name with its maker (SCHOTT_N_BK7), or IOR and the Abbe number. Newer files of the program round IOR to three
/// digits; the formula of the glass then supplies the index.
Medium CraygReader::medium(std::string_view name, double index, double abbe) {
  if (same(name, "AIR") || index == 0 || index == 1) return {};
  const auto vd = abbe > 0 ? std::optional(abbe) : std::nullopt;
  if (same(name, "UNKNOWN")) return {.nd = index, .vd = vd};
  const std::size_t split = std::min(name.find('_'), name.size() - 1);
  std::string glass(name.substr(split + 1));
  std::ranges::replace(glass, '_', '-');
  Medium found = in_.glass(line_, glass, std::array{std::string(name.substr(0, split))}, index, vd);
  const Glass* table = found.catalogue ? in_.glasses().find(*found.glass, *found.catalogue) : nullptr;
  const bool rounded = std::abs(index * 100 - std::round(index * 100)) < 1e-9;
  if (table && rounded && std::abs(table->nd - index) <= 0.005) found.nd = index_at(*table, d_line_nm);
  return found;
}

void CraygReader::surface(std::vector<std::string_view> cells, std::string_view remark) {
  if (same(cells[0], "radius")) return;  // the order of the columns is fixed
  // Rows of air may lack the Abbe number.
  if (cells.size() + 1 == columns.size() && same(cells[4], "AIR")) cells.insert(cells.begin() + 4, "0");
  if (cells.size() != columns.size()) {
    in_.must_be(line_, "row", std::to_string(cells.size()) + " cells", all_columns);
  }
  std::array<double, 5> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = number(columns[i], cells[i]);
  const auto [radius, thickness, index, housing, abbe] = values;
  if (index != 0 && !(index >= 0.1 && index <= 5)) in_.must_be(line_, "IOR", to_text(index), "0.1 to 5");
  const std::string geometry = lower(cells[6]);
  if (!is_one_of(geometry, "spherical planar aspherical cylinder_x cylinder_y")) {
    in_.must_be(line_, "Geometry", in_quotes(cells[6]), "SPHERICAL, PLANAR, ASPHERICAL, CYLINDER_X or CYLINDER_Y");
  }
  in_.limit(in_.lens.surfaces.size() + 1);
  const Medium before = in_.lens.surfaces.empty() ? Medium{} : in_.lens.surfaces.back().medium;
  SurfaceRow row{.radius = geometry == "planar" ? 0 : radius, .thickness = thickness};
  row.medium = medium(cells[5], index, abbe);
  // The stop is the first plane with an index of 0, or in air.
  const bool has_stop = std::ranges::any_of(in_.lens.surfaces, &SurfaceRow::stop);
  row.stop = !has_stop && radius == 0 && (index == 0 || (before == Medium{} && row.medium == Medium{}));
  // The letter names the axis of the cylinder.
  if (row.radius != 0 && geometry.starts_with("cylinder"))
    row.curved_in = geometry.back() == 'y' ? Section::x : Section::y;
  if (housing > 0) row.semi_diameter = housing;
  if (!remark.empty()) row.comment = std::string(beginning(remark, 200));
  in_.requests.surface_lines.push_back(line_);
  aspheric_lines_.push_back(geometry == "aspherical" ? line_ : 0);
  in_.lens.surfaces.push_back(std::move(row));
}

/// The surface of a number in front of a colon.
std::pair<SurfaceRow&, std::size_t> CraygReader::indexed(std::string_view word) {
  const double value = number("surface", word);
  if (!(value >= 0 && value < static_cast<double>(in_.lens.surfaces.size()) && value == std::floor(value))) {
    in_.must_be(line_, "surface", in_quotes(word), "the number of a row of [Surfaces], from 0");
  }
  return {in_.lens.surfaces[static_cast<std::size_t>(value)], static_cast<std::size_t>(value)};
}

/// "10: k=-1.2 a4=1e-6 a6=2e-9"
void CraygReader::asphere(std::string_view line) {
  const auto [surface, coefficients] = split(line);
  auto [row, index] = indexed(surface);
  if (aspheric_lines_[index] == 0) {
    in_.must_be(line_, "surface", std::to_string(index),
                "a surface with the geometry ASPHERICAL and one line of coefficients");
  }
  aspheric_lines_[index] = 0;
  for (const std::string_view word : words(coefficients)) {
    const std::size_t equals = std::min(word.find('='), word.size());
    const std::string name = lower(word.substr(0, equals));
    const double value = number(name, word.substr(std::min(equals + 1, word.size())));
    if (name == "k") {
      row.conic = value;
    } else if (is_one_of(name, "a2 a4 a6 a8 a10 a12 a14")) {
      if (value != 0) row.aspheric.push_back({std::stoi(name.substr(1)), value});
    } else {
      in_.must_be(line_, "coefficient", in_quotes(name), "k, a2, a4, ... or a14");
    }
  }
}

/// "Focal Length Samples: 70 135 200", then "5: 8.78 26.15 32.85" for each surface in front of a variable distance.
void CraygReader::distances(std::string_view line) {
  const auto [surface, numbers] = split(line);
  const auto samples = words(numbers);
  auto& list = in_.lens.configurations;
  if (same(surface, "focal length samples")) {
    in_.limit(samples.size(), "samples");
    list.clear();
    for (const std::string_view word : samples) {
      Configuration& position = list.emplace_back();
      position.focal_length_mm = number("focal length", word);
      position.name = to_text(*position.focal_length_mm) + " mm";
    }
    return;
  }
  auto [row, index] = indexed(surface);
  if (samples.empty() || samples.size() != list.size()) {
    in_.must_be(line_, "distances", std::to_string(samples.size()) + " numbers",
                std::to_string(list.size()) + ", one for each of the focal length samples");
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    change_of(list[i], static_cast<int>(index)).thickness = number("distance", samples[i]);
  }
  row.thickness = *change_of(list[0], static_cast<int>(index)).thickness;
}

void CraygReader::read(std::string_view text) {
  std::string section;
  for (Lines lines(text); lines.next();) {
    line_ = lines.number();
    const std::string_view whole = trimmed(lines.text());
    const std::size_t mark = std::min(whole.find('#'), whole.size());
    const std::string_view line = trimmed(whole.substr(0, mark)),
                           remark = trimmed(whole.substr(std::min(mark + 1, whole.size())));
    if (line.empty()) continue;
    if (line.starts_with('[')) {
      section = lower(line);
      if (section == "[elements]") section = "[surfaces]";
      if (std::ranges::find(sections, section) == sections.end()) {
        in_.must_be(line_, "section", in_quotes(line),
                    "[Metadata], [Surfaces], [Aspheric Coefficients] or [Variable Distances]");
      }
    } else if (section == "[metadata]") {
      metadata(line);
    } else if (section == "[surfaces]") {
      surface(words(line, columns.size() + 1), remark);
    } else if (section == "[aspheric coefficients]") {
      asphere(line);
    } else {
      distances(line);
    }
  }
  if (in_.lens.surfaces.empty()) throw Error(in_.where() + ": no rows after [Surfaces]; must be at least one");
  for (const int line : aspheric_lines_) {
    if (line > 0)
      in_.must_be(line, "Geometry", "ASPHERICAL without coefficients", "followed by a line in [Aspheric Coefficients]");
  }
  in_.lens.semi_diameters = "housing radii";
  in_.requests.names_missing_apertures = true;
}

}  // namespace

bool is_crayg(std::string_view text) {
  for (Lines lines(text); lines.next() && lines.number() <= 100;) {
    const std::string_view line = trimmed(lines.text());
    if (!line.empty() && !line.starts_with('#')) return same(line, "[metadata]");
  }
  return false;
}

void read_crayg(std::string_view text, Import& in) { CraygReader(in).read(text); }

}  // namespace petzval::formats_detail
