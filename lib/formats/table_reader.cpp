// SPDX-License-Identifier: Apache-2.0
// Hand-typed tables of surfaces, with or without heads, from patents, spreadsheets and renderers. Each line is a head,
// a row or a comment; there is no fourth kind, so that nothing is dropped. data/README.md describes the form.
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
#include "table_columns.hpp"
#include "table_lens.hpp"
#include "table_text.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using io_detail::in_quotes;

bool is_object_word(std::string_view cell) { return is_one_of(cell, "obj object"); }
bool is_image_word(std::string_view cell) { return is_one_of(cell, "ima img image film sensor si"); }

/// In a column of comments, "ASP" means an asphere, and "aperture" may mean any rim.
bool marks_stop_in_comment(std::string_view cell) {
  return is_stop_word(cell) && (!is_asphere_mark(cell) || cell == "*") && !is_one_of(cell, "as ast aperture");
}

/// A row before its cells are interpreted.
struct RawRow {
  int line = 0;
  std::vector<std::string_view> cells{};
  std::string_view remark{};
  std::string stop{};  ///< the word that marks the stop
  bool stop_in_front = false, object = false, image = false;
};

class TableReader {
 public:
  TableReader(std::string_view text, Import& in) : text_(text), in_(in) {}
  TableReader(std::vector<TableLine> lines, Import& in) : text_(std::move(lines)), in_(in) {}
  void read();

 private:
  using Columns = std::vector<TableColumn>;

  void take_comments();
  void take_lines();
  Columns columns_for_rows(const TableLine& head) const;
  bool take_units(const TableLine& line);
  void take_text(const TableLine& line);
  void use_comment_as_head();
  void drop_asphere_marks();
  void drop_labels();
  void take_titles();
  void end_last_row();
  bool are_labels() const;
  void take_label(int line, std::string_view label, std::string& stop);
  void name_asphere(int line, std::string_view mark);
  void guess();
  void check_head() const;
  void take_marks(RawRow& row);
  void check_width(const RawRow& row) const;
  TableRow row_of(const RawRow& raw);
  void put(TableRow& row, const TableColumn& column, std::string_view cell, const RawRow& raw);
  double value(const RawRow& row, const TableColumn& column, std::string_view cell) const;
  void take_object(const TableRow& row, const RawRow& raw);
  bool is_bare_plane(const RawRow& raw) const;
  void take_image(const RawRow& raw, bool last) const;
  std::size_t find(Column kind) const {
    return static_cast<std::size_t>(std::ranges::find(columns_, kind, &TableColumn::kind) - columns_.begin());
  }
  bool has(Column kind) const { return find(kind) < columns_.size(); }

  TableText text_;
  Import& in_;
  Columns columns_;
  int head_line_ = 0;  ///< 0 if the table has no head
  bool guessed_ = false;
  bool asphere_named_ = false;
  std::vector<RawRow> rows_;
  std::string said_;  ///< comments and titles
};

