// SPDX-License-Identifier: Apache-2.0
#include "table_lens.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

bool is_air(std::string_view name) {
  return name.empty() || same(name, "air") || same(name, "vacuum") || same(name, "vac");
}

class TableBuilder {
 public:
  TableBuilder(TableLens table, Import& in) : table_(std::move(table)), rows_(table_.rows), in_(in) {}
  void build();

 private:
  void check(const TableRow& row) const;
  void move_gaps_behind();
  Medium medium(const TableRow& row, const Medium& before);
  void name_other_makers(const TableRow& row, const Medium& taken);
  void choose_stop();
  void take_apertures();

  TableLens table_;
  std::vector<TableRow>& rows_;
  Import& in_;
  std::set<std::string> named_;  ///< glasses whose other makers were named in a warning
};

void TableBuilder::check(const TableRow& row) const {
  if (row.radius != 0 && std::abs(row.radius) < 1e-12) {
    in_.must_be(row.line, "radius", to_text(row.radius), "at least 1e-12 mm, or 0 for a plane");
  }
  if (row.thickness && !(std::abs(*row.thickness) < 1e10)) {
    in_.must_be(row.line, "thickness", to_text(*row.thickness), "below 1e10 mm");
  }
  if (row.index && *row.index != 0 && !(*row.index >= 0.1 && *row.index <= 5)) {
    in_.must_be(row.line, "index", to_text(*row.index), "0.1 to 5");
  }
  if (row.aperture && !(*row.aperture >= 0)) in_.must_be(row.line, "aperture", to_text(*row.aperture), "at least 0");
}

/// Moves distances to the previous surface if the column states gaps in front of surfaces: if the table says so, or if
/// the first glass would otherwise have no thickness.
void TableBuilder::move_gaps_behind() {
  const TableRow& first = rows_.front();
  const bool guess = table_.gaps == TableGaps::unknown && rows_.size() > 1 && first.thickness == 0.0 &&
                     (first.index.value_or(0) > 1.01 || !is_air(first.glass));
  if (table_.gaps != TableGaps::in_front && !guess) return;
  if (guess) {
    in_.warn(first.line, "thickness",
             "is 0 for the first glass, so the column is taken as the gap in front of each surface");
  }
  for (std::size_t i = 0; i + 1 < rows_.size(); ++i) rows_[i].thickness = rows_[i + 1].thickness;
  rows_.back().thickness.reset();
}

Medium TableBuilder::medium(const TableRow& row, const Medium& before) {
  const bool stated = row.index && *row.index != 0;
  if (row.mirror) return before;
  if (is_air(row.glass)) {
    if (!row.index) return row.in_medium && row.radius == 0 ? before : Medium{};
    if (!stated || *row.index == 1) return {.nd = 1};
    Medium medium{.nd = *row.index};
    if (row.abbe.value_or(0) > 0) medium.vd = *row.abbe;
    return medium;
  }
  if (!stated) {
    if (const auto code = medium_of_code(row.glass)) return *code;
  }
  // A name without a maker is a glass of Schott if Schott has this name.
  std::vector<std::string> catalogues;
  if (!row.catalogue.empty()) {
    catalogues.push_back(row.catalogue);
  } else if (in_.glasses().find(row.glass, "schott") || in_.glasses().find(row.glass, "schott-legacy")) {
    catalogues.emplace_back("schott");
  }
  const auto nd = stated ? row.index : std::nullopt;
  const auto vd = row.abbe.value_or(0) > 0 ? row.abbe : std::nullopt;
  Medium found = in_.glass(row.line, row.glass, catalogues, nd, vd);
  if (row.catalogue.empty() && !stated) name_other_makers(row, found);
  return found;
}

/// Warns if a name stands for several glasses: F2 has n_d 1.62004 at Schott and 1.61293 at CDGM.
void TableBuilder::name_other_makers(const TableRow& row, const Medium& taken) {
  constexpr double min_index_difference = 1e-3;
  if (!taken.glass || !taken.catalogue || !named_.insert(*taken.glass).second) return;
  const Glass* glass = in_.glasses().find(*taken.glass, *taken.catalogue);
  std::string others;
  for (const Glass& other : in_.glasses().glasses()) {
    if (!glass || !same(other.name, glass->name) || std::abs(other.nd - glass->nd) <= min_index_difference) continue;
    others += ", " + other.catalogue + " (n_d " + to_text(other.nd, 6) + ')';
  }
  if (others.empty()) return;
  in_.warn(row.line, row.glass,
           "is taken from " + glass->catalogue + " (n_d " + to_text(glass->nd, 6) + "), not from" + others.substr(1) +
               "; a column \"catalogue\" selects another");
}

