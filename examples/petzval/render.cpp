// SPDX-License-Identifier: Apache-2.0
// Renders a scene through a lens by path, light or bidirectional path tracing.
//
//   petzval render --scene chess data/lenses/double_gauss_100mm_f2_28deg.json --model exact_float --focus 950
//               --integrator bidirectional --spp 256 --out chess
//   petzval render --scene room.json data/lenses/double_gauss_52mm_f1.8.json --model auto --spp 64 --focus 2000
//               --wavelengths hero --out room
#include "commands.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/image/image.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/f_number.hpp"
#include "renderer/built_in_scenes.hpp"
#include "renderer/checkpoint.hpp"
#include "renderer/first_hits.hpp"
#include "renderer/ghosts.hpp"
#include "renderer/outputs.hpp"
#include "renderer/render.hpp"
#include "renderer/scene_checksum.hpp"
#include "renderer/scene_json.hpp"
#include "renderer/scene_model.hpp"
#include "renderer/shards.hpp"
#include "support/bokeh.hpp"
#include "support/bokeh_flags.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/focus_points.hpp"
#include "support/interrupt.hpp"
#include "support/lens_light.hpp"
#include "support/load_lens.hpp"
#include "support/model_rows.hpp"
#include "support/picture_files.hpp"
#include "support/text.hpp"

