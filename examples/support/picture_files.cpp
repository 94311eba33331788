// SPDX-License-Identifier: Apache-2.0
#include "picture_files.hpp"

#include <algorithm>
#include <utility>

#include "interrupt.hpp"
#include "petzval/image/exr.hpp"
#include "text.hpp"

namespace examples {

void add_channels(std::map<std::string, std::vector<float>>& channels, const std::string& prefix,
                  const petzval::RgbImage& image) {
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float>& values = channels[prefix + "RGB"[c]];
    for (std::size_t i = c; i < image.pixels.size(); i += 3) values.push_back(image.pixels[i]);
  }
}

Option* add_formats(App& app, std::vector<std::string>& formats, const std::string& png) {
  formats = {"exr", "png"};
  return app.add_option("--format", formats, "files of each image: exr and pfm (float, linear), png (" + png + ")")
      ->delimiter(',')
      ->one_of({"exr", "png", "pfm"})
      ->default_str("exr,png");
}

void write_png(const petzval::Rgb8Image& image, const std::filesystem::path& file) {
  const Together uninterrupted;
  petzval::write_png(image, file, parameters());
}

std::vector<std::filesystem::path> write_picture(const petzval::RgbImage& image, const petzval::Rgb8Image& shown,
                                                 const std::vector<std::string>& formats,
                                                 const std::filesystem::path& stem,
                                                 const std::map<std::string, std::string>& texts,
                                                 const std::map<std::string, double>& numbers,
                                                 const std::map<std::string, std::vector<float>>& channels) {
  const std::map<std::string, std::string> attributes = texts.empty() ? parameters() : texts;
  std::vector<std::filesystem::path> files;
  const Together uninterrupted;
  for (const std::string& format : formats) {
    std::filesystem::path file = stem;
    file += '.' + format;
    if (std::find(files.begin(), files.end(), file) != files.end()) continue;
    if (format == "exr") {
      petzval::ExrPart part{.width = image.width, .height = image.height, .channels = channels};
      part.texts = attributes;
      part.numbers = numbers;
      add_channels(part.channels, "", image);
      petzval::write_exr({&part, 1}, file);
    }
    if (format == "pfm") petzval::write_pfm(image, file);
    if (format == "png") {
      auto all = attributes;
      for (const auto& [name, value] : numbers) all.emplace(name, number(value));
      petzval::write_png(shown, file, all);
    }
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace examples
