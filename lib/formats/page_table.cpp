// SPDX-License-Identifier: Apache-2.0
#include "page_table.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

bool is_object(std::string_view word) { return lower(word).starts_with("obj"); }
bool is_image(std::string_view word) { return is_one_of(word, "img ima image im"); }

/// True for the columns that a row of air leaves out.
bool is_of_glass(Column kind) {
  return kind == Column::index || kind == Column::abbe || kind == Column::glass || kind == Column::catalogue ||
         kind == Column::left_out;
}

bool is_aperture(Column kind) {
  return kind == Column::semi_diameter || kind == Column::diameter || kind == Column::aperture;
}

/// The cells of a line between separators, as tokens; an empty cell is "-".
std::vector<PageToken> divided(std::string_view text, char separator) {
  std::vector<PageToken> cells;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(separator, from), text.size());
    const std::string_view cell = trimmed(text.substr(from, to - from));
    cells.push_back({cell.empty() ? "-" : std::string(cell), number(cell).has_value()});
    from = to + 1;
  }
  return cells;
}

/// The label of a row in front of a bracket, and the bracket: "13(St)".
std::pair<std::optional<int>, std::string_view> label_and_mark(std::string_view word) {
  const std::size_t bracket = std::min(word.find('('), word.size());
  if (const auto label = label_of(word)) return {label, mark_of(word)};
  return {bracket > 0 ? label_of(word.substr(0, bracket)) : std::nullopt, word.substr(bracket)};
}

/// True for the name of a lens or a group: "L1", "G2".
bool is_element(std::string_view word) {
  return word.size() > 1 && (word[0] == 'L' || word[0] == 'G') && label_of(word.substr(1));
}

/// A mark of the stop or of an asphere: "(aperture stop)", "STO", "*", "(ASP)"; also other text in brackets.
struct Mark {
  bool is_mark = false, stop = false, asphere = false;
};

Mark mark_in(std::string_view word) {
  const bool in_brackets = word.size() > 2 && word.starts_with('(') && word.ends_with(')');
  const std::string inner = lower(in_brackets ? word.substr(1, word.size() - 2) : word);
  const auto contains = [&](std::string_view part) { return inner.find(part) != std::string::npos; };
  Mark mark{.is_mark = in_brackets || is_stop_word(word) || is_asphere_mark(word) || is_element(word) ||
                       is_one_of(word, "fs f.s. fc cg st sp blende")};
  if (!mark.is_mark || contains("variable") || contains("flare") || !variable_name(inner).empty()) {
    mark.is_mark = mark.is_mark && contains("flare");
    return mark;
  }
  mark.asphere = contains("asp") || contains("*");
  mark.stop = !mark.asphere && (contains("stop") || contains("sto") || contains("aperture") || contains("diaphragm") ||
                                contains("iris") || is_one_of(inner, "ast as s st sp blende"));
  return mark;
}

/// A value with a name: "r1 = 5", "r 1 = 5", "r1 5", "nD = 1.65". `kind` is empty for other words.
struct Named {
  std::string kind, number;
  std::size_t value = 0;  ///< place of the value
};

Named named_at(const std::vector<PageToken>& t, std::size_t i) {
  std::string name = lower(t[i].text);
  std::erase_if(name, [](char c) { return std::string_view("'*()_").find(c) != std::string_view::npos; });
  std::size_t next = i + 1;
  if (next + 1 < t.size() && t[next].is_number && t[next + 1].text == "=") name += t[next++].text;
  const bool equals = next < t.size() && t[next].text == "=";
  const std::size_t value = next + equals;
  const std::size_t digits = std::min(name.find_first_of("0123456789"), name.size());
  const bool long_name = is_one_of(name, "nd vd \u03bdd \u03c5d");
  const bool may_lack_number = long_name || (equals && is_one_of(name, "n v \u03bd \u03c5"));
  if (value >= t.size() || digits == 0 || (digits == name.size() && !may_lack_number)) return {};
  if (name.find_first_not_of("0123456789", digits) != std::string::npos) return {};
  // Without "=", a row of positions has several numbers.
  if (!equals && value + 1 < t.size() && t[value + 1].is_number) return {};
  return {name.substr(0, digits), name.substr(digits), value};
}

