// SPDX-License-Identifier: Apache-2.0
// Repeats figure 7 of Wu et al. 2010, "Realistic rendering of bokeh effect based on optical aberrations": a point light
// at 1000 mm through three double Gauss lenses and a fourth double Gauss, focused at five distances.
//
//   wu_figure7 --out wu_figure7.svg
#include <algorithm>
#include <array>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/glass/glass.hpp"
#include "support/bokeh.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/svg_page.hpp"
#include "support/wu2010.hpp"

namespace {

examples::SheetRow sheet_row(const examples::WuRow& wu, const examples::BokehSetup& setup, std::uint32_t samples,
                             examples::Progress& progress) {
  const auto file = petzval::data_directory() / "lenses" / (std::string(wu.lens) + ".json");
  const auto loaded = examples::load_lens({.file = file.string()}, std::array{petzval::d_line_nm});
  examples::SheetRow row{wu.title, wu.subtitle};
  for (const double focus : examples::wu_focus_mm) {
    progress.step(std::string(wu.lens) + ", " + examples::focus_caption(focus));
    const auto scene = examples::focused_scene(loaded.lens, focus, setup);
    const auto image = petzval::point_image(scene.lens, scene.light,
                                            {.samples = samples,
                                             .pixels = examples::tile_pixels(examples::wu_focus_mm.size()),
                                             .threads = examples::threads()});
    row.tiles.push_back(examples::bokeh_tile(focus, image, examples::expose(examples::irradiance(image))));
  }
  return row;
}

}  // namespace

int main(int argc, char** argv) {
  std::string out_file;
  petzval::FocusCriterion criterion = petzval::FocusCriterion::min_rms;
  std::uint32_t samples = 1u << 21;
  examples::App app(
      "Repeats figure 7 of Wu et al. 2010: a point light at 1000 mm from the front vertex, on axis, at the d line, "
      "through four double Gauss lenses focused at 800 to 1200 mm. One SVG.",
      "wu_figure7");
  examples::add_criterion(app, criterion);
  examples::add_samples(app, samples);
  examples::add_out_file(app, out_file, "picture to write", "FILE.svg")->required();

  return examples::run(app, argc, argv, [&] {
    examples::want_ending("--out", out_file, ".svg");
    const examples::BokehSetup setup{.light_mm = examples::wu_light_mm, .focus = {.criterion = criterion}};
    examples::Sheet sheet{"A point light at 1000 mm at five focus distances", {}, {}};
    {
      examples::Progress progress("figure 7", examples::wu_rows().size() * examples::wu_focus_mm.size());
      for (const examples::WuRow& wu : examples::wu_rows()) {
        sheet.rows.push_back(sheet_row(wu, setup, samples, progress));
      }
    }
    sheet.notes = {
        "After figure 7 of Wu et al. 2010. On axis, 587.56 nm, wide open; distances from the front vertex; film "
        "focused "
        "by " +
        examples::in_words(criterion) + "."};
    for (const std::string& note : examples::bokeh_notes()) sheet.notes.push_back(note);
    examples::write_svg(examples::draw_sheet(sheet), out_file);
    std::cout << out_file << '\n';
  });
}
