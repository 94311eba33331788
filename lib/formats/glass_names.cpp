// SPDX-License-Identifier: Apache-2.0
#include "glass_names.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "core/text.hpp"
#include "glass/catalogue_age.hpp"
#include "glass/similar_names.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using glass_detail::bare;

/// True if a catalogue belongs to the maker of `own` ("sumita", "schott-1983"): the maker's name is one of its words,
/// possibly truncated. "SUMITA_AUG2011", "NIKON-HIKARI" and "OLD-OHAR" belong to sumita, hikari and ohara.
bool same_maker(std::string_view catalogue, std::string_view own) {
  constexpr std::string_view separators = "-_ 0123456789";
  const std::string_view maker = own.substr(0, std::min(own.find_first_of(separators), own.size()));
  while (!catalogue.empty()) {
    const std::string_view word = catalogue.substr(0, std::min(catalogue.find_first_of(separators), catalogue.size()));
    const bool cut_off = word.size() >= 4 && word.size() < maker.size();
    if (!word.empty() && same(word, cut_off ? maker.substr(0, word.size()) : maker)) return true;
    catalogue.remove_prefix(std::min(word.size() + 1, catalogue.size()));
  }
  return false;
}

int age(const Glass& glass) { return glass_detail::age(glass.catalogue); }

/// Rank of the maker if the name is still ambiguous: names without a prefix (F2, SK16) are names of Schott; CDGM reuses
/// names of others.
int maker(const Glass& glass) { return same_maker(glass.catalogue, "schott") ? 0 : glass.catalogue == "cdgm" ? 2 : 1; }

/// Index of a glass's catalogue in a list; the size of the list if it is not listed.
std::ptrdiff_t catalogue_rank(std::span<const std::string> catalogues, const Glass& glass) {
  const auto listed = std::ranges::find_if(
      catalogues, [&](const std::string& c) { return same(c, glass.catalogue) || same_maker(c, glass.catalogue); });
  return listed - catalogues.begin();
}

}  // namespace

std::string describe(const Glass& glass) {
  return glass.name + " (" + glass.catalogue + ", n_d " + to_text(glass.nd, 6) + ", V_d " + to_text(glass.vd, 4) + ")";
}

bool is_listed(std::span<const std::string> catalogues, const Glass& glass) {
  return catalogue_rank(catalogues, glass) < std::ssize(catalogues);
}

GlassNames::GlassNames(const GlassCatalogue& glasses) {
  for (const Glass& glass : glasses.glasses()) by_name_.emplace(bare(glass.name), &glass);
}

const Glass* GlassNames::find(std::string_view name, std::span<const std::string> catalogues, std::optional<double> nd,
                              Numbers numbers) const {
  const auto rank = [&](const Glass& glass) {
    double off = nd ? std::round(std::abs(glass.nd - *nd) / 1e-6) : 0;  // rounded to the digits of the file
    constexpr double other_glass_rank = 2e-3 / 1e-6;
    if (numbers == Numbers::leftovers) off = std::min(off, other_glass_rank);
    const std::ptrdiff_t listed_rank = catalogue_rank(catalogues, glass);
    return numbers == Numbers::stated
               ? std::tuple(off, listed_rank, age(glass), 0.0, maker(glass))
               : std::tuple(0.0, listed_rank, age(glass), is_listed(catalogues, glass) ? 0.0 : off, maker(glass));
  };
  const auto [first, last] = by_name_.equal_range(bare(name));
  const Glass* best = nullptr;
  for (auto it = first; it != last; ++it) {
    if (!best || rank(*it->second) < rank(*best)) best = it->second;
  }
  return best;
}

std::string GlassNames::others(const Glass& found, std::span<const std::string> catalogues,
                               std::optional<double> nd) const {
  constexpr double min_index_difference = 1e-4;
  if (is_listed(catalogues, found) || (nd && std::abs(found.nd - *nd) <= min_index_difference)) return "";
  std::string list;
  const auto [first, last] = by_name_.equal_range(bare(found.name));
  for (auto it = first; it != last; ++it) {
    const Glass& other = *it->second;
    if (age(other) != age(found) || std::abs(other.nd - found.nd) <= min_index_difference) continue;
    append(list, ", ", describe(other));
  }
  return list;
}

}  // namespace petzval::formats_detail