/// True if a cell can stand in a column.
bool fits(Column kind, const PageToken& cell, bool last) {
  if (is_none(cell.text)) return true;
  const auto value = number(cell.text);
  const auto within = [&](double least, double most) { return value && *value >= least && *value <= most; };
  switch (kind) {
    case Column::radius:
    case Column::curvature: return value || is_plane_word(cell.text);
    case Column::thickness:
    case Column::gap_before: return value || cell.text == "(variable)" || (last && is_plane_word(cell.text));
    case Column::index: return same(cell.text, "air") || value == 0.0 || within(0.999, 1.001) || within(1.3, 2.7);
    case Column::abbe: return value == 0.0 || within(8, 120);
    case Column::glass: return !value;
    case Column::semi_diameter:
    case Column::diameter:
    case Column::aperture: return within(0, HUGE_VAL);
    case Column::conic:
    case Column::term: return value.has_value();
    default: return true;
  }
}

}  // namespace

bool names_radius(const PageLine& line, int label) {
  for (std::size_t i = 0; i + 1 < line.tokens.size(); ++i) {
    const Named name = named_at(line.tokens, i);
    const PageToken& value = line.tokens[name.value];
    if (name.kind == "r" && label_of(name.number) == label && (value.is_number || is_plane_word(value.text)))
      return true;
  }
  return false;
}

bool is_top(const PageLine& line) {
  const auto& t = line.tokens;
  return t.size() == 2 && label_of(t[0].text) && label_of(t[1].text) == *label_of(t[0].text) + 1;
}

std::string variable_name(std::string_view word) {
  std::string name;
  for (const char c : word) {
    if (std::string_view("()[]' .").find(c) == std::string_view::npos) name += lower(c);
  }
  if (is_one_of(name, "bf bfl fb b.f.")) return "Bf";
  const std::size_t letters = name.starts_with("dd") ? 2 : name.starts_with('d') ? 1 : 0;
  const bool digits = letters > 0 && name.size() > letters && name.size() <= letters + 4 &&
                      name.find_first_not_of("0123456789", letters) == std::string::npos;
  return digits ? 'd' + name.substr(letters) : std::string();
}

std::vector<TableColumn> surface_columns(const PageLine& line) {
  // Lines with numbers or values are no heads, unless the head names its columns' lines: "n(587.6)".
  if (line.numbers() > 1 || line.tokens.size() < 3) return {};
  for (const char separator : {'\t', '|', ';', ',', ' '}) {
    std::vector<std::string_view> heads;
    const std::vector<PageToken> cells = separator == ' ' ? line.tokens : divided(line.text, separator);
    for (const PageToken& cell : cells) {
      // "\u03b8g, F" is one head.
      if (!heads.empty() && heads.back().starts_with("\u03b8") && is_one_of(cell.text, "F Fj")) continue;
      if (cell.text != "-" && cell.text != "=") heads.push_back(cell.text);
    }
    if (separator != ' ' && heads.size() < 3) continue;
    std::vector<TableColumn> columns = columns_of(heads, separator == ' ');
    const auto has = [&](std::initializer_list<Column> kinds) {
      return std::ranges::any_of(columns, [&](const TableColumn& c) { return std::ranges::count(kinds, c.kind) > 0; });
    };
    const bool surfaces = has({Column::radius, Column::curvature}) && has({Column::thickness, Column::gap_before}) &&
                          has({Column::index, Column::glass});
    if (surfaces) return columns;
  }
  return {};
}

std::size_t PageTable::find(Column kind) const {
  return static_cast<std::size_t>(std::ranges::find(columns_, kind, &TableColumn::kind) - columns_.begin());
}

