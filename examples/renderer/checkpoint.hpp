// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/picture_sums.hpp"
#include "support/files.hpp"

namespace renderer {

/// File of the sums of a picture as an EXR of 32-bit floats, exact to the bit.
///
/// A sum is an exact series of floats: channel R is the rounded sum, R.1 the remainder, R.2 the next remainder, as many
/// as needed. Part "sums" has the pixels, "tiles" samples, sums and targets by tile and round, "guides" the channels
/// for denoisers if they are set. Channels that begin with "light." belong to light paths, the others to film samples.
/// The first part has two texts: the job (JSON of all inputs) and a checksum of the job and all values.
class Checkpoint {
 public:
  /// Writes the file atomically. @throws petzval::Error that names the file
  static void write(const PictureSums& sums, const examples::Json& job, const std::filesystem::path& file);

  /// Reads the sums of a job.
  /// @throws petzval::Error that names the file, if it is not a checkpoint, was changed, or belongs to another job;
  ///         then the message lists the different keys
  static PictureSums read(const std::filesystem::path& file, const examples::Json& job);

  /// Reads the sums of any job, and the job. @throws petzval::Error that names the file, if it is not a checkpoint or
  /// was changed
  static PictureSums read_any(const std::filesystem::path& file, examples::Json& job);

 private:
  static std::vector<petzval::ExrPart> parts(const PictureSums& sums);
};

/// @throws petzval::Error that names the file and the keys with different values, if there are differences
void refuse_other_job(const std::filesystem::path& file, const examples::Json& found, const examples::Json& expected);

}  // namespace renderer