void TableReader::take_comments() {
  for (const TableComment& comment : text_.comments) {
    if (said_.size() < 65'536) said_ += std::string(beginning(comment.text, 4096)) + ' ';
    in_.note(comment.text);
  }
}

/// Takes a line of words before the table as its title.
void TableReader::take_text(const TableLine& line) {
  std::string title;
  for (const std::string_view cell : line.cells) append(title, " ", beginning(cell, 4096));
  said_ += title + ' ';
  in_.warn(line.number, "line", in_quotes(title) + " names no columns; it is taken as a title");
  auto& notes = in_.lens.imported->notes;
  notes.insert(notes.begin(), std::move(title));
}

/// Lines with numbers and words before the head are titles: "50 mm f/5", "EPD 10".
void TableReader::take_titles() {
  const auto is_value = [](std::string_view cell) {
    return looks_like_a_number(cell) || is_plane_word(cell) || is_none(cell) || is_stop_word(cell);
  };
  const auto title = [&](const RawRow& row) { return !std::ranges::all_of(row.cells, is_value); };
  if (!std::ranges::all_of(rows_, title)) return;
  for (const RawRow& row : std::exchange(rows_, {})) take_text({row.line, row.cells, {}});
}

/// The last row may end after its radius, or have a word for its thickness: the film is then at the paraxial focus.
void TableReader::end_last_row() {
  const std::size_t thickness = find(Column::thickness);
  auto& cells = rows_.back().cells;
  if (thickness == columns_.size() || rows_.size() < 2) return;
  if (thickness > cells.size() || is_stop_word(cells.front())) return;
  if (thickness == cells.size()) cells.push_back("-");
  if (is_one_of(cells[thickness], "bf bfl b.f. (bf) variable (variable)")) cells[thickness] = "-";
}

/// Takes a line of units below the heads: "mm mm - - mm".
bool TableReader::take_units(const TableLine& line) {
  if (head_line_ == 0 || !rows_.empty() || line.cells.size() > columns_.size()) return false;
  const auto is_unit = [](std::string_view cell) { return is_none(cell) || unit_of(cell); };
  if (!std::ranges::all_of(line.cells, is_unit) || std::ranges::all_of(line.cells, is_none)) return false;
  for (std::size_t i = 0; i < line.cells.size(); ++i) {
    if (const auto unit = unit_of(line.cells[i])) columns_[i].unit_mm = *unit;
  }
  return true;
}

/// The columns of a head. Words separated by blanks may be one head or two ("Abbe no"); the rows decide.
TableReader::Columns TableReader::columns_for_rows(const TableLine& head) const {
  std::size_t widest = 0;
  for (const TableLine& line : text_.lines) {
    if (&line != &head) widest = std::max(widest, line.cells.size());
  }
  Columns joined = columns_of(head.cells, !text_.has_empty_cells()), single = columns_of(head.cells, false);
  const bool as_wide = single.size() == widest && joined.size() != widest;
  return as_wide ? std::move(single) : std::move(joined);
}

void TableReader::take_lines() {
  const bool by_blanks = !text_.has_empty_cells();
  for (const TableLine& line : text_.lines) {
    if (line.cells.size() > TableText::most_cells) {
      in_.must_be(line.number, "row", "more than " + std::to_string(TableText::most_cells) + " cells", "fewer");
    }
    if (is_head(line.cells, by_blanks)) {
      if (head_line_ == 0) take_titles();
      if (!rows_.empty()) {
        in_.must_be(line.number, "row", in_quotes(line.cells[0]) + " ..., a head after rows",
                    "a single head before a single table");
      }
      columns_ = columns_for_rows(line);
      head_line_ = line.number;
      continue;
    }
    if (take_units(line)) continue;
    const auto is_data = [](std::string_view cell) { return looks_like_a_number(cell) || is_plane_word(cell); };
    const bool data = std::ranges::any_of(line.cells, is_data);
    if (rows_.empty() && !data && head_line_ == 0 && !is_stop_word(line.cells[0])) {
      take_text(line);
      continue;
    }
    // A title with a number: "Cooke triplet 50 mm f/5".
    const bool in_columns = line.cells.size() >= 2 && (is_data(line.cells[0]) || is_data(line.cells[1]));
    if (rows_.empty() && head_line_ == 0 && !in_columns && !is_stop_word(line.cells[0])) {
      take_text(line);
      continue;
    }
    in_.limit(rows_.size() + 1);
    rows_.push_back({line.number, line.cells, line.remark});
  }
}

/// Uses a comment before the rows as the head ("# radius  thickness  n  aperture") if all its words are heads and their
/// number equals the number of cells.
void TableReader::use_comment_as_head() {
  if (head_line_ != 0 || rows_.empty()) return;
  std::size_t widest = 0;
  for (const RawRow& row : rows_) widest = std::max(widest, row.cells.size());
  for (const TableComment& comment : text_.comments) {
    if (comment.number > rows_.front().line) return;
    for (const bool by_blanks : {false, true}) {
      const auto cells = by_blanks ? words(comment.text, TableText::most_cells) : text_.cells_of(comment.text);
      Columns columns = columns_of(cells, by_blanks);
      const bool known = std::ranges::find(columns, Column::left_out, &TableColumn::kind) == columns.end();
      const bool fits = columns.size() == widest || (columns.size() + 1 == widest && are_labels());
      if (known && fits && columns.size() >= 3) {
        columns_ = std::move(columns);
        head_line_ = comment.number;
      }
    }
  }
}

/// True if the first cells are 1, 2, 3, ..., with or without an S or a mark. The row of the stop may lack a number.
bool TableReader::are_labels() const {
  std::optional<int> last;
  int labels = 0;
  bool skipped = false;
  for (const RawRow& row : rows_) {
    const auto label = label_of(row.cells[0]);
    if (!label) {
      if (!is_stop_word(row.cells[0]) && !is_object_word(row.cells[0]) && !is_image_word(row.cells[0])) return false;
      skipped = true;
      continue;
    }
    const bool next = last ? *label == *last + 1 || (skipped && *label == *last + 2) : *label <= 1 || skipped;
    if (!next || row.cells.size() < 3) return false;
    last = label;
    skipped = false;
    ++labels;
  }
  return labels >= 2;
}

/// Drops the marks of aspheres in a cell of their own behind the row number: "10 (ASP) -40 30".
void TableReader::drop_asphere_marks() {
  const bool own_column =
      columns_.size() > 1 && (columns_[1].kind == Column::comment || columns_[1].kind == Column::stop);
  if (own_column || (has(Column::number) ? find(Column::number) != 0 : !are_labels())) return;
  for (RawRow& row : rows_) {
    if (row.cells.size() < 3 || !label_of(row.cells[0]) || !is_asphere_mark(row.cells[1])) continue;
    name_asphere(row.line, row.cells[1]);
    row.cells.erase(row.cells.begin() + 1);
  }
}

void TableReader::drop_labels() {
  if (has(Column::number)) return;
  if (head_line_ != 0) {
    // A column of row numbers without a head makes the rows one cell longer.
    const bool wider =
        std::ranges::any_of(rows_, [&](const RawRow& row) { return row.cells.size() > columns_.size(); });
    if (!wider) return;
  }
  if (!are_labels()) return;
  in_.warn(rows_.front().line, "columns", "the first column counts the rows and is not read");
  for (RawRow& row : rows_) {
    if (is_stop_word(row.cells[0])) continue;
    row.object = is_object_word(row.cells[0]), row.image = is_image_word(row.cells[0]);
    take_label(row.line, row.cells[0], row.stop);
    row.cells.erase(row.cells.begin());
  }
}

/// Takes the mark of a row number, which patents use for the stop and for aspheres.
void TableReader::take_label(int line, std::string_view label, std::string& stop) {
  const std::string_view mark = mark_of(label);
  if (is_asphere_mark(mark) || (label.size() > 1 && label.starts_with('*'))) {
    name_asphere(line, label);
  } else if (!mark.empty()) {
    stop = std::string(mark);
  }
}

/// Warns once of a mark of an asphere, unless the table has columns for its terms.
void TableReader::name_asphere(int line, std::string_view mark) {
  if (has(Column::term) || has(Column::conic) || std::exchange(asphere_named_, true)) return;
  in_.warn(line, mark, "marks an asphere and is left out: aspheric terms need columns with heads (k A4 A6)");
}

/// Heads must name radius, thickness and medium. Other known heads are read; unknown heads are listed in a warning.
void TableReader::check_head() const {
  std::string unknown;
  for (const TableColumn& column : columns_) {
    if (column.kind == Column::left_out) {
      append(unknown, ", ", in_quotes(column.name));
      continue;
    }
    if (column.of_sphere != 0) {
      in_.warn(head_line_, column.name, "is taken as 1 + k, so that a sphere has 1; a column of k has the head k");
    }
    const bool once = column.kind != Column::term && column.kind != Column::comment && column.kind != Column::number;
    const auto same_kind = [&](const TableColumn& other) {
      return other.kind == column.kind && (once || (column.kind == Column::term && other.order == column.order));
    };
    if (std::ranges::count_if(columns_, same_kind) > 1) {
      in_.must_be(head_line_, "head", in_quotes(column.name) + " and another head of its meaning", "a single one");
    }
  }
  const auto need = [&](bool given, const char* what) {
    if (given) return;
    in_.must_be(head_line_, "head",
                unknown.empty() ? "no " + std::string(what) : "no " + std::string(what) + " and the unknown " + unknown,
                "heads for radius, thickness, and index or glass (R d nd vd semi)");
  };
  need(has(Column::radius) || has(Column::curvature), "radius");
  need(has(Column::thickness) || has(Column::gap_before), "thickness");
  need(has(Column::index) || has(Column::glass), "index");
  const int apertures = has(Column::semi_diameter) + has(Column::diameter) + has(Column::aperture);
  if (apertures > 1) in_.must_be(head_line_, "head", "several columns of apertures", "a single column");
  if (!unknown.empty()) {
    in_.warn(head_line_, "head", "has columns that are not known and are left out: " + unknown);
  }
}

void TableReader::guess() {
  if (head_line_ != 0) return;
  std::vector<std::vector<std::string_view>> plain;
  for (const RawRow& row : rows_) {
    auto cells = row.cells;
    if (is_stop_word(cells[0]) || is_object_word(cells[0]) || is_image_word(cells[0])) continue;
    if (cells.size() > 2 && is_stop_word(cells.back())) cells.pop_back();
    plain.push_back(std::move(cells));
  }
  const auto is_index_of = [&](std::string_view name, double nd) { return in_.glasses().find(name, nd) != nullptr; };
  GuessedColumns found = guess_columns(plain, is_index_of);
  if (found.columns.empty()) {
    in_.must_be(rows_.front().line, "columns", "without heads, and " + found.reason,
                "named by a first line (R d nd vd semi)");
  }
  columns_ = std::move(found.columns);
  guessed_ = true;
  // An index of 0 marks tables of renderers, which have these columns and no heads.
  const bool renderers =
      columns_.size() == 4 && columns_[2].kind == Column::index && columns_[3].kind == Column::aperture &&
      std::ranges::any_of(plain, [&](const auto& cells) { return cells.size() == 4 && text_.number(cells[2]) == 0.0; });
  if (renderers) return;
  std::string names;
  for (const TableColumn& column : columns_) append(names, ", ", column.name);
  in_.warn(rows_.front().line, "columns", "have no heads; they are taken as " + names);
}

/// Removes the words that mark the stop, the object and the image from a row.
void TableReader::take_marks(RawRow& row) {
  auto& cells = row.cells;
  const std::size_t width = columns_.size(),
                    radius = has(Column::radius) ? find(Column::radius) : find(Column::curvature);
  const auto take = [&](std::size_t at) {
    if (row.stop.empty()) row.stop = std::string(cells[at]);
    row.stop_in_front = row.stop_in_front || at <= radius;
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(at));
  };
  const auto kind = [&](std::size_t at) { return at < width ? columns_[at].kind : Column::left_out; };
  // The mark is the last cell of the row, or precedes a complete row.
  const Column last = kind(cells.size() - 1);
  const bool of_words = last == Column::comment || last == Column::stop || last == Column::number;
  if (cells.size() > 1 && is_stop_word(cells.back()) && !of_words && cells.size() - 1 != radius) take(cells.size() - 1);
  if (cells.size() == width + 1 && is_stop_word(cells[0])) take(0);
  if (cells.size() > 1 && radius == 0 && (is_object_word(cells[0]) || is_image_word(cells[0]))) {
    row.object = is_object_word(cells[0]), row.image = !row.object;
    cells.erase(cells.begin());
  }
  if (radius >= cells.size() || !is_stop_word(cells[radius])) return;
  // The mark replaces the radius, unless a radius follows.
  const auto zero = [&](std::size_t at) { return at < cells.size() && text_.number(cells[at]) == 0.0; };
  const bool followed = !text_.has_empty_cells() && radius + 2 < cells.size() && cells.size() != width &&
                        (is_plane_word(cells[radius + 1]) || zero(radius + 1));
  const bool word_follows = radius + 1 < cells.size() && is_plane_word(cells[radius + 1]);
  if (followed || (word_follows && !text_.has_empty_cells())) return take(radius);
  if (row.stop.empty()) row.stop = std::string(cells[radius]);
  row.stop_in_front = true;
  cells[radius] = "inf";
}

