// SPDX-License-Identifier: Apache-2.0
// Pages of patents, pasted whole: text, a table of surfaces, aspheric data, a table of positions. A line that has
// numbers and is not understood is refused; other lines are skipped, and a warning says which.
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "page_aspheres.hpp"
#include "page_positions.hpp"
#include "page_table.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using io_detail::in_quotes;

/// A lens on a page: the lines [first, last), and the line of its first row or head.
struct Embodiment {
  std::size_t first = 0, head = 0, last = 0;
};

/// True if the rows below a head begin with the first surface, and do not continue a table.
bool begins_table(std::span<const PageLine> below) {
  for (const PageLine& line : below.first(std::min<std::size_t>(below.size(), 8))) {
    if (is_top(line) || line.tokens.size() < 2) continue;
    const std::size_t star = line.tokens[0].text == "*" ? 1 : 0;
    const auto label = label_of(line.tokens[star].text);
    if (label) return *label <= 1;
    if (line.numbers() > 1) return true;
  }
  return false;
}

std::vector<Embodiment> embodiments_of(std::span<const PageLine> lines) {
  std::vector<Embodiment> all;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool is_head = !surface_columns(lines[i]).empty();
    const bool head = is_head && (all.empty() || begins_table(lines.subspan(i + 1)));
    if (!head && !names_radius(lines[i], 1)) continue;
    // Words above "r1 = 52.1" may read as a head.
    if (!head && !all.empty() && i - all.back().head <= 3 && names_radius(lines[i], 1) &&
        !names_radius(lines[all.back().head], 1)) {
      all.back().head = i;
      continue;
    }
    Embodiment next{0, i, lines.size()};
    if (!all.empty()) {
      // The title of an example, and its focal length, precede its table.
      const std::size_t before = all.back().head;
      next.first = i;
      for (std::size_t k = i; k-- > before + 1;) {
        const bool near = i - k <= 8 && lines[k].says("table");
        const bool title = (near || lines[k].says("example embodiment")) && lines[k].tokens.size() <= 8;
        if (!title) continue;
        next.first = k;
        break;
      }
      all.back().last = next.first;
    }
    all.push_back(next);
  }
  return all;
}

class PageReader {
 public:
  PageReader(std::vector<PageLine> lines, Import& in)
      : page_(std::move(lines)), lines_(page_), in_(in), aspheres_(page_, in), positions_(in) {}
  void read();

 private:
  enum class Section { text, rows, aspheres, positions, skipped };

  void choose();
  void collect_gaps();
  void take(const PageLine& line);
  bool open_section(const PageLine& line);
  void skip(const PageLine& line);
  void say_skipped();
  void build();

  std::vector<PageLine> page_;
  std::span<const PageLine> lines_;  ///< of the embodiment
  Import& in_;
  PageTable table_;
  PageAspheres aspheres_;
  std::optional<PagePositions> values_;
  Positions positions_;
  Section section_ = Section::text;
  std::vector<const PageLine*> skipped_;
  bool several_ = false;  ///< true if the page has several tables
};

/// Selects the embodiment that ReadOptions::entry names.
void PageReader::choose() {
  const auto all = embodiments_of(lines_);
  const auto wanted = number(in_.entry());
  std::string list;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PageLine& title = lines_[i == 0 ? all[i].head : all[i].first];
    append(list, ", ", std::to_string(i + 1) + " in line " + std::to_string(title.number));
  }
  if (all.empty()) throw Error(in_.where() + ": no table of surfaces; must be a table of radius, thickness and index");
  several_ = all.size() > 1;
  if (several_ && in_.entry().empty()) {
    throw Error(in_.where() + ": the page has " + std::to_string(all.size()) + " tables of lenses: " + list +
                "; must be chosen (--embodiment N)");
  }
  const bool exists =
      wanted && *wanted >= 1 && *wanted <= static_cast<double>(all.size()) && *wanted == std::floor(*wanted);
  if (several_ && !exists) {
    throw Error(in_.where() + ": embodiment = " + in_quotes(in_.entry()) + "; must be a number of a table: " + list);
  }
  const Embodiment& chosen = all[exists ? static_cast<std::size_t>(*wanted) - 1 : 0];
  lines_ = lines_.subspan(chosen.first, chosen.last - chosen.first);
  if (several_) in_.lens.imported->entry = in_.entry();
}

/// Opens the section that a title names; false for other lines.
bool PageReader::open_section(const PageLine& line) {
  const bool bracket = line.text.find('[') == line.text.find_first_not_of(" \t");
  if (!line.has_words_only() && !bracket) return false;
  if (!line.numbers() && line.tokens.size() > 12) return false;  // a sentence
  if (line.says("aspher conic coefficient")) {
    section_ = Section::aspheres;
  } else if (line.says("condition expression") ||
             (line.says("group unit single constituent") && line.says("data focal"))) {
    section_ = Section::skipped;
  } else if (line.says("variable various specification general interval spacing") ||
             (line.says("zoom") && line.says("data distance ratio"))) {
    section_ = Section::positions;
  } else {
    return false;
  }
  return true;
}

