// SPDX-License-Identifier: Apache-2.0
#include "table_columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

struct Head {
  std::string_view name;  ///< lower case, without blanks and signs
  Column kind;
};

constexpr Head heads[] = {
    {"#", Column::number},
    {"no", Column::number},
    {"nr", Column::number},
    {"num", Column::number},
    {"number", Column::number},
    {"row", Column::number},
    {"s", Column::number},
    {"s#", Column::number},
    {"sno", Column::number},
    {"i", Column::number},
    {"id", Column::number},
    {"surf", Column::number},
    {"surf#", Column::number},
    {"surface", Column::number},
    {"surface#", Column::number},
    {"surfaceno", Column::number},
    {"surfacenumber", Column::number},
    {"r", Column::radius},
    {"rad", Column::radius},
    {"radius", Column::radius},
    {"roc", Column::radius},
    {"rdy", Column::radius},
    {"ry", Column::radius},
    {"yradius", Column::radius},
    {"radiusofcurvature", Column::radius},
    {"curvatureradius", Column::radius},
    {"c", Column::curvature},
    {"cv", Column::curvature},
    {"cuy", Column::curvature},
    {"curv", Column::curvature},
    {"curvature", Column::curvature},
    {"d", Column::thickness},
    {"t", Column::thickness},
    {"th", Column::thickness},
    {"thi", Column::thickness},
    {"thick", Column::thickness},
    {"thickness", Column::thickness},
    {"dist", Column::thickness},
    {"distance", Column::thickness},
    {"gap", Column::thickness},
    {"spacing", Column::thickness},
    {"separation", Column::thickness},
    {"thicknessdistance", Column::thickness},
    {"axialdistance", Column::thickness},
    {"axialthickness", Column::thickness},
    {"gapbefore", Column::gap_before},
    {"gapinfront", Column::gap_before},
    {"thicknessbefore", Column::gap_before},
    {"distancebefore", Column::gap_before},
    {"axpos", Column::gap_before},
    {"n", Column::index},
    {"nd", Column::index},
    {"index", Column::index},
    {"ior", Column::index},
    {"refindex", Column::index},
    {"refractiveindex", Column::index},
    {"v", Column::abbe},
    {"vd", Column::abbe},
    {"v#", Column::abbe},
    {"vno", Column::abbe},
    {"vnumber", Column::abbe},
    {"nu", Column::abbe},
    {"nud", Column::abbe},
    {"abbe", Column::abbe},
    {"abbeno", Column::abbe},
    {"abbenumber", Column::abbe},
    {"abbevd", Column::abbe},
    {"dispersion", Column::abbe},
    {"glass", Column::glass},
    {"glas", Column::glass},
    {"glassname", Column::glass},
    {"glasstype", Column::glass},
    {"material", Column::glass},
    {"mat", Column::glass},
    {"medium", Column::glass},
    {"catalog", Column::catalogue},
    {"catalogue", Column::catalogue},
    {"maker", Column::catalogue},
    {"manufacturer", Column::catalogue},
    {"semi", Column::semi_diameter},
    {"sd", Column::semi_diameter},
    {"sa", Column::semi_diameter},
    {"semidia", Column::semi_diameter},
    {"semidiam", Column::semi_diameter},
    {"semidiameter", Column::semi_diameter},
    {"semiap", Column::semi_diameter},
    {"semiaperture", Column::semi_diameter},
    {"clearsemidiameter", Column::semi_diameter},
    {"clearsemiaperture", Column::semi_diameter},
    {"clearradius", Column::semi_diameter},
    {"apertureradius", Column::semi_diameter},
    {"housingradius", Column::semi_diameter},
    {"halfdiameter", Column::semi_diameter},
    {"halfaperture", Column::semi_diameter},
    {"dia", Column::diameter},
    {"diam", Column::diameter},
    {"diameter", Column::diameter},
    {"ca", Column::diameter},
    {"clearaperture", Column::diameter},
    {"cleardiameter", Column::diameter},
    {"cleardia", Column::diameter},
    {"effectivediameter", Column::diameter},
    {"aperturediameter", Column::diameter},
    {"fulldiameter", Column::diameter},
    {"ap", Column::aperture},
    {"aperture", Column::aperture},
    {"clear", Column::aperture},
    {"k", Column::conic},
    {"cc", Column::conic},
    {"kappa", Column::conic},
    {"conic", Column::conic},
    {"conicconstant", Column::conic},
    {"stop", Column::stop},
    {"sto", Column::stop},
    {"comment", Column::comment},
    {"description", Column::comment},
    {"element", Column::comment},
    {"label", Column::comment},
    {"name", Column::comment},
    {"note", Column::comment},
    {"notes", Column::comment},
    {"remark", Column::comment},
    {"remarks", Column::comment},
    {"surfacetype", Column::comment},
    {"type", Column::comment},
};

