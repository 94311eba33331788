// SPDX-License-Identifier: Apache-2.0
// Draws contact sheets of out-of-focus point lights, shaped by irises, cat's eyes and weights.
//
//   petzval shapes --out out
#include "commands.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/camera/bokeh.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/bokeh.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/svg_page.hpp"
#include "support/text.hpp"

namespace {

using examples::number;

constexpr double focus_mm = 2000, light_mm = 10000;  // from the front vertex

petzval::Lens lens_of_data(const std::string& id) {
  return petzval::compile(petzval::read_prescription(petzval::data_directory() / "lenses" / (id + ".json")));
}

petzval::Lens focused(const petzval::Lens& lens) { return petzval::with_focus(lens, focus_mm); }

std::uint32_t samples = 1 << 19;  // per tile

petzval::PsfOptions tile_options(double half_width_mm, std::size_t columns) {
  return {.samples = samples,
          .pixels = examples::tile_pixels(columns),
          .half_width_mm = half_width_mm,
          .threads = examples::threads()};
}

examples::Tile tile(const petzval::Psf& image, const std::vector<std::string>& captions) {
  return {examples::expose(examples::irradiance(image)).picture, captions, image.pixels * image.pixel_mm};
}

/// The Tronnier double Gauss at f/4, with a light on the axis.
struct AxialScene {
  petzval::Lens lens = focused(petzval::with_f_number(lens_of_data("double_gauss_100mm_f2.0"), 4));
  petzval::FieldPoint light{0, -light_mm};
  double half_width_mm = 1.08 * petzval::point_image(lens, light, {.samples = 1 << 14}).size.max_radius;
  std::string text = lens.name() +
                     " at f/4, focused at 2 m. A point light at 10 m on the axis, as in a photograph. Each tile has "
                     "its own exposure.";

