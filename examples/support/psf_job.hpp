// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files.hpp"
#include "petzval/analysis/psf_set.hpp"
#include "petzval/image/image.hpp"
#include "shard.hpp"

namespace examples {

/// Text of an EXR part of a set: the origin of its distance. Parts without this text count from the front vertex.
inline constexpr const char* distance_from_key = "distance_from";
std::string distance_from(const petzval::ExrPart& part);

/// A set of PSFs to be computed: all that its numbers depend on.
///
/// A folder holds job.json, which says what is computed; psfs/NAME.exr, one file for each PSF, there as soon as it is
/// whole; and shard_2_of_8.json for each shard that began.
class PsfJob {
 public:
  /// description: with fields_deg, distances_mm (null: infinite), wavelengths_nm, f_numbers.
  explicit PsfJob(Json description);
  /// Of a folder. Throws petzval::Error that names the file.
  static PsfJob read(const std::filesystem::path& folder);

  const Json& description() const noexcept { return description_; }
  const petzval::PsfSet::Axes& axes() const noexcept { return axes_; }
  std::string name(std::size_t node) const;

  /// Makes the folder this job's. Throws petzval::Error if it has another job.
  void begin(const std::filesystem::path& folder, const Shard& shard) const;

  std::filesystem::path file(const std::filesystem::path& folder, std::size_t node) const;
  void write(const std::filesystem::path& folder, std::size_t node, const petzval::PsfKernel& kernel) const;
  /// A PSF as it was written. Throws petzval::Error that names its file, also where it belongs to another job.
  petzval::ExrPart part(const std::filesystem::path& folder, std::size_t node) const;

  /// All PSFs, gathered from folders of this job. Throws one petzval::Error that names every file that is corrupt
  /// without a whole copy or differs between folders, and the shards of missing ones, where shards that began tell
  /// them.
  std::vector<petzval::ExrPart> gather(const std::vector<std::filesystem::path>& folders) const;

 private:
  Json description_;
  std::string id_;
  petzval::PsfSet::Axes axes_;
};

/// The set as one EXR, an index (.json) and a contact sheet (.png) beside it; returns the three paths.
/// interpolation_error: goes into the index if there is one.
std::vector<std::filesystem::path> write_psf_set(const PsfJob& job, const std::vector<petzval::ExrPart>& parts,
                                                 const std::filesystem::path& file,
                                                 const std::optional<Json>& interpolation_error = {});

}  // namespace examples