/// Skips a line of text; refuses a line of numbers.
void PageReader::skip(const PageLine& line) {
  const auto& t = line.tokens;
  const auto is_coefficient = [](const PageToken& x) { return x.is_number && x.text.find('e') != x.text.npos; };
  const bool coefficient = std::ranges::any_of(t, is_coefficient);
  const std::size_t half = 2 * line.numbers() + (section_ == Section::rows ? 1 : 0);
  const bool numbers = line.numbers() > 1 && half > t.size();
  // "AlO = 0.0001" is a term with letters for digits, "SC = 0.5" an unknown name of a conic.
  const auto is_term = [](const PageToken& x) {
    const bool other = std::string_view("fFdDrR(").find(x.text[0]) != std::string_view::npos;
    return !other && x.text.find('/') == std::string::npos;
  };
  bool value = false;
  for (std::size_t i = 1; i < t.size(); ++i)
    value = value || (t[i].text == "=" && line.numbers() > 0 && is_term(t[i - 1]));
  value = value || (line.numbers() > 0 && line.says("conic coefficient") && line.says("="));
  // "Exit pupil position 20.1 30.2", "3 4" at the top of a page.
  const auto is_word = [](const PageToken& x) {
    return letters_in(x.text) > 2 && x.text.find_first_of("0123456789") == x.text.npos && !is_plane_word(x.text);
  };
  const bool named = is_word(t[0]) && (section_ == Section::positions || (t.size() > 1 && is_word(t[1])));
  const bool condition =
      t[0].text.size() > 2 && t[0].text[0] == '(' && label_of(t[0].text.substr(1, t[0].text.size() - 2));
  const bool top =
      condition || is_one_of(t[0].text, "position positions") || is_top(line) ||
      is_one_of(t[0].text,
                "US EP JP DE GB FR CN KR TW WO Jan. Feb. Mar. Apr. May Jun. Jul. Aug. Sep. Sept. Oct. Nov. Dec.");
  const bool suspect =
      coefficient || (numbers && !named && !top) || (value && t.size() < 12 && section_ == Section::aspheres);
  if (!table_.is_empty() && section_ != Section::skipped && suspect && !line.says("continued")) {
    in_.must_be(line.number, "line", line.said(),
                section_ == Section::rows ? "the next row of the table of surfaces, or text"
                                          : "aspheric data, a value with its name, or text");
  }
  skipped_.push_back(&line);
}

void PageReader::take(const PageLine& line) {
  const std::string_view start = trimmed(line.text);
  if (line.says("continued")) return skip(line);
  if (auto columns = surface_columns(line); !columns.empty()) {
    table_.set_head(line, std::move(columns));
    section_ = Section::rows;
    return;
  }
  if (start.starts_with("# ") || start.starts_with("//") || start.starts_with('%')) {
    return in_.note(trimmed(start.substr(start.find_first_not_of("#/%"))));
  }
  // A title may stand between rows.
  if (!table_.is_empty() && table_.is_next(line)) section_ = Section::rows;
  if (section_ == Section::rows && table_.take_row(line)) return in_.limit(table_.rows().size());
  if (section_ == Section::rows && table_.is_other_row(line)) {
    in_.must_be(line.number, "row", line.said(), "the row that follows the row above");
  }
  if (section_ <= Section::rows && table_.take_named(line)) {
    section_ = Section::rows;
    values_->take_gaps(line);
    return in_.limit(table_.rows().size());
  }
  if (!table_.is_empty() && section_ != Section::skipped && section_ != Section::positions &&
      aspheres_.take(line, section_ == Section::aspheres)) {
    section_ = Section::aspheres;
    return;
  }
  if (section_ != Section::skipped && values_->take(line)) return;
  if (!open_section(line)) skip(line);
}

/// Names the thicknesses that vary before the values are read, which may precede the table.
void PageReader::collect_gaps() {
  PageTable rows;
  for (const PageLine& line : lines_) {
    if (auto columns = surface_columns(line); !columns.empty()) {
      rows.set_head(line, std::move(columns));
    } else if (!rows.take_row(line)) {
      rows.take_named(line);
    }
  }
  std::set<std::string> gaps;
  for (const PageRow& row : rows.rows()) {
    if (!row.variable.empty()) gaps.insert(row.variable);
  }
  gaps.erase("Bf");
  values_.emplace(std::move(gaps), in_);
}

void PageReader::say_skipped() {
  if (skipped_.empty()) return;
  const std::string more = "more lines, up to line " + std::to_string(skipped_.back()->number) + ", are skipped";
  in_.warn(skipped_.front()->number, "text",
           skipped_.front()->said() + (skipped_.size() > 1 ? " and " + more : " is skipped"));
  in_.lens.imported->title = std::string(beginning(trimmed(skipped_.front()->text), 200));
}