PageRow* PageTable::find(int label) {
  const auto found = std::ranges::find(rows_, std::optional(label), &PageRow::label);
  return found == rows_.end() ? nullptr : &*found;
}

void PageTable::set_head(const PageLine& line, std::vector<TableColumn> columns) {
  head_line_ = line.number;
  labelled_ = columns.front().kind == Column::number;
  while (!columns.empty() && columns.front().kind == Column::number) columns.erase(columns.begin());
  counted_ = labelled_ || std::ranges::find(columns, Column::number, &TableColumn::kind) != columns.end();
  columns_ = std::move(columns);
  separator_ = ' ';
  for (const char separator : {'\t', '|', ';', ','}) {
    const auto cells = static_cast<std::size_t>(std::ranges::count(line.text, separator)) + 1;
    if (cells >= columns_.size()) {
      separator_ = separator;
      break;
    }
  }
}

/// The cells behind the label.
std::vector<PageToken> PageTable::cells_of(const PageLine& line, std::size_t from) const {
  if (separator_ == ' ') return {line.tokens.begin() + static_cast<std::ptrdiff_t>(from), line.tokens.end()};
  std::vector<PageToken> cells = divided(trimmed(line.text), separator_);
  if (separator_ == '|') {
    if (!cells.empty() && cells.front().text == "-") cells.erase(cells.begin());
    if (cells.size() > columns_.size() + (from > 0) && cells.back().text == "-") cells.pop_back();
  }
  if (from > 0) cells.erase(cells.begin());
  return cells;
}

/// A row without the marks in front of and behind its numbers.
PageRow PageTable::take_marks(const PageLine& line, std::size_t from) const {
  PageRow row{.line = line.number};
  std::vector<PageToken> cells = cells_of(line, from);
  // "inf(stop)".
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t bracket = std::min(cells[i].text.find('('), cells[i].text.size());
    if (bracket == cells[i].text.size() || !is_plane_word(cells[i].text.substr(0, bracket))) continue;
    cells.insert(cells.begin() + static_cast<std::ptrdiff_t>(i) + 1, {cells[i].text.substr(bracket)});
    cells[i].text.resize(bracket);
  }
  const auto take = [&](std::size_t at) {
    const Mark mark = mark_in(cells[at].text);
    const bool plane = is_plane_word(cells[at + 1 < cells.size() ? at + 1 : 0].text);
    const bool short_s = same(cells[at].text, "s") && plane;
    if (cells[at].text.size() > 2 && cells[at].text.ends_with('*')) {  // "34.3*"
      const std::string_view value = std::string_view(cells[at].text).substr(0, cells[at].text.size() - 1);
      if (!number(value) && !is_plane_word(value)) return false;
      cells[at] = PageToken{std::string(value), number(value).has_value()};
      row.asphere = true;
      return false;
    }
    if (!mark.is_mark && !short_s) return false;
    if (mark.stop || short_s) row.stop = "stop";
    row.asphere = row.asphere || mark.asphere;
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(at));
    return true;
  };
  while (!cells.empty() && take(0)) {
  }
  const bool words_last =
      !columns_.empty() && (columns_.back().kind == Column::comment || columns_.back().kind == Column::stop);
  while (cells.size() > 1 && !words_last && take(cells.size() - 1)) {
  }
  // "plano stop 9.0", "inf (STOP) 1.5".
  for (std::size_t at = cells.size(); !words_last && cells.size() > 2 && at-- > 1;) {
    const Mark mark = mark_in(cells[at].text);
    if ((mark.stop || mark.asphere) && cells[at].text.size() > 1) take(at);
  }
  row.cells = std::move(cells);
  return row;
}

/// The label that the next row has; nullopt before the first row, and if rows have no labels.
std::optional<int> PageTable::next_label() const {
  const auto last =
      std::ranges::find_if(rows_.rbegin(), rows_.rend(), [](const PageRow& row) { return row.label.has_value(); });
  return last == rows_.rend() ? std::nullopt : std::optional(*last->label + 1);
}

