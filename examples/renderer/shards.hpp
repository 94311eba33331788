// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/picture_sums.hpp"
#include "support/files.hpp"
#include "support/shard.hpp"

namespace renderer {

/// The checkpoint of a shard, which has every count-th tile: tile_2_of_8.exr, or sums.exr of a whole picture.
std::filesystem::path checkpoint_file(const std::filesystem::path& folder, const examples::Shard& shard);

/// The sums of a whole picture from the shards in some folders, and its job. A tile is whole with as many samples of
/// each pixel as the job's "samples" says, with one where that is null. A shard may be there twice with the same bits.
/// Throws one petzval::Error that names every missing or unfinished shard, and every file that is corrupt, belongs to
/// another job or differs from its twin.
PictureSums gather(const std::vector<std::filesystem::path>& folders, examples::Json& job);

}  // namespace renderer
