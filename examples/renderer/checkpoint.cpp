// SPDX-License-Identifier: Apache-2.0
#include "renderer/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/image/image.hpp"

namespace renderer {
namespace {

namespace fs = std::filesystem;
using examples::Json;

constexpr std::array<const char*, 3> rgb{"R", "G", "B"};

/// Prefixes of the channels of film samples and of light paths.
const std::array<std::pair<PictureSums::Of, std::string>, 2> prefixes{
    {{PictureSums::Of::film, ""}, {PictureSums::Of::light, "light."}}};

std::string of_round(const std::string& name, std::size_t round) { return name + std::to_string(round + 1); }

std::string term_name(const std::string& name, std::size_t term) {
  return term == 0 ? name : name + '.' + std::to_string(term);
}

/// Adds the channels of sums; at(i) is the i-th sum.
template <class At>
void add_channels(petzval::ExrPart& part, const std::string& name, const At& at) {
  const auto size = static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height);
  std::vector<FixedSum> rest;
  for (std::size_t i = 0; i < size; ++i) rest.push_back(at(i));
  std::size_t term = 0;
  do {
    std::vector<float>& values = part.channels[term_name(name, term++)];
    for (FixedSum& sum : rest) {
      values.push_back(static_cast<float>(sum.value()));
      sum -= FixedSum(static_cast<double>(values.back()));
    }
  } while (std::any_of(rest.begin(), rest.end(), [](const FixedSum& sum) { return sum != FixedSum(); }));
}

/// Reads the sums written by add_channels() and calls set(i, sum).
template <class Set>
void read_channels(const petzval::ExrPart& part, const std::string& name, const Set& set) {
  std::vector<FixedSum> sums(static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height));
  for (std::size_t term = 0;; ++term) {
    const auto channel = part.channels.find(term_name(name, term));
    if (channel == part.channels.end()) {
      if (term == 0) throw petzval::Error("part \"" + part.name + "\" has no channel " + name);
      break;
    }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += FixedSum(static_cast<double>(channel->second[i]));
  }
  for (std::size_t i = 0; i < sums.size(); ++i) set(i, sums[i]);
}

FixedSum whole(std::uint32_t count) { return FixedSum(static_cast<double>(count)); }
std::uint32_t count(const FixedSum& sum) { return static_cast<std::uint32_t>(sum.value()); }

std::string checksum_of(const std::string& job, const std::vector<petzval::ExrPart>& parts) {
  std::string bytes = job;
  const auto add = [&bytes](std::uint64_t bits, int size) {
    for (int byte = 0; byte < size; ++byte) bytes += static_cast<char>(bits >> (8 * byte) & 0xff);
  };
  for (const petzval::ExrPart& part : parts) {
    bytes += part.name;
    for (const auto& [name, value] : part.numbers) bytes += name, add(std::bit_cast<std::uint64_t>(value), 8);
    for (const auto& [name, values] : part.channels) {
      bytes += name;
      for (const float value : values) add(std::bit_cast<std::uint32_t>(value), 4);
    }
  }
  return petzval::checksum(bytes);
}

const std::string& text(const petzval::ExrPart& part, const char* key) {
  const auto found = part.texts.find(key);
  if (found == part.texts.end()) throw petzval::Error(std::string("has no text ") + key);
  return found->second;
}

}  // namespace

std::vector<petzval::ExrPart> Checkpoint::parts(const PictureSums& sums) {
  petzval::ExrPart pixels{.name = "sums", .width = sums.width_, .height = sums.height_};
  petzval::ExrPart tiles{
      .name = "tiles", .width = static_cast<int>(sums.tile_columns_), .height = static_cast<int>(sums.tile_rows_)};
  for (const auto& [of, prefix] : prefixes) {
    const auto& own = sums.pixels_[static_cast<std::size_t>(of)];
    for (std::size_t c = 0; c < rgb.size(); ++c) {
      add_channels(pixels, prefix + rgb[c], [&, c](std::size_t i) { return own[i][c]; });
    }
    const auto part = [&sums, which = of ](std::size_t t) -> const auto& { return sums.part(t, which); };
    add_channels(tiles, prefix + std::string("target"), [&](std::size_t t) { return whole(part(t).target); });
    for (std::size_t r = 0; r < PictureSums::rounds; ++r) {
      add_channels(tiles, prefix + of_round("samples_", r), [&](std::size_t t) { return whole(part(t).samples[r]); });
      for (std::size_t c = 0; c < rgb.size(); ++c) {
        add_channels(tiles, prefix + of_round(rgb[c], r), [&](std::size_t t) { return part(t).sums[r][c]; });
      }
    }
  }
  pixels.numbers["rejected"] = static_cast<double>(sums.rejected_);
  std::vector<petzval::ExrPart> all{std::move(pixels), std::move(tiles)};
  if (!sums.guides_.empty()) {
    all.push_back({.name = "guides", .width = sums.width_, .height = sums.height_});
    all.back().channels = sums.guides_;
  }
  return all;
}