/// Rows with cells separated by blanks may have fewer cells: they may end after the distances (air), or if only words,
/// V-numbers and aspheric terms are missing. In all other rows a missing cell is ambiguous.
void TableReader::check_width(const RawRow& row) const {
  const std::size_t width = columns_.size(), cells = row.cells.size();
  if (cells == width || (cells < width && text_.has_empty_cells() && !guessed_)) return;
  std::string names;
  for (const TableColumn& column : columns_) append(names, ", ", column.name);
  const auto refuse = [&] {
    in_.must_be(row.line, "row", std::to_string(cells) + (cells == 1 ? " cell" : " cells"),
                std::to_string(width) + ": " + names + "; \"-\" for an empty cell");
  };
  if (cells > width) refuse();
  const auto tells_no_medium = [](const TableColumn& c) {
    return c.kind == Column::number || c.kind == Column::radius || c.kind == Column::curvature ||
           c.kind == Column::thickness || c.kind == Column::gap_before;
  };
  const auto may_be_missing = [](const TableColumn& c) {
    return c.kind == Column::abbe || c.kind == Column::glass || c.kind == Column::catalogue ||
           c.kind == Column::conic || c.kind == Column::term || c.kind == Column::comment || c.kind == Column::stop ||
           c.kind == Column::left_out;
  };
  const auto end = columns_.begin() + static_cast<std::ptrdiff_t>(cells);
  const bool air =
      std::all_of(columns_.begin(), end, tells_no_medium) && std::none_of(end, columns_.end(), tells_no_medium);
  if (!air && !std::all_of(end, columns_.end(), may_be_missing)) refuse();
}

