// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "petzval/core/error.hpp"

namespace petzval::detail {

/// Writes beside the file first, so that a failure leaves neither a torn file nor the loss of an old one.
inline void write_whole(std::string_view bytes, const std::filesystem::path& file) {
  std::filesystem::path part = file;
  part += ".part";
  std::error_code error;
  {
    std::ofstream out(part, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (out) std::filesystem::rename(part, file, error);
    if (out && !error) return;
  }
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  throw Error(file.string() + ": cannot be written" + (error ? " (" + error.message() + ")" : std::string()) +
              ", wanted a folder that exists, may be written and has room");
}

}  // namespace petzval::detail
