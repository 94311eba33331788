// SPDX-License-Identifier: Apache-2.0
#include "import.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "glass/similar_names.hpp"
#include "io/json.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using glass_detail::same_bare;

constexpr std::size_t most_warnings = 1000;

/// Names of materials in other programs, and in the tables.
constexpr std::array<std::pair<std::string_view, std::string_view>, 15> other_names = {{
    {"SILICA", "F_SILICA"},
    {"FUSEDSILICA", "F_SILICA"},
    {"FSILICA", "F_SILICA"},
    {"SIO2", "F_SILICA"},
    {"FUSED", "F_SILICA"},
    {"C79-80", "F_SILICA"},  // Corning HPFS 7980
    {"MGF2", "MGF2_O"},
    {"SAPPHIRE", "SAPPHIRE_O"},
    {"AL2O3", "SAPPHIRE_O"},
    {"POLYCARB", "POLYCARBONATE"},
    {"POLYSTYR", "POLYSTYRENE"},
    {"ACRYLIC", "PMMA"},
    {"E48R", "ZEONEX_E48R"},
    {"SEAWATER", "WATER"},
    {"CAFL", "CAF2"},
}};

}  // namespace

Import::Import(std::string where, std::string_view format, const ReadOptions& options)
    : where_(std::move(where)), entry_(options.entry), glasses_(options.glasses) {
  const std::filesystem::path path = where_;
  lens.id = path.stem().string();
  lens.imported = FileOrigin{std::string(format), path.filename().string()};
}

void Import::warn(int line, std::string_view command, const std::string& message) {
  auto& warnings = lens.imported->warnings;
  if (warnings.size() < most_warnings) {
    warnings.push_back({line, std::string(beginning(command, 60)), message});
  } else {
    ++left_out_;
  }
}

void Import::refuse(int line, std::string_view command, const std::string& found, const std::string& rule) const {
  std::string text = where_;
  if (line > 0) text += ": line " + std::to_string(line);
  if (!command.empty()) text += ": " + std::string(beginning(command, 60));
  throw Error(text + " = " + found + "; must be " + rule);
}

void Import::must_be(int line, std::string_view parameter, const std::string& value, const std::string& rule) const {
  throw Error(where_ + ':' + std::to_string(line) + ": " + std::string(beginning(parameter, 60)) + " = " + value +
              "; must be " + rule);
}

void Import::limit(std::size_t count, std::string_view what, std::size_t ends) const {
  constexpr std::size_t max_entries = 10'000;
  if (count <= max_entries + ends) return;
  throw Error(where_ + ": more than " + std::to_string(max_entries) + ' ' + std::string(what) + "; must be fewer");
}

void Import::note(std::string_view text) {
  auto& notes = lens.imported->notes;
  if (!text.empty() && notes.size() < 1000) notes.emplace_back(beginning(text, 4096));
}

void Import::count_left_out_warnings() {
  if (left_out_ == 0) return;
  lens.imported->warnings.push_back({0, "file", std::to_string(left_out_) + " more warnings are left out"});
}

double Import::number(int line, std::string_view command, std::string_view word) const {
  if (const auto value = formats_detail::number(word)) return *value;
  refuse(line, command, io_detail::in_quotes(word), "a finite number with a decimal point");
}

const GlassCatalogue& Import::glasses() {
  if (!glasses_) glasses_ = &glass_tables();
  return *glasses_;
}

std::optional<double> index_at(const Glass& glass, double nm) {
  if (nm < glass.shortest_nm - 1e-6 || nm > glass.longest_nm + 1e-6) return {};
  return refractive_index(glass, nm);
}

namespace {

/// The medium of a glass, with n_d and V_d from its formula.
Medium medium_of(const Glass& glass) {
  Medium medium{.glass = glass.name, .catalogue = glass.catalogue, .nd = index_at(glass, d_line_nm)};
  const auto n_f = index_at(glass, spectral_line_nm("F")), n_c = index_at(glass, spectral_line_nm("C"));
  if (medium.nd && n_f && n_c) {
    const double v = *n_f == *n_c ? 0 : (*medium.nd - 1) / (*n_f - *n_c);
    if (v >= 0 && std::isfinite(v)) medium.vd = v;
  }
  return medium;
}

// Difference of n_d between two glasses of one name, and half a unit of the fourth decimal.
constexpr double min_index_difference = 0.01, rounded_index = 5e-5;

}  // namespace

const GlassNames& Import::names() {
  if (!names_) names_.emplace(glasses());
  return *names_;
}

