// SPDX-License-Identifier: Apache-2.0
// Lays out pictures of petzval render on a sheet and measures the highlights of the balls scene.
//
//   petzval sheet --columns 5 --title "Balls" --out balls.png --balls balls.csv FOLDER...
#include "commands.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/image/image.hpp"
#include "renderer/highlights.hpp"
#include "support/cli.hpp"
#include "support/contact_sheet.hpp"
#include "support/files.hpp"
#include "support/text.hpp"

namespace {

namespace fs = std::filesystem;
using examples::Json;
using examples::number;

struct Picture {
  fs::path folder;
  petzval::RgbImage image;
  Json job;

  /// The focus, and differences from an upright film behind the unmodified lens.
  std::vector<std::string> captions() const {
    const Json &mm = job.at("focus_mm"), &expressive = job.at("expressive");
    std::string from = job.at("distance_from");
    std::replace(from.begin(), from.end(), '_', ' ');
    const bool surface = !job.at("focal_surface").at("points").get<std::string>().empty();
    std::vector<std::string> lines{surface        ? "a focal surface"
                                   : mm.is_null() ? "focus infinity"
                                                  : "focus " + number(mm.get<double>()) + " mm from the " + from};
    const bool bent = !expressive.at("power_spline").empty() || !expressive.at("curvature_points").empty() ||
                      expressive.at("dispersion") != 1 || expressive.at("from_lens") != 0;
    if (job.at("tilt_deg") != 0 || job.at("swing_deg") != 0) lines.emplace_back("film tilted");
    if (bent) lines.emplace_back("expressive lens");
    return lines;
  }
  std::string lens() const {
    return job.at("lens").get<std::string>() + (job.at("model") == "pinhole" ? ", pinhole" : "");
  }
};

Picture read(const fs::path& folder) {
  Picture picture{folder, petzval::read_exr(folder / "picture.exr"), {}};
  try {
    picture.job = Json::parse(examples::read_text(folder / "render.json")).at("job");
    picture.captions(), picture.lens();
  } catch (const Json::exception&) {
    throw petzval::Error((folder / "render.json").string() + ": not a file of bokeh_scene");
  }
  return picture;
}

examples::Sheet sheet_of(const std::vector<Picture>& pictures, const std::string& title, std::size_t columns) {
  examples::Sheet sheet{title, {}, {}};
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Picture& p = pictures[i];
    if (p.image.width != pictures[0].image.width || p.image.height != pictures[0].image.height) {
      throw petzval::Error((p.folder / "picture.exr").string() + ": size = " + std::to_string(p.image.width) + " x " +
                           std::to_string(p.image.height) + " pixels; must be the same for all pictures");
    }
    if (i % columns == 0) {
      const std::string film = p.job.at("film_mm");
      const double width_mm = examples::parse_number("film", film.substr(0, film.find('x')), examples::positive_number);
      const auto end = pictures.begin() + static_cast<std::ptrdiff_t>(std::min(i + columns, pictures.size()));
      const bool same_lens = std::all_of(pictures.begin() + static_cast<std::ptrdiff_t>(i), end,
                                         [&](const Picture& other) { return other.lens() == p.lens(); });
      sheet.rows.push_back({same_lens ? p.lens() : "", "", width_mm / p.image.width, {}});
    }
    examples::SheetRow& row = sheet.rows.back();
    row.tiles.push_back({petzval::to_srgb8(p.image), p.captions()});
    if (row.title.empty()) row.tiles.back().captions.insert(row.tiles.back().captions.begin(), p.lens());
  }
  sheet.notes = {"petzval render: white is radiance 1 in the centre; scale bars on the film."};
  return sheet;
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
      csv +=
          '"' + p.lens() + "\"," + p.job.at("focus_mm").dump() + ',' + std::to_string(25 * (static_cast<int>(i) - 6));
      for (const double x : {h.x, h.y, h.axis_ratio, h.to_radius_deg, h.outward_skewness, h.light, h.neighbour_light})
        csv += ',' + number(x, 4);
      csv += h.trusted() ? ",yes\n" : ",no\n";
    }
  }
  return csv;
}

}  // namespace

int commands::sheet(int argc, char** argv) {
  std::vector<std::string> folders;
  std::string title = "Scenes through lenses", out, balls;
  std::uint32_t columns = 1;
  examples::App app(
      "Lays out pictures of petzval render on a sheet, in rows from the left. All pictures must have the same size.",
      "petzval sheet");
  app.add_option("FOLDER", folders, "folders with picture.exr and render.json")->required();
  examples::add_count(app, "--columns", columns, {1, 100, "a whole number from 1 to 100"}, "pictures per row");
  app.add_option("--title", title, "title of the sheet")->capture_default_str();
  examples::add_out_file(
      app, balls,
      "CSV of the balls scene: for each highlight axis_ratio, the angle of its long axis to the radius, and its "
      "outward skewness; x_mm: position of the ball; beside: light of other spots near the ball, relative to the "
      "highlight; trusted: yes for complete highlights of at least 6 pixels that are far brighter than other spots",
      "CSV", "--balls");
  examples::add_out_file(app, out, "PNG to write", "FILE.png")->required();
  return examples::run(app, argc, argv, [&] {
    examples::want_ending("--out", out, ".png");
    std::vector<Picture> pictures;
    for (const std::string& folder : folders) pictures.push_back(read(folder));
    petzval::write_png(examples::draw_sheet(sheet_of(pictures, title, columns)), out);
    std::cout << out << '\n';
    if (balls.empty()) return;
    examples::write_text(balls, ball_table(pictures));
    std::cout << balls << '\n';
  });
}
