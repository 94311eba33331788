// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/write_file.hpp"

#include <fstream>
#include <optional>
#include <string>
#include <system_error>

#include "petzval/core/error.hpp"

namespace petzval::inline v0 {
namespace {

namespace fs = std::filesystem;

/// The path that a new file may replace; nothing for a pipe, a device or a dangling link.
std::optional<fs::path> place(const fs::path& file) {
  std::error_code error;
  const auto entry = fs::symlink_status(file, error).type();
  if (entry == fs::file_type::not_found) return file;
  if (entry == fs::file_type::symlink) {
    const fs::path target = fs::canonical(file, error);
    return error ? std::nullopt : place(target);
  }
  const bool ordinary = entry == fs::file_type::regular || entry == fs::file_type::directory;
  return ordinary ? std::optional(file) : std::nullopt;
}

bool write(std::string_view bytes, const fs::path& file) {
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  return bool(out);
}

}  // namespace

void write_file(std::string_view bytes, const fs::path& file) {
  std::error_code error;
  if (const auto target = place(file)) {
    fs::path part = *target;
    part += ".part";
    if (write(bytes, part)) {
      fs::rename(part, *target, error);
      if (!error) return;
    }
    std::error_code ignored;
    if (fs::is_regular_file(part, ignored)) fs::remove(part, ignored);
  } else if (write(bytes, file)) {
    return;
  }
  throw Error(file.string() + ": cannot be written" + (error ? " (" + error.message() + ")" : std::string()) +
              ", wanted an existing, writable folder with space");
}

}  // namespace petzval::inline v0
