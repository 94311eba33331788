// SPDX-License-Identifier: Apache-2.0
// FlareSim's .lens files: keys ("focal_length: 50"), a line "surfaces:", then rows of radius, thickness, index,
// V-number, aperture and number of coating layers. The column of apertures is called semi_ap, but contains diameters in
// many files.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "io/json.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "table_lens.hpp"
#include "table_text.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using io_detail::in_quotes;

constexpr std::array<const char*, 6> names = {"radius", "thickness", "ior", "abbe", "semi_ap", "coating"};
constexpr std::size_t least_cells = 5, most_cells = names.size() + 1;

class FlaresimReader {
 public:
  explicit FlaresimReader(Import& in) : in_(in) {}
  void read(std::string_view text);

 private:
  void comment(int line, std::string_view text);
  void key(int line, std::string_view name, std::string_view value);
  void row(int line, const std::vector<std::string_view>& cells, std::string_view remark);

  Import& in_;
  TableLens table_;
  std::optional<double> of_rows_;  ///< f-number in the comment "52 surfaces, 31 glass elements, f/4.0"
  int of_rows_line_ = 0;
};

void FlaresimReader::comment(int line, std::string_view text) {
  if (text.empty() || text.starts_with("radius")) return;
  const auto stated = f_number_in(text);
  if (!in_.lens.f_number) in_.lens.f_number = stated;
  if (text.find(" surfaces, ") != std::string_view::npos) of_rows_ = stated, of_rows_line_ = line;
  in_.note(text);
}

void FlaresimReader::key(int line, std::string_view name, std::string_view value) {
  const auto positive = [&] {
    const auto read = number(value);
    if (!read || !(*read > 0)) in_.must_be(line, name, in_quotes(value), "a positive number");
    return *read;
  };
  if (same(name, "name")) {
    in_.lens.imported->title = std::string(beginning(value, 4096));
    // Comments round the f-number to a tenth.
    if (const auto stated = f_number_in(value)) in_.lens.f_number = stated;
  } else if (same(name, "focal_length")) {
    in_.lens.focal_length_mm = positive();
  } else if (same(name, "f_number") || same(name, "fnumber") || same(name, "f_stop")) {
    in_.lens.f_number = positive();
  } else {
    in_.warn(line, name, "is not known and is left out");
  }
}

void FlaresimReader::row(int line, const std::vector<std::string_view>& cells, std::string_view remark) {
  const bool stop = same(cells[0], "stop"), plane = is_plane_word(cells[0]);
  if (!stop && !plane && !looks_like_a_number(cells[0])) {
    in_.must_be(line, "row", in_quotes(cells[0]), "a surface: a radius, inf or stop; aspheric surfaces are not read");
  }
  if (cells.size() < least_cells || cells.size() > most_cells) {
    in_.must_be(line, "row", std::to_string(cells.size()) + " cells",
                "radius, thickness, ior, abbe, semi_ap, coating, type");
  }
  in_.limit(table_.rows.size() + 1);
  std::array<double, names.size()> values{};
  for (std::size_t i = stop || plane ? 1 : 0; i < std::min(cells.size(), names.size()); ++i) {
    const auto value = number(cells[i]);
    if (!value) in_.must_be(line, names[i], in_quotes(cells[i]), "a finite number with a decimal point");
    values[i] = *value;
  }
  Section section = Section::both;
  if (cells.size() == most_cells) {
    const std::string type = lower(cells.back());
    // The letter names the axis of the cylinder.
    if (type == "cyl_y" || type == "cylinder_y") {
      section = Section::x;
    } else if (type == "cyl_x" || type == "cylinder_x") {
      section = Section::y;
    } else if (type != "sph" && type != "spherical") {
      in_.must_be(line, "type", in_quotes(type), "sph, cyl_x or cyl_y");
    }
  }
  const auto [radius, thickness, ior, abbe, aperture, coating] = values;
  table_.rows.push_back({.line = line,
                         .radius = radius,
                         .thickness = thickness,
                         .index = ior,
                         .abbe = abbe,
                         .aperture = aperture,
                         .curved_in = radius == 0 ? Section::both : section,
                         .stop = stop ? "stop" : "",
                         .comment = std::string(beginning(remark, 200))});
}

void FlaresimReader::read(std::string_view text) {
  bool rows = false;
  for (Lines lines(text); lines.next();) {
    const std::string_view whole = trimmed(lines.text());
    const std::size_t mark = std::min(whole.find('#'), whole.size());
    const std::string_view line = trimmed(whole.substr(0, mark));
    std::string_view remark = whole.substr(mark);
    remark = trimmed(remark.substr(std::min(remark.find_first_not_of('#'), remark.size())));
    if (line.empty()) {
      comment(lines.number(), remark);
      continue;
    }
    if (rows) {
      row(lines.number(), words(line, most_cells + 1), remark);
      continue;
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) {
      in_.must_be(lines.number(), "line", in_quotes(line), "\"key: value\", or \"surfaces:\" before rows");
    }
    const std::string_view name = trimmed(line.substr(0, colon));
    rows = same(name, "surfaces");
    if (!rows) key(lines.number(), name, trimmed(line.substr(colon + 1)));
  }
  if (table_.rows.empty()) throw Error(in_.where() + ": no rows after \"surfaces:\"; must be at least one");
  // The name of a lens with a converter has the f-number of the bare lens. The comment is rounded to a tenth.
  if (of_rows_ && in_.lens.f_number && std::abs(*of_rows_ - *in_.lens.f_number) > 0.051) {
    in_.warn(of_rows_line_, "f-number",
             "f/" + to_text(*of_rows_, 4) + " of this line is taken, not f/" + to_text(*in_.lens.f_number, 4));
    in_.lens.f_number = of_rows_;
  }
  table_.likely_apertures = TableApertures::semi_diameters;
  table_.gaps = TableGaps::behind;
  build_table(std::move(table_), in_);
}

}  // namespace

bool is_flaresim(std::string_view text) {
  bool keys = false;
  for (Lines lines(text); lines.next() && lines.number() <= 1000;) {
    const std::string_view line = trimmed(lines.text());
    if (line.empty() || line.starts_with('#')) continue;
    const std::string_view key = line.substr(0, line.find(':'));
    if (same(line, "surfaces:")) return keys;
    keys = keys || same(key, "name") || same(key, "focal_length");
  }
  return false;
}

void read_flaresim(std::string_view text, Import& in) { FlaresimReader(in).read(text); }

}  // namespace petzval::formats_detail