  petzval::Psf image(petzval::ModelKind model, const petzval::BokehControls& controls, std::size_t columns) const {
    return petzval::point_image(examples::camera_of({lens, light}, {.model = model, .bokeh = controls}), light,
                                tile_options(half_width_mm, columns));
  }
};

examples::Sheet blades() {
  constexpr std::array counts{3, 4, 5, 6, 7, 8, 9};
  struct Edges {
    const char* name;
    double roundness;
  };
  constexpr std::array all_edges{Edges{"straight", 0}, Edges{"rounded", 0.5}, Edges{"hollow", -0.5}};
  const AxialScene scene;
  examples::Sheet sheet{
      "Bokeh of irises with blades",
      {},
      {scene.text,
       "Light: area of the iris relative to the round iris of the same f-number. The first corner points up, and all "
       "corners are on the edge of the round iris."}};
  for (const auto& [name, roundness] : all_edges) {
    auto& tiles =
        sheet.rows.emplace_back(examples::SheetRow{std::string(name) + " edges", "roundness " + number(roundness)})
            .tiles;
    for (const int count : counts) {
      const petzval::Iris iris{.blades = count, .roundness = roundness};
      const auto image = petzval::point_image(petzval::with_iris(scene.lens, iris), scene.light,
                                              tile_options(scene.half_width_mm, counts.size()));
      const double area_ratio = petzval::iris_area(iris) / petzval::iris_area(petzval::Iris{});
      tiles.push_back(tile(image, {std::to_string(count) + " blades", "light: " + number(100 * area_ratio, 3) + " %"}));
    }
  }
  return sheet;
}

/// Rows of a real lens, of the two discs fitted to it, and of a thin lens with the fit as controls.
examples::Sheet cats_eyes() {
  constexpr std::array fields_deg{0.0, 4.0, 7.0, 9.5, 11.5};
  constexpr double half_film_mm = 18;
  const petzval::Lens lens = focused(lens_of_data("double_gauss_100mm_f1.35"));
  const petzval::TwoDiscs discs = petzval::fit_two_discs(lens, half_film_mm);
  const petzval::BokehControls eye{.lens_ratio = discs.lens_ratio, .rate_of_change = discs.rate_of_change};
  const auto light = [&](double field_deg) { return petzval::FieldPoint{petzval::radians(field_deg), -light_mm}; };
  const double half_width_mm = 1.08 * petzval::point_image(lens, light(0), {.samples = 1 << 14}).size.max_radius;
  examples::Sheet sheet{
      "Cat's eyes over the field",
      {},
      {lens.name() + ", wide open, focused at 2 m. A point light at 10 m, as in a photograph. Each tile has its own "
                     "exposure.",
       "Light: relative to the axis. Two discs: lens ratio " + number(discs.lens_ratio, 3) + ", rate of change " +
           number(discs.rate_of_change, 3) + "; error of the pupil's shape: " + number(100 * discs.error, 2) +
           " % of its area on a film of 36 mm."}};
  struct Row {
    const char *title, *subtitle;
    petzval::ModelKind model;
    petzval::BokehControls controls;
  };
  for (const auto& [title, subtitle, model, controls] :
       {Row{"exact rays", "every surface of the lens", petzval::ModelKind::exact_double, {}},
        Row{"two discs",
            "a thin lens with two fitted discs, as bright as the lens",
            petzval::ModelKind::thin_two_disc,
            {}},
        Row{"thin lens", "with the lens ratio and the rate of change of the fit", petzval::ModelKind::thin, eye}}) {
    auto& tiles = sheet.rows.emplace_back(examples::SheetRow{title, subtitle}).tiles;
    double on_axis = 0;
    for (const double field : fields_deg) {
      const examples::BokehScene scene{lens, light(field)};
      const auto image = petzval::point_image(examples::camera_of(scene, {.model = model, .bokeh = controls}),
                                              scene.light, tile_options(half_width_mm, fields_deg.size()));
      if (on_axis == 0) on_axis = image.mean_throughput;
      tiles.push_back(
          tile(image, {number(field) + "°", "light: " + number(100 * image.mean_throughput / on_axis, 3) + " %"}));
    }
  }
  return sheet;
}

/// The second rim of a thin lens from smaller than the first rim to larger, on and off the axis.
examples::Sheet lens_ratios() {
  constexpr std::array ratios{0.2, 0.5, 0.7, 0.85, 1.0, 1.3, 2.0};
  constexpr double field_deg = 10, rate_of_change = -0.5;
  const petzval::Lens lens = focused(lens_of_data("double_gauss_100mm_f1.35"));
  examples::Sheet sheet{"Lens ratio from 0.2 to 2",
                        {},
                        {"A thin lens with two rims. Lens ratio: radius of the second rim divided by the radius of the "
                         "first. A far point light; each tile has its own exposure. Light: relative to a lens with one "
                         "rim, at the same field."}};
  for (const double field : {0.0, field_deg}) {
    const examples::BokehScene scene{lens, {petzval::radians(field), -light_mm}};
    const auto image = [&](const petzval::BokehControls& controls, const petzval::PsfOptions& options) {
      return petzval::point_image(examples::camera_of(scene, {.model = petzval::ModelKind::thin, .bokeh = controls}),
                                  scene.light, options);
    };
    const petzval::Psf open = image({}, {.samples = samples});
    const double half_width_mm = 1.08 * open.size.max_radius;
    auto& tiles = sheet.rows
                      .emplace_back(examples::SheetRow{
                          field == 0 ? "on the axis" : number(field) + "\u00b0 off the axis",
                          "rate of change " + number(rate_of_change) +
                              ": the second rim moves with the distance from the centre of the film"})
                      .tiles;
    for (const double ratio : ratios) {
      const petzval::Psf eye =
          image({.lens_ratio = ratio, .rate_of_change = rate_of_change}, tile_options(half_width_mm, ratios.size()));
      tiles.push_back(tile(eye, {"ratio " + number(ratio),
                                 "light: " + number(100 * eye.mean_throughput / open.mean_throughput, 3) + " %"}));
    }
  }
  return sheet;
}

/// Rows for the kinds of edge weights.
examples::Sheet weights() {
  const AxialScene scene;
  examples::Sheet sheet{
      "Weights of the rim",
      {},
      {scene.text,
       "Weight 1 + p (d + 1) x^d - p; x: fraction of the iris area nearer to its centre, or for d below "
       "0 farther out."}};
  const auto add_row = [&](const std::string& title, const std::vector<petzval::EdgeWeight>& edges, int blades) {
    auto& tiles = sheet.rows.emplace_back(examples::SheetRow{title, ""}).tiles;
    for (const auto& [d, p] : edges) {
      const auto image = scene.image(petzval::ModelKind::exact_float,
                                     {.blades = blades, .weight_distribution = d, .weight_strength = p}, edges.size());
      tiles.push_back(tile(image, {"d = " + number(d), "p = " + number(p)}));
    }
  };
  std::vector<petzval::EdgeWeight> middle, rim, thin;
  for (const double p : {0.8, 0.6, 0.4, 0.2, 0.0}) middle.push_back({-4, p}), rim.push_back({4, p});
  for (const double d : {5.5, 8.7, 12.7, 20.7, 50.7}) thin.push_back({d, 0.6});
  add_row("bright middle", middle, 0);
  add_row("bright rim", rim, 0);
  add_row("thin rim", thin, 0);
  add_row("thin rim, six blades", thin, 6);
  return sheet;
}

/// A heart with an edge that is soft over a pixel.
petzval::IrisMap heart() {
  constexpr int pixels = 256;
  petzval::IrisMap map{pixels, pixels, {}};
  for (int i = 0; i < pixels * pixels; ++i) {
    const double x = 1.35 * (2 * (i % pixels) + 1 - pixels) / pixels;
    const double y = 1.35 * (pixels - 1 - 2 * (i / pixels)) / pixels + 0.1;
    const double a = x * x + y * y - 1;
    map.values.push_back(a * a * a - x * x * y * y * y < 0 ? 1.0f : 0.0f);
  }
  return map;
}

examples::Sheet maps() {
  const AxialScene scene;
  examples::Sheet sheet{"Weight maps of the stop", {}, {scene.text}};
  struct Shown {
    petzval::IrisMap map;
    std::string title, subtitle;
  };
  const std::vector<Shown> shown{
      {petzval::onion_rings({.period = 0.06, .contrast = 0.25}), "onion rings", "period .06, contrast .25"},
      {petzval::onion_rings({.period = 0.1, .contrast = 0.5, .jitter = 0.3}), "onion rings", "period .1, contrast .5"},
      {heart(), "an image as iris", "a heart"}};
  const auto add_row = [&](petzval::ModelKind model, const std::string& title) {
    auto& tiles = sheet.rows.emplace_back(examples::SheetRow{title, ""}).tiles;
    for (const auto& [map, caption, below] : shown) {
      petzval::BokehControls controls;
      controls.weight_map = map;
      tiles.push_back(tile(scene.image(model, controls, shown.size()), {caption, below}));
    }
  };
  add_row(petzval::ModelKind::exact_float, "exact rays");
  add_row(petzval::ModelKind::thin, "thin lens");
  return sheet;
}

}  // namespace

