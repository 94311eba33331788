// SPDX-License-Identifier: Apache-2.0
#include "petzval/media/glass.hpp"

#include <dirent.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>

#include "petzval/core/error.hpp"

namespace petzval::inline v0 {
namespace {

constexpr std::string_view header = "catalogue,name,nd,vd,formula,wl_min_um,wl_max_um,coefficients,origin";
constexpr std::size_t columns = 9;

constexpr std::array<std::pair<std::string_view, DispersionFormula>, 5> formulas = {{
    {"sellmeier", DispersionFormula::sellmeier},
    {"sellmeier_squared", DispersionFormula::sellmeier_squared},
    {"polynomial", DispersionFormula::polynomial},
    {"cauchy", DispersionFormula::cauchy},
    {"buchdahl", DispersionFormula::buchdahl},
}};

constexpr char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool comes_before(std::string_view a, std::string_view b) noexcept {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [](char x, char y) { return lower(x) < lower(y); });
}

bool same(std::string_view a, std::string_view b) noexcept {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t from = 0;;) {
    const std::size_t to = text.find(separator, from);
    parts.push_back(text.substr(from, to - from));
    if (to == std::string_view::npos) return parts;
    from = to + 1;
  }
}

double parse_number(std::string_view text, const std::string& where, const char* what) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw Error(where + ": " + what + " is \"" + std::string(text) + "\", wanted a finite number");
  }
  return value;
}

Glass parse_glass(std::string_view line, const std::string& where) {
  const auto cells = split(line, ',');
  if (cells.size() != columns) {
    throw Error(where + ": " + std::to_string(cells.size()) + " columns, wanted " + std::to_string(columns) + ": " +
                std::string(header));
  }
  Glass glass;
  glass.catalogue = cells[0];
  glass.name = cells[1];
  if (glass.catalogue.empty() || glass.name.empty()) throw Error(where + ": catalogue or name is empty, wanted both");
  glass.nd = parse_number(cells[2], where, "nd");
  glass.vd = parse_number(cells[3], where, "vd");
  const auto formula =
      std::find_if(formulas.begin(), formulas.end(), [&](const auto& f) { return f.first == cells[4]; });
  if (formula == formulas.end()) {
    throw Error(where + ": formula is \"" + std::string(cells[4]) +
                "\", wanted sellmeier, sellmeier_squared, polynomial, cauchy or buchdahl");
  }
  glass.formula = formula->second;
  glass.shortest_nm = parse_number(cells[5], where, "wl_min_um") * 1000;
  glass.longest_nm = parse_number(cells[6], where, "wl_max_um") * 1000;
  for (const auto cell : split(cells[7], ' ')) glass.coefficients.push_back(parse_number(cell, where, "coefficient"));

  const auto count = glass.coefficients.size();
  const bool buchdahl = glass.formula == DispersionFormula::buchdahl;
  if (buchdahl ? count != 3 : count % 2 == 0) {
    throw Error(where + ": " + std::to_string(count) + " coefficients, wanted " + (buchdahl ? "3" : "c0 and pairs"));
  }
  if (!(glass.shortest_nm > 0 && glass.shortest_nm < glass.longest_nm)) {
    throw Error(where + ": range is " + std::string(cells[5]) + " to " + std::string(cells[6]) +
                " um, wanted two increasing positive numbers");
  }
  return glass;
}

struct CloseFolder {
  void operator()(DIR* folder) const noexcept { ::closedir(folder); }
};

/// Of the files in a folder. std::filesystem::directory_iterator would end the program where memory ends (libstdc++).
std::vector<std::string> names_in(const std::filesystem::path& directory) {
  const std::unique_ptr<DIR, CloseFolder> folder(::opendir(directory.c_str()));
  std::vector<std::string> names;
  while (folder) {
    errno = 0;
    const dirent* entry = ::readdir(folder.get());
    if (!entry) break;
    names.emplace_back(entry->d_name);
  }
  if (errno != 0) {
    throw Error(directory.string() + ": " + std::generic_category().message(errno) +
                ", wanted a folder of glass tables");
  }
  return names;
}

void read_table(const std::filesystem::path& file, std::vector<Glass>& glasses) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(file.string() + ": cannot be opened, wanted a glass table");
  std::string line;
  for (std::size_t count = 1; std::getline(stream, line) || count == 1; ++count) {
    if (line.ends_with('\r')) line.pop_back();
    const std::string where = file.string() + ": line " + std::to_string(count);
    if (count > 1) {
      glasses.push_back(parse_glass(line, where));
    } else if (line != header) {
      throw Error(where + ": header is \"" + line.substr(0, 100) + "\", wanted " + std::string(header));
    }
  }
  if (stream.bad()) throw Error(file.string() + ": cannot be read to its end");
}

}  // namespace

GlassCatalogue::GlassCatalogue(std::vector<Glass> glasses) : glasses_(std::move(glasses)) {
  std::stable_sort(glasses_.begin(), glasses_.end(),
                   [](const Glass& a, const Glass& b) { return comes_before(a.name, b.name); });
}

GlassCatalogue GlassCatalogue::load(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : names_in(directory)) {
    if (name.starts_with("glass_") && name.ends_with(".csv")) files.push_back(directory / name);
  }
  if (files.empty()) throw Error(directory.string() + ": no file glass_*.csv, wanted at least one");
  std::sort(files.begin(), files.end());
  std::vector<Glass> glasses;
  for (const auto& file : files) read_table(file, glasses);
  return GlassCatalogue(std::move(glasses));
}

std::span<const Glass> GlassCatalogue::named(std::string_view name) const noexcept {
  const auto first =
      std::lower_bound(glasses_.begin(), glasses_.end(), name,
                       [](const Glass& glass, std::string_view n) { return comes_before(glass.name, n); });
  const auto last = std::find_if(first, glasses_.end(), [&](const Glass& glass) { return !same(glass.name, name); });
  return {first, last};
}

const Glass* GlassCatalogue::find(std::string_view name, std::string_view catalogue) const noexcept {
  const auto candidates = named(name);
  const auto found =
      std::find_if(candidates.begin(), candidates.end(), [&](const Glass& g) { return same(g.catalogue, catalogue); });
  return found == candidates.end() ? nullptr : &*found;
}

const Glass* GlassCatalogue::find(std::string_view name, double nd) const noexcept {
  const auto candidates = named(name);
  const auto nearest = std::min_element(candidates.begin(), candidates.end(), [nd](const Glass& a, const Glass& b) {
    return std::abs(a.nd - nd) < std::abs(b.nd - nd);
  });
  // Moulding changes n_d by up to 0.002; a larger difference means another glass of the same name.
  return nearest != candidates.end() && std::abs(nearest->nd - nd) <= 0.01 ? &*nearest : nullptr;
}

}  // namespace petzval::inline v0