/// The tokens of a row without words that name the element: "L1 1 52.1", "2 Lens 1 42.9", "6: inf", "8 IR filter inf".
std::vector<PageToken> PageTable::row_tokens(const PageLine& line) const {
  std::vector<PageToken> t = line.tokens;
  if (separator_ != ' ' || !labelled_) return t;
  // "ST 7 inf": the mark stands in front of the number.
  if (t.size() > 2 && is_one_of(t[0].text, "s st as sto stop") && label_of(t[1].text)) {
    t[0] = t[1];
    t[1] = {"(stop)"};
  }
  if (is_element(t[0].text) && t.size() > 2 && label_of(t[1].text)) t.erase(t.begin());
  if (!label_of(t[0].text)) return t;
  if (t.size() > 1 && t[1].text == "=") t.erase(t.begin() + 1);
  const auto is_name = [](const PageToken& token) {
    return letters_in(token.text) > 2 && !is_plane_word(token.text) && !is_stop_word(token.text) &&
           !is_asphere_mark(token.text) && !is_image(token.text) && variable_name(token.text).empty() &&
           token.text.find('(') == std::string::npos && token.text.find('*') == std::string::npos &&
           lower(token.text).find("variable") == std::string::npos;
  };
  while (t.size() > 2 && is_name(t[1])) {
    const bool lens = same(t[1].text, "lens") && label_of(t[2].text);
    t.erase(t.begin() + 1, t.begin() + (lens ? 3 : 2));
  }
  return t;
}

bool PageTable::take_row(const PageLine& line) {
  if (columns_.empty() || named_ || is_top(line)) return false;
  if (rows_.empty() && !counted_ && label_of(line.tokens[0].text) && *label_of(line.tokens[0].text) <= 1 &&
      line.tokens.size() > columns_.size()) {
    labelled_ = true;
  }
  const std::vector<PageToken> tokens = row_tokens(line);
  if (std::ranges::any_of(tokens, [](const PageToken& t) { return t.text == "="; })) return false;
  // The label, with an asterisk in front or behind: "* 5", "5*", "*5)".
  const std::size_t star = tokens.size() > 1 && tokens[0].text == "*" ? 1 : 0;
  const auto [label, mark] = label_and_mark(tokens[star].text);
  const bool s_of_plane = tokens[0].text == "S" && tokens.size() > 1 && is_plane_word(tokens[1].text);
  const bool unnumbered =
      mark_in(tokens[0].text).stop || s_of_plane || is_object(tokens[0].text) || is_image(tokens[0].text);
  if (labelled_ && !unnumbered) {
    if (!label || tokens.size() < star + 2) return false;
    const auto next = next_label();
    const bool skipped = next && !rows_.back().label && *label == *next + 1;
    if (next ? *label != *next && !skipped : *label > 1) return false;
  } else if (!unnumbered && !is_plane_word(tokens[0].text) && !tokens[0].is_number &&
             !is_meant_as_number(tokens[0].text)) {
    return false;
  }
  const std::size_t from = labelled_ && !unnumbered ? star + 1 : 0;
  if (is_object(tokens[0].text) || is_image(tokens[from < tokens.size() ? from : 0].text)) {
    // "Object plane inf (d0)", "Image plane inf" and "9 Image inf" are no surfaces.
    const bool follows = from == 0 || !next_label() || label == next_label();
    return follows && line.numbers() < 3;
  }
  PageRow row = take_marks({line.number, line.text, tokens}, from);
  if (labelled_ && !unnumbered) {
    row.label = label;
    const Mark own = mark_in(mark);
    if (own.stop || same(mark, "s")) row.stop = "stop";
    row.asphere = row.asphere || own.asphere || star > 0 || tokens[0].text.find('*') != std::string::npos;
  }
  const auto is_data = [](const PageToken& t) {
    return t.is_number || is_plane_word(t.text) || is_meant_as_number(t.text) || !variable_name(t.text).empty();
  };
  if (std::ranges::none_of(row.cells, is_data)) return false;
  if (!row.stop.empty() && columns_[0].kind == Column::radius && is_none(row.cells[0].text)) row.cells[0] = {"inf"};
  // The object: "0 inf inf", "0 inf D0", "0 inf 1000.0".
  const bool object = rows_.empty() && label == 0 && row.stop.empty() && row.cells.size() == 2;
  if (object && is_plane_word(row.cells[0].text)) {
    object_distance_ = number(row.cells[1].text);
    return true;
  }
  name_gap(row);
  rows_.push_back(std::move(row));
  return true;
}