namespace {

namespace fs = std::filesystem;
using examples::Json;

constexpr std::uint32_t usual_width = 600;
/// Luminance below which noise is absolute, relative to white.
constexpr double noise_floor = 0.05;

struct Options {
  std::string scene, integrator = "bidirectional", wavelengths, coatings, out_folder;
  examples::CameraFlags setup;
  examples::Shard shard;
  std::vector<std::string> formats{"exr", "png"};
  std::uint32_t samples = 0, width = 0, height = 0, seed = 0, ghosts = 0;  // width, height 0: not given
  double budget_px = 0, seconds = 0, noise = 0, exposure = 1;
  bool choose_model = false, resume = false;
};

void say(const fs::path& file) { std::cout << file.string() << '\n'; }

/// The --wavelengths of a lens that is compiled for wavelengths.
std::string wavelengths_of(const std::vector<double>& nm) {
  for (const char* const mode : {"d", "rgb"}) {
    const renderer::PathColourSource colours(*renderer::colour_mode_named(mode));
    if (nm.empty() || std::ranges::is_permutation(colours.compiled_nm(), nm)) return mode;
  }
  const bool one = nm.size() == 1 || (nm.size() == 2 && nm.back() == petzval::d_line_nm);
  return one ? examples::number(nm.front()) : "hero";
}

petzval::CameraSetup setup_of(const Json& job) { return petzval::camera_setup(job.at("setup").dump(), "job"); }

/// Writes picture.*, render.json and tiles.json. job: all inputs of the numbers; about: entries of render.json.
void write_results(const renderer::PictureSums& sums, Json job, const Json& about,
                   const std::vector<std::string>& formats, const fs::path& folder, double exposure = 1) {
  const petzval::CameraSetup setup = setup_of(job);
  const std::map<std::string, std::string> texts{
      {"lens", job.at("lens")},
      {"lensModel", job.at("lens")},
      {"model", std::string(petzval::name(setup.camera.model))},
      {"integrator", job.at("integrator")},
      {"wavelengths", wavelengths_of(setup.lens.wavelengths_nm)},
      {"normalisation", std::string(petzval::name(setup.camera.normalisation))},
      {"distanceFrom", std::string(petzval::name(setup.focus.origin))},
      {"petzval", job.at("petzval")}};
  const std::map<std::string, double> numbers{{"fNumber", job.at("real_f_number")},
                                              {"aperture", job.at("real_f_number")},
                                              {"focus", *setup.focus_mm / 1000},  // m
                                              {"focusMm", *setup.focus_mm},
                                              {"white", job.at("white")},
                                              {"seed", job.at("seed")}};
  const double white_level = job.at("white");
  const auto white = static_cast<float>(exposure / white_level);
  for (const fs::path& file : renderer::write_pictures(sums, texts, numbers, formats, folder, white)) {
    say(file);
  }
  if (sums.rejected() > 0) {
    std::cerr << "note: " << sums.rejected() << " contributions were rejected: not finite, or beyond 2^40\n";
  }
  Json report{{"setup", job.at("setup")}}, numbers_of_sums = renderer::statistics(sums, noise_floor * white_level);
  examples::write_text(folder / "tiles.json", numbers_of_sums["tiles"].dump() + '\n');
  numbers_of_sums.erase("tiles"), job.erase("setup");
  report.update(about), report.update(numbers_of_sums);
  if (const std::uint32_t lights = job.value("ghosts", 0u); lights > 0) {
    const auto light = [](const petzval::RgbImage& image) {
      return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
    };
    const double fraction = light(renderer::picture_with_ghosts(sums)) / light(sums.picture()) - 1;
    report["ghosts"].update({{"lights", lights}, {"fraction", examples::finite_or_null(fraction)}});
  }
  report["job"] = std::move(job);
  examples::write_text(folder / "render.json", report.dump(1) + '\n');
  say(folder / "tiles.json"), say(folder / "render.json");
}

std::string file_checksum(const std::string& file) {
  return file.empty() ? "" : petzval::checksum(examples::read_text(file));
}

/// The scene, the lens and all options that determine the picture.
class Job {
 public:
  explicit Job(const Options& options)
      : options_(options),
        integrator_(*renderer::integrator_named(options.integrator)),
        colours_(colours_named(options.wavelengths)),
        scene_(description(options)),
        loaded_(examples::load_lens(options.setup, colours_.compiled_nm())),
        lens_(examples::focused(loaded_, options.setup)),
        setup_(options.setup.used_with(loaded_.lens)) {
    setup_.lens.wavelengths_nm.assign(colours_.compiled_nm().begin(), colours_.compiled_nm().end());
    setup_.film = options.setup.sized_film(options.width, options.height, usual_width);
    setup_.camera.threads = examples::threads();
    setup_.camera.bokeh = examples::controls_of(options.setup);
    if (!options.coatings.empty()) {
      lens_ = *examples::coated(lens_, options.coatings);
      setup_.coating.reset(), setup_.camera.transmission = true;
      if (options.coatings != "file") setup_.coating = examples::coating_named(options.coatings);
    } else if (setup_.coating) {
      lens_ = petzval::with_coating(lens_, *setup_.coating);
    }
    if (!scene_.has_light()) std::cerr << "note: " << options.scene << " has no light source: the picture is black\n";
    examples::say_what_does_not_fit(lens_, setup_.film);
    if (options.ghosts > 0 && beyond_the_lens()) {
      throw petzval::Error("--ghosts = " + std::to_string(options.ghosts) +
                           "; must not be used with a focal surface or an expressive lens, which have no surfaces");
    }
    choose_model();
    if (!options.setup.points_file.empty()) read_points();
    if (!setup_.camera.expressive.dispersion.empty() && options.wavelengths == "d") {
      std::cerr << "note: --dispersion has an effect only with --wavelengths rgb or hero\n";
    }
    setup_.camera.expressive = examples::expressive_of(options.setup, lens_, setup_.film);
  }

  /// @throws petzval::Error  if the lens cannot be focused
  static void check_focus(const Options& options) {
    examples::focused(examples::load_lens(options.setup, colours_named(options.wavelengths).compiled_nm()),
                      options.setup);
  }

