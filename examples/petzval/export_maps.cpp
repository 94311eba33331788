// SPDX-License-Identifier: Apache-2.0
#include "export_maps.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "petzval/image/image.hpp"

namespace commands {
namespace {

/// A part with the channels R, G, B; missing channels are 0.
petzval::ExrPart texture(int width, int height, std::span<const float> texels, std::size_t channels) {
  petzval::ExrPart part{.width = width, .height = height};
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<float> values(texels.size() / channels, 0.0f);
    for (std::size_t i = 0; k < channels && i < values.size(); ++i) values[i] = texels[i * channels + k];
    part.channels.push_back({std::string(1, "RGB"[k]), std::move(values)});
  }
  return part;
}

}  // namespace

void write_omniverse(const petzval::OmniverseTables& tables, const std::filesystem::path& enter,
                     const std::filesystem::path& exit) {
  petzval::write_exr(std::array{texture(tables.columns, tables.rows, tables.directions, 3)}, enter);
  petzval::write_exr(std::array{texture(tables.exit_size, tables.exit_size, tables.positions, 2)}, exit);
}

}  // namespace commands
