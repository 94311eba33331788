// SPDX-License-Identifier: Apache-2.0
// Draws a contact sheet of the shapes that irises with blades give to a point of light out of focus.
//
//   bokeh_shapes --out out
#include <array>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/core/parallel.hpp"
#include "petzval/io/lens_json.hpp"
#include "petzval/media/glass.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/bokeh.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/text.hpp"

namespace {

constexpr int tile_pixels = 200;
constexpr std::array blade_counts{3, 4, 5, 6, 7, 8, 9};
constexpr double f_number = 4, focus_mm = 2000, light_mm = 10000;

struct Edges {
  const char* name;
  double roundness;
};
constexpr std::array all_edges{Edges{"straight", 0}, Edges{"rounded", 0.5}, Edges{"hollow", -0.5}};

/// The light through irises of 3 to 9 blades. half_width_mm: of a tile.
examples::SheetRow blades(const petzval::Lens& lens, const petzval::FieldPoint& light, const Edges& edges,
                          double half_width_mm, examples::Progress& progress) {
  examples::SheetRow row{.title = std::string(edges.name) + " edges",
                         .subtitle = "roundness " + examples::number(edges.roundness),
                         .pixel_mm = 2 * half_width_mm / tile_pixels,
                         .tiles = {}};
  for (const int count : blade_counts) {
    const std::string caption = std::to_string(count) + " blades";
    progress.step(caption + ", " + edges.name);
    const petzval::Iris iris{.blades = count, .roundness = edges.roundness};
    const auto image = petzval::point_image(petzval::with_iris(lens, iris), light,
                                            {.samples = 1 << 20,
                                             .pixels = tile_pixels,
                                             .half_width_mm = half_width_mm,
                                             .threads = petzval::processor_threads()});
    const double share = petzval::iris_area(iris) / petzval::iris_area({});
    row.tiles.push_back({examples::expose(examples::irradiance(image.psf)).picture,
                         {caption, "light: " + examples::number(100 * share, 3) + " %"}});
  }
  return row;
}

examples::Sheet sheet() {
  const auto file = petzval::data_directory() / "lenses" / "double_gauss_100mm_f2.0.json";
  const petzval::Lens open = petzval::compile(petzval::read_prescription(file));
  const petzval::Lens lens =
      petzval::with_focus(petzval::with_f_number(open, f_number), focus_mm, {.origin = petzval::DistanceOrigin::film});
  const petzval::FieldPoint light{0, lens.film_z() - light_mm};
  const double half_width_mm = 1.08 * petzval::point_image(lens, light, {.samples = 1 << 14}).size.max_radius;
  examples::Sheet result{
      "Bokeh of irises with blades",
      {},
      {lens.name() +
           " at f/4, focused at 2 m. A point of light at 10 m on the axis, as a photograph shows it. Each tile "
           "has its own exposure.",
       "Light: the area of the iris, of the round one's at the same f-number. The first corner points up, and all "
       "corners lie where the round iris ends."}};
  examples::Progress progress("bokeh shapes", all_edges.size() * blade_counts.size());
  for (const Edges& edges : all_edges) result.rows.push_back(blades(lens, light, edges, half_width_mm, progress));
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  std::string out_folder;
  examples::App app(
      "Draws bokeh_blades.png into DIR and prints its path: a point of light out of focus through the Tronnier double "
      "Gauss with 3 to 9 blades, whose edges are straight, rounded or hollow.",
      "bokeh_shapes");
  app.add_option("--out", out_folder, "folder for the sheet")->required()->type_name("DIR");
  return examples::run(app, argc, argv, [&] {
    const auto picture = examples::draw_sheet(sheet());
    const std::filesystem::path folder = out_folder;
    examples::make_folder(folder);
    petzval::write_png(picture, folder / "bokeh_blades.png");
    std::cout << (folder / "bokeh_blades.png").string() << '\n';
  });
}
