// SPDX-License-Identifier: Apache-2.0
#include "table_text.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//") || line.starts_with(';') || line.starts_with('%');
}

/// The position of a comment after a row: "#" or "//" after a blank. A "#" between separators is the head of a column.
std::size_t remark_start(std::string_view line) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    const bool mark = line[i] == '#' || line.substr(i, 2) == "//";
    if (!mark || (line[i - 1] != ' ' && line[i - 1] != '\t')) continue;
    const std::size_t behind = std::min(line.find_first_not_of(' ', i + 1), line.size());
    const bool head = behind == line.size() || std::string_view("\t,;|").find(line[behind]) != std::string_view::npos;
    if (line[i] != '#' || !head) return i;
  }
  return line.size();
}

std::string_view without_quotes(std::string_view cell) {
  if (cell.size() >= 2 && (cell[0] == '"' || cell[0] == '\'') && cell.back() == cell[0])
    return cell.substr(1, cell.size() - 2);
  return cell;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  if (separator == ' ') {
    auto cells = words(line, TableText::most_cells + 1);
    for (std::string_view& cell : cells) {
      if (cell.size() > 1 && (cell.ends_with(',') || cell.ends_with(';'))) cell.remove_suffix(1);
    }
    return cells;
  }
  std::vector<std::string_view> cells;
  for (std::size_t from = 0; from <= line.size() && cells.size() <= TableText::most_cells;) {
    // A quoted cell may contain the separator.
    std::size_t start = std::min(line.find_first_not_of(" \t", from), line.size());
    if (separator == '\t') start = from;
    const bool quoted = start < line.size() && line[start] == '"';
    const std::size_t closed = quoted ? line.find('"', start + 1) : start;
    const std::size_t end =
        std::min(line.find(separator, closed == std::string_view::npos ? start : closed), line.size());
    cells.push_back(without_quotes(trimmed(line.substr(from, end - from))));
    from = end + 1;
  }
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
  return cells;
}

std::string_view without_brackets(std::string_view cell) {
  const bool inside =
      cell.size() > 2 && ((cell[0] == '(' && cell.back() == ')') || (cell[0] == '[' && cell.back() == ']'));
  return inside ? cell.substr(1, cell.size() - 2) : cell;
}

/// True for two numbers in one cell, "50,6   5,2", which a comma would cut.
bool has_two_numbers(std::string_view cell) {
  const auto parts = words(cell, 2);
  return parts.size() == 2 && looks_like_a_number(parts[0]) && looks_like_a_number(parts[1]);
}

/// True for the line of Markdown between head and rows: "|---|:-:|".
bool is_rule(std::string_view line) { return line.find_first_not_of("|-: \t") == std::string_view::npos; }

bool has_comma_for_point(std::string_view cell) {
  const std::size_t comma = cell.find(',');
  if (comma == std::string_view::npos || cell.find('.') != std::string_view::npos) return false;
  std::string with_point(cell);
  with_point[comma] = '.';
  return number(with_point).has_value();
}

}  // namespace

/// The line with typographic minus signs and blanks replaced by ASCII.
std::string_view TableText::in_ascii(std::string_view line) {
  static constexpr std::array<std::pair<std::string_view, char>, 8> signs = {{
      {"\u2212", '-'},
      {"\u2013", '-'},
      {"\u2014", '-'},
      {"\u00a0", ' '},
      {"\u2007", ' '},
      {"\u2009", ' '},
      {"\u202f", ' '},
      {"\u3000", ' '},
  }};
  const auto found = [&](const auto& sign) { return line.find(sign.first) != std::string_view::npos; };
  if (std::ranges::none_of(signs, found)) return line;
  std::string changed;
  changed.reserve(line.size());
  for (std::size_t i = 0; i < line.size();) {
    const auto sign = std::ranges::find_if(signs, [&](const auto& s) { return line.substr(i).starts_with(s.first); });
    if (sign != signs.end()) {
      changed.push_back(sign->second);
      i += sign->first.size();
    } else {
      changed.push_back(line[i++]);
    }
  }
  return changed_lines_.emplace_back(std::move(changed));
}

