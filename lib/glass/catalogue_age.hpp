// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace petzval::glass_detail {

/// Rank of a catalogue, lowest first: 0 for current catalogues, 1 for "-legacy", 2 for "-1983".
constexpr int age(std::string_view catalogue) noexcept {
  return catalogue.ends_with("-1983") ? 2 : catalogue.ends_with("-legacy") ? 1 : 0;
}

}  // namespace petzval::glass_detail