  /// Renders and writes the results.
  void run() {
    const renderer::LensCamera lens = camera(setup_);
    refuse_walls(lens);
    say_where_focus_is_steep(lens.camera());
    const fs::path folder = options_.out_folder;
    const fs::path file = renderer::checkpoint_file(folder, options_.shard);
    Json job = description_of_numbers(lens.camera());
    renderer::PictureSums sums(setup_.film.columns, setup_.film.rows);
    if (options_.resume && examples::exists(file)) {
      sums = resumed(file, job);
    } else if (options_.resume) {
      std::cerr << "note: " << file.string() << " does not exist: the picture starts from the beginning\n";
    } else if (examples::exists(file)) {
      const fs::path kept = fs::path(file).replace_extension(".before.exr");
      examples::rename(file, kept);
      std::cerr << "note: without --resume the picture starts from the beginning; the old sums are kept in "
                << kept.string() << '\n';
    }
    examples::make_folder(folder);
    std::vector<std::size_t> tiles;
    for (std::size_t t = 0; t < sums.tiles(); ++t) {
      if (options_.shard.has(t)) tiles.push_back(t);
    }
    const renderer::UnitTracer tracer(scene_, lens, colours_, integrator_, options_.seed);
    renderer::PictureSums::Channels guides = sums.guides();
    std::erase_if(guides, [](const auto& channel) { return channel.first.starts_with("ghosts."); });
    if (guides.empty()) guides = renderer::first_hits(tracer, sums, tiles, examples::threads());
    double ghost_seconds = 0;
    if (options_.ghosts > 0) {
      const renderer::Stopwatch watch(ghost_seconds);
      petzval::CameraSetup radiometric = setup_;
      radiometric.camera.normalisation = petzval::Normalisation::irradiance;
      radiometric.film.shift_x_mm = radiometric.film.shift_y_mm = 0;
      const double scale =
          job.at("white").get<double>() / examples::irradiance_on_axis(petzval::camera(radiometric, lens_));
      const auto lights = renderer::ghost_lights(scene_, lens, options_.ghosts, options_.seed, examples::threads());
      guides.merge(renderer::ghosts(lens.camera(), lights, colours_, scale, examples::threads()));
    }
    sums.set_guides(std::move(guides));
    renderer::Effort effort = this->effort(job.at("white"));
    if (effort.seconds) *effort.seconds = std::max(*effort.seconds - ghost_seconds, 0.02);  // one pass
    const renderer::RenderReport report = [&] {
      const examples::Interrupt interrupt;
      return renderer::render(
          tracer, sums, tiles, effort, examples::threads(), [&] { renderer::Checkpoint::write(sums, job, file); },
          [] { return examples::Interrupt::asked(); });
    }();
    say(file);
    if (report.finished && options_.noise > 0) say_noise(sums, job.at("white"));
    if (!report.finished && !report.interrupted) {
      std::cerr << "note: out of time; the same command with --resume continues\n";
    }
    if (options_.shard.count > 1) return;
    Json about{{"model", petzval::name(chosen_.model)},
               {"why", chosen_.why},
               {"seconds", report.seconds},
               {"lens_seconds_share", report.busy_seconds > 0 ? report.lens_seconds / report.busy_seconds : 0},
               {"paths", report.paths},
               {"paths_per_second", report.seconds > 0 ? static_cast<double>(report.paths) / report.seconds : 0},
               {"finished", report.finished && !report.interrupted}};
    if (options_.ghosts > 0) about["ghosts"]["seconds"] = ghost_seconds;
    write_results(sums, job, about, options_.formats, folder, options_.exposure);
  }

  petzval::ModelKind model() const noexcept { return chosen_.model; }

