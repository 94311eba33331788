// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "files.hpp"

namespace examples {

/// Throws petzval::Error: `where`, what was found there, cut if long, and what was wanted.
[[noreturn]] void refuse(const std::string& where, const Json& found, const std::string& wanted);

/// The document. Throws petzval::Error that names the file: if it is no JSON, for a repeated key, which would hide a
/// value, and for more than 8 levels, which no format here has: printing and comparing values takes a call for each.
Json read_json(const std::filesystem::path& file);

/// Throws petzval::Error unless `json` is an object with no other keys than these. words: the keys, for the message.
void check_keys(const std::string& where, const Json& json, std::initializer_list<std::string_view> known,
                const std::string& words);

}  // namespace examples
