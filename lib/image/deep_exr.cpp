// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/exr.hpp"

#include <ImathBox.h>
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <ImfTileDescription.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "image/exr_head.hpp"
#include "image/file_capacity.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

constexpr std::uint64_t max_values = std::uint64_t(1) << 27;  // limit of pixels and of samples: 3 GiB

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

/// Number of the deep part with a name, or of the first deep part.
int part_of(const Imf::MultiPartInputFile& in, const std::string& name) {
  std::string names;
  for (int part = 0; part < in.parts(); ++part) {
    const Imf::Header& header = in.header(part);
    if (!header.hasType() || (header.type() != Imf::DEEPSCANLINE && header.type() != Imf::DEEPTILE)) continue;
    const std::string own = header.hasName() ? header.name() : "";
    if (name.empty() || name == own) return part;
    names += (names.empty() ? "\"" : ", \"") + own + '"';
  }
  if (names.empty()) throw Error("no part has deep scan lines or tiles; must be a deep image");
  throw Error("part = " + name + "; must be " + names);
}

DeepPicture read(const std::filesystem::path& file, double unit_mm, const std::string& part_name) {
  Imf::MultiPartInputFile in(file.string().c_str(), 0);
  const int part = part_of(in, part_name);
  const Imf::Header& header = in.header(part);
  const std::array<std::string, 4> names = colours_of(header.channels());
  const bool has_back = header.channels().findChannel("ZBack") != nullptr;
  const std::string size_rule = "; must not exceed the size of the file";
  const auto size_of = [&](const Imath::Box2i& window, std::uint64_t most_in_a_byte) {
    const auto width = std::uint64_t(std::int64_t(window.max.x) - window.min.x + 1),
               height = std::uint64_t(std::int64_t(window.max.y) - window.min.y + 1);
    const std::string size = "size = " + std::to_string(width) + " x " + std::to_string(height);
    if (width > max_values || height > max_values || width * height > max_values) {
      throw Error(size + "; must be at most " + std::to_string(max_values) + " pixels");
    }
    if (!image_detail::fits_in_file(width * height, most_in_a_byte, file)) throw Error(size + " pixels" + size_rule);
    return std::array{static_cast<std::size_t>(width), static_cast<std::size_t>(height)};
  };
  // Deflate expands a byte to at most 1032 bytes. Counts take 4 bytes, samples 2 or more. Other pixels of the display
  // window and of tiles need no bytes.
  constexpr std::uint64_t counts_in_a_byte = 1 << 9, samples_in_a_byte = 1 << 10, pixels_in_a_byte = 1 << 14;
  const Imath::Box2i window = header.dataWindow(), display = header.displayWindow();
  const std::size_t width = size_of(window, counts_in_a_byte)[0], columns = size_of(display, pixels_in_a_byte)[0];

  // Bands of one row, or of one row of tiles.
  std::optional<Imf::DeepScanLineInputPart> lines;
  std::optional<Imf::DeepTiledInputPart> tiles;
  int band = 1;
  if (header.type() == Imf::DEEPTILE) {
    const auto tile = header.tileDescription();
    size_of({{1, 1}, {static_cast<int>(tile.xSize), static_cast<int>(tile.ySize)}}, pixels_in_a_byte);
    tiles.emplace(in, part), band = static_cast<int>(tile.ySize);
  } else {
    lines.emplace(in, part);
  }
  const auto tile_row = [&](int row) { return (row - window.min.y) / band; };
  const auto read_counts = [&](const Imf::DeepFrameBuffer& buffer, int first, int last) {
    if (lines) return lines->setFrameBuffer(buffer), lines->readPixelSampleCounts(first, last);
    tiles->setFrameBuffer(buffer);
    tiles->readPixelSampleCounts(0, tiles->numXTiles(0) - 1, tile_row(first), tile_row(last));
  };

  // A damaged file may state any number of samples: all counts are checked before samples are read.
  std::vector<std::uint32_t> counts(width * size_of(window, counts_in_a_byte)[1]);
  Imf::DeepFrameBuffer only_counts;
  only_counts.insertSampleCountSlice(count_slice(counts, window, width));
  read_counts(only_counts, window.min.y, window.max.y);
  std::uint64_t samples = 0;
  for (std::size_t i = 0; i < counts.size(); i += width) {
    samples = std::accumulate(&counts[i], &counts[i] + width, samples);
    if (samples > max_values || !image_detail::fits_in_file(samples, samples_in_a_byte, file)) {
      throw Error("samples = " + std::to_string(samples) + " up to row " + std::to_string(i / width) + size_rule +
                  " or " + std::to_string(max_values));
    }
  }
  DeepPicture picture;
  FragmentLists& lists = picture.lists;
  lists.columns = static_cast<int>(columns), lists.rows = static_cast<int>(size_of(display, pixels_in_a_byte)[1]);
  lists.offsets.assign(columns * static_cast<std::size_t>(lists.rows) + 1, 0);
  if (image_detail::fits_in_file(samples, 1, file)) lists.fragments.reserve(static_cast<std::size_t>(samples));

  std::array<DeepPlane, 6> planes;  // R, G, B, A, Z, ZBack
  const std::size_t green = names[0] == "Y" ? 0 : 1, blue = names[0] == "Y" ? 0 : 2, back = has_back ? 5 : 4;
  const std::uint32_t* count = counts.data();
  for (int row = window.min.y; row <= window.max.y;) {
    const Imath::Box2i rows{{window.min.x, row}, {window.max.x, std::min(window.max.y, row + band - 1)}};
    const std::span of_band(count, static_cast<std::size_t>(rows.max.y - row + 1) * width);
    for (DeepPlane& plane : planes) plane.begins.resize(of_band.size());
    Imf::DeepFrameBuffer buffer = only_counts;
    const auto insert = [&](const std::string& name, std::size_t plane) {
      buffer.insert(name, planes[plane].slice(rows, width));
    };
    for (std::size_t c = 0; c <= blue; ++c) insert(names[c], c);
    if (!names[3].empty()) insert("A", 3);
    insert("Z", 4);
    if (has_back) insert("ZBack", 5);
    read_counts(buffer, row, rows.max.y);
    for (DeepPlane& plane : planes) plane.point(of_band);
    if (lines) lines->readPixels(row, row);
    if (tiles) tiles->readTiles(0, tiles->numXTiles(0) - 1, tile_row(row), tile_row(row));

    for (std::size_t at = 0; row <= rows.max.y; ++row) {
      for (int column = window.min.x; column <= window.max.x; ++column, at += *count++) {
        if (!display.intersects(Imath::V2i(column, row))) {
          picture.outside += *count;
          continue;
        }
        const std::size_t before = lists.fragments.size();
        for (std::size_t k = at; k < at + *count; ++k) {
          const auto value = [&](std::size_t plane) { return planes[plane].values[k]; };
          const auto depth = [&](std::size_t plane) {
            return unit_mm == 1 ? value(plane) : static_cast<float>(value(plane) * unit_mm);
          };
          if (!(value(4) > 0)) {
            ++picture.without_depth;
            continue;
          }
          picture.volumes += value(back) > value(4);
          lists.fragments.push_back(
              {depth(4), value(0), value(green), value(blue), names[3].empty() ? 1.0f : value(3), depth(back)});
        }
        lists.offsets[static_cast<std::size_t>(row - display.min.y) * columns +
                      static_cast<std::size_t>(column - display.min.x) + 1] = lists.fragments.size() - before;
      }
    }
  }
  std::partial_sum(lists.offsets.begin(), lists.offsets.end(), lists.offsets.begin());
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

DeepPicture read_deep_exr(const std::filesystem::path& file, double unit_mm, const std::string& part) {
  return image_detail::read_exr_file(file, [&] {
    if (!(unit_mm > 0 && std::isfinite(unit_mm)))
      throw Error("unit_mm = " + std::to_string(unit_mm) + "; must be positive");
    return read(file, unit_mm, part);
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
    std::vector<const char*> names{"R", "G", "B", "A", "Z"};
    if (std::ranges::any_of(lists.fragments, [](const auto& f) { return f.back_mm > f.depth_mm; }))
      names.push_back("ZBack");
    for (const char* name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));

    Imf::DeepScanLineOutputFile out(stream, header, 0);
    std::vector<std::uint32_t> counts(width);
    std::array<DeepPlane, 6> planes;
    for (int row = 0; row < lists.rows; ++row) {
      const std::size_t* const offsets = &lists.offsets[static_cast<std::size_t>(row) * width];
      for (std::size_t i = 0; i < width; ++i) counts[i] = static_cast<std::uint32_t>(offsets[i + 1] - offsets[i]);
      Imf::DeepFrameBuffer buffer;
      const Imath::Box2i line{{0, row}, {lists.columns - 1, row}};
      buffer.insertSampleCountSlice(count_slice(counts, line, width));
      for (std::size_t c = 0; c < names.size(); ++c) {
        planes[c].point(counts);
        buffer.insert(names[c], planes[c].slice(line, width));
      }
      for (std::size_t i = offsets[0]; i < offsets[width]; ++i) {
        const FragmentLists::Fragment& f = lists.fragments[i];
        const float numbers[] = {f.red, f.green, f.blue, f.alpha, f.depth_mm, std::max(f.depth_mm, f.back_mm)};
        for (std::size_t c = 0; c < names.size(); ++c) planes[c].values[i - offsets[0]] = numbers[c];
      }
      out.setFrameBuffer(buffer);
      out.writePixels(1);
    }
  } catch (const std::exception& e) {
    throw Error(file.string() + ": " + e.what());
  }
  write_file(stream.str(), file);
}

}  // namespace petzval
