// SPDX-License-Identifier: Apache-2.0
#include "table_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "text_file.hpp"

namespace petzval::inline v0::files_detail {
namespace {

constexpr std::size_t most_rows = 10'000;

struct Row {
  int line = 0;
  double radius = 0, gap = 0, index = 0, abbe = 0, aperture = 0;
};

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//") || line.starts_with(';') || line.starts_with('%');
}

std::string_view without_comma(std::string_view word) {
  if (word.ends_with(',') || word.ends_with(';')) word.remove_suffix(1);
  return word;
}

/// "100 mm", "100mm", ".100mm." and "f/2", "f1.35": what comments and file names say about a lens.
std::optional<double> number_before(std::string_view text, std::string_view unit) {
  for (std::size_t at = text.find(unit); at != std::string_view::npos; at = text.find(unit, at + 1)) {
    std::size_t end = at;
    while (end > 0 && text[end - 1] == ' ') --end;
    std::size_t start = end;
    while (start > 0 && (std::string_view("0123456789.").find(text[start - 1]) != std::string_view::npos)) --start;
    while (start < end && text[start] == '.') ++start;
    if (const auto value = number(text.substr(start, end - start)); value && *value > 0) return value;
  }
  return {};
}

std::optional<double> number_behind_f(std::string_view text) {
  for (std::size_t at = text.find('f'); at != std::string_view::npos; at = text.find('f', at + 1)) {
    if (at > 0 && std::string_view(" .,(-_/").find(text[at - 1]) == std::string_view::npos) continue;
    std::size_t start = at + 1;
    if (start < text.size() && text[start] == '/') ++start;
    std::size_t end = start;
    while (end < text.size() && std::string_view("0123456789.").find(text[end]) != std::string_view::npos) ++end;
    while (end > start && text[end - 1] == '.') --end;
    if (const auto value = number(text.substr(start, end - start)); value && *value >= 0.5 && *value <= 64)
      return value;
  }
  return {};
}

class TableReader {
 public:
  explicit TableReader(Import& in) : in_(in) {}
  void read(std::string_view text);

 private:
  void take(int line, const std::vector<std::string_view>& columns);
  void order_columns();
  void order_gaps();
  void build();
  void choose_diameters();
  void place_film();
  double f_number(double aperture_scale) const;

  Import& in_;
  std::vector<Row> rows_;
  std::size_t columns_ = 0;
  std::string said_;  ///< comments and the file's name
};

void TableReader::take(int line, const std::vector<std::string_view>& columns) {
  if (columns_ == 0) columns_ = columns.size();
  if (columns.size() != columns_ || columns_ < 4 || columns_ > 5) {
    in_.refuse(
        line, "row", std::to_string(columns.size()) + " columns",
        columns_ == 5 ? "5: radius, thickness, index, V-number, aperture" : "4: radius, thickness, index, aperture");
  }
  if (rows_.size() >= most_rows) {
    throw Error(in_.where() + ": more than " + std::to_string(most_rows) + " surfaces, wanted fewer");
  }
  static constexpr std::array<const char*, 5> names = {"radius", "thickness", "index", "V-number", "aperture"};
  std::array<double, 5> values{};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::size_t meaning = i == 3 && columns_ == 4 ? 4 : i;
    values[meaning] = in_.number(line, names[meaning], without_comma(columns[i]));
  }
  rows_.push_back({line, values[0], values[1], values[2], values[3], values[4]});
}

/// Five columns stand in either order; V-numbers of glasses lie between 15 and 110.
void TableReader::order_columns() {
  if (columns_ != 5) return;
  const auto plausible = [&](double Row::*member) {
    return std::ranges::all_of(rows_, [&](const Row& row) {
      return row.index <= 1.01 || (row.*member >= 15 && row.*member <= 110) || row.*member == 0;
    });
  };
  if (plausible(&Row::abbe) || !plausible(&Row::aperture)) return;
  for (Row& row : rows_) std::swap(row.abbe, row.aperture);
  in_.warn(rows_.front().line, "columns", "the last column is taken as V-numbers, the one before it as apertures");
}

/// The second column is the gap in front of each surface where the first glass would have no thickness.
void TableReader::order_gaps() {
  if (!(rows_.size() > 1 && rows_.front().gap == 0 && rows_.front().index > 1.01)) return;
  in_.warn(rows_.front().line, "thickness",
           "the first glass has none, so the second column is taken as the gap in front of each surface");
  for (std::size_t i = 0; i + 1 < rows_.size(); ++i) rows_[i].gap = rows_[i + 1].gap;
  rows_.back().gap = 0;
}

