// SPDX-License-Identifier: Apache-2.0
#include "renderer/outputs.hpp"

#include <cmath>
#include <utility>

#include "support/picture_files.hpp"

namespace renderer {

using examples::finite_or_null;
using examples::Json;

petzval::RgbImage picture_with_ghosts(const PictureSums& sums) {
  petzval::RgbImage picture = sums.picture();
  for (std::size_t c = 0; c < 3; ++c) {
    const auto ghosts = sums.guides().find(std::string("ghosts.") + "RGB"[c]);
    if (ghosts == sums.guides().end()) continue;
    for (std::size_t i = c; i < picture.pixels.size(); i += 3) picture.pixels[i] += ghosts->second[i / 3];
  }
  return picture;
}

std::vector<std::filesystem::path> write_pictures(const PictureSums& sums,
                                                  const std::map<std::string, std::string>& texts,
                                                  const std::map<std::string, double>& numbers,
                                                  const std::vector<std::string>& formats,
                                                  const std::filesystem::path& folder, float exposure) {
  const petzval::RgbImage picture = picture_with_ghosts(sums);
  return examples::write_picture(picture, petzval::to_srgb8(picture, exposure), formats, folder / "picture", texts,
                                 numbers, sums.guides());
}

Json statistics(const PictureSums& sums, double floor) {
  double samples = 0, squares = 0, largest = 0;
  Json means = Json::array(), errors = Json::array(), counts = Json::array(), noises = Json::array();
  const std::vector<PictureSums::Noise> noise = sums.noise();
  for (std::size_t t = 0; t < sums.tiles(); ++t) {
    const PixelBlock b = sums.block(t);
    samples += static_cast<double>(sums.samples(t)) * b.width * b.height;
    if (t % sums.tile_columns() == 0) {
      for (Json* const rows : {&means, &errors, &counts, &noises}) rows->push_back(Json::array());
    }
    counts.back().push_back(sums.samples(t));
    const double relative = noise[t].relative(floor);
    noises.back().push_back(finite_or_null(relative));
    squares += relative * relative / static_cast<double>(sums.tiles());
    if (!(relative <= largest)) largest = relative;
    const Estimate luminance = sums.luminance(t);
    means.back().push_back(luminance.mean);
    errors.back().push_back(finite_or_null(luminance.standard_error));
  }
  Json channels = Json::array();
  for (const Estimate& channel : sums.mean()) {
    channels.push_back({{"mean", channel.mean}, {"standard_error", finite_or_null(channel.standard_error)}});
  }
  return {
      {"samples", samples / (static_cast<double>(sums.width()) * sums.height())},
      {"light_paths", sums.light_paths()},
      {"mean_radiance", std::move(channels)},
      {"noise", {{"rms", finite_or_null(std::sqrt(squares))}, {"largest", finite_or_null(largest)}, {"floor", floor}}},
      {"tiles",
       {{"rows", sums.tile_rows()},
        {"columns", sums.tile_columns()},
        {"mean", std::move(means)},
        {"standard_error", std::move(errors)},
        {"samples", std::move(counts)},
        {"noise", std::move(noises)}}},
      {"rejected", sums.rejected()}};
}

}  // namespace renderer
