// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace examples {

/// Part `index` of `count` parts, from 1: every count-th piece of the work.
struct Shard {
  std::size_t index = 1, count = 1;

  bool has(std::size_t piece) const noexcept { return piece % count == index - 1; }
  std::string text() const { return std::to_string(index) + '/' + std::to_string(count); }
  /// The stem of the shard's file: "tile_2_of_8".
  std::string stem(std::string_view prefix) const;
};

/// Parses "2/8". @throws petzval::Error that begins with `where`
Shard parse_shard(const std::string& where, const std::string& text);

/// The shard whose file has the given stem, with any extension; nullopt for other names.
std::optional<Shard> shard_of_file(const std::filesystem::path& file, std::string_view prefix);

}  // namespace examples