bool PageTable::is_next(const PageLine& line) const {
  const auto next = next_label();
  if (named_) return next && names_radius(line, *next);
  return next && label_and_mark(row_tokens(line)[0].text).first == *next && is_row_of_cells(line) && !is_top(line);
}

/// True for a label and cells.
bool PageTable::is_row_of_cells(const PageLine& line) const {
  const auto tokens = row_tokens(line);
  return tokens.size() > 1 && !tokens[1].text.ends_with('.') &&
         std::all_of(tokens.begin() + 1, tokens.end(), [](const PageToken& t) {
           return is_meant_as_number(t.text) || t.is_number || is_plane_word(t.text) || is_none(t.text) ||
                  mark_in(t.text).is_mark || !variable_name(t.text).empty();
         });
}

bool PageTable::is_other_row(const PageLine& line) const {
  if (rows_.empty() || line.tokens.size() < 2 || is_top(line)) return false;
  const auto label = label_of(line.tokens[0].text);
  if (!labelled_) {
    return !named_ && line.tokens.size() >= columns_.size() && (label || is_meant_as_number(line.tokens[0].text)) &&
           is_row_of_cells(line);
  }
  return label && next_label() && *label >= *next_label() && is_row_of_cells(line);
}

bool PageTable::is_printed() const {
  const auto printed = [&](const PageRow& row) {
    const bool short_air = labelled_ && separator_ == ' ' && row.cells.size() + 2 <= columns_.size() &&
                           (is_aperture(columns_.back().kind) || columns_.back().kind == Column::left_out) &&
                           row.cells.size() > 2;
    return short_air || (&row != &rows_.back() && !row.variable.empty());
  };
  return object_distance_ || std::ranges::any_of(rows_, printed);
}

/// Takes the name of a thickness that varies: "(variable)", "D5", "d 5", "2.10 (variable)", "d5 (variable)", "variable
/// (A)".
void PageTable::name_gap(PageRow& row) const {
  auto& cells = row.cells;
  const auto varies = [](const PageToken& cell) {
    std::string word = lower(cell.text);
    std::erase_if(word, [](char c) { return std::string_view("().").find(c) != std::string_view::npos; });
    return !cell.is_number && (word.find("variable") != std::string::npos || word == "var");
  };
  const auto name_of = [](std::string_view word) {
    const std::size_t open = word.find('('), close = word.find(')');
    const std::string_view inner = open < close && close != word.npos ? word.substr(open + 1, close - open - 1) : word;
    const bool letter = inner.size() == 1 && inner[0] >= 'A' && inner[0] <= 'Z' && inner.size() != word.size();
    return letter ? std::string(inner) : variable_name(inner);
  };
  const auto erase = [&](std::size_t at) { cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(at)); };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].is_number) continue;
    const bool apart = i + 1 < cells.size() && is_one_of(cells[i].text, "d dd") && cells[i + 1].is_number;
    const bool variable = varies(cells[i]);
    std::string name = variable_name(apart ? cells[i].text + cells[i + 1].text : cells[i].text);
    if (name.empty() && variable) name = name_of(cells[i].text.substr(0, cells[i].text.find('(')));
    if (name.empty() && variable) name = name_of(cells[i].text);
    if (name.empty() && !variable) continue;
    if (apart) erase(i + 1);
    // "d5 (variable)", "variable (d5)".
    const std::string behind = i + 1 < cells.size() && cells[i + 1].text[0] == '(' ? name_of(cells[i + 1].text) : "";
    if (i + 1 < cells.size() && (varies(cells[i + 1]) || (variable && !behind.empty()))) {
      if (name.empty()) name = behind;
      erase(i + 1);
    }
    row.variable = name.empty() && row.label ? 'd' + std::to_string(*row.label) : name;
    cells[i] = {"(variable)"};
    if (variable && i == find(Column::thickness) + 1 && cells[i - 1].is_number) {
      erase(i);
      cells[i - 1] = {"(variable)"};
    }
    return;
  }
}

