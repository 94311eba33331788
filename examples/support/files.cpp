// SPDX-License-Identifier: Apache-2.0
#include "files.hpp"

#include <cmath>
#include <iostream>
#include <system_error>

#include "cli.hpp"
#include "interrupt.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace examples {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what, const std::error_code& error) {
  throw petzval::Error(file.string() + ": " + what + " (" + error.message() + ")");
}

}  // namespace

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

void Output::add(App& app) {
  app.add_flag("--json", json, "print the JSON report instead of the paths, which go to standard error");
}

void Output::file(const std::filesystem::path& path) const {
  (json ? std::cerr : std::cout) << path.string() << std::endl;
}

void Output::report(const Json& json_report) const {
  if (json) std::cout << json_report.dump(1) << '\n';
}

std::string read_text(const std::filesystem::path& file, std::size_t most) {
  return petzval::read_file(file, "a file", most);
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  const Together uninterrupted;
  petzval::write_file(text, file);
}

void want_ending(const std::string& option, const std::filesystem::path& file, const std::string& ending) {
  if (file.extension() == ending) return;
  throw petzval::Error(option + " = " + file.string() + "; must end in " + ending);
}

bool exists(const std::filesystem::path& file) {
  std::error_code error;
  const bool found = std::filesystem::exists(file, error);
  if (error) fail(file, "cannot check that it exists", error);
  return found;
}

std::vector<std::filesystem::path> entries(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> result;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    result.push_back(entry->path());
  }
  if (error) fail(folder, "cannot read the folder", error);
  return result;
}

void rename(const std::filesystem::path& file, const std::filesystem::path& new_name) {
  std::error_code error;
  std::filesystem::rename(file, new_name, error);
  if (error) fail(file, "cannot rename to " + new_name.string(), error);
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error, unknown;
  clean_on_signals(folder, false);
  for (auto part = folder; !part.empty() && !std::filesystem::exists(part, unknown) && !unknown;
       part = part.parent_path()) {
    clean_on_signals(part, true);
  }
  std::filesystem::create_directories(folder, error);
  if (std::filesystem::is_directory(folder, unknown)) return;
  fail(folder, "cannot create the folder", error ? error : std::make_error_code(std::errc::not_a_directory));
}

}  // namespace examples