void TableReader::build() {
  const bool index_0_marks_stops =
      std::ranges::any_of(rows_, [](const Row& r) { return r.radius == 0 && r.index == 0; });
  double before = 1;
  for (const Row& row : rows_) {
    const double index = row.index == 0 ? 1 : row.index;
    SurfaceRow& surface = in_.lens.surfaces.emplace_back();
    surface.radius = row.radius;
    surface.thickness = row.gap;
    surface.medium.nd = index;
    if (row.abbe > 0 && index != 1) surface.medium.vd = row.abbe;
    surface.stop = row.radius == 0 && (index_0_marks_stops ? row.index == 0 : index == before);
    if (row.aperture < 0) in_.refuse(row.line, "aperture", to_text(row.aperture), "0 or more");
    if (row.aperture > 0) surface.semi_diameter = row.aperture / 2;
    before = index;
  }
}

double TableReader::f_number(double aperture_scale) const {
  Prescription p = in_.lens;
  p.imported.reset();
  for (SurfaceRow& row : p.surfaces) {
    if (row.semi_diameter) *row.semi_diameter *= aperture_scale;
  }
  return paraxial_f_number(in_.compiled(p));
}

/// Some tables have semi-diameters in the place of diameters. The f-number that the file declares tells, where no
/// comment does.
void TableReader::choose_diameters() {
  in_.lens.semi_diameters = "half of the table's apertures";
  if (!in_.lens.f_number || lower(said_).find("aperture diameter") != std::string::npos) return;
  const double as_diameters = f_number(1), as_radii = f_number(2), declared = *in_.lens.f_number;
  const auto off = [&](double found) { return std::abs(std::log(found / declared)); };
  if (!(std::isfinite(as_diameters) && std::isfinite(as_radii)) || off(as_diameters) <= off(as_radii)) return;
  for (SurfaceRow& row : in_.lens.surfaces) {
    if (row.semi_diameter) *row.semi_diameter *= 2;
  }
  in_.lens.semi_diameters = "the table's apertures";
  in_.warn(rows_.front().line, "aperture",
           "the last column is taken as semi-diameters: they give f/" + to_text(as_radii, 3) + ", diameters f/" +
               to_text(as_diameters, 3) + ", and the file declares f/" + to_text(declared, 3));
}

void TableReader::place_film() {
  SurfaceRow& last = in_.lens.surfaces.back();
  if (last.thickness != 0) return;
  Prescription p = in_.lens;
  p.imported.reset();
  const FirstOrder first = first_order(in_.compiled(p));
  if (first.afocal || !(first.back_focal_distance > 0)) return;
  last.thickness = first.back_focal_distance;
  in_.lens.image_distance = "paraxial focus";
  in_.warn(rows_.back().line, "thickness",
           "of the last surface is 0; the film is put at the paraxial focus, " + to_text(last.thickness, 7) + " mm");
}

void TableReader::read(std::string_view text) {
  for (Lines lines(text); lines.next();) {
    const std::string_view line = trimmed(lines.text());
    if (line.empty()) continue;
    if (is_comment(line)) {
      const std::string_view words_of_it = trimmed(line.substr(std::min(line.find_first_not_of("#/;%"), line.size())));
      if (said_.size() < 65'536) said_ += std::string(beginning(words_of_it, 4096)) + ' ';
      auto& notes = in_.lens.imported->notes;
      if (!words_of_it.empty() && notes.size() < 1000) notes.emplace_back(beginning(words_of_it, 4096));
      continue;
    }
    const auto columns = words(line.substr(0, line.find('#')), 64);
    const bool names = rows_.empty() && !number(without_comma(columns[0])) &&
                       columns[0].find_first_of("0123456789") == std::string_view::npos;
    if (!names) take(lines.number(), columns);
  }
  if (rows_.empty()) throw Error(in_.where() + ": no rows, wanted radius, thickness, index and aperture of surfaces");
  auto& notes = in_.lens.imported->notes;
  if (!notes.empty()) {
    in_.lens.imported->title = notes.front();
    notes.erase(notes.begin());
  }
  said_ += ' ' + in_.lens.id + ' ';
  const std::string all = lower(said_);
  in_.lens.focal_length_mm = number_before(all, "mm");
  in_.lens.f_number = number_behind_f(all);
  order_columns();
  order_gaps();
  build();
  validate(in_.lens, in_.where());
  choose_diameters();
  place_film();
}

}  // namespace

bool is_table(std::string_view text) {
  int tried = 0;
  for (Lines lines(text); lines.next();) {
    const std::string_view line = trimmed(lines.text());
    if (line.empty() || is_comment(line)) continue;
    const auto columns = words(line, 6);
    const auto is_number = [](std::string_view word) {
      // A decimal comma makes it a bad table, not another format.
      std::string text_of(without_comma(word));
      std::ranges::replace(text_of, ',', '.');
      return number(text_of).has_value() || text_of == "nan" || text_of == "inf" || text_of == "1e400";
    };
    if ((columns.size() == 4 || columns.size() == 5) && std::ranges::all_of(columns, is_number)) return true;
    if (++tried == 2) return false;
  }
  return false;
}

void read_table(std::string_view text, Import& in) { TableReader(in).read(text); }

}  // namespace petzval::inline v0::files_detail
