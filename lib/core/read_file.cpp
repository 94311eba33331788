// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/files.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "open_file.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

std::string in_bytes(std::uintmax_t size) {
  constexpr std::uintmax_t mebibyte = std::uintmax_t{1} << 20;
  std::string text = std::to_string(size) + " bytes";
  if (size > 0 && size % mebibyte == 0) text += " (" + std::to_string(size / mebibyte) + " MiB)";
  return text;
}

}  // namespace

std::string read_file(const std::filesystem::path& file, const std::string& kind, std::size_t most) {
  std::ifstream stream = core_detail::opened(file, kind);
  const auto refuse = [&](std::uintmax_t size, const char* or_more) {
    throw Error(file.string() + ": size = " + in_bytes(size) + or_more + "; must be at most " + in_bytes(most));
  };
  std::string bytes;
  std::error_code unknown;
  if (const auto size = std::filesystem::file_size(file, unknown); !unknown) {
    if (size > most) refuse(size, "");
    bytes.reserve(static_cast<std::size_t>(size));
  }
  std::array<char, 65536> block;
  errno = 0;
  while (stream.read(block.data(), block.size()), stream.gcount() > 0) {
    const auto count = static_cast<std::size_t>(stream.gcount());
    // The size is checked again while reading: devices and pipes report no size, and files may grow.
    if (count > most - bytes.size()) refuse(bytes.size() + count, " or more");
    bytes.append(block.data(), count);
  }
  if (stream.bad()) {
    throw Error(file.string() + ": cannot be read to its end (" + core_detail::reason() + ")");
  }
  return bytes;
}

}  // namespace petzval
