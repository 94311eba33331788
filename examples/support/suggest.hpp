// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace examples {

/// The name nearest to a mistyped name; empty if all names differ in more than a third of the letters.
std::string nearest(std::string_view mistyped, std::span<const std::string> names);

/// The flag for a mistyped flag: the flag of `names` with its meaning in other programs, else the nearest.
std::string nearest_flag(std::string_view mistyped, std::span<const std::string> names);

}  // namespace examples