void Checkpoint::write(const PictureSums& sums, const Json& job, const fs::path& file) {
  std::vector<petzval::ExrPart> all = parts(sums);
  const std::string job_text = job.dump();
  const std::string sum = checksum_of(job_text, all);
  all.front().texts = {{"job", job_text}, {"checksum", sum}};
  petzval::write_exr(all, file);
}

PictureSums Checkpoint::read(const fs::path& file, const Json& job) {
  Json found;
  PictureSums sums = read_any(file, found);
  refuse_other_job(file, found, job);
  return sums;
}

PictureSums Checkpoint::read_any(const fs::path& file, Json& job) {
  const std::vector<petzval::ExrPart> all = petzval::read_exr_parts(file);
  try {
    const auto& job_text = text(all.front(), "job");
    const std::string sum = checksum_of(job_text, all);
    if (text(all.front(), "checksum") != sum) {
      throw petzval::Error("checksum = " + sum + "; must be " + text(all.front(), "checksum") +
                           ": the file has changed");
    }
    job = Json::parse(job_text, nullptr, false);
    if (!job.is_object()) throw petzval::Error("text job is not a JSON object");
    PictureSums sums(all.front().width, all.front().height);
    const auto part = [&](std::size_t i, const char* name, std::size_t width, std::size_t height) -> const auto& {
      if (i >= all.size() || all[i].name != name || all[i].width != static_cast<int>(width) ||
          all[i].height != static_cast<int>(height)) {
        throw petzval::Error("has no part \"" + std::string(name) + "\" of " + std::to_string(width) + " x " +
                             std::to_string(height));
      }
      return all[i];
    };
    const petzval::ExrPart& tiles = part(1, "tiles", sums.tile_columns_, sums.tile_rows_);
    for (const auto& [of, prefix] : prefixes) {
      auto& pixels = sums.pixels_[static_cast<std::size_t>(of)];
      for (std::size_t c = 0; c < rgb.size(); ++c) {
        read_channels(all.front(), prefix + rgb[c], [&, c](std::size_t i, const FixedSum& own) { pixels[i][c] = own; });
      }
      const auto to = [&sums, which = of ](std::size_t t) -> auto& { return sums.part(t, which); };
      read_channels(tiles, prefix + std::string("target"),
                    [&](std::size_t t, const FixedSum& own) { to(t).target = count(own); });
      for (std::size_t r = 0; r < PictureSums::rounds; ++r) {
        read_channels(tiles, prefix + of_round("samples_", r),
                      [&](std::size_t t, const FixedSum& own) { to(t).samples[r] = count(own); });
        for (std::size_t c = 0; c < rgb.size(); ++c) {
          read_channels(tiles, prefix + of_round(rgb[c], r),
                        [&](std::size_t t, const FixedSum& own) { to(t).sums[r][c] = own; });
        }
      }
    }
    if (all.size() > 2) {
      const auto width = static_cast<std::size_t>(sums.width_), height = static_cast<std::size_t>(sums.height_);
      sums.guides_ = part(2, "guides", width, height).channels;
    }
    const auto rejected = all.front().numbers.find("rejected");
    if (rejected == all.front().numbers.end()) throw petzval::Error("has no number rejected");
    sums.rejected_ = static_cast<std::uint64_t>(rejected->second);
    return sums;
  } catch (const petzval::Error& error) {
    throw petzval::Error(file.string() + ": " + error.what() + "; must be a checkpoint of petzval render");
  }
}

void refuse_other_job(const fs::path& file, const Json& found, const Json& expected) {
  // Names of files, whose contents have checksums.
  constexpr std::array left_out{"/setup/lens/file", "/setup/lens/configuration", "/setup/lens/prescription",
                                "/setup/lens/glass_files", "/setup/iris_map"};
  const Json own = found.flatten(), other = expected.flatten();
  const auto at = [](const Json& values, const std::string& key) {
    return values.contains(key) ? values.at(key).dump() : "nothing";
  };
  std::string differences;
  std::set<std::string> seen;
  for (const Json* const values : {&own, &other}) {
    for (const auto& entry : values->items()) {
      const std::string key = entry.key();
      if (at(own, key) == at(other, key) || !seen.insert(key).second) continue;
      if (std::ranges::any_of(left_out, [&](const char* start) { return key.starts_with(start); })) continue;
      differences +=
          (differences.empty() ? "" : ", ") + key.substr(1) + " = " + at(own, key) + "; must be " + at(other, key);
    }
  }
  if (differences.empty()) return;
  throw petzval::Error(file.string() + ": belongs to another picture: " + differences);
}

}  // namespace renderer
