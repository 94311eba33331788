// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <filesystem>
#include <fstream>
#include <istream>

#include "core/open_file.hpp"
#include "petzval/core/config.hpp"

namespace petzval::image_detail {

/// Checks the sizes of the attributes in an EXR header, because OpenEXR allocates any size that a damaged header
/// states. OpenEXR itself reports all other errors of the header.
///
/// @throws Error without the file name, if an attribute extends beyond the file or does not have the size of its type
void check_exr_attributes(std::istream& in);

/// Rethrows an error of an EXR file as an Error of one line with the file name.
///
/// @param error  an Error without the file name, or an exception of OpenEXR
[[noreturn]] void refuse_exr(const std::filesystem::path& file, const std::exception& error);

/// Checks the attributes of a file and returns the result of read(), which opens the file with OpenEXR.
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
