// SPDX-License-Identifier: Apache-2.0
// Lays out pictures on a sheet and measures the highlights of the balls scene.
//
//   petzval sheet --title "Balls" --out balls.svg --balls balls.csv FOLDER...
//   petzval sheet out/a/*.exr out/b/*.exr --columns 4 --out sheet.svg
#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <iostream>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/image/image.hpp"
#include "petzval/io/json.hpp"
#include "renderer/highlights.hpp"
#include "support/bokeh.hpp"
#include "support/cli.hpp"
#include "support/contact_sheet.hpp"
#include "support/files.hpp"
#include "support/svg_page.hpp"
#include "support/text.hpp"

namespace {

namespace fs = std::filesystem;
using examples::Json;
using examples::number;

/// A picture of petzval render, or a picture file without a set-up.
struct Picture {
  fs::path path;
  petzval::RgbImage image;
  std::optional<petzval::CameraSetup> setup;
  std::string lens;  ///< its name; empty for a picture file

  double film_width_mm() const { return setup ? setup->film.width_mm : 0; }
  bool own_exposure() const { return !setup && path.extension() == ".exr"; }
  /// The name of the file; or the focus, and differences from an upright film behind the unmodified lens.
  std::vector<std::string> captions() const {
    if (!setup) return {path.filename().string()};
    const double mm = setup->focus_mm.value();
    std::vector<std::string> lines{!setup->focal_points.empty() ? "a focal surface"
                                   : std::isinf(mm)             ? "focus infinity"
                                                                : "focus " + number(mm) + " mm from the " +
                                                          examples::in_words(setup->focus.origin)};
    if (setup->film.tilted()) lines.emplace_back("film tilted");
    if (!setup->camera.expressive.empty()) lines.emplace_back("expressive lens");
    return lines;
  }
};

Picture read(const fs::path& path) {
  std::error_code none;
  if (!fs::is_directory(path, none)) {
    if (path.extension() == ".png") return {path, petzval::read_png(path), {}, {}};
    if (path.extension() == ".exr") return {path, petzval::read_exr(path), {}, {}};
    throw petzval::Error(path.string() + ": must be a folder of petzval render, or a picture in .png or .exr");
  }
  const std::string file = (path / "render.json").string(), text = examples::read_text(file);
  Picture picture{path, petzval::read_exr(path / "picture.exr"), petzval::camera_setup(text, file), {}};
  picture.lens = Json::parse(text).at("job").at("lens");
  if (picture.setup->camera.model == petzval::ModelKind::pinhole) picture.lens += ", pinhole";
  return picture;
}

/// The exposure that clips one pixel of 5000.
float exposure_below_white(const petzval::RgbImage& image) {
  std::vector<float> values;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    values.push_back(std::max({image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]}));
  }
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 4999 / 5000);
  std::nth_element(values.begin(), rank, values.end());
  return *rank > 0 ? 1 / *rank : 1;
}

/// The picture with exposure 1 unless each picture has its own, as .exr files have.
petzval::Rgb8Image shown(const Picture& picture, bool own_exposure) {
  if (picture.own_exposure()) return examples::expose(picture.image).picture;
  return petzval::to_srgb8(picture.image, own_exposure ? exposure_below_white(picture.image) : 1);
}

examples::Sheet sheet_of(std::span<const Picture> pictures, const std::string& title, std::size_t columns,
                         bool own_exposure) {
  examples::Sheet sheet{title, {}, {}};
  std::string row_title;
  for (std::size_t i = 0; i < pictures.size(); i += columns) {
    const auto shown_pictures = pictures.subspan(i, std::min(columns, pictures.size() - i));
    const bool same_lens =
        std::ranges::all_of(shown_pictures, [&](const Picture& p) { return p.lens == shown_pictures.front().lens; });
    const std::string lens = same_lens ? shown_pictures.front().lens : "";
    examples::SheetRow& row = sheet.rows.emplace_back(examples::SheetRow{
        same_lens && lens == row_title ? "" : lens, same_lens ? "" : "lenses below the pictures", {}, columns});
    row_title = lens;
    for (const Picture& p : shown_pictures) {
      row.tiles.push_back({shown(p, own_exposure), p.captions(), p.film_width_mm()});
      if (!same_lens && p.setup.has_value())
        row.tiles.back().captions.insert(row.tiles.back().captions.begin(), p.lens);
    }
  }
  return sheet;
}

/// The square part of a picture, as high as the picture, around a column.
petzval::RgbImage square_at(const petzval::RgbImage& image, double x) {
  const int size = std::min(image.width, image.height);
  const int left = std::clamp(static_cast<int>(std::lround(x - size / 2.0)), 0, image.width - size);
  petzval::RgbImage result(size, size);
  for (int y = 0; y < size; ++y) std::copy_n(image.pixel(left, y), 3 * size, result.pixel(0, y));
  return result;
}