bool PageTable::take_named(const PageLine& line) {
  const auto& t = line.tokens;
  const std::size_t rows_before = rows_.size();
  bool found = false, stop = false, asphere = false;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const Mark mark = mark_in(t[i].text);
    if (mark.is_mark) {
      // A mark belongs to the radius in front of it, or else to the next radius.
      const bool behind = rows_.size() > rows_before;
      (behind ? rows_.back().asphere : asphere) |= mark.asphere;
      if (mark.stop && t[i].text.size() > 1) behind ? void(rows_.back().stop = "stop") : void(stop = true);
      continue;
    }
    if (named_ && !rows_.empty() && take_pair(t[i].text)) continue;
    const Named name = named_at(t, i);
    const PageToken& value = t[std::min(name.value, t.size() - 1)];
    // "r14 = Stop" is a plane.
    const bool is_stop = mark_in(value.text).stop;
    const bool is_value = value.is_number || is_plane_word(value.text) || is_meant_as_number(value.text) || is_stop;
    if (is_one_of(name.kind, "r radius") && is_value) {
      if (rows_.empty()) {
        named_ = true;
        head_line_ = line.number;
        columns_ = columns_of(std::vector<std::string_view>{"r", "d", "nd", "vd"}, false);
      }
      if (!named_) return false;
      PageRow row{.line = line.number, .label = label_of(name.number), .stop = stop ? "stop" : "", .asphere = asphere};
      row.cells = {is_stop ? PageToken{"inf"} : value, {"-"}, {"-"}, {"-"}};
      if (is_stop) row.stop = "stop";
      stop = asphere = false;
      rows_.push_back(std::move(row));
    } else if (named_ && !rows_.empty() && is_one_of(name.kind, "d t l n nd v vd \u03bd \u03bdd \u03c5 \u03c5d s e")) {
      const bool gap = is_one_of(name.kind, "d t l s e");
      PageRow* own = gap && !name.number.empty() ? find(label_of(name.number).value_or(-1)) : nullptr;
      PageRow& row = own ? *own : rows_.back();
      PageToken& cell = row.cells[gap ? 1 : name.kind[0] == 'n' ? 2 : 3];
      if (cell.text != "-") {
        if (!gap) apart_line_ = line.number;
        return found;  // a second value: a table of positions
      }
      cell = value;
      const std::size_t next = name.value + 1;
      const bool list = next < t.size() && (t[next].is_number || is_one_of(t[next].text, "- to"));
      // "d1 = 5.09 1.717 47.99" states index and V-number without names.
      const bool glass =
          list && next + 2 == t.size() && fits(Column::index, t[next], false) && fits(Column::abbe, t[next + 1], false);
      if (gap && glass) {
        row.cells[2] = t[next];
        row.cells[3] = t[next + 1];
      } else if (gap && list) {
        row.variable = 'd' + name.number;
        cell = {"(variable)"};
      } else if (gap && !value.is_number && !is_meant_as_number(value.text)) {
        const bool varies = lower(value.text).find("variable") != std::string::npos;
        row.variable = varies ? 'd' + name.number : variable_name(value.text);
        if (!row.variable.empty()) cell = {"(variable)"};
      }
    } else {
      continue;
    }
    found = true;
    i = name.value;
  }
  if (found && stop) rows_.back().stop = "stop";
  return found;
}

