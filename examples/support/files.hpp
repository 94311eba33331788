// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace examples {

/// JSON whose keys keep their order.
using Json = nlohmann::ordered_json;

/// The value, or null if it is not finite: JSON has no infinity.
Json finite_or_null(double value);
/// The value, or null.
Json or_null(const std::optional<double>& value);

class App;

/// Standard output of a command that writes files: their paths, or with --json one report.
struct Output {
  bool json = false;

  /// Adds --json.
  void add(App& app);
  /// Prints the path of a complete file at once; with --json on standard error.
  void file(const std::filesystem::path& path) const;
  /// Prints the report with --json.
  void report(const Json& json_report) const;
};

/// Size limits of files that are read whole, bytes: 16 MiB of JSON, whose values take 16 times the size of their text
/// in memory, and 1 GiB of tables and meshes.
inline constexpr std::size_t largest_json = std::size_t{16} << 20, largest_table = std::size_t{1} << 30;

/// Read and write whole files.
///
/// @param most  size limit in bytes, which also stops endless files
/// @throws petzval::Error that names the file
std::string read_text(const std::filesystem::path& file, std::size_t most = largest_table);
void write_text(const std::filesystem::path& file, const std::string& text);

/// @throws petzval::Error that names the option, if the file name does not end in `ending`
void want_ending(const std::string& option, const std::filesystem::path& file, const std::string& ending);

// Wrappers of std::filesystem functions. They throw petzval::Error with the name of the file and the system's reason.

/// True if a file or folder of that name exists.
bool exists(const std::filesystem::path& file);
/// The files and folders in a folder.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);
/// Renames a file.
void rename(const std::filesystem::path& file, const std::filesystem::path& new_name);
/// Creates the folder and its parents if they are missing.
void make_folder(const std::filesystem::path& folder);

}  // namespace examples
