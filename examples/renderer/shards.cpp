// SPDX-License-Identifier: Apache-2.0
#include "renderer/shards.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "petzval/core/error.hpp"
#include "renderer/checkpoint.hpp"
#include "support/files.hpp"

namespace renderer {
namespace {

namespace fs = std::filesystem;
using examples::Json;
using examples::Shard;

constexpr const char* whole_picture = "sums.exr";

std::optional<Shard> shard_of(const fs::path& file) {
  if (file.filename() == whole_picture) return Shard{};
  return file.extension() == ".exr" ? examples::shard_of_file(file, "tile") : std::nullopt;
}

/// Files by number of shards and by index.
using ShardFiles = std::map<std::size_t, std::map<std::size_t, std::vector<fs::path>>>;

ShardFiles shard_files(const std::vector<fs::path>& folders) {
  ShardFiles files;
  for (const fs::path& folder : folders) {
    std::vector<fs::path> own = examples::entries(folder);
    std::sort(own.begin(), own.end());
    for (const fs::path& file : own) {
      if (const auto shard = shard_of(file)) files[shard->count][shard->index].push_back(file);
    }
  }
  return files;
}

void refuse_unfinished(const fs::path& file, const PictureSums& sums, const Shard& shard, std::uint64_t samples) {
  std::size_t tiles = 0, unfinished = 0;
  for (std::size_t t = 0; t < sums.tiles(); ++t) {
    if (shard.has(t)) {
      ++tiles;
      unfinished += sums.samples(t) < samples;
    } else if (sums.samples(t) > 0) {
      throw petzval::Error(file.string() + ": has tile " + std::to_string(t) + " of another shard");
    }
  }
  if (unfinished == 0) return;
  throw petzval::Error(file.string() + ": unfinished: " + std::to_string(unfinished) + " of " + std::to_string(tiles) +
                       " tiles lack samples");
}

/// The sums of a shard from its files, which must agree. job: the job of the picture; if null, set from the first file.
PictureSums shard_sums(const std::vector<fs::path>& files, const Shard& shard, Json& job) {
  std::optional<PictureSums> found;
  for (const fs::path& file : files) {
    Json own_job;
    PictureSums sums = Checkpoint::read_any(file, own_job);
    if (job.is_null()) job = own_job;
    refuse_other_job(file, own_job, job);
    if (!found) {
      const Json samples = job.value("samples", Json()), noise = job.value("noise", Json());
      refuse_unfinished(file, sums, shard, samples.is_number() && noise.is_null() ? samples.get<std::uint64_t>() : 1);
      found = std::move(sums);
    } else if (*found != sums) {
      throw petzval::Error(file.string() + " and " + files.front().string() + " differ");
    }
  }
  return std::move(*found);
}

}  // namespace

fs::path checkpoint_file(const fs::path& folder, const Shard& shard) {
  return folder / (shard.count == 1 ? whole_picture : shard.stem("tile") + ".exr");
}

PictureSums gather(const std::vector<fs::path>& folders, Json& job) {
  std::string where;
  for (const fs::path& folder : folders) where += (where.empty() ? "" : ", ") + folder.string();
  const ShardFiles files = shard_files(folders);
  if (files.size() != 1) {
    std::string found;
    for (const auto& [count, shards] : files) {
      found += (found.empty() ? "" : " and of ") + shards.begin()->second.front().string();
    }
    throw petzval::Error(where + ": " + (files.empty() ? "no shard" : "different numbers of shards: " + found) +
                         "; must be tile_I_of_N.exr with the same N, or " + whole_picture);
  }
  const std::size_t count = files.begin()->first;
  std::vector<std::string> faults;
  std::optional<PictureSums> all;
  job = nullptr;
  for (std::size_t index = 1; index <= count; ++index) {
    const Shard shard{index, count};
    const auto own = files.begin()->second.find(index);
    if (own == files.begin()->second.end()) {
      faults.push_back("shard " + shard.text() + " is missing");
      continue;
    }
    try {
      const PictureSums sums = shard_sums(own->second, shard, job);
      if (!all) all.emplace(sums.width(), sums.height());
      all->add(sums);
    } catch (const petzval::Error& error) {
      faults.push_back("shard " + shard.text() + ": " + error.what());
    }
  }
  if (faults.empty()) return std::move(*all);
  std::string message;
  for (const std::string& fault : faults) message += fault + "; ";
  throw petzval::Error(where + ": " + message + "must be " + std::to_string(count) + " complete shards of one picture");
}

}  // namespace renderer