void TableBuilder::choose_stop() {
  std::vector<std::size_t> marked;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!rows_[i].stop.empty()) marked.push_back(i);
  }
  if (marked.empty()) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i].radius == 0 && rows_[i].index == 0.0) marked.push_back(i);
    }
  }
  in_.requests.plane_may_be_stop = true;
  if (marked.empty()) return;
  in_.lens.surfaces[marked.front()].stop = true;
  for (std::size_t i = 1; i < marked.size(); ++i) {
    in_.warn(rows_[marked[i]].line, "stop", "a second stop only limits rays; the first is the stop");
  }
}

/// Takes the column of apertures, which are diameters or semi-diameters.
void TableBuilder::take_apertures() {
  const auto has_one = [](const TableRow& row) { return row.aperture.value_or(0) > 0; };
  const auto first = std::ranges::find_if(rows_, has_one);
  if (first == rows_.end()) {
    return in_.warn(0, "aperture", "the table has no apertures; the surfaces have no semi-diameters");
  }
  const bool semi_diameters = table_.apertures == TableApertures::semi_diameters;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (has_one(rows_[i])) in_.lens.surfaces[i].semi_diameter = (semi_diameters ? 1 : 0.5) * *rows_[i].aperture;
  }
  in_.lens.semi_diameters = semi_diameters ? "the table's apertures" : "half of the table's apertures";
  in_.requests.names_missing_apertures = true;
  if (table_.apertures == TableApertures::unknown) {
    in_.requests.unknown_apertures = {first->line, table_.likely_apertures == TableApertures::diameters};
  }
}

void TableBuilder::build() {
  for (const TableRow& row : rows_) check(row);
  move_gaps_behind();
  Medium before = in_.lens.object_space;
  const TableRow* air = nullptr;
  std::size_t air_rows = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const TableRow& row = rows_[i];
    in_.requests.surface_lines.push_back(row.line);
    SurfaceRow& surface = in_.lens.surfaces.emplace_back();
    surface.radius = row.radius;
    if (!row.thickness && i + 1 < rows_.size()) {
      in_.must_be(row.line, "thickness", "-", "a number: the distance to the next surface");
    }
    surface.thickness = row.thickness.value_or(0);
    surface.conic = row.conic;
    surface.aspheric = row.terms;
    surface.mirror = row.mirror;
    surface.curved_in = row.curved_in;
    surface.medium = medium(row, before);
    if (!row.comment.empty()) surface.comment = row.comment;
    if (!row.index && row.glass.empty() && !row.mirror && surface.medium == Medium{} && ++air_rows == 1) air = &row;
    before = surface.medium;
  }
  if (air) {
    in_.warn(air->line, "index",
             "is missing in " + std::to_string(air_rows) + (air_rows == 1 ? " row" : " rows") + "; air is taken");
  }
  // A table may end with a plane for the film, without a distance behind it.
  const TableRow& last = rows_.back();
  const bool ends = last.thickness.value_or(0) == 0;
  in_.requests.last_plane_may_be_film = ends && rows_.size() > 1 && last.stop.empty() && last.index != 0.0;
  choose_stop();
  take_apertures();
  if (ends) {
    in_.requests.film_at_focus = {
        .line = last.line,
        .command = "thickness",
        .reason = last.thickness ? "of the last surface is 0" : "of the last surface is not stated"};
  }
}

}  // namespace

std::optional<double> focal_length_in(std::string_view text) {
  const std::string all = lower(text);
  const std::string_view digits = "0123456789.";
  for (std::size_t at = all.find("mm"); at != std::string::npos; at = all.find("mm", at + 1)) {
    std::size_t end = at;
    while (end > 0 && all[end - 1] == ' ') --end;
    std::size_t start = end;
    while (start > 0 && digits.find(all[start - 1]) != std::string_view::npos) --start;
    while (start < end && all[start] == '.') ++start;
    if (const auto value = number(std::string_view(all).substr(start, end - start)); value && *value > 0) return value;
  }
  return {};
}

std::optional<double> f_number_in(std::string_view text) {
  const std::string all = lower(text);
  for (std::size_t at = all.find('f'); at != std::string::npos; at = all.find('f', at + 1)) {
    if (at > 0 && std::string_view(" .,(-_/").find(all[at - 1]) == std::string_view::npos) continue;
    std::size_t start = at + 1;
    if (start < all.size() && all[start] == '/') ++start;
    std::size_t end = std::min(all.find_first_not_of("0123456789.", start), all.size());
    while (end > start && all[end - 1] == '.') --end;
    const auto value = number(std::string_view(all).substr(start, end - start));
    if (value && *value >= 0.5 && *value <= 64) return value;
  }
  return {};
}

void build_table(TableLens table, Import& import) { TableBuilder(std::move(table), import).build(); }

}  // namespace petzval::formats_detail
