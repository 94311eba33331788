// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/exr.hpp"

#include <ImathBox.h>
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "image/exr_head.hpp"
#include "image/file_capacity.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

constexpr std::uint64_t max_values = std::uint64_t(1) << 27;  // limit of pixels and of samples: 3 GiB of values

/// One channel of all samples of some rows, with the pointers per pixel that OpenEXR requires.
struct DeepPlane {
  std::vector<float> values;
  std::vector<float*> begins;

  void point(std::span<const std::uint32_t> counts) {
    values.resize(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
    begins.resize(counts.size());
    std::size_t at = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) begins[i] = values.data() + at, at += counts[i];
  }
  Imf::DeepSlice slice(const Imath::Box2i& rows, std::size_t width) {
    // OpenEXR counts pixels from (0, 0).
    const std::ptrdiff_t first =
        -rows.min.x - static_cast<std::ptrdiff_t>(rows.min.y) * static_cast<std::ptrdiff_t>(width);
    return {Imf::FLOAT, reinterpret_cast<char*>(begins.data() + first), sizeof(float*), sizeof(float*) * width,
            sizeof(float)};
  }
};

Imf::Slice count_slice(std::vector<std::uint32_t>& counts, const Imath::Box2i& rows, std::size_t width) {
  const std::ptrdiff_t first =
      -rows.min.x - static_cast<std::ptrdiff_t>(rows.min.y) * static_cast<std::ptrdiff_t>(width);
  return {Imf::UINT, reinterpret_cast<char*>(counts.data() + first), sizeof(std::uint32_t),
          sizeof(std::uint32_t) * width};
}

/// Names of the channels for red, green, blue and alpha; alpha is empty if there is no channel A.
std::array<std::string, 4> colours_of(const Imf::ChannelList& channels) {
  if (!channels.findChannel("Z")) throw Error("channel Z is missing; must have depths");
  const std::string alpha = channels.findChannel("A") ? "A" : "";
  if (channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B"))
    return {"R", "G", "B", alpha};
  if (channels.findChannel("Y")) return {"Y", "Y", "Y", alpha};
  throw Error("channels R, G and B, or Y, are missing; must have colours");
}

DeepPicture read(const std::filesystem::path& file, double unit_mm) {
  Imf::MultiPartInputFile in(file.string().c_str(), 0);
  int part = 0;
  while (part < in.parts() && !(in.header(part).hasType() && in.header(part).type() == Imf::DEEPSCANLINE)) ++part;
  if (part == in.parts()) throw Error("no part has deep scan lines; must be a deep image");
  const Imf::Header& header = in.header(part);
  const std::array<std::string, 4> names = colours_of(header.channels());
  const bool has_back = header.channels().findChannel("ZBack") != nullptr;
  const Imath::Box2i window = header.dataWindow();
  const auto width = std::uint64_t(std::int64_t(window.max.x) - window.min.x + 1),
             height = std::uint64_t(std::int64_t(window.max.y) - window.min.y + 1);
  if (width > max_values || height > max_values || width * height > max_values) {
    throw Error("size = " + std::to_string(width) + " x " + std::to_string(height) + "; must be at most " +
                std::to_string(max_values) + " pixels");
  }
  // Deflate expands a byte to at most 1032 bytes. Counts take 4 bytes, samples 2 or more.
  const std::string size_rule = "; must not exceed the size of the file";
  if (!image_detail::fits_in_file(width * height, 1 << 9, file)) {
    throw Error("size = " + std::to_string(width) + " x " + std::to_string(height) + " pixels" + size_rule);
  }
  DeepPicture picture;
  FragmentLists& lists = picture.lists;
  lists.columns = static_cast<int>(width), lists.rows = static_cast<int>(height);
  lists.offsets.assign(1, 0);

  Imf::DeepScanLineInputPart deep(in, part);
  std::uint64_t samples = 0;
  std::vector<std::uint32_t> counts(static_cast<std::size_t>(width));
  std::array<DeepPlane, 6> planes;  // R, G, B, A, Z, ZBack
  for (int row = window.min.y; row <= window.max.y; ++row) {
    // Read row by row, because a damaged file may state any number of samples: the counts are checked before the
    // samples are read.
    const Imath::Box2i line{{window.min.x, row}, {window.max.x, row}};
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(count_slice(counts, line, static_cast<std::size_t>(width)));
    for (DeepPlane& plane : planes) plane.begins.resize(counts.size());
    const auto slices = [&] {
      const auto insert = [&](const char* name, std::size_t plane) {
        buffer.insert(name, planes[plane].slice(line, static_cast<std::size_t>(width)));
      };
      for (std::size_t c = 0; c < (names[0] == "Y" ? 1u : 3u); ++c) insert(names[c].c_str(), c);
      if (!names[3].empty()) insert("A", 3);
      insert("Z", 4);
      if (has_back) insert("ZBack", 5);
    };
    slices();
    deep.setFrameBuffer(buffer);
    deep.readPixelSampleCounts(row, row);
    samples += std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    if (samples > max_values || !image_detail::fits_in_file(samples, 1 << 10, file)) {
      throw Error("samples = " + std::to_string(samples) + " up to row " + std::to_string(row - window.min.y) +
                  size_rule + " or " + std::to_string(max_values));
    }
    for (DeepPlane& plane : planes) plane.point(counts);
    deep.readPixels(row, row);

    std::size_t at = 0;
    for (const std::uint32_t count : counts) {
      for (std::uint32_t k = 0; k < count; ++k, ++at) {
        const float z = planes[4].values[at];
        if (!(z > 0)) {
          ++picture.without_depth;
          continue;
        }
        picture.volumes += has_back && planes[5].values[at] > z;
        const std::size_t green = names[0] == "Y" ? 0 : 1, blue = names[0] == "Y" ? 0 : 2;
        lists.fragments.push_back({unit_mm == 1 ? z : static_cast<float>(z * unit_mm), planes[0].values[at],
                                   planes[green].values[at], planes[blue].values[at],
                                   names[3].empty() ? 1.0f : planes[3].values[at]});
      }
      lists.offsets.push_back(lists.fragments.size());
    }
  }
  return picture;
}

void check(const FragmentLists& lists) {
  const auto pixels =
      static_cast<std::size_t>(std::max(lists.columns, 0)) * static_cast<std::size_t>(std::max(lists.rows, 0));
  if (pixels == 0 || lists.offsets.size() != pixels + 1 || lists.offsets.front() != 0 ||
      lists.offsets.back() != lists.fragments.size() || !std::is_sorted(lists.offsets.begin(), lists.offsets.end())) {
    throw Error("offsets = " + std::to_string(lists.offsets.size()) + " for " + std::to_string(lists.columns) + " x " +
                std::to_string(lists.rows) +
                " pixels; must be one more than pixels, ascending from 0 to the number of fragments");
  }
}

}  // namespace

