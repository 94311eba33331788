// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace commands {

/// Writes the table of a camera (petzval::camera_table()) for petzval_camera.h. The ending of the file name sets the
/// format: .h is C source, .bin little-endian floats, .json the numbers with the names of their positions.
///
/// @param title     the lens and its setting, one line
/// @throws petzval::Error if the name has another ending or the file cannot be written
void write_camera_table(const std::vector<float>& table, const std::string& title, const std::filesystem::path& file);

/// @throws petzval::Error  if write_camera_table() would not know the format
void check_table_name(const std::filesystem::path& file);

}  // namespace commands
