// SPDX-License-Identifier: Apache-2.0
#include "suggest.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace examples {
namespace {

/// Number of insertions, deletions, replacements and swaps of neighbours between two words (optimal string alignment).
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t k = 0; k <= b.size(); ++k) {
      if (i == 0 || k == 0) {
        d[i][k] = i + k;
        continue;
      }
      const std::size_t replaced = d[i - 1][k - 1] + (a[i - 1] == b[k - 1] ? 0 : 1);
      d[i][k] = std::min({d[i - 1][k] + 1, d[i][k - 1] + 1, replaced});
      if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1]) {
        d[i][k] = std::min(d[i][k], d[i - 2][k - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest(std::string_view mistyped, std::span<const std::string> names) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, mistyped.size() / 3) + 1;
  for (const std::string& candidate : names) {
    std::size_t distance = edits(mistyped, candidate);
    if (mistyped.size() > 2 && candidate.find(mistyped) != std::string::npos)
      distance = std::min<std::size_t>(distance, 1);
    if (distance < least) least = distance, best = candidate;
  }
  return best;
}

std::string nearest_flag(std::string_view mistyped, std::span<const std::string> names) {
  static constexpr std::pair<std::string_view, std::string_view> meanings[]{
      {"--aperture", "--f-number"}, {"--fstop", "--f-number"}, {"--f-stop", "--f-number"}, {"-f", "--f-number"},
      {"--distance", "--at"},       {"--distance", "--focus"}, {"--focus", "--at"},        {"--subject", "--at"},
      {"--subject", "--focus"},     {"-o", "--out"},           {"--output", "--out"},      {"--resolution", "--size"},
      {"--width", "--size"},        {"--height", "--size"},    {"--samples", "--spp"},     {"--samples", "--rays"},
      {"--spp", "--rays"},          {"--sensor", "--film"},    {"--coc", "--blur"},        {"--angle", "--fields"},
      {"--input", "--image"},       {"-j", "--threads"}};
  mistyped = mistyped.substr(0, mistyped.find('='));
  for (const auto& [flag, same] : meanings) {
    if (mistyped == flag && std::ranges::find(names, same) != names.end()) return std::string(same);
  }
  return nearest(mistyped, names);
}

}  // namespace examples