double TableReader::value(const RawRow& row, const TableColumn& column, std::string_view cell) const {
  if (const auto number = text_.number(cell)) return *number;
  in_.must_be(row.line, column.name, in_quotes(cell), "a finite number with a decimal point");
}

void TableReader::put(TableRow& row, const TableColumn& column, std::string_view cell, const RawRow& raw) {
  const double mm = column.unit_mm;
  switch (column.kind) {
    case Column::left_out: break;
    case Column::number:
      if (is_stop_word(cell)) row.stop = std::string(cell), row.in_medium = true;
      take_label(raw.line, cell, row.stop);
      break;
    case Column::radius: row.radius = is_plane_word(cell) ? 0 : mm * value(raw, column, cell); break;
    case Column::curvature: {
      const double curvature = is_plane_word(cell) && !is_infinite(cell) ? 0 : value(raw, column, cell);
      row.radius = curvature == 0 ? 0 : mm / curvature;
      break;
    }
    case Column::thickness:
    case Column::gap_before: row.thickness = mm * value(raw, column, cell); break;
    case Column::index: row.index = same(cell, "air") ? 1 : value(raw, column, cell); break;
    case Column::abbe: row.abbe = value(raw, column, cell); break;
    case Column::glass:
      if (same(cell, "mirror") || same(cell, "refl")) {
        row.mirror = true;
      } else if (is_stop_word(cell)) {
        row.stop = std::string(cell);
      } else {
        row.glass = std::string(cell);
      }
      break;
    case Column::catalogue: row.catalogue = std::string(cell); break;
    case Column::semi_diameter:
    case Column::diameter:
    case Column::aperture: row.aperture = mm * value(raw, column, cell); break;
    case Column::conic: row.conic = value(raw, column, cell) - column.of_sphere; break;
    case Column::term:
      if (const double coefficient = value(raw, column, cell); coefficient != 0) {
        row.terms.push_back({column.order, coefficient * std::pow(mm, 1 - column.order)});
      }
      break;
    case Column::stop:
      if (is_stop_word(cell) || same(cell, "x") || same(cell, "yes") || same(cell, "true") || cell == "1") {
        row.stop = std::string(cell);
      } else if (!same(cell, "no") && !same(cell, "false") && cell != "0") {
        in_.must_be(raw.line, column.name, in_quotes(cell), "\"stop\" or empty");
      }
      break;
    case Column::comment:
      if (same(cell, "mirror") || same(cell, "refl")) row.mirror = true;
      if (marks_stop_in_comment(cell)) row.stop = std::string(cell);
      row.comment = std::string(beginning(cell, 200));
      break;
  }
}