/// Takes index and V-number of the last row from "1.6228/56.9".
bool PageTable::take_pair(const std::string& word) {
  const std::size_t slash = word.find('/');
  if (slash == std::string::npos) return false;
  const bool commas = word.find(',') != std::string::npos;
  const auto pair = tokens_of(word.substr(0, slash) + ' ' + word.substr(slash + 1), commas);
  if (pair.size() != 2 || !pair[0].is_number || !pair[1].is_number) return false;
  std::ranges::copy(pair, rows_.back().cells.begin() + 2);
  return true;
}

/// Fills the columns of a row from its cells. Air lacks the columns of glass, or has the index 1; the last row may lack
/// its thickness. False if the cells fit no form of row.
bool PageTable::fill(PageRow& row, std::vector<PageToken> cells, bool last) const {
  const auto is_gap = [](Column c) { return c == Column::thickness || c == Column::gap_before; };
  const auto is_air = [](const PageToken& c) {
    return std::abs(number(c.text).value_or(9) - 1) < 1e-3 || same(c.text, "air");
  };
  const std::function<bool(Column)> forms[] = {
      [](Column) { return true; },
      [](Column c) { return c != Column::left_out; },
      [](Column c) { return !is_of_glass(c); },
      [](Column c) { return !is_of_glass(c) || c == Column::index; },
      [](Column c) { return !is_of_glass(c) || c == Column::glass; },
      [](Column c) { return !is_of_glass(c) && !is_aperture(c); },
      [&](Column c) { return !is_of_glass(c) && !(last && is_gap(c)); },
      [&](Column c) { return !is_of_glass(c) && !(last && is_gap(c)) && !is_aperture(c); },
  };
  for (const auto& has : forms) {
    std::vector<PageToken> filled;
    std::size_t taken = 0;
    for (const TableColumn& column : columns_) {
      if (!has(column.kind)) {
        filled.push_back({"-"});
      } else if (taken < cells.size() && fits(column.kind, cells[taken], last)) {
        filled.push_back(cells[taken++]);
      }
    }
    if (taken != cells.size() || filled.size() != columns_.size()) continue;
    // Glass has a V-number; a row with an index only is air.
    const std::size_t index = find(Column::index);
    const bool lacks_abbe = has(Column::index) && !has(Column::abbe) && find(Column::abbe) < columns_.size();
    if (lacks_abbe && index < filled.size() && !is_air(filled[index]) && !is_none(filled[index].text)) continue;
    row.cells = std::move(filled);
    return true;
  }
  return false;
}

void PageTable::complete(PageRow& row, bool last, const Import& in) const {
  // "3 stop 47" has a thickness.
  const bool single = !row.stop.empty() && row.cells.size() == 1 && row.cells[0].is_number;
  if (!single && fill(row, row.cells, last)) return;
  // The mark of the stop may stand in place of the radius: "7 STO 1.5".
  const std::size_t radius = std::min({find(Column::radius), find(Column::curvature), row.cells.size()});
  std::vector<PageToken> plane = row.cells;
  plane.insert(plane.begin() + static_cast<std::ptrdiff_t>(radius), {"inf"});
  if (!row.stop.empty() && fill(row, std::move(plane), last)) return;
  std::string names, found;
  for (const TableColumn& column : columns_) append(names, ", ", column.name);
  for (const PageToken& cell : row.cells) append(found, " ", cell.text);
  const bool whole = row.cells.size() == columns_.size();
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    const Column kind = whole ? columns_[i].kind : Column::left_out;
    const PageToken& cell = row.cells[i];
    if (whole ? fits(kind, cell, last) : cell.is_number || !is_meant_as_number(cell.text)) continue;
    in.must_be(row.line, whole ? columns_[i].name : "cell", io_detail::in_quotes(cell.text),
               kind == Column::index  ? "an index, 1.3 to 2.7"
               : kind == Column::abbe ? "a V-number, 8 to 120"
                                      : "a number with a decimal point");
  }
  in.must_be(row.line, "row", io_detail::in_quotes(beginning(found, 80)),
             "a cell per column: " + names + "; air has neither index nor V-number");
}

