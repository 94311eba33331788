// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace examples {

/// Keys keep their order.
using Json = nlohmann::ordered_json;

/// JSON has no infinity: it becomes null.
Json finite_or_null(double value);

/// Read and write whole files. Throw petzval::Error that names the file.
std::string read_text(const std::filesystem::path& file);
void write_text(const std::filesystem::path& file, const std::string& text);

/// Throws petzval::Error that names the option if the file's name does not end so.
void want_ending(const std::string& option, const std::filesystem::path& file, const std::string& ending);

/// Makes the folder and its parents if missing. Throws petzval::Error that names it.
void make_folder(const std::filesystem::path& folder);

}  // namespace examples
