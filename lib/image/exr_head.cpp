// SPDX-License-Identifier: Apache-2.0
#include "image/exr_head.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "petzval/core/error.hpp"

namespace petzval::image_detail {
namespace {

/// Types of fixed size: OpenEXR reads this number of bytes and ignores the size in the header.
constexpr std::pair<std::uint64_t, std::string_view> fixed_sizes[] = {
    {1, " compression deepImageState envmap lineOrder "},
    {4, " float int "},
    {8, " double rational timecode v2f v2i "},
    {9, " tiledesc "},
    {12, " v3f v3i "},
    {16, " box2f box2i v2d "},
    {24, " v3d "},
    {28, " keycode "},
    {32, " chromaticities "},
    {36, " m33f "},
    {64, " m44f "},
    {72, " m33d "},
    {128, " m44d "}};

}  // namespace

void check_exr_attributes(std::istream& in) {
  const auto size = static_cast<std::uint64_t>(in.seekg(0, std::ios::end).tellg());
  in.seekg(0);
  const auto word = [&] {
    unsigned char b[4] = {};
    in.read(reinterpret_cast<char*>(b), 4);
    return std::uint32_t{b[0]} | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 | std::uint32_t{b[3]} << 24;
  };
  // A name ends with 0; OpenEXR allows 255 characters. Control characters become '?', so that messages stay on one
  // line.
  const auto text = [&] {
    std::string name;
    for (int c = in.get(); c > 0 && name.size() < 256; c = in.get())
      name += c >= ' ' && c < 127 ? static_cast<char>(c) : '?';
    return name;
  };
  if (!in || word() != 20000630) return;
  const bool several_parts = word() >> 12 & 1;
  // An empty name ends the attributes of a part; another empty name ends the parts of a file.
  for (bool first = true; in; first = false) {
    const std::string name = text();
    if (name.empty() && (first || !several_parts)) return;
    if (name.empty()) {
      if (in.peek() == 0) return;
      continue;
    }
    const std::string type = text();
    const std::uint64_t bytes = word(), begin = static_cast<std::uint64_t>(in.tellg());
    if (!in) return;
    if (bytes > size) {
      throw Error("attribute " + name + ": size = " + std::to_string(bytes) + " bytes in a file of " +
                  std::to_string(size) + " bytes; must lie within the file");
    }
    // The number of bytes that OpenEXR consumes, independent of the stated size.
    std::uint64_t read = bytes;
    for (const auto& [length, types] : fixed_sizes) {
      if (types.find(" " + type + " ") != types.npos) read = length;
    }
    if (type == "chlist") {
      while (in && !text().empty()) in.seekg(16, std::ios::cur);
      read = in ? static_cast<std::uint64_t>(in.tellg()) - begin : 0;
    } else if (type == "preview") {
      const std::uint64_t width = word(), height = word();
      read = width > size || height > size ? size : 8 + 4 * width * height;
    } else if (type == "stringvector") {
      for (read = 0; in && read < bytes; in.seekg(static_cast<std::streamoff>(begin + read)))
        read += std::uint64_t{4} + word();
    }
    if (read != bytes) {
      throw Error("attribute " + name + " of type " + type + ": size = " + std::to_string(bytes) + " bytes; must be " +
                  std::to_string(read));
    }
    in.seekg(static_cast<std::streamoff>(begin + bytes));
  }
}

void refuse_exr(const std::filesystem::path& file, const std::exception& error) {
  if (dynamic_cast<const Error*>(&error)) throw Error(file.string() + ": " + error.what());
  std::string reason = error.what();
  // OpenEXR writes: Cannot read image file "x.exr". Reason.
  const std::string name = '"' + file.string() + "\". ";
  if (const auto at = reason.find(name); at != reason.npos) reason.erase(0, at + name.size());
  if (reason.ends_with('.')) reason.pop_back();
  throw Error(file.string() + ": cannot be read (" + reason + "); must be a complete EXR file");
}

}  // namespace petzval::image_detail