TableRow TableReader::row_of(const RawRow& raw) {
  TableRow row{.line = raw.line, .stop = raw.stop, .in_medium = raw.stop_in_front};
  std::vector<std::string_view> cells = raw.cells;
  // In a row without a glass the cell may be missing; the next number then stands in its position.
  const std::size_t glass = find(Column::glass);
  if (!text_.has_empty_cells() && cells.size() + 1 == columns_.size() && glass < cells.size() &&
      looks_like_a_number(cells[glass])) {
    cells.insert(cells.begin() + static_cast<std::ptrdiff_t>(glass), "-");
  }
  RawRow whole = raw;
  whole.cells = cells;
  check_width(whole);
  bool radius = false;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const TableColumn& column = columns_[i];
    if (is_none(cells[i])) continue;
    const bool is_radius = column.kind == Column::radius || column.kind == Column::curvature;
    radius = radius || is_radius;
    if (column.kind == Column::thickness && is_plane_word(cells[i]))
      continue;  // the row is the object, or is refused below
    put(row, column, cells[i], raw);
  }
  const std::size_t stop = find(Column::stop);
  if (row.radius != 0 && is_asphere_mark(row.stop) && (stop >= cells.size() || is_none(cells[stop]))) {
    name_asphere(raw.line, std::exchange(row.stop, {}));
  }
  if (!radius && row.stop.empty()) {
    in_.must_be(raw.line, "radius", "missing", "a number, or \"inf\" for a plane");
  }
  if (row.comment.empty() && !raw.remark.empty()) row.comment = std::string(beginning(raw.remark, 200));
  return row;
}

