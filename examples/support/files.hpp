// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace examples {

/// Keys keep their order.
using Json = nlohmann::ordered_json;

/// JSON has no infinity: it becomes null.
Json finite_or_null(double value);

/// Sizes of files that are read whole, bytes: at most 16 MiB of JSON, whose values take 16 times their text, and 1 GiB
/// of tables and meshes.
inline constexpr std::size_t largest_json = std::size_t{16} << 20, largest_table = std::size_t{1} << 30;

/// Read and write whole files. Throw petzval::Error that names the file; read_text() also for a file of more than
/// `most` bytes, such as an endless one.
std::string read_text(const std::filesystem::path& file, std::size_t most = largest_table);
void write_text(const std::filesystem::path& file, const std::string& text);

/// Throws petzval::Error that names the option if the file's name does not end so.
void want_ending(const std::string& option, const std::filesystem::path& file, const std::string& ending);

// The functions of std::filesystem that the programs use. They throw petzval::Error that names the file and the
// system's reason.

/// True if there is a file or folder of that name.
bool exists(const std::filesystem::path& file);
/// The files and folders in a folder.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);
/// Gives a file another name.
void rename(const std::filesystem::path& file, const std::filesystem::path& new_name);
/// Makes the folder and its parents if missing.
void make_folder(const std::filesystem::path& folder);

}  // namespace examples
