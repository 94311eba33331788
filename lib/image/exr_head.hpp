// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <filesystem>
#include <fstream>
#include <istream>

#include "core/open_file.hpp"
#include "petzval/core/version.hpp"

namespace petzval::image_detail {

/// Refuses an EXR file with an attribute that reaches beyond the file's end, as OpenEXR takes memory for any size that
/// a damaged head states, or that has not the size of its type. What else is wrong with the head is left to OpenEXR.
/// Throws Error without the file's name.
void check_exr_attributes(std::istream& in);

/// Throws Error of one line for what went wrong with an EXR file: our own Error without the file's name, or an
/// exception of OpenEXR, which names the file and not what was wanted.
[[noreturn]] void refuse_exr(const std::filesystem::path& file, const std::exception& error);

/// The result of read(), which opens the file by OpenEXR, after its attributes were checked.
template <class Read>
auto read_exr_file(const std::filesystem::path& file, const Read& read) {
  std::ifstream in = core_detail::opened(file, "an EXR file");
  try {
    check_exr_attributes(in);
    return read();
  } catch (const std::exception& error) {
    refuse_exr(file, error);
  }
}

}  // namespace petzval::image_detail
