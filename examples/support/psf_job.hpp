// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/image/image.hpp"
#include "shard.hpp"

namespace examples {

/// Key of the text in an EXR part with the origin of its distance. Parts without it count from the front vertex.
inline constexpr const char* distance_from_key = "distance_from";
std::string distance_from(const petzval::ExrPart& part);

/// A set of PSFs to be computed: all inputs of its numbers.
///
/// A folder holds job.json, the description; psfs/NAME.exr, one file for each PSF, written as soon as the PSF is
/// complete; and shard_2_of_8.json for each shard that began.
class PsfJob {
 public:
  /// description: includes fields_deg, distances_mm (null: infinite), wavelengths_nm and f_numbers.
  explicit PsfJob(Json description);
  /// Reads the job of a folder. @throws petzval::Error that names the file
  static PsfJob read(const std::filesystem::path& folder);

  const Json& description() const noexcept { return description_; }
  const petzval::PsfSet::Axes& axes() const noexcept { return axes_; }
  std::string name(std::size_t node) const;

  /// Writes this job into the folder. @throws petzval::Error if the folder has another job
  void begin(const std::filesystem::path& folder, const Shard& shard) const;

  std::filesystem::path file(const std::filesystem::path& folder, std::size_t node) const;
  void write(const std::filesystem::path& folder, std::size_t node, const petzval::PsfKernel& kernel) const;
  /// Reads a written PSF. @throws petzval::Error that names its file, also if the file belongs to another job
  petzval::ExrPart part(const std::filesystem::path& folder, std::size_t node) const;

  /// Gathers all PSFs from folders of this job.
  /// @throws petzval::Error that names every file that differs between folders or is corrupt without an intact copy,
  ///         and the missing PSFs, by shard if the number of shards is known
  std::vector<petzval::ExrPart> gather(const std::vector<std::filesystem::path>& folders) const;

 private:
  Json description_;
  std::string id_;
  petzval::PsfSet::Axes axes_;
};

/// Writes the set as one EXR with an index (.json) and a contact sheet (.svg) next to it. Returns the three paths. The
/// index includes interpolation_error if given.
std::vector<std::filesystem::path> write_psf_set(const PsfJob& job, const std::vector<petzval::ExrPart>& parts,
                                                 const std::filesystem::path& file,
                                                 const std::optional<Json>& interpolation_error = {});

}  // namespace examples