void PageTable::complete(const Import& in) {
  // Lists of radii and of indices: the first index stands behind the last radius.
  if (named_ && !rows_.empty() && number(rows_.back().cells[2].text).value_or(1) > 1.1) apart_line_ = rows_.back().line;
  if (apart_line_ > 0)
    in.must_be(apart_line_, "index", "apart from its radius", "in the line of its radius, or the next");
  for (PageRow& row : rows_) {
    const std::optional<int> before = &row == &rows_.front() ? std::optional(0) : (&row - 1)->label;
    if (named_ && row.label != before.value_or(0) + 1) {
      in.must_be(row.line, "r", row.label ? std::to_string(*row.label) : "without a number",
                 "the radius that follows number " + std::to_string(before.value_or(0)));
    }
    complete(row, &row == &rows_.back(), in);
  }
  // A number that is missing in a row could pass for another, or make air of glass.
  const auto states = [&](const PageRow& row, auto kinds) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (kinds(columns_[i].kind) && !is_none(row.cells[i].text) && number(row.cells[i].text) != 0.0) return true;
    }
    return false;
  };
  const auto has_index = [&](const PageRow& row) {
    return states(row, [](Column c) { return c == Column::index || c == Column::glass; });
  };
  const auto is_glass = [&](const PageRow& row) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i].kind == Column::index && number(row.cells[i].text).value_or(0) > 1.1) return true;
    }
    return false;
  };
  const auto has_abbe = [&](const PageRow& row) { return states(row, [](Column c) { return c == Column::abbe; }); };
  const auto has_aperture = [&](const PageRow& row) { return states(row, is_aperture); };
  const bool abbe = std::ranges::any_of(rows_, has_abbe);
  const bool apertures = 2 * std::ranges::count_if(rows_, has_aperture) > std::ssize(rows_) &&
                         std::ranges::any_of(columns_, [](const TableColumn& c) { return is_aperture(c.kind); });
  for (const PageRow& row : rows_) {
    if (has_abbe(row) && !has_index(row)) in.must_be(row.line, "index", "missing", "stated before the V-number");
    if (abbe && is_glass(row) && !has_abbe(row)) in.must_be(row.line, "V-number", "missing", "stated as in other rows");
    if (apertures && !has_aperture(row)) in.must_be(row.line, "aperture", "missing", "stated as in other rows");
  }
}

std::vector<TableLine> PageTable::lines() const {
  std::vector<TableLine> lines{{head_line_, {"No"}, {}}};
  for (const TableColumn& column : columns_) lines[0].cells.push_back(column.name);
  for (const PageRow& row : rows_) {
    TableLine& line = lines.emplace_back(TableLine{row.line, {row.stop.empty() ? "-" : "stop"}, {}});
    const auto states = [&](Column kind) {
      const std::size_t i = find(kind);
      return i < columns_.size() && !is_none(row.cells[i].text);
    };
    const bool air = !states(Column::index) && !states(Column::glass);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const std::string& cell = row.cells[i].text;
      const bool index = columns_[i].kind == Column::index;
      const bool plane = columns_[i].kind == Column::radius && std::abs(number(cell).value_or(0)) > 1e9;
      line.cells.push_back(cell == "(variable)" ? "0" : plane ? "inf" : air && index ? "1" : std::string_view(cell));
    }
  }
  return lines;
}

}  // namespace petzval::formats_detail