constexpr std::array<std::pair<std::string_view, double>, 8> units = {{
    {"mm", 1},
    {"cm", 10},
    {"m", 1000},
    {"in", 25.4},
    {"inch", 25.4},
    {"inches", 25.4},
    {"millimetres", 1},
    {"millimeters", 1},
}};

/// Greek letters of heads, and their names in the list of heads.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> greek = {{
    {"\u03bd", "v"},
    {"\u03c5", "v"},
    {"\u03ba", "k"},
    {"\u03c6", "dia"},
    {"\u03a6", "dia"},
    {"\u00f8", "dia"},
    {"\u00d8", "dia"},
    {"\u2300", "dia"},
}};

/// A head as the list of heads spells it, and the text in its brackets.
struct PlainHead {
  std::string name, bracket;
};

PlainHead plain(std::string_view head) {
  PlainHead result;
  bool in_bracket = false;
  for (std::size_t i = 0; i < head.size();) {
    const auto letter = std::ranges::find_if(greek, [&](const auto& g) { return head.substr(i).starts_with(g.first); });
    if (letter != greek.end()) {
      result.name += letter->second;
      i += letter->first.size();
      continue;
    }
    const char c = lower(head[i++]);
    if (c == '(' || c == '[') {
      in_bracket = true;
    } else if (c == ')' || c == ']') {
      in_bracket = false;
    } else if (in_bracket) {
      if (c != ' ') result.bracket += c;
    } else if (std::string_view(" _-.,:/*").find(c) == std::string_view::npos) {
      result.name += c;
    }
  }
  return result;
}

std::optional<int> order_of_term(std::string_view name) {
  // "a4", and "r^4".
  const std::size_t letters = name.starts_with("r^") ? 2 : name.starts_with('a') ? 1 : 0;
  if (letters == 0) return {};
  const auto order = number(name.substr(letters));
  if (!order || !(*order >= 2 && *order <= 40 && *order == std::floor(*order))) return {};
  return static_cast<int>(*order);
}

bool is_glass_name(std::string_view cell) {
  return !is_none(cell) && !looks_like_a_number(cell) && !is_plane_word(cell) && !is_stop_word(cell);
}

bool is_air_name(std::string_view cell) { return same(cell, "air") || same(cell, "vacuum"); }

}  // namespace

std::optional<double> unit_of(std::string_view cell) {
  std::string name;
  for (const char c : cell) {
    if (std::string_view("()[] .").find(c) == std::string_view::npos) name += lower(c);
  }
  const auto found = std::ranges::find(units, std::string_view(name), [](const auto& u) { return u.first; });
  return found == units.end() ? std::nullopt : std::optional(found->second);
}