 private:
  static renderer::PathColourSource colours_named(const std::string& text) {
    if (const auto mode = renderer::colour_mode_named(text)) return renderer::PathColourSource(*mode);
    const std::string rule =
        "--wavelengths = \"" + text +
        "\"; must be d, rgb, hero, visible (the same as hero), or one wavelength in nm or as a spectral line like F";
    try {
      const std::vector<double> nm = examples::parse_wavelengths("--wavelengths", text);
      if (nm.size() == 1) return renderer::PathColourSource(nm.front());
    } catch (const petzval::Error&) {
      throw petzval::Error(rule);
    }
    throw petzval::Error(rule);
  }
  static renderer::SceneDescription description(const Options& options) {
    if (options.scene.ends_with(".json")) return renderer::read_scene(options.scene);
    if (auto scene = renderer::built_in_scene(options.scene)) return std::move(*scene);
    throw petzval::Error("--scene = \"" + options.scene + "\"; must be " + std::string(renderer::built_in_scene_names) +
                         " or a file that ends in .json (petzval blur and view have other scenes)");
  }
  renderer::LensCamera camera(const petzval::CameraSetup& setup) const {
    return {petzval::camera(setup, lens_), scene_.description().pose};
  }
  /// Reads the points of the focal surface, projected by the model.
  void read_points() {
    setup_.focal_points.clear();
    const renderer::LensCamera lens = camera(setup_);
    examples::read_focal_surface(options_.setup.points_file, setup_, lens.camera(),
                                 [&](const petzval::Vec3<double>& world) { return lens.to_lens(world); });
  }
  void say_where_focus_is_steep(const petzval::Camera& camera) const {
    petzval::FilmPoint steepest;
    if (camera.focal_steepness(&steepest) < 1 || integrator_ == renderer::Integrator::path) return;
    const petzval::Vec2<double> pixel = setup_.film.raster(steepest);
    std::cerr << "note: near pixel (" << examples::number(pixel.x, 3) << ", " << examples::number(pixel.y, 3)
              << ") the focal surface is so steep that rays of several film points coincide; light paths count only "
                 "one of them: --integrator path includes all their light\n";
  }
  void say_noise(const renderer::PictureSums& sums, double white) const {
    double largest = 0;
    std::size_t above = 0;
    for (const auto& tile : sums.noise()) {
      const double own = tile.relative(noise_floor * white);
      largest = std::max(largest, own), above += !(own <= options_.noise);
    }
    if (above == 0) return;
    std::cerr << "note: --noise " << examples::number(options_.noise) << ": " << above << " of " << sums.tiles()
              << " tiles are above it after --spp " << options_.samples << "; the largest noise is "
              << examples::number(largest, 3) << '\n';
  }
  /// Reads the sums of a picture to be continued, which may get more samples than before.
  static renderer::PictureSums resumed(const fs::path& file, Json& job) {
    Json found;
    renderer::PictureSums sums = renderer::Checkpoint::read_any(file, found);
    // Uniform samples may continue with --noise. The reverse is refused: light paths of tiles exceed their film
    // samples.
    const bool with_noise = !job.at("noise").is_null();
    const auto without_samples = [&](Json of) {
      of.erase("samples"), of.erase("ghosts");
      if (with_noise) of.erase("noise");
      return of;
    };
    renderer::refuse_other_job(file, without_samples(found), without_samples(job));
    const Json had = found.value("samples", Json()), asked = job.at("samples");
    if (had.is_number() && asked.is_number() && had > asked) {
      std::cerr << "note: " << file.string() << ": --spp = " << asked << "; the picture keeps its " << had
                << " samples\n";
      job["samples"] = had;
    }
    return sums;
  }
  renderer::Effort effort(double white) const {
    renderer::Effort effort;
    if (options_.samples > 0) effort.samples = options_.samples;
    if (options_.seconds > 0) effort.seconds = options_.seconds;
    if (options_.noise > 0) effort.noise = options_.noise;
    effort.floor = noise_floor * white;
    return effort;
  }