/// Rows with the highlights of three balls, enlarged: a tile for each picture.
void add_highlights(examples::Sheet& sheet, const std::vector<Picture>& pictures) {
  for (const auto& [title, ball] :
       {std::pair{"in the centre", 6u}, std::pair{"half way to the edge", 9u}, std::pair{"at the edge", 12u}}) {
    examples::SheetRow row{title, ""};
    for (const Picture& p : pictures) {
      const auto highlights = renderer::ball_highlights(p.image);
      if (highlights.size() <= ball || !highlights[ball]) continue;
      const petzval::RgbImage part = square_at(p.image, highlights[ball]->x);
      row.tiles.push_back({petzval::to_srgb8(part, exposure_below_white(p.image)),
                           {examples::focus_caption(*p.setup->focus_mm)},
                           p.film_width_mm() / p.image.width * part.width});
    }
    if (!row.tiles.empty()) sheet.rows.push_back(std::move(row));
  }
}

std::string ball_table(const std::vector<Picture>& pictures) {
  std::string csv =
      "lens,focus_mm,x_mm,centroid_x_px,centroid_y_px,axis_ratio,long_axis_to_radius_deg,outward_skewness,light,"
      "beside,trusted\n";
  for (const Picture& p : pictures) {
    const auto highlights = renderer::ball_highlights(p.image);
    for (std::size_t i = 0; i < highlights.size(); ++i) {
      if (!highlights[i]) continue;
      const renderer::Highlight& h = *highlights[i];
      csv += '"' + p.lens + "\"," + examples::finite_or_null(*p.setup->focus_mm).dump() + ',' +
             std::to_string(25 * (static_cast<int>(i) - 6));
      for (const double x : {h.x, h.y, h.axis_ratio, h.to_radius_deg, h.outward_skewness, h.light, h.neighbour_light})
        csv += ',' + number(x, 4);
      csv += h.trusted() ? ",yes\n" : ",no\n";
    }
  }
  return csv;
}

}  // namespace

int commands::sheet(int argc, char** argv) {
  std::vector<std::string> paths;
  std::string title = "Scenes through lenses", out, balls;
  std::uint32_t columns = 1;
  examples::App app(
      "Lays out pictures on a sheet, in rows from the left: pictures of petzval render with lens and focus, and "
      "picture files with their names. Films of known sizes have one scale in a row; other pictures are equally wide.",
      "petzval sheet");
  app.add_option("PICTURE", paths, "folders with picture.exr and render.json, and picture files (.png, .exr)")
      ->required();
  examples::add_count(app, "--columns", columns, {1, 100, "a whole number from 1 to 100"}, "pictures per row");
  app.add_option("--title", title, "title of the sheet")->capture_default_str();
  examples::add_out_file(
      app, balls,
      "adds enlarged highlights of three balls to the sheet, gives each picture its own exposure, and writes a CSV "
      "of the balls scene: for each highlight axis_ratio, the angle of its long axis to the radius, and its "
      "outward skewness; x_mm: position of the ball; beside: light of other spots near the ball, relative to the "
      "highlight; trusted: yes for complete highlights of at least 6 pixels that are far brighter than other spots",
      "CSV", "--balls");
  examples::add_out_file(app, out, "SVG to write", "FILE.svg")->required();
  return examples::run(app, argc, argv, [&] {
    examples::want_ending("--out", out, ".svg");
    std::vector<Picture> pictures;
    bool rendered = false, exr = false;
    for (const std::string& path : paths) {
      const Picture& p = pictures.emplace_back(read(path));
      if (!balls.empty() && !p.setup.has_value())
        throw petzval::Error("--balls: " + path + " is a file; must be a folder of petzval render");
      rendered |= p.setup.has_value(), exr |= p.own_exposure();
    }
    examples::Sheet sheet = sheet_of(pictures, title, columns, !balls.empty());
    if (rendered) {
      sheet.notes.push_back(balls.empty()
                                ? "petzval render: white is radiance 1 in the centre; scale bars on the film."
                                : "petzval render: each picture has its own exposure; scale bars on the film.");
    }
    if (exr) sheet.notes.emplace_back("Picture files in EXR: each has its own exposure.");
    if (!balls.empty()) add_highlights(sheet, pictures);
    examples::write_svg(examples::draw_sheet(sheet), out);
    std::cout << out << '\n';
    if (balls.empty()) return;
    examples::write_text(balls, ball_table(pictures));
    std::cout << balls << '\n';
  });
}
