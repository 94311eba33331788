// SPDX-License-Identifier: Apache-2.0
#include "shard.hpp"

#include <charconv>

#include "petzval/core/error.hpp"

namespace examples {
namespace {

/// Parses two whole numbers separated by `between`, the first from 1 to the second.
std::optional<Shard> shard_in(std::string_view text, std::string_view between) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [middle, first] = std::from_chars(text.data(), end, shard.index);
  if (first != std::errc() || !std::string_view(middle, end).starts_with(between)) return {};
  const auto [rest, second] = std::from_chars(middle + between.size(), end, shard.count);
  if (second != std::errc() || rest != end || shard.index < 1 || shard.index > shard.count) return {};
  return shard;
}

}  // namespace

std::string Shard::stem(std::string_view prefix) const {
  return std::string(prefix) + '_' + std::to_string(index) + "_of_" + std::to_string(count);
}

Shard parse_shard(const std::string& where, const std::string& text) {
  if (const auto shard = shard_in(text, "/")) return *shard;
  throw petzval::Error(where + " = \"" + text + "\"; must be i/n with whole numbers, i from 1 to n");
}

std::optional<Shard> shard_of_file(const std::filesystem::path& file, std::string_view prefix) {
  const std::string stem = file.stem().string();
  if (!stem.starts_with(std::string(prefix) + '_')) return {};
  return shard_in(std::string_view(stem).substr(prefix.size() + 1), "_of_");
}

}  // namespace examples