TableText::TableText(std::string_view text) {
  std::vector<TableLine> raw;  // one cell each: the whole line
  std::vector<TableLine> with_semicolon;
  for (Lines all(text); all.next();) {
    const std::string_view whole = in_ascii(all.text()), line = trimmed(whole);
    if (line.empty()) continue;
    if (is_comment(line)) {
      // In a table separated by semicolons, a row with an empty first cell begins like a comment.
      if (line.starts_with(';') && std::ranges::count(line, ';') > 2) {
        with_semicolon.push_back({all.number(), {line}, {}});
        continue;
      }
      const std::size_t start = std::min(line.find_first_not_of("#/;%"), line.size());
      comments.push_back({all.number(), trimmed(line.substr(start))});
      continue;
    }
    // Tabs before a row may be empty cells.
    const std::size_t end = remark_start(whole);
    const std::string_view mark = whole.substr(end);
    raw.push_back({all.number(),
                   {whole.substr(0, end)},
                   trimmed(mark.substr(std::min(mark.find_first_not_of("#/"), mark.size())))});
  }
  choose_separator(raw);
  for (TableLine& line : with_semicolon) {
    if (separator_ == ';') {
      raw.push_back(std::move(line));
    } else {
      comments.push_back({line.number, trimmed(line.cells[0].substr(line.cells[0].find_first_not_of(';')))});
    }
  }
  std::ranges::stable_sort(raw, {}, &TableLine::number);
  std::ranges::stable_sort(comments, {}, &TableComment::number);
  for (TableLine& line : raw) {
    if (separator_ == '|' && is_rule(line.cells[0])) continue;
    line.cells = cells_of(line.cells[0]);
    if (!line.cells.empty()) lines.push_back(std::move(line));
  }
  if (separator_ != ';') return;
  bool points = false;
  for (const TableLine& line : lines) {
    for (const std::string_view cell : line.cells) {
      decimal_commas_ = decimal_commas_ || has_comma_for_point(cell);
      points = points || (cell.find('.') != std::string_view::npos && formats_detail::number(cell));
    }
  }
  decimal_commas_ = decimal_commas_ && !points;
}

/// Chooses the separator. The first line is ignored, as it may be a title.
void TableText::choose_separator(const std::vector<TableLine>& raw) {
  const std::size_t first = raw.size() > 1 ? 1 : 0;
  const auto all_lines_have = [&](char c) {
    return !raw.empty() && std::all_of(raw.begin() + static_cast<std::ptrdiff_t>(first), raw.end(),
                                       [&](const auto& l) { return l.cells[0].find(c) != std::string_view::npos; });
  };
  const auto no_cell_has_two_numbers = [&](char c) {
    return std::ranges::none_of(
        raw, [&](const auto& l) { return std::ranges::any_of(split(l.cells[0], c), has_two_numbers); });
  };
  const auto has_gaps = [](const TableLine& l) {
    return std::ranges::any_of(split(l.cells[0], '\t'), [](std::string_view cell) { return cell.empty(); });
  };
  if (all_lines_have('|')) {
    separator_ = '|';
    // Markdown: an additional bar starts each line. If only some lines begin with a bar, it follows an empty cell.
    bars_in_front_ = std::ranges::all_of(raw, [](const auto& l) { return trimmed(l.cells[0]).starts_with('|'); });
  } else if (all_lines_have(';')) {
    separator_ = ';';
  } else if (all_lines_have('\t') && no_cell_has_two_numbers('\t') && !has_gaps(raw[0])) {
    separator_ = '\t';  // repeated tabs in the first line align its cells
  } else if (all_lines_have(',') && no_cell_has_two_numbers(',')) {
    separator_ = ',';
  }
}

std::vector<std::string_view> TableText::cells_of(std::string_view text) const {
  text = bars_in_front_ ? trimmed(text) : text;
  if (bars_in_front_ && text.starts_with('|')) text.remove_prefix(1);
  return split(text, separator_);
}

std::optional<double> TableText::number(std::string_view cell) const {
  if (!decimal_commas_ || !has_comma_for_point(cell)) return formats_detail::number(cell);
  std::string with_point(cell);
  with_point[with_point.find(',')] = '.';
  return formats_detail::number(with_point);
}

bool looks_like_a_number(std::string_view cell) {
  if (cell.starts_with('+') || cell.starts_with('-')) cell.remove_prefix(1);
  if (same(cell, "nan")) return true;
  if (cell.starts_with('.') || cell.starts_with(',')) cell.remove_prefix(1);
  return !cell.empty() && cell[0] >= '0' && cell[0] <= '9';
}

bool is_plane_word(std::string_view cell) {
  return is_infinite(cell) || is_one_of(cell, "plano plane planar flat pl pl.");
}

bool is_stop_word(std::string_view cell) {
  cell = without_brackets(cell);
  return same(cell, "aperture stop") || is_one_of(cell, "stop sto asp ast as aperture diaphragm iris *");
}

bool is_asphere_mark(std::string_view cell) {
  return is_one_of(without_brackets(cell), "asp asph asph. asphere aspheric *");
}

std::string_view mark_of(std::string_view label) {
  const std::size_t end = std::min(label.find_first_not_of("0123456789"), label.size());
  std::string_view mark = label.substr(end);
  while (mark.starts_with(' ')) mark.remove_prefix(1);
  const bool marks = is_stop_word(mark) || is_asphere_mark(mark) || same(mark, "s");
  return end > 0 && marks ? mark : std::string_view();
}

std::optional<int> label_of(std::string_view cell) {
  cell.remove_suffix(mark_of(cell).size());
  if (!cell.empty() && std::string_view("Ss#*").find(cell[0]) != std::string_view::npos) cell.remove_prefix(1);
  while (!cell.empty() && std::string_view("*.):").find(cell.back()) != std::string_view::npos) cell.remove_suffix(1);
  if (cell.empty() || cell.size() > 5 || cell.find_first_not_of("0123456789") != std::string_view::npos) return {};
  return static_cast<int>(*number(cell));
}

bool is_none(std::string_view cell) { return cell.empty() || is_one_of(cell, "- -- --- none n/a ."); }

}  // namespace petzval::formats_detail