DeepPicture read_deep_exr(const std::filesystem::path& file, double unit_mm) {
  return image_detail::read_exr_file(file, [&] {
    if (!(unit_mm > 0 && std::isfinite(unit_mm)))
      throw Error("unit_mm = " + std::to_string(unit_mm) + "; must be positive");
    return read(file, unit_mm);
  });
}

void write_deep_exr(const FragmentLists& lists, const std::filesystem::path& file) {
  Imf::StdOSStream stream;
  try {
    check(lists);
    const auto width = static_cast<std::size_t>(lists.columns);
    const Imath::Box2i window{{0, 0}, {lists.columns - 1, lists.rows - 1}};
    Imf::Header header(window, window);
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    constexpr std::array names{"R", "G", "B", "A", "Z"};
    for (const char* name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));

    std::vector<std::uint32_t> counts;
    for (std::size_t i = 0; i + 1 < lists.offsets.size(); ++i) {
      counts.push_back(static_cast<std::uint32_t>(lists.offsets[i + 1] - lists.offsets[i]));
    }
    std::array<DeepPlane, 5> planes;
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(count_slice(counts, window, width));
    for (std::size_t c = 0; c < names.size(); ++c) {
      planes[c].point(counts);
      buffer.insert(names[c], planes[c].slice(window, width));
    }
    for (std::size_t i = 0; i < lists.fragments.size(); ++i) {
      const FragmentLists::Fragment& f = lists.fragments[i];
      const float numbers[] = {f.red, f.green, f.blue, f.alpha, f.depth_mm};
      for (std::size_t c = 0; c < names.size(); ++c) planes[c].values[i] = numbers[c];
    }
    Imf::DeepScanLineOutputFile out(stream, header, 0);
    out.setFrameBuffer(buffer);
    out.writePixels(lists.rows);
  } catch (const std::exception& e) {
    throw Error(file.string() + ": " + e.what());
  }
  write_file(stream.str(), file);
}

}  // namespace petzval
