// SPDX-License-Identifier: Apache-2.0
#include "io/exr_head.hpp"

#include <cstdint>
#include <fstream>
#include <string>

#include "petzval/core/error.hpp"

namespace petzval::inline v0::io_detail {

void check_exr_attributes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::error_code without;
  const std::uintmax_t size = std::filesystem::file_size(file, without);
  const auto word = [&] {
    unsigned char b[4] = {};
    in.read(reinterpret_cast<char*>(b), 4);
    return std::uint32_t{b[0]} | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 | std::uint32_t{b[3]} << 24;
  };
  // A name ends with 0. OpenEXR has at most 255 characters.
  const auto text = [&] {
    std::string name;
    for (int c = in.get(); c > 0 && name.size() < 256; c = in.get()) name += static_cast<char>(c);
    return name;
  };
  if (without || word() != 20000630) return;
  const bool several_parts = word() >> 12 & 1;
  // The attributes of a part end with an empty name, the parts of a file with another one.
  for (bool first = true; in; first = false) {
    const std::string name = text();
    if (name.empty() && (first || !several_parts)) return;
    if (name.empty()) {
      if (in.peek() == 0) return;
      continue;
    }
    text();
    const std::uint32_t bytes = word();
    if (bytes > size) {
      throw Error("attribute " + name + " claims " + std::to_string(bytes) + " bytes of a file of " +
                  std::to_string(size) + ", wanted one within it");
    }
    in.seekg(bytes, std::ios::cur);
  }
}

}  // namespace petzval::inline v0::io_detail