/// The first row may be the object: it is called so, or is a plane at infinity.
void TableReader::take_object(const TableRow& row, const RawRow& raw) {
  const std::size_t thickness = find(Column::thickness);
  const bool far = thickness < raw.cells.size() && is_plane_word(raw.cells[thickness]);
  if (row.radius != 0) in_.must_be(raw.line, "radius", to_text(row.radius) + " of the object", "0 (a plane)");
  in_.warn(raw.line, "row", "is taken as the object");
  if (!far && row.thickness) in_.lens.design.object_distance_mm = *row.thickness;
}

/// True if a row has only a radius. A row with the comment "film" does not become the film by its comment.
bool TableReader::is_bare_plane(const RawRow& raw) const {
  for (std::size_t i = 0; i < std::min(raw.cells.size(), columns_.size()); ++i) {
    const Column kind = columns_[i].kind;
    const bool of_image = kind == Column::radius || kind == Column::comment || kind == Column::number;
    if (!of_image && !is_none(raw.cells[i])) return false;
  }
  return true;
}

/// Checks that a row for the image is the last row. The previous row states its distance.
void TableReader::take_image(const RawRow& raw, bool last) const {
  if (!last) in_.must_be(raw.line, "row", "the image", "the last row");
  const std::size_t radius = find(Column::radius);
  if (radius < raw.cells.size() && text_.number(raw.cells[radius]).value_or(0) != 0) {
    in_.warn(raw.line, "radius", "of the image is left out: a film is flat");
  }
}

