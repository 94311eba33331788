// SPDX-License-Identifier: Apache-2.0
#include "renderer/outputs.hpp"

#include "support/picture_files.hpp"

namespace renderer {

using examples::finite_or_null;
using examples::Json;

std::vector<std::filesystem::path> write_pictures(const PictureSums& sums,
                                                  const std::map<std::string, std::string>& texts,
                                                  const std::map<std::string, double>& numbers,
                                                  const std::vector<std::string>& formats,
                                                  const std::filesystem::path& folder, float exposure) {
  const petzval::RgbImage picture = sums.picture();
  return examples::write_picture(picture, petzval::to_srgb8(picture, exposure), formats, folder / "picture", texts,
                                 numbers, sums.guides());
}

Json statistics(const PictureSums& sums) {
  double samples = 0;
  Json means = Json::array(), errors = Json::array();
  for (std::size_t t = 0; t < sums.tiles(); ++t) {
    const PixelBlock b = sums.block(t);
    samples += static_cast<double>(sums.samples(t)) * b.width * b.height;
    if (t % sums.tile_columns() == 0) {
      means.push_back(Json::array());
      errors.push_back(Json::array());
    }
    const Estimate luminance = sums.luminance(t);
    means.back().push_back(luminance.mean);
    errors.back().push_back(finite_or_null(luminance.standard_error));
  }
  Json channels = Json::array();
  for (const Estimate& channel : sums.mean()) {
    channels.push_back({{"mean", channel.mean}, {"standard_error", finite_or_null(channel.standard_error)}});
  }
  return {{"samples", samples / (static_cast<double>(sums.width()) * sums.height())},
          {"mean_radiance", std::move(channels)},
          {"tiles",
           {{"rows", sums.tile_rows()},
            {"columns", sums.tile_columns()},
            {"mean", std::move(means)},
            {"standard_error", std::move(errors)}}},
          {"rejected", sums.rejected()}};
}

}  // namespace renderer
