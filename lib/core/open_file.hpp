// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "petzval/core/error.hpp"

namespace petzval::core_detail {

/// Throws Error if `file` is a folder: some systems open a folder as a file and fail only when it is read.
/// @param rule the required kind of file, for the message
inline void refuse_folder(const std::filesystem::path& file, const std::string& rule) {
  std::error_code unknown;
  if (std::filesystem::is_directory(file, unknown)) throw Error(file.string() + ": is a folder; must be " + rule);
}

/// The system's text for the last failure, from errno: "No such file or directory".
inline std::string reason() { return std::generic_category().message(errno); }

/// Opens a file for binary reading.
/// @throws Error if the file is a folder or cannot be opened
inline std::ifstream opened(const std::filesystem::path& file, const std::string& rule) {
  refuse_folder(file, rule);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(file.string() + ": cannot be opened (" + reason() + "); must be " + rule);
  return stream;
}

}  // namespace petzval::core_detail