void TableReader::read() {
  take_comments();
  take_lines();
  if (rows_.empty()) throw Error(in_.where() + ": no rows; must be radius, thickness and index of surfaces");
  use_comment_as_head();
  drop_asphere_marks();
  drop_labels();
  guess();
  if (head_line_ != 0) check_head();
  end_last_row();
  if (text_.has_decimal_commas()) in_.warn(rows_.front().line, "numbers", "have decimal commas");

  auto& notes = in_.lens.imported->notes;
  if (!notes.empty()) {
    in_.lens.imported->title = notes.front();
    notes.erase(notes.begin());
  }
  const std::string all = lower(said_);
  in_.lens.focal_length_mm = focal_length_in(all);
  in_.lens.f_number = f_number_in(all);

  TableLens table;
  const bool diameters = has(Column::diameter) || all.find("aperture diameter") != std::string::npos;
  table.apertures = has(Column::semi_diameter) ? TableApertures::semi_diameters
                    : diameters                ? TableApertures::diameters
                                               : TableApertures::unknown;
  table.gaps = has(Column::gap_before) ? TableGaps::in_front : guessed_ ? TableGaps::unknown : TableGaps::behind;
  const std::size_t thickness = find(Column::thickness);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    RawRow& raw = rows_[i];
    take_marks(raw);
    for (std::size_t c = 0; c < std::min(raw.cells.size(), columns_.size()); ++c) {
      if (columns_[c].kind != Column::number && columns_[c].kind != Column::comment) continue;
      raw.object = raw.object || is_object_word(raw.cells[c]);
      const bool label = columns_[c].kind == Column::number;
      raw.image = raw.image || (is_image_word(raw.cells[c]) && (label || is_bare_plane(raw)));
    }
    if (raw.image && i > 0) {
      take_image(raw, i + 1 == rows_.size());
      continue;
    }
    const bool endless = thickness < raw.cells.size() && is_plane_word(raw.cells[thickness]);
    TableRow row = row_of(raw);
    if (i == 0 && (raw.object || (endless && row.radius == 0 && rows_.size() > 1))) {
      take_object(row, raw);
      continue;
    }
    if (raw.object) in_.must_be(raw.line, "row", "the object", "the first row");
    if (endless) in_.must_be(raw.line, "thickness", in_quotes(raw.cells[thickness]), "a finite number");
    table.rows.push_back(std::move(row));
  }
  if (table.rows.empty()) throw Error(in_.where() + ": no rows of surfaces; must be at least one");
  build_table(std::move(table), in_);
}

}  // namespace

/// True if one of the first lines is a row: two numbers, or a plane and a number, after an optional label or mark.
bool is_table(std::string_view text) {
  int tried = 0;
  bool head = false;
  const TableText table(text.substr(0, std::min<std::size_t>(text.size(), 65'536)));
  for (const TableLine& line : table.lines) {
    const auto is_data = [](std::string_view cell) { return looks_like_a_number(cell) || is_plane_word(cell); };
    const auto& cells = line.cells;
    for (std::size_t from = 0; from < 2 && from + 1 < cells.size(); ++from) {
      const bool starts = from == 0 || label_of(cells[0]) || is_stop_word(cells[0]) || is_object_word(cells[0]);
      if (starts && is_data(cells[from]) && (is_data(cells[from + 1]) || is_none(cells[from + 1]))) return true;
    }
    if (head && std::ranges::any_of(cells, is_data)) return true;
    head = head || is_head(cells, !table.has_empty_cells());
    if (++tried == 5) return false;
  }
  return false;
}

void read_table(std::string_view text, Import& in) { TableReader(text, in).read(); }

void read_table(std::vector<TableLine> lines, Import& in) { TableReader(std::move(lines), in).read(); }

}  // namespace petzval::formats_detail