std::optional<TableColumn> column_of(std::string_view head) {
  auto [name, bracket] = plain(head);
  TableColumn column{.name = std::string(head)};
  const auto find = [&own = name] { return std::ranges::find(heads, std::string_view(own), &Head::name); };
  if (!bracket.empty()) {
    if (const auto unit = unit_of(bracket)) {
      column.unit_mm = *unit;
    } else if (find() != std::end(heads) && (find()->kind == Column::index || find()->kind == Column::abbe)) {
      // "n(d)" and "n (587.6 nm)"; an index of another line is another column.
      const auto nm = number(bracket.substr(0, bracket.find_first_not_of("0123456789.")));
      const bool d_line = bracket == "d" || (nm && std::abs((*nm < 1 ? 1000 * *nm : *nm) - 587.56) < 0.1);
      if (!d_line) return {};
    } else {
      name += bracket;  // "A(4)"
    }
  }
  if (find() == std::end(heads) && name.size() > 2 && name.ends_with("mm")) name.resize(name.size() - 2);
  if (find() != std::end(heads)) {
    column.kind = find()->kind;
    return column;
  }
  if (const auto order = order_of_term(name)) {
    column.kind = Column::term;
    column.order = *order;
    return column;
  }
  return {};
}

std::vector<TableColumn> columns_of(std::span<const std::string_view> cells, bool by_blanks) {
  std::vector<TableColumn> columns;
  for (std::size_t i = 0; i < cells.size();) {
    // The longest run of words that is a head: "semi diameter (mm)".
    std::size_t taken = 1;
    TableColumn column{.name = std::string(cells[i])};
    if (const auto known = column_of(cells[i])) column = *known;
    std::string joined(cells[i]);
    for (std::size_t more = 1; by_blanks && more < 4 && i + more < cells.size(); ++more) {
      // Letters are heads of their own: "V D".
      const std::string_view next = cells[i + more];
      const bool in_brackets = next.starts_with('(') || next.starts_with('[');
      if (!in_brackets && (next.size() < 2 || cells[i].size() < 2)) break;
      joined += ' ' + std::string(cells[i + more]);
      if (const auto known = column_of(joined)) {
        column = *known;
        taken = more + 1;
      }
    }
    columns.push_back(std::move(column));
    i += taken;
  }
  // Two heads have two meanings: "index" is a row number if there is "nd", and a second "d" ("r d n D") is a diameter.
  const auto find = [&](Column kind) { return std::ranges::find(columns, kind, &TableColumn::kind); };
  const auto second = [&](Column kind) {
    const auto first = find(kind);
    return first == columns.end() ? first
                                  : std::ranges::find(std::next(first), columns.end(), kind, &TableColumn::kind);
  };
  if (second(Column::index) != columns.end() && find(Column::number) == columns.end()) {
    const auto word =
        std::ranges::find_if(columns, [](const TableColumn& column) { return same(column.name, "index"); });
    if (word != columns.end()) word->kind = Column::number;
  }
  if (const auto other = second(Column::thickness); other != columns.end()) {
    if (same(find(Column::thickness)->name, "d") && !same(other->name, "d")) {
      find(Column::thickness)->kind = Column::diameter;
    } else if (same(other->name, "d")) {
      other->kind = Column::diameter;
    }
  }
  if (find(Column::curvature) != columns.end() && find(Column::radius) != columns.end()) {
    find(Column::curvature)->kind = Column::left_out;
  }
  return columns;
}

bool is_head(std::span<const std::string_view> cells, bool by_blanks) {
  const auto is_data = [](std::string_view cell) { return looks_like_a_number(cell) || is_plane_word(cell); };
  const auto data = static_cast<std::size_t>(std::ranges::count_if(cells, is_data));
  if (2 * data >= cells.size()) return false;  // numbers are no heads
  const auto columns = columns_of(cells, by_blanks);
  const auto known =
      columns.size() - static_cast<std::size_t>(std::ranges::count(columns, Column::left_out, &TableColumn::kind));
  return known >= 2 && known > data;
}

namespace {

/// The numbers of rows behind radius and thickness, and behind a glass.
struct Tail {
  std::vector<std::string_view> cells;
  std::string_view glass;  ///< empty: none

