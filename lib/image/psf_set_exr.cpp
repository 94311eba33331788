// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/psf.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

constexpr std::array<const char*, 3> channel_names{"Y", "hits.x", "hits.y"};
constexpr std::array diffractions{Diffraction::negligible, Diffraction::visible, Diffraction::dominant};

/// The checksum of all numbers and channels and of the texts `anchor` and `diffraction`.
std::string checksum_of(const ExrPart& part) {
  std::string bytes;
  const auto add = [&bytes](std::uint64_t bits, int count) {
    for (int byte = 0; byte < count; ++byte) bytes += static_cast<char>(bits >> (8 * byte) & 0xff);
  };
  for (const auto& [name, value] : part.numbers) bytes += name, add(std::bit_cast<std::uint64_t>(value), 8);
  for (const char* name : {"anchor", "diffraction"}) {
    if (const auto text = part.texts.find(name); text != part.texts.end()) bytes += text->second;
  }
  for (const char* name : channel_names) {
    const auto own = part.channels.find(name);
    if (own == part.channels.end()) continue;
    for (const float value : own->second) add(std::bit_cast<std::uint32_t>(value), 4);
  }
  return checksum(bytes);
}

}  // namespace

std::string psf_part_name(const PsfSetPoint& point) {
  return to_text(point.field_deg) + "deg_" + to_text(point.distance_mm) +
         (std::isinf(point.distance_mm) ? "_" : "mm_") + to_text(point.wavelength_nm) + "nm_f" +
         to_text(point.f_number);
}

ExrPart to_exr_part(const PsfKernel& kernel, const PsfSetPoint& point) {
  ExrPart part;
  part.name = psf_part_name(point);
  part.width = part.height = kernel.pixels;
  part.channels = {
      {channel_names[0], kernel.light}, {channel_names[1], kernel.hits_x}, {channel_names[2], kernel.hits_y}};
  part.numbers = {{"field_deg", point.field_deg},
                  {"distance_mm", point.distance_mm},
                  {"wavelength_nm", point.wavelength_nm},
                  {"f_number", point.f_number},
                  {"pixel_mm", kernel.pixel_mm},
                  {"anchor_x_mm", kernel.anchor_mm.x},
                  {"anchor_y_mm", kernel.anchor_mm.y},
                  {"total", kernel.total},
                  {"throughput", kernel.throughput},
                  {"error", kernel.error},
                  {"rays", kernel.rays}};
  part.texts = {{"anchor", kernel.chief_ray ? "chief_ray" : "centroid"},
                {"diffraction", std::string(name(kernel.diffraction))}};
  part.texts["checksum"] = checksum_of(part);
  return part;
}

std::pair<PsfSetPoint, PsfKernel> from_exr_part(const ExrPart& part) {
  const std::string where = "part \"" + part.name + "\": ";
  const auto number = [&](const char* key) {
    const auto found = part.numbers.find(key);
    if (found == part.numbers.end()) throw Error(where + "no number " + key + "; must be a part of a PSF set");
    return found->second;
  };
  const auto text = [&](const char* key) {
    const auto found = part.texts.find(key);
    if (found == part.texts.end()) throw Error(where + "no text " + key + "; must be a part of a PSF set");
    return found->second;
  };
  PsfKernel kernel;
  const PsfSetPoint point{number("field_deg"), number("distance_mm"), number("wavelength_nm"), number("f_number")};
  kernel.pixels = part.width;
  kernel.pixel_mm = number("pixel_mm");
  kernel.anchor_mm = {number("anchor_x_mm"), number("anchor_y_mm")};
  kernel.total = number("total");
  kernel.throughput = number("throughput");
  kernel.error = number("error");
  kernel.rays = number("rays");
  kernel.chief_ray = text("anchor") == "chief_ray";
  for (const Diffraction d : diffractions) {
    if (text("diffraction") == name(d)) kernel.diffraction = d;
  }
  std::array<std::vector<float>*, 3> values{&kernel.light, &kernel.hits_x, &kernel.hits_y};
  for (std::size_t c = 0; c < values.size(); ++c) {
    const auto own = part.channels.find(channel_names[c]);
    if (own == part.channels.end()) {
      throw Error(where + "no channel " + channel_names[c] + "; must be a part of a PSF set");
    }
    *values[c] = own->second;
  }
  if (part.width != part.height || text("checksum") != checksum_of(part)) {
    throw Error(where + "checksum = " + checksum_of(part) + "; must be " + text("checksum") + ": the file has changed");
  }
  return {point, std::move(kernel)};
}

PsfSet read_psf_set(const std::filesystem::path& file) { return psf_set_of(read_exr_parts(file), file); }

PsfSet psf_set_of(std::vector<ExrPart> parts, const std::filesystem::path& file) {
  try {
    std::vector<std::pair<PsfSetPoint, PsfKernel>> found;
    std::array<std::set<double>, 4> seen;
    for (ExrPart& part : parts) {
      found.push_back(from_exr_part(part));
      part = {};
      const PsfSetPoint& point = found.back().first;
      const std::array at{point.field_deg, point.distance_mm, point.wavelength_nm, point.f_number};
      for (std::size_t axis = 0; axis < at.size(); ++axis) seen[axis].insert(at[axis]);
    }
    const auto axis = [&](std::size_t i) { return std::vector<double>(seen[i].begin(), seen[i].end()); };
    PsfSet::Axes axes{axis(0), axis(1), axis(2), axis(3)};
    std::map<std::string, std::size_t> indices;
    for (std::size_t i = 0; i < found.size(); ++i) indices[psf_part_name(found[i].first)] = i;
    std::vector<PsfKernel> kernels;
    for (std::size_t node = 0; node < axes.size(); ++node) {
      const std::string part_name = psf_part_name(axes.point(node));
      const auto entry = indices.find(part_name);
      if (entry == indices.end())
        throw Error("no part \"" + part_name + "\"; must have one for every node of the grid");
      kernels.push_back(std::move(found[entry->second].second));
    }
    return {std::move(axes), std::move(kernels)};
  } catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
  }
}

}  // namespace petzval
