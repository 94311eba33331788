// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace examples {

/// Keys stay in the order in which they are written down.
using Json = nlohmann::ordered_json;

/// JSON knows no infinity: such a number becomes null.
Json finite_or_null(double value);

/// The whole file, or none of it. Throws petzval::Error that names it.
std::string read_text(const std::filesystem::path& file);
void write_text(const std::filesystem::path& file, const std::string& text);

/// Makes the folder, and those above it, where missing. Throws petzval::Error that names it.
void make_folder(const std::filesystem::path& folder);

}  // namespace examples