Medium Import::glass(int line, std::string_view name, std::span<const std::string> catalogues, std::optional<double> nd,
                     std::optional<double> vd, Numbers numbers) {
  std::string_view asked = name;
  const Glass* found = names().find(asked, catalogues, nd, numbers);
  if (!found) {
    const auto other =
        std::ranges::find_if(other_names, [&](const auto& entry) { return same_bare(entry.first, name); });
    if (other != other_names.end()) found = names().find(other->second, catalogues, nd, numbers);
  }
  // Examples: "L-TIM28_MOLD" is a moulded L-TIM28, "NBK7_SCHOTT" is an N-BK7.
  bool names_its_maker = false;
  if (const std::size_t tail = name.find_last_of('_'); !found && tail != std::string_view::npos && tail > 0) {
    const std::string maker_name(name.substr(tail + 1));
    found = names().find(name.substr(0, tail), std::array{maker_name}, nd, numbers);
    names_its_maker = found && is_listed(std::array{maker_name}, *found);
    if (names_its_maker) asked = name.substr(0, tail);
  }
  if (found && numbers == Numbers::stated && nd && std::abs(found->nd - *nd) > min_index_difference) {
    warn(line, name,
         "has n_d " + to_text(*nd, 6) + " in the file; " + describe(*found) +
             " differs, so the file's n_d and V_d are taken");
    return {.glass = std::string(name), .nd = *nd, .vd = vd};
  }
  if (found) {
    if (!same_bare(asked, found->name)) {
      warn(line, name, "is in no glass table; " + describe(*found) + " is taken for it");
    } else if (!catalogues.empty() && !names_its_maker && !is_listed(catalogues, *found)) {
      std::string list;
      for (const std::string& c : catalogues) append(list, ", ", c);
      warn(line, name, "is not in the catalogues of the file (" + list + "); " + describe(*found) + " is taken for it");
    } else if (const std::string others = names().others(*found, catalogues, nd); !names_its_maker && !others.empty()) {
      warn(line, name, "is in several catalogues; " + describe(*found) + " is taken, not " + others);
    }
    Medium medium = medium_of(*found);
    // Other melts, and moulded glasses, have different indices.
    if (numbers == Numbers::stated && nd && medium.nd && std::abs(*medium.nd - *nd) > rounded_index) medium.nd = nd;
    return medium;
  }

  // The fictitious glass of OpticStudio's catalogue MISC, for examples.
  if (same(name, "N15")) {
    warn(line, name, "is in no glass table; an index of 1.5 at all wavelengths is taken");
    return {.nd = 1.5, .vd = 0};
  }
  if (nd && *nd > 0 && *nd <= 5) {
    std::string message = "is in no glass table; n_d " + to_text(*nd, 6) +
                          (vd ? " and V_d " + to_text(*vd, 4) + " of the file are" : " of the file is") + " taken";
    for (const Glass* nearest : nearest_glasses(glasses(), *nd, vd, 1)) {
      message += "; the nearest glass is " + describe(*nearest);
    }
    warn(line, name, message);
    return {.glass = std::string(name), .nd = *nd, .vd = vd};
  }

  const std::string similar = glass_detail::similar_names(glasses(), name);
  std::string list;
  for (const std::string& c : catalogues) append(list, ", ", c);
  refuse(line, name, "a name in no glass table, without an index in the file",
         "a glass of the tables or of a catalogue (--glasses FILE, an .agf or .yml)" +
             (list.empty() ? std::string() : "; the file names the catalogues " + list) +
             (similar.empty() ? std::string() : "; similar names: " + similar));
}

SurfaceChange& change_of(Configuration& configuration, int surface) {
  auto& changes = configuration.changes;
  const auto known = std::ranges::find(changes, surface, &SurfaceChange::surface);
  if (known != changes.end()) return *known;
  SurfaceChange& change = changes.emplace_back();
  change.surface = surface;
  return change;
}

std::optional<Medium> medium_of_code(std::string_view code) {
  // "517642" and "517.642"; with more digits "51680.6417" and "620410.603236".
  const std::size_t point = code.find('.');
  const std::string_view left = code.substr(0, point);
  const std::string_view right = point == std::string_view::npos ? std::string_view() : code.substr(point + 1);
  const auto digits = [](std::string_view text) {
    return !text.empty() && text.size() <= 12 && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  };
  std::string_view index = left, abbe = right;
  if (point == std::string_view::npos) {
    if (left.size() != 6) return {};
    index = left.substr(0, 3), abbe = left.substr(3);
  }
  if (!digits(index) || !digits(abbe) || index.size() < 3 || abbe.size() < 2) return {};
  const auto decimal = [](std::string_view whole, std::string_view rest) {
    return *formats_detail::number(std::string(whole).append(".").append(rest));
  };
  const double vd = decimal(abbe.substr(0, 2), abbe.substr(2));
  if (!(vd > 0)) return {};
  return Medium{.glass = std::string(code), .nd = decimal("1", index), .vd = vd};
}

}  // namespace petzval::formats_detail
