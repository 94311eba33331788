// SPDX-License-Identifier: Apache-2.0
// Focus by clicking: lens blur in a window, or the replay of a log of its events.
//
//   petzval view --scene town double_gauss_52mm_f1.8
//   petzval view --replay log.json --json --out out
#include <cmath>
#include <string>

#include "commands.hpp"
#include "layers/layer_input.hpp"
#include "layers/lens_setup.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/json_input.hpp"
#include "support/load_lens.hpp"
#include "viewer/replay.hpp"
#include "viewer/session.hpp"
#include "viewer/window.hpp"

namespace {

/// The set-up of an editor, which measures distances from the front vertex.
petzval::CameraSetup for_editor(examples::CameraFlags flags) {
  auto& wavelengths = flags.lens.wavelengths_nm;
  if (wavelengths.empty()) wavelengths = {petzval::d_line_nm};
  const petzval::Lens compiled = examples::load_lens(flags, wavelengths).lens;
  petzval::CameraSetup setup = flags.used_with(compiled);
  if (setup.focus_mm && std::isfinite(*setup.focus_mm)) {
    *setup.focus_mm -= petzval::origin_z(petzval::prepared(setup, compiled), setup.focus.origin);
  }
  setup.focus = {};
  return setup;
}

}  // namespace

int commands::view(int argc, char** argv) {
  viewer::WindowOptions window;
  viewer::ReplayOptions replay;
  lens_blur::InputFlags& input = window.session.input;
  examples::CameraFlags setup;
  setup.focus_mm.reset();
  examples::App app(
      "Lens blur in a window: click into the picture to focus. --replay computes the same without a window from a log "
      "of events: a state for each event, and DIR/event_0001.png and so on. Events that are refused, or whose state "
      "has no picture, are reported, the others go on, and the exit status is 1.",
      "petzval view");
  lens_blur::add_input(app, input, window.session.fov_deg, window.session.layers);
  examples::add_setup(app, setup);
  app.add_option("LENS", setup.lens.file, "shipped lens (petzval lenses) or lens file")
      ->default_str("double_gauss_52mm_f1.8");
  examples::add_thin_lens(app, setup.lens.thin_mm);
  examples::add_number(app, "--f-number", setup.f_number, examples::positive_number,
                       "f-number of the thin lens, or of LENS")
      ->default_str("LENS: wide open");
  lens_blur::add_ghosts(app, window.session.ghosts, "To first order until the picture is still");
  auto* log =
      app.add_option("--replay", replay.log_file, "replay a log of events, without a window")->type_name("LOG.json");
  app.add_flag("--json", replay.json, "print states as JSON, one in each line")->needs(log);
  examples::add_count(app, "--rays", replay.rays, {1, 16384, "a whole number from 1 to 16384"},
                      "rays per pixel of the picture after each event; `still` has those of petzval blur")
      ->needs(log);
  app.add_option("--log", window.log_file, "file for the log of events of the window")
      ->type_name("LOG.json")
      ->default_str("petzval-view.json");
  app.add_option(
         "--panels", window.panels,
         "what the window shows at the start: focus, points, lens, bokeh, aberrations, keys, histogram; map (blur "
         "over the picture), sharp (the picture of a pinhole)")
      ->type_name("NAME,...")
      ->delimiter(',');
  examples::add_out_file(
      app, window.screenshot,
      "write a picture of the window when all rays are traced, and close it; with --replay after its "
      "events",
      "PICTURE.png", "--screenshot");
  examples::add_threads(app);
  examples::add_out_folder(app, window.out_folder, "folder for pictures");
  return examples::run(app, argc, argv, [&] {
    window.session.threads = examples::threads();
    if (!replay.log_file.empty()) {
      const bool scene_given = !input.scene.empty() || !input.image.empty() || !input.deep.empty();
      if (scene_given || app.given("LENS") || app.given("--thin-lens") || app.given("--setup")) {
        throw petzval::Error("--replay: the log names the scene and the lens; must be used without them");
      }
      const examples::Json events = examples::read_json(replay.log_file);
      viewer::SessionOptions session = viewer::options_of(events, replay.log_file);
      session.threads = window.session.threads, session.layers = window.session.layers;
      if (input.width > 0) session.input.width = input.width, session.input.height = input.height;
      if (window.screenshot.empty()) {
        replay.session = session, replay.events = viewer::events_of(events, replay.log_file);
        replay.out_folder = window.out_folder;
        viewer::replay(replay);
      } else {
        window.session = session, window.first_events = viewer::events_of(events, replay.log_file);
        viewer::show_window(window);
      }
      return;
    }
    if (input.scene.empty() && input.image.empty() && input.deep.empty()) input.scene = "town";
    petzval::LensSource& lens = setup.lens;
    if (lens.thin_mm > 0 && !lens.file.empty()) {
      throw petzval::Error("lens: LENS and --thin-lens are given; must be one of them");
    }
    if (lens.thin_mm > 0 && !setup.f_number) throw petzval::Error("--thin-lens needs --f-number");
    if (!(lens.thin_mm > 0) && setup.file.empty() && lens.file.empty()) lens.file = "double_gauss_52mm_f1.8";
    if (lens.thin_mm > 0 && window.session.ghosts > 0) {
      throw petzval::Error("--ghosts with --thin-lens, which has no surfaces; must be a lens of surfaces");
    }
    window.session.setup = for_editor(setup);
    if (window.log_file.empty()) window.log_file = "petzval-view.json";
    viewer::show_window(window);
  });
}
