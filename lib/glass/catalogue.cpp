// SPDX-License-Identifier: Apache-2.0
#if !defined(_WIN32)
#include <dirent.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <memory>
#include <sstream>
#include <system_error>
#include <utility>

#include "catalogue_age.hpp"
#include "core/text.hpp"
#include "glass_table.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/glass/glass.hpp"

namespace petzval {
namespace {

constexpr char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool comes_before(std::string_view a, std::string_view b) noexcept {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [](char x, char y) { return lower(x) < lower(y); });
}

bool same(std::string_view a, std::string_view b) noexcept {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

void sort_by_name(std::vector<Glass>& glasses) {
  std::stable_sort(glasses.begin(), glasses.end(),
                   [](const Glass& a, const Glass& b) { return comes_before(a.name, b.name); });
}

/// The glasses of a name, in a list sorted by name.
std::span<const Glass> named(std::span<const Glass> glasses, std::string_view name) noexcept {
  const auto first = std::lower_bound(glasses.begin(), glasses.end(), name, [](const Glass& glass, std::string_view n) {
    return comes_before(glass.name, n);
  });
  const auto last = std::find_if(first, glasses.end(), [&](const Glass& glass) { return !same(glass.name, name); });
  return {first, last};
}

/// The glass of a name with the nearest n_d; nullptr if no n_d is within `most`.
const Glass* nearest_named(std::span<const Glass> glasses, std::string_view name, double nd, double most) noexcept {
  const auto candidates = named(glasses, name);
  const auto nearest = std::min_element(candidates.begin(), candidates.end(), [nd](const Glass& a, const Glass& b) {
    return std::abs(a.nd - nd) < std::abs(b.nd - nd);
  });
  return nearest != candidates.end() && std::abs(nearest->nd - nd) <= most ? &*nearest : nullptr;
}

#if defined(_WIN32)

std::vector<std::string> names_in(const std::filesystem::path& directory) {
  std::vector<std::string> names;
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(directory, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    names.push_back(entry->path().filename().string());
  }
  if (failed) throw Error(directory.string() + ": " + failed.message() + "; must be a folder of glass tables");
  return names;
}

#else

struct CloseFolder {
  void operator()(DIR* folder) const noexcept { ::closedir(folder); }
};

/// std::filesystem::directory_iterator (libstdc++) would terminate the program if memory runs out.
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
                "; must be a folder of glass tables");
  }
  return names;
}

#endif

}  // namespace

GlassCatalogue::GlassCatalogue(std::vector<Glass> glasses) : glasses_(std::move(glasses)) { sort_by_name(glasses_); }

GlassCatalogue GlassCatalogue::load(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : names_in(directory)) {
    if (name.starts_with("glass_") && name.ends_with(".csv")) files.push_back(directory / name);
  }
  if (files.empty()) throw Error(directory.string() + ": no file glass_*.csv; must contain at least one");
  std::sort(files.begin(), files.end());
  std::vector<Glass> glasses;
  for (const auto& file : files) {
    std::istringstream stream(read_file(file, "a glass table"));
    glass_detail::read_glass_table(stream, file.string(), glasses);
  }
  return GlassCatalogue(std::move(glasses));
}

const Glass* GlassCatalogue::find(std::string_view name, std::string_view catalogue) const noexcept {
  for (const auto glasses : {added(), tables()}) {
    const auto candidates = named(glasses, name);
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [&](const Glass& g) { return same(g.catalogue, catalogue); });
    if (found != candidates.end()) return &*found;
  }
  return nullptr;
}

const Glass* GlassCatalogue::find(std::string_view name, double nd) const noexcept {
  // Moulding changes n_d by up to 0.002; a larger difference means another glass of the same name.
  if (const Glass* own = nearest_named(added(), name, nd, 0.002)) return own;
  const Glass* from_tables = nearest_named(tables(), name, nd, 0.01);
  return from_tables ? from_tables : nearest_named(added(), name, nd, 0.01);
}

const Glass* GlassCatalogue::find(std::string_view name) const {
  if (const auto own = named(added(), name); !own.empty()) return own.data();
  const auto candidates = named(tables(), name);
  if (candidates.empty()) return nullptr;
  constexpr double min_index_difference = 1e-4;
  const auto age = [](const Glass& glass) { return glass_detail::age(glass.catalogue); };
  const Glass& first = *std::ranges::min_element(candidates, {}, age);
  const auto equal_rank = [&](const Glass& glass) { return age(glass) == age(first); };
  const bool ambiguous = std::ranges::any_of(candidates, [&](const Glass& glass) {
    return equal_rank(glass) && std::abs(glass.nd - first.nd) > min_index_difference;
  });
  if (!ambiguous) return &first;
  std::string list;
  for (const Glass& glass : candidates) {
    if (equal_rank(glass)) list += (list.empty() ? "" : ", ") + glass.catalogue + " (n_d " + to_text(glass.nd, 6) + ")";
  }
  throw Error("glass \"" + std::string(name) + "\" differs between catalogues: " + list +
              "; the catalogue or n_d must be given");
}

const GlassCatalogue& glass_tables() {
  static const GlassCatalogue tables = GlassCatalogue::load(data_directory() / "glass");
  return tables;
}

GlassCatalogue with_glasses(const GlassCatalogue& catalogue, std::vector<Glass> glasses) {
  GlassCatalogue result;
  const auto before = catalogue.added();
  glasses.insert(glasses.end(), before.begin(), before.end());
  sort_by_name(glasses);
  result.added_count_ = glasses.size();
  const auto tables = catalogue.tables();
  glasses.insert(glasses.end(), tables.begin(), tables.end());
  result.glasses_ = std::move(glasses);
  return result;
}

std::vector<const Glass*> nearest_glasses(const GlassCatalogue& catalogue, double nd, std::optional<double> vd,
                                          std::size_t count) {
  if (!std::isfinite(nd) || !std::isfinite(vd.value_or(0))) {
    throw Error("nearest_glasses: n_d = " + to_text(nd) + ", V_d = " + to_text(vd.value_or(0)) + "; must be finite");
  }
  const auto distance = [&](const Glass& glass) {
    return std::hypot((glass.nd - nd) / 0.001, vd ? (glass.vd - *vd) / 0.5 : 0.0);
  };
  std::vector<std::pair<double, const Glass*>> by_distance;
  by_distance.reserve(catalogue.glasses().size());
  for (const Glass& glass : catalogue.glasses()) by_distance.emplace_back(distance(glass), &glass);
  const auto last = by_distance.begin() + static_cast<std::ptrdiff_t>(std::min(count, by_distance.size()));
  std::partial_sort(by_distance.begin(), last, by_distance.end());  // ties: the first of the catalogue
  std::vector<const Glass*> result;
  std::transform(by_distance.begin(), last, std::back_inserter(result), [](const auto& entry) { return entry.second; });
  return result;
}

}  // namespace petzval
