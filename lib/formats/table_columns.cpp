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

/// The heads of a kind of column, in lower case, without blanks and punctuation.
struct Heads {
  Column kind;
  std::string_view names;
};

constexpr Heads all_heads[] = {
    {Column::number,
     "# no nr num number row m s s# si sn sno i id surf surf# surface surface# surfaceno surfacenumber"},
    {Column::number, "facenumber faceno planeno lenssurface fl\u00e4che fl\u00e4chennummer"},
    {Column::left_out, "focallength lensfocallength \u03b8gf \u03b8gfj pgf"},
    {Column::radius, "r ri rj rad radius roc rdy ry yradius radiusofcurvature curvatureradius"},
    {Column::curvature, "c cv cuy curv curvature"},
    {Column::thickness,
     "d di dj t th thi thick thickness dist distance gap dicke abstand space spacing separation interval "
     "thicknessdistance "
     "axialdistance axialthickness surfacedistance surfaceinterval surfaceseparation surfacespacing onaxisdistance "
     "onaxisspacing onaxissurfacespacing "
     "axialspacing airgap thicknessorairgap"},
    {Column::gap_before, "gapbefore gapinfront thicknessbefore distancebefore axpos"},
    {Column::index, "n nd ndi ndj nj brechzahl index ior refindex refractiveindex indexofrefraction"},
    {Column::abbe,
     "v vd vdi vdj vj v# vno vnumber nu nud abbe abbeno abbe# abbenumber abbezahl abv abbe'snumber abbevd dispersion"},
    {Column::glass, "glass glas glassname glasstype material mat mat'l matl medium"},
    {Column::catalogue, "catalog catalogue maker manufacturer"},
    {Column::semi_diameter,
     "semi sd sa er effectiveradius effradius semidia semidiam semidiameter semiap semiaperture clearsemidiameter "
     "clearsemiaperture clearsemidia clearradius apertureradius housingradius halfdiameter halfaperture"},
    {Column::diameter,
     "outerdiameter lensdiameter effectivebeamdiameter dia diam diameter ca clearaperture cleardiameter cleardia "
     "effectivediameter aperturediameter "
     "fulldiameter"},
    {Column::aperture, "ap ea aperture clear effectiveaperture"},
    {Column::conic, "k cc kappa conic conicconstant"},
    {Column::stop, "stop sto"},
    {Column::comment, "comment description element label name note notes remark remarks surfacetype type"},
};

/// The kind of column for a head; nullopt if the head is not known.
std::optional<Column> kind_of(std::string_view head) {
  const auto found = std::ranges::find_if(all_heads, [&](const Heads& h) { return is_one_of(head, h.names); });
  return found == std::end(all_heads) ? std::nullopt : std::optional(found->kind);
}

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

/// Greek letters in heads and their spelling in the list of heads.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> greek = {{
    {"\u03bd", "v"},
    {"\u03c5", "v"},
    {"\u03ba", "kappa"},
    {"\u03c6", "dia"},
    {"\u03a6", "dia"},
    {"\u00f8", "dia"},
    {"\u00d8", "dia"},
    {"\u2300", "dia"},
}};