  void choose_model() {
    if (!options_.choose_model) {
      const std::string model(petzval::name(setup_.camera.model));
      if (options_.budget_px > 0) throw petzval::Error("--budget with --model " + model + "; must be --model auto");
      chosen_ = {setup_.camera.model, {"--model " + model}};
      return;
    }
    chosen_ = chosen();
    setup_.camera.model = chosen_.model;
  }
  /// True if the camera has a focal surface or an expressive lens.
  bool beyond_the_lens() const noexcept {
    return !options_.setup.points_file.empty() || !setup_.focal_points.empty() || options_.setup.from_lens != 0 ||
           !setup_.camera.expressive.empty();
  }
  renderer::ModelForScene chosen() const {
    if (beyond_the_lens()) {
      throw petzval::Error(
          "--model auto: a focal surface or an expressive lens needs a first-order model by name: pinhole, thin, "
          "thin_two_disc or thick");
    }
    // Errors near a limit may differ in their last digits between machines.
    if (options_.shard.count > 1) {
      throw petzval::Error("--model auto with --shard " + options_.shard.text() +
                           "; must be a model by name, the same for all shards");
    }
    const fs::path file = renderer::checkpoint_file(options_.out_folder, options_.shard);
    if (options_.resume && examples::exists(file)) {
      Json job;
      renderer::Checkpoint::read_any(file, job);
      const petzval::ModelKind before = setup_of(job).camera.model;
      return {before, {std::string(petzval::name(before)) + " was chosen at the start of the picture"}};
    }
    if (options_.budget_px == 0 && options_.samples == 0) {
      throw petzval::Error("--model auto with --time needs --budget or --spp for the choice");
    }
    petzval::CameraSetup setup = setup_;
    setup.camera.model = petzval::ModelKind::exact_float;
    const renderer::LensCamera exact = camera(setup);
    refuse_walls(exact);
    renderer::ModelForScene found =
        options_.budget_px > 0
            ? renderer::model_within(scene_, exact, options_.budget_px, examples::threads())
            : renderer::model_below_noise(scene_, exact, colours_, integrator_, options_.samples, examples::threads());
    std::cerr << "note: model " << petzval::name(found.model) << '\n' << examples::bullets(found.why);
    return found;
  }
  void refuse_walls(const renderer::LensCamera& lens) const {
    if (const renderer::Object* const wall = scene_.around(lens.front())) {
      throw petzval::Error(options_.scene + ": the camera is inside " + wall->name +
                           "; must be outside all solids (a room is a mesh that faces inwards, or quads)");
    }
  }

  Json description_of_numbers(const petzval::Camera& camera) const {
    double white = 1;
    if (setup_.camera.normalisation == petzval::Normalisation::irradiance) white = examples::irradiance_on_axis(camera);
    std::string glasses;
    for (const std::string& file : setup_.lens.glass_files) glasses += file_checksum(file);
    return {{"scene", renderer::checksum(scene_.description())},
            {"lens", lens_.name()},
            {"prescription", petzval::checksum(petzval::format_prescription(loaded_.prescription))},
            {"glasses", glasses},
            {"iris_map", file_checksum(setup_.iris_map)},
            {"integrator", options_.integrator},
            {"white", white},
            {"real_f_number", petzval::real_f_number(lens_)},
            {"seed", options_.seed},
            {"sequence", "16 rounds of Owen-Sobol points"},
            {"ghosts", options_.ghosts},
            {"noise", options_.noise > 0 ? Json(options_.noise) : Json()},
            {"samples", options_.samples > 0 ? Json(options_.samples) : Json()},
            {"petzval", PETZVAL_VERSION},
            {"setup", Json::parse(petzval::to_json(setup_))}};
  }

