// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/picture_sums.hpp"
#include "support/files.hpp"
#include "support/shard.hpp"

namespace renderer {

/// The checkpoint of a shard, which has every count-th tile: tile_2_of_8.exr, or sums.exr for a whole picture.
std::filesystem::path checkpoint_file(const std::filesystem::path& folder, const examples::Shard& shard);

/// Merges the shards in some folders to the sums of the whole picture, with its job. A tile is complete with the number
/// of samples per pixel in the job's "samples", or with one sample if that is null. A shard may occur twice if its bits
/// are equal.
///
/// @throws petzval::Error that names every missing or unfinished shard, and every file that is corrupt, belongs to
///         another job or differs from the other file of its shard
PictureSums gather(const std::vector<std::filesystem::path>& folders, examples::Json& job);

}  // namespace renderer
