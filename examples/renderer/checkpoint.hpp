// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/picture_sums.hpp"
#include "support/files.hpp"

namespace renderer {

/// The sums of a picture as an EXR of 32-bit floats, bit for bit.
///
/// A sum is an exact series of floats: channel R is the sum rounded, R.1 what is left, R.2 the rest of that, and so on
/// as far as a picture needs them. Part "sums" has the pixels, "tiles" samples and luminance by tile and round,
/// "totals" a pixel for each round. Texts of the first part: the job, JSON of all that decides the numbers, and a
/// checksum of it and of all values.
class Checkpoint {
 public:
  /// Writes a whole file or none. Throws petzval::Error that names the file.
  static void write(const PictureSums& sums, const examples::Json& job, const std::filesystem::path& file);

  /// Throws petzval::Error that names the file: for one that is no checkpoint or was changed, and for another job, with
  /// the keys that differ.
  static PictureSums read(const std::filesystem::path& file, const examples::Json& job);

  /// Of any job, which is given out. Throws petzval::Error that names the file, for one that is no checkpoint or was
  /// changed.
  static PictureSums read_any(const std::filesystem::path& file, examples::Json& job);

 private:
  static std::vector<petzval::ExrPart> parts(const PictureSums& sums);
};

/// Throws petzval::Error that names the file and the keys whose values differ, if any.
void refuse_other_job(const std::filesystem::path& file, const examples::Json& found, const examples::Json& wanted);

}  // namespace renderer