  Options options_;
  renderer::Integrator integrator_;
  renderer::PathColourSource colours_;
  renderer::Scene scene_;
  examples::LoadedLens loaded_;
  petzval::Lens lens_;
  petzval::CameraSetup setup_;  ///< of the picture
  renderer::ModelForScene chosen_;
};

/// Renders one picture, or the frames of a focus pull.
void render_frames(Options options) {
  const examples::FocusPull& pull = options.setup.pull;
  const std::uint32_t count = options.setup.frame_count();
  if (count > 1 && !pull.moves()) {
    throw petzval::Error("--frames = " + std::to_string(count) + ": must be used with --focus A:B or KEYS.json");
  }
  const fs::path folder = options.out_folder;
  if (pull.moves()) {  // a distance out of reach is refused before the first frame
    options.setup.focus_mm = pull.nearest_mm();
    Job::check_focus(options);
  }
  for (std::uint32_t frame = 0; frame < count; ++frame) {
    if (count > 1) {
      options.out_folder = (folder / ("frame_" + examples::frame_number(frame))).string();
      options.setup.focus_mm = pull.distance_mm(frame, count);
    }
    Job job(options);
    job.run();
    examples::end_if_asked();
    // Models of different frames must not differ.
    options.setup.camera.model = job.model(), options.choose_model = false, options.budget_px = 0;
  }
}

/// Runs: petzval render merge FOLDER... --out DIR
int merge(int argc, char** argv) {
  std::vector<std::string> folders, formats{"exr", "png"};
  std::string out_folder;
  examples::App app(
      "Merges the shards of a picture, each rendered with --shard I/N, bit for bit as one run. Writes picture.*, "
      "tiles.json and render.json to DIR.",
      "petzval render merge");
  app.add_option("FOLDER", folders, "folders with tile_I_of_N.exr")->required();
  examples::add_formats(app, formats, "png (sRGB)");
  examples::add_out_folder(app, out_folder)->required();
  return examples::run(app, argc, argv, [&] {
    Json job;
    const renderer::PictureSums sums = renderer::gather({folders.begin(), folders.end()}, job);
    examples::make_folder(out_folder);
    write_results(sums, job,
                  {{"model", petzval::name(setup_of(job).camera.model)}, {"why", Json::array({"merged from shards"})}},
                  formats, out_folder);
  });
}

}  // namespace

