// SPDX-License-Identifier: Apache-2.0
#include "files.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "petzval/core/error.hpp"
#include "petzval/io/write_file.hpp"

namespace examples {

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string read_text(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) throw petzval::Error(file.string() + ": is a folder, wanted a file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw petzval::Error(file.string() + ": cannot be opened: " + std::strerror(errno));
  std::ostringstream text;
  text << in.rdbuf();
  if (!in || in.bad()) throw petzval::Error(file.string() + ": cannot be read");
  return std::move(text).str();
}

void write_text(const std::filesystem::path& file, const std::string& text) { petzval::write_file(text, file); }

void want_ending(const std::string& option, const std::filesystem::path& file, const std::string& ending) {
  if (file.extension() == ending) return;
  throw petzval::Error(option + ": found " + file.string() + ", wanted a name that ends in " + ending);
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder)) {
    throw petzval::Error(folder.string() + ": cannot be created as a folder" + (error ? ": " + error.message() : ""));
  }
}

}  // namespace examples