/// A head in the spelling of the list of heads, and the text in its brackets.
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
  if (!bracket.empty()) {
    const auto kind = kind_of(name);
    if (const auto unit = unit_of(bracket)) {
      column.unit_mm = *unit;
    } else if (kind == Column::index || kind == Column::abbe) {
      // "n(d)" and "n (587.6 nm)"; an index of another line is another column.
      const auto nm = number(bracket.substr(0, bracket.find_first_not_of("0123456789.")));
      const bool d_line = bracket == "d" || (nm && std::abs((*nm < 1 ? 1000 * *nm : *nm) - 587.56) < 0.1);
      const bool word = bracket.find_first_of("0123456789") == bracket.npos && bracket.size() > 2;
      if (!d_line && !word) return {};
    } else if (!kind) {
      name += bracket;  // "A(4)"; "Ri (radius of curvature)" says its name twice
    }
  }
  if (!kind_of(name) && name.size() > 2 && name.ends_with("mm")) name.resize(name.size() - 2);
  if (const auto kind = kind_of(name)) {
    column.kind = *kind;
    column.of_sphere = name == "kappa" ? 1 : 0;
    return column;
  }
  // "Refractive index nd" in a single cell.
  const std::size_t blank = std::min(head.rfind(' '), head.size());
  if (head.size() - blank <= 5 && blank < head.size()) {
    const auto word = kind_of(plain(head.substr(0, blank)).name), sign = kind_of(plain(head.substr(blank)).name);
    if (word && word == sign) return TableColumn{.kind = *word, .name = std::string(head)};
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
    // The longest run of words that is a known head: "semi diameter (mm)".
    std::size_t taken = 1;
    TableColumn column{.name = std::string(cells[i])};
    if (const auto known = column_of(cells[i])) column = *known;
    std::string joined(cells[i]);
    for (std::size_t more = 1; by_blanks && more < 4 && i + more < cells.size(); ++more) {
      // Single letters are separate heads: "V D".
      const std::string_view next = cells[i + more];
      const bool in_brackets = next.starts_with('(') || next.starts_with('[');
      if (!in_brackets && next != "#" && (next.size() < 2 || cells[i].size() < 2)) break;
      joined += ' ' + std::string(cells[i + more]);
      if (const auto known = column_of(joined)) {
        column = *known;
        taken = more + 1;
      }
    }
    i += taken;
    // "Refractive index nd", "Radius of curvature R": a word and its sign are one head.
    const auto sign = by_blanks && i < cells.size() && cells[i].size() <= 4 && column.name.size() > 4
                          ? column_of(cells[i])
                          : std::nullopt;
    if (sign && sign->kind == column.kind && column.kind <= Column::abbe && column.kind > Column::number) {
      ++i;
      if (i < cells.size() && cells[i].starts_with('(')) ++i;  // the unit
    }
    columns.push_back(std::move(column));
  }
  // Two heads are ambiguous: "index" is a row number if there is also "nd", and a second "d" ("r d n D") is a diameter.
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
  if (2 * data >= cells.size()) return false;  // numbers are not heads
  const auto columns = columns_of(cells, by_blanks);
  const auto known =
      columns.size() - static_cast<std::size_t>(std::ranges::count(columns, Column::left_out, &TableColumn::kind));
  return known >= 2 && known > data;
}

namespace {

/// The numbers of a row after radius and thickness, and its glass.
struct Tail {
  std::vector<std::string_view> cells;
  std::string_view glass;  ///< empty if absent

  std::optional<double> number(std::size_t i) const {
    return i < cells.size() ? formats_detail::number(cells[i]) : std::nullopt;
  }
};

constexpr double least_abbe = 15, most_abbe = 110;

/// True for indices of glasses, and for 1 or 0, which mean air.
bool is_index(double value) { return value == 0 || (value >= 0.9 && value <= 5); }

bool has_glass(const Tail& tail) {
  if (!tail.glass.empty()) return !is_air_name(tail.glass);
  return tail.number(0).value_or(0) > 1.01;
}

/// True if a column may be the V-numbers of glasses, with 0 or no number for air.
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
      if (glass_at && *glass_at != i) return refused("several columns contain glasses");
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
  if (numbers > 3) return refused("rows of " + std::to_string(widest) + " cells have no common order");
  if (numbers == 1) kinds = {index_first ? index : aperture};
  if (numbers == 1 && !index_first && !glass_at) return refused("the third column has no indices");
  if (numbers >= 2 && !index_first) return refused("the column after the thickness has no indices");
  if (numbers == 2) {
    // Tables of renderers have an aperture in each row; tables of patents have no V-number for air.
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