int commands::render(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "merge") return merge(argc - 1, argv + 1);
  Options options;
  examples::App app(
      "Renders a scene through a lens. World: right-handed, y up, mm; the entrance pupil is at the position of the "
      "scene's camera. Writes picture.* to DIR (linear Rec. 709; a sky of radiance 1 gives 1 in the centre, or "
      "irradiance with --normalisation irradiance) and render.json: the set-up of the camera for --setup, model and "
      "reasons, samples, seconds, fraction of the time spent in the lens, mean radiance with standard errors; and "
      "tiles.json: luminance and noise of tiles. For denoisers "
      "picture.exr also has albedo.R/G/B, "
      "normal.X/Y/Z (world) and depth.Z (mm along the axis from the front vertex) of the surfaces seen through the "
      "lens; "
      "sky: 0, 0, infinity.\n"
      "Default: 64 samples per pixel. --time without --spp takes as many samples as the time allows; --time with "
      "--spp leaves missing samples to --resume. Ctrl-C writes sums and picture. --resume continues; a larger --spp "
      "adds samples to a finished picture, bit for bit as one run.",
      "petzval render");
  examples::add_setup(app, options.setup);
  app.add_option(
         "--scene", options.scene,
         "scene or file of a scene (.json); for a film of 36x24 mm and lenses of 100 mm (statues: 50 mm). petzval blur "
         "and view have other scenes")
      ->required()
      ->type_name("NAME:{balls,chess,statues,street,table}");
  examples::add_lens(app, options.setup.lens);
  std::vector<std::string> models{"auto"};
  for (const petzval::ModelKind m : petzval::models()) models.emplace_back(petzval::name(m));
  app.add_option(
         "--model",
         [&](const std::string& text) {
           options.choose_model = text == "auto";
           options.setup.camera.model = petzval::model_named(text).value_or(petzval::ModelKind::exact_float);
         },
         "model of the lens; auto: the fastest model within --budget, or by default the fastest model whose bias is "
         "below a tenth of the noise")
      ->one_of(models)
      ->default_str("exact_float");
  examples::add_number(app, "--budget", options.budget_px, examples::positive_number,
                       "largest error of a ray for --model auto (pixels)")
      ->default_str("a tenth of the noise");
  app.add_option("--integrator", options.integrator,
                 "direction of tracing; path: from the film; light: from the lamps, which misses views through mirrors "
                 "and smooth glass; "
                 "bidirectional: both, for small lamps")
      ->one_of({"path", "light", "bidirectional"})
      ->capture_default_str();
  examples::add_count(app, "--spp", options.samples, {1, 1u << 24, "a whole number from 1 to 16777216"},
                      "samples per pixel")
      ->default_str("64");
  examples::add_number(app, "--noise", options.noise, examples::positive_number,
                       "largest noise of a tile; spend samples where the picture is noisy, until the noise of each "
                       "tile of 16 x 16 pixels is "
                       "below this: standard error of the luminance of a pixel (rms), divided by the mean luminance of "
                       "the tile or, if larger, 0.05 of white. --spp is then the upper limit, by default 4096")
      ->default_str("none");
  examples::add_number(
      app, "--time", options.seconds, examples::positive_number,
      "time limit (s); no pass over the picture starts after it. A pass is always finished and takes 1 sample per "
      "pixel, or up to 16 with --spp")
      ->default_str("none");
  examples::add_count(app, "--seed", options.seed, {0, 4294967295.0, "a whole number from 0 to 4294967295"},
                      "seed of the random numbers");
  examples::add_threads(app);
  examples::add_picture_size(app, options.width, options.height, usual_width);
  examples::add_camera(app, options.setup, "each is written as with one --focus, to DIR/frame_0001 and so on");
  examples::add_bokeh(app, options.setup);
  examples::add_focal_surface(app, options.setup,
                              "distances in focus, depth-of-field extents and blurs at points of the picture, for a "
                              "first-order --model");
  examples::add_expressive(app, options.setup);
  examples::add_tilt(app, options.setup, {-89.9, 89.9, "an angle from -89.9 to 89.9"});
  app.add_option(
         "--wavelengths", options.wavelengths,
         "wavelengths of the light; d: the lens at the d line; rgb: one wavelength per channel; hero or visible: "
         "four wavelengths per path over the visible spectrum; NM: the lens at one wavelength (nm or a line like "
         "F), focused at the d line")
      ->type_name("d|rgb|hero|NM")
      ->default_str("d");
  constexpr std::array units{petzval::Normalisation::unity_on_axis, petzval::Normalisation::irradiance};
  options.setup.camera.normalisation = units.front();
  examples::add_choice(app, "--normalisation", options.setup.camera.normalisation, units, "unit of the picture",
                       examples::names(units));
  examples::add_coatings(app, options.coatings, "all light passes the lens");
  examples::add_count(app, "--ghosts", options.ghosts, {0, 65536, "a whole number from 0 to 65536"},
                      "add the ghosts of so many points of the lamps and the sky: reflections between the surfaces of "
                      "the lens, as of petzval ghosts; 16 suit most scenes. Also the channels ghosts.R, .G and .B of "
                      "picture.exr. Their time counts for --time")
      ->default_str("none");
  examples::add_number(app, "--exposure", options.exposure, examples::positive_number,
                       "brightness of picture.png: white is the radiance 1 / exposure in the centre");
  std::string tile;
  app.add_option("--shard", tile,
                 "render every Nth tile of 16 x 16 pixels, starting with the Ith; 'petzval render merge DIR --out DIR' "
                 "adds the shards")
      ->type_name("I/N");
  app.add_flag("--resume", options.resume,
               "continue from the checkpoint in DIR with at least as many samples, bit for bit as one run");
  const auto* formats = examples::add_formats(app, options.formats, "png (sRGB)");
  examples::add_out_folder(app, options.out_folder)->required();

  return examples::run(app, argc, argv, [&] {
    if (options.wavelengths.empty()) options.wavelengths = wavelengths_of(options.setup.lens.wavelengths_nm);
    if (options.samples == 0 && options.noise > 0) options.samples = 4096;
    if (options.samples == 0 && options.seconds == 0) options.samples = 64;
    if (!tile.empty()) options.shard = examples::parse_shard("--shard", tile);
    if (options.shard.count > 1 && options.noise > 0) {
      throw petzval::Error("--noise with --shard " + tile +
                           "; must be used for whole pictures: the number of light paths depends on all tiles");
    }
    if (options.shard.count > 1 && formats->given()) {
      throw petzval::Error("--format must not be used with --shard " + tile +
                           "; 'petzval render merge' writes the picture");
    }
    render_frames(options);
  });
}