int commands::shapes(int argc, char** argv) {
  std::string out_folder;
  examples::App app(
      "Draws contact sheets of an out-of-focus point light into DIR and prints their paths: bokeh_blades.svg (3 to 9 "
      "blades, straight, rounded and hollow), bokeh_cats_eyes.svg (a lens over its field compared with two fitted "
      "discs), bokeh_lens_ratio.svg (a second rim from 0.2 to 2 times as large), bokeh_weights.svg (weights of the "
      "rim) and bokeh_maps.svg (onion rings, an image as iris).",
      "petzval shapes");
  examples::add_out_folder(app, out_folder, "folder for the sheets")->required();
  examples::add_samples(app, samples);
  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] {
    struct Picture {
      const char *file, *caption;
      std::function<examples::Sheet()> sheet;
    };
    const std::filesystem::path folder = out_folder;
    examples::make_folder(folder);  // fail before the drawing, which takes seconds
    const std::array<Picture, 5> all{{{"bokeh_blades.svg", "blades", blades},
                                      {"bokeh_cats_eyes.svg", "cat's eyes", cats_eyes},
                                      {"bokeh_lens_ratio.svg", "lens ratios", lens_ratios},
                                      {"bokeh_weights.svg", "weights", weights},
                                      {"bokeh_maps.svg", "maps", maps}}};
    examples::Progress progress("bokeh shapes", all.size());
    std::vector<std::string> pictures;
    for (const auto& [file, caption, sheet] : all) {
      progress.step(caption);
      pictures.push_back(examples::draw_sheet(sheet()));
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      examples::write_svg(pictures[i], folder / all[i].file);
      std::cout << (folder / all[i].file).string() << '\n';
    }
  });
}