void PageReader::build() {
  if (table_.is_empty()) {
    throw Error(in_.where() +
                ": no row with the number 1 below a head; must be a table of radius, thickness and index");
  }
  table_.complete(in_);
  const auto& rows = table_.rows();
  read_table(table_.lines(), in_);
  auto& surfaces = in_.lens.surfaces;
  if (surfaces.size() != rows.size()) {
    in_.must_be(rows.front().line, "table", std::to_string(rows.size()) + " rows", "a surface per row");
  }
  if (table_.object_distance()) in_.lens.design.object_distance_mm = *table_.object_distance();
  const auto is_glass = [](const SurfaceRow& s) { return s.mirror || !s.medium.is_air(); };
  const auto has_vd = [](const SurfaceRow& s) { return s.mirror || s.medium.vd || s.medium.glass; };
  if (std::ranges::none_of(surfaces, is_glass))
    in_.must_be(rows.front().line, "index", "missing in all rows", "stated for glass");
  if (std::ranges::none_of(surfaces, has_vd))
    in_.warn(rows.front().line, "V-number", "is stated for no glass; the lens has no colour");
  aspheres_.apply(table_, several_);
  values_->apply(positions_);
  const auto at = [&](const std::string& name) -> Variable* {
    const auto found = positions_.variables.find(name);
    return found == positions_.variables.end() ? nullptr : &found->second;
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Positions::Row row{rows[i].line, {}, {}};
    row.thickness.number = surfaces[i].thickness;
    if (surfaces[i].semi_diameter) row.diameter.number = 2 * *surfaces[i].semi_diameter;
    const bool last = i + 1 == rows.size();
    // The back focus of a page may count from the lens in front of a cover glass.
    const bool cover = last && rows.size() > 2 && surfaces[i].radius == 0 && surfaces[i - 1].radius == 0;
    // "Bf" in the last row, or nothing: the value of the page.
    const std::string name = !rows[i].variable.empty() ? rows[i].variable : "Bf";
    if (!rows[i].variable.empty() || (last && !cover && surfaces[i].thickness == 0)) {
      row.thickness = {{}, at(name) || !last ? at(name) : at("Bf")};
      if (!row.thickness.variable && !last) {
        in_.must_be(rows[i].line, "thickness", in_quotes(name),
                    "a row of the table of positions, which the page lacks");
      }
      if (row.thickness.variable) {
        row.thickness.variable->used = true;
        in_.requests.last_plane_may_be_film = in_.requests.last_plane_may_be_film && !last;
      }
    }
    positions_.rows.push_back(row);
  }
  positions_.apply();
  if (in_.lens.focal_length_mm) {
    in_.requests.focal_length = {at("Focal Length")->line, "f", *in_.lens.focal_length_mm, false, true};
  } else {
    in_.warn(rows.front().line, "f", "is not stated by the page; no focal length checks the table");
  }
}

void PageReader::read() {
  choose();
  collect_gaps();
  for (const PageLine& line : lines_) take(line);
  say_skipped();
  build();
}

}  // namespace

/// A page has a table of surfaces, and radii with names, sections, thicknesses that vary, or rows of air without cells
/// for the glass.
bool is_page(std::string_view text) {
  const auto lines = page_lines(text.substr(0, std::min<std::size_t>(text.size(), 1 << 20)));
  PageTable table;
  bool values_before = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const PageLine& line = lines[i];
    if (trimmed(line.text).starts_with('#')) continue;
    if (auto columns = surface_columns(line); !columns.empty()) {
      if (i + 1 == lines.size()) continue;
      const auto label = label_of(lines[i + 1].tokens.front().text);
      if (label && *label > 1 && columns.front().kind == Column::number) return true;  // the first row is missing
      if (!begins_table(std::span(lines).subspan(i + 1))) continue;
      if (values_before || !table.is_empty()) return true;
      table.set_head(line, std::move(columns));
      continue;
    }
    if (names_radius(line, 1)) return true;
    if (table.take_row(line)) continue;
    if (table.is_other_row(line)) return true;
    const std::string_view first = line.tokens.front().text;
    const bool value = std::ranges::any_of(line.tokens, [](const PageToken& t) { return t.text == "="; });
    const bool letter = letters_in(first.substr(0, 1)) > 0 || first[0] == '(';
    const bool has_word = letter && !is_plane_word(first) && !is_stop_word(first) && !is_asphere_mark(first) &&
                          !label_of(first) && !is_one_of(first, "S film sensor");
    const bool focal_length = line.numbers() > 0 && (line.says("focal") || is_one_of(first, "f fno efl"));
    values_before = values_before || value || focal_length || first.starts_with('[');
    if (table.rows().size() > 1 && (value || has_word || first.starts_with('['))) return true;
  }
  return table.is_printed();
}

void read_page(std::string_view text, Import& in) { PageReader(page_lines(text), in).read(); }

}  // namespace petzval::formats_detail