  std::optional<double> number(std::size_t i) const {
    return i < cells.size() ? formats_detail::number(cells[i]) : std::nullopt;
  }
};

constexpr double least_abbe = 15, most_abbe = 110;

/// Indices of glasses, and 1 or 0 for air.
bool is_index(double value) { return value == 0 || (value >= 0.9 && value <= 5); }

bool has_glass(const Tail& tail) {
  if (!tail.glass.empty()) return !is_air_name(tail.glass);
  return tail.number(0).value_or(0) > 1.01;
}

/// True if a column has the V-numbers of glasses, and 0 or nothing for air.
bool could_be_abbe(std::span<const Tail> tails, std::size_t column, bool strict_air) {
  return std::ranges::all_of(tails, [&](const Tail& tail) {
    const auto value = tail.number(column);
    if (!value || *value == 0) return true;
    if (!has_glass(tail)) return !strict_air;
    return *value >= least_abbe && *value <= most_abbe;
  });
}

}  // namespace

GuessedColumns guess_columns(std::span<const std::vector<std::string_view>> rows,
                             const std::function<bool(std::string_view, double)>& is_index_of) {
  const auto refused = [](std::string reason) { return GuessedColumns{{}, std::move(reason)}; };
  std::optional<std::size_t> glass_at;
  std::size_t widest = 0;
  for (const auto& row : rows) {
    widest = std::max(widest, row.size());
    for (std::size_t i = 2; i < row.size(); ++i) {
      if (!is_glass_name(row[i])) continue;
      if (glass_at && *glass_at != i) return refused("glasses stand in several columns");
      glass_at = i;
    }
  }
  std::vector<Tail> tails;
  std::size_t numbers = 0;
  for (const auto& row : rows) {
    Tail& tail = tails.emplace_back();
    for (std::size_t i = 2; i < row.size(); ++i) {
      const bool glass_omitted = glass_at == i && looks_like_a_number(row[i]);
      if (glass_at == i && !glass_omitted) {
        tail.glass = is_none(row[i]) ? std::string_view("air") : row[i];
      } else {
        tail.cells.push_back(row[i]);
      }
    }
    if (glass_at && tail.glass.empty()) tail.glass = "air";
    numbers = std::max(numbers, tail.cells.size());
  }

  const auto indices_at_0 = std::ranges::all_of(tails, [&](const Tail& tail) {
    return !tail.number(0) || (is_index(*tail.number(0)) && (!glass_at || *tail.number(0) < 2.8));
  });
  const bool index_first =
      glass_at && numbers == 1
          ? std::ranges::any_of(
                tails, [&](const Tail& tail) { return tail.number(0) && is_index_of(tail.glass, *tail.number(0)); })
          : indices_at_0;
  std::vector<Column> kinds;
  using enum Column;
  if (numbers == 0 && !glass_at) return refused("no column has indices or glasses");
  if (numbers > 3) return refused("rows of " + std::to_string(widest) + " cells have no usual order");
  if (numbers == 1) kinds = {index_first ? index : aperture};
  if (numbers == 1 && !index_first && !glass_at) return refused("the third column has no indices");
  if (numbers >= 2 && !index_first) return refused("the column behind the thickness has no indices");
  if (numbers == 2) {
    // Renderers' tables have an aperture in each row, patents no V-number for air.
    const bool any_air = std::ranges::any_of(tails, std::not_fn(has_glass));
    kinds = {index, any_air && could_be_abbe(tails, 1, true) ? abbe : aperture};
  }
  if (numbers == 3) {
    const bool abbe_last = !could_be_abbe(tails, 1, false) && could_be_abbe(tails, 2, false);
    kinds = abbe_last ? std::vector{index, aperture, abbe} : std::vector{index, abbe, aperture};
  }
  static constexpr std::array<std::pair<Column, const char*>, 6> names = {{{radius, "radius"},
                                                                           {thickness, "thickness"},
                                                                           {index, "index"},
                                                                           {abbe, "V-number"},
                                                                           {glass, "glass"},
                                                                           {aperture, "aperture"}}};
  kinds.insert(kinds.begin(), {radius, thickness});
  if (glass_at) kinds.insert(kinds.begin() + static_cast<std::ptrdiff_t>(*glass_at), glass);
  GuessedColumns result;
  for (const Column kind : kinds) {
    result.columns.push_back(
        {.kind = kind, .name = std::ranges::find(names, kind, [](const auto& n) { return n.first; })->second});
  }
  return result;
}

}  // namespace petzval::formats_detail
