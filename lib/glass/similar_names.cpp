// SPDX-License-Identifier: Apache-2.0
#include "similar_names.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include "catalogue_age.hpp"

namespace petzval::glass_detail {
namespace {

constexpr bool is_separator(char c) noexcept { return c == '-' || c == ' ' || c == '_'; }
constexpr char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Number of letters to insert, remove or replace (Levenshtein distance); `most` + 1 if it exceeds `most`.
std::size_t changes(std::string_view a, std::string_view b, std::size_t most) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > most) return most + 1;
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return std::min(row.back(), most + 1);
}

}  // namespace

std::string bare(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (!is_separator(c)) result.push_back(lower(c));
  }
  return result;
}

bool same_bare(std::string_view a, std::string_view b) noexcept {
  std::size_t i = 0, j = 0;
  while (true) {
    while (i < a.size() && is_separator(a[i])) ++i;
    while (j < b.size() && is_separator(b[j])) ++j;
    if (i == a.size() || j == b.size()) return i == a.size() && j == b.size();
    if (lower(a[i++]) != lower(b[j++])) return false;
  }
}

std::string similar_names(const GlassCatalogue& glasses, std::string_view name) {
  constexpr std::size_t max_name_size = 60, names = 5;
  const std::string bare_name = bare(name.substr(0, max_name_size));
  const std::size_t most = std::max<std::size_t>(1, bare_name.size() / 3);
  std::vector<std::tuple<std::size_t, int, const Glass*>> found;
  for (const Glass& glass : glasses.glasses()) {
    const std::size_t distance = changes(bare(glass.name), bare_name, most);
    if (distance <= most) found.emplace_back(distance, age(glass.catalogue), &glass);
  }
  std::ranges::stable_sort(found, {}, [](const auto& f) { return std::pair(std::get<0>(f), std::get<1>(f)); });
  std::vector<std::string_view> listed;
  std::string list;
  for (const auto& entry : found) {
    const std::string& listed_name = std::get<2>(entry)->name;
    if (listed.size() == names || std::ranges::find(listed, listed_name) != listed.end()) continue;
    listed.push_back(listed_name);
    list += (list.empty() ? "" : ", ") + listed_name;
  }
  return list;
}

}  // namespace petzval::glass_detail
