// SPDX-License-Identifier: Apache-2.0
// Computes the images of point lights over fields, distances, wavelengths and f-numbers as one EXR, optionally in
// shards on several machines, and interpolates the image of any point between them.
//
//   petzval psf-set data/lenses/double_gauss_100mm_f2_28deg.json --fields 0,5,10,14 --at 1000,2000,4000,inf
//           --f-number 2,2.8 --focus 2000 --out set
//   petzval psf-set query set/psf_set.exr --fields 7 --at 1500 --out psf.exr
#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/image/psf.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/bokeh.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/design.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/psf_job.hpp"
#include "support/text.hpp"

namespace {

namespace fs = std::filesystem;
using examples::Json;
using examples::number;
using petzval::PsfSetPoint;

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Options {
  std::string out_folder;
  examples::CameraFlags setup;
  petzval::PsfSet::Axes axes{
      .fields_deg = {}, .distances_mm = {}, .wavelengths_nm = {petzval::d_line_nm}, .f_numbers = {}};
  double focus_mm = infinity;
  std::uint32_t samples = 1u << 20, pixels = 129;
  examples::Shard shard;
  bool resume = false, check = false;
  examples::Output output;
};

/// The lens at its f-numbers, focused, with lights in object space.
class Scenes {
 public:
  Scenes(const examples::LoadedLens& loaded, const Options& options)
      : lens_(loaded.lens), options_(options), wide_open_(options.axes.f_numbers.empty()) {}

  bool wide_open() const noexcept { return wide_open_; }
  const petzval::Lens& lens() const noexcept { return lens_; }

  /// @throws petzval::Error if the point is not in front of the lens
  examples::BokehScene at(const PsfSetPoint& point) {
    if (!stopped_ || f_number_ != point.f_number) {
      if (!wide_open_) options_.setup.f_number = point.f_number;
      stopped_ = examples::stopped_down(lens_, options_.setup);
      f_number_ = point.f_number;
    }
    auto scene = examples::focused_scene(
        *stopped_, options_.focus_mm,
        {.light_mm = point.distance_mm, .focus = options_.setup.focus, .field_rad = petzval::radians(point.field_deg)});
    examples::for_flag("--fields", [&] { return petzval::scene_point(scene.lens, scene.light); });
    return scene;
  }

  petzval::PsfKernel kernel(const PsfSetPoint& point, std::uint32_t seed = 0, double half_width_mm = 0) {
    const examples::BokehScene scene = at(point);
    return petzval::psf_kernel(scene.lens, lens_, scene.light,
                               scene.lens.wavelength_index(petzval::Wavelength::nm(point.wavelength_nm)),
                               {.samples = options_.samples,
                                .pixels = static_cast<int>(options_.pixels),
                                .half_width_mm = half_width_mm,
                                .seed = seed,
                                .threads = examples::threads()});
  }

 private:
  petzval::Lens lens_;
  Options options_;
  bool wide_open_;
  std::optional<petzval::Lens> stopped_;
  double f_number_ = 0;
};

examples::PsfJob job_of(const examples::LoadedLens& loaded, const Options& options) {
  Json distances = Json::array();
  for (const double mm : options.axes.distances_mm) distances.push_back(examples::finite_or_null(mm));
  std::vector<double> f_numbers = options.axes.f_numbers;
  if (f_numbers.empty()) {  // rounded, for file names
    f_numbers = {examples::parse_number("f-number", examples::number(petzval::real_f_number(loaded.lens), 4),
                                        examples::positive_number)};
  }
  return examples::PsfJob({{"lens", loaded.lens.name()},
                           {"dispersion", petzval::name(loaded.lens.dispersion())},
                           {"fields_deg", options.axes.fields_deg},
                           {"distances_mm", std::move(distances)},
                           {"distance_from", petzval::name(options.setup.focus.origin)},
                           {"wavelengths_nm", options.axes.wavelengths_nm},
                           {"f_numbers", std::move(f_numbers)},
                           {"wide_open", options.axes.f_numbers.empty()},
                           {"focus_mm", examples::finite_or_null(options.focus_mm)},
                           {"criterion", petzval::name(options.setup.focus.criterion)},
                           {"iris",
                            {{"blades", options.setup.iris.blades},
                             {"roundness", options.setup.iris.roundness},
                             {"rotation_deg", examples::exact_degrees(options.setup.iris.rotation_rad)},
                             {"area", options.setup.iris_area}}},
                           {"samples", options.samples},
                           {"pixels", options.pixels},
                           {"prescription", Json::parse(petzval::format_prescription(loaded.prescription))},
                           {"petzval", PETZVAL_VERSION}});
}

/// PSFs of this shard that are not complete in the folder. Notes on standard error name corrupt files.
std::vector<std::size_t> left_to_do(const examples::PsfJob& job, const Options& options) {
  std::vector<std::size_t> left;
  for (std::size_t node = 0; node < job.axes().size(); ++node) {
    if (!options.shard.has(node)) continue;
    if (options.resume && examples::exists(job.file(options.out_folder, node))) {
      try {
        job.part(options.out_folder, node);
        continue;
      } catch (const petzval::Error& error) {
        std::cerr << "note: " << error.what() << "; computed again\n";
      }
    }
    left.push_back(node);
  }
  return left;
}

/// Traces the centres of all cells of the grid, at the wavelengths of the set, and compares them with the
/// interpolation.
Json interpolation_error(const std::vector<petzval::ExrPart>& parts, const examples::PsfJob& job, Scenes& scenes) {
  std::vector<petzval::PsfKernel> kernels;
  for (const petzval::ExrPart& part : parts) kernels.push_back(petzval::from_exr_part(part).second);
  const petzval::PsfSet set(job.axes(), std::move(kernels));
  const auto middles = [](const std::vector<double>& axis, bool inverse) {
    std::vector<double> result;
    for (std::size_t i = 0; i + 1 < axis.size(); ++i) {
      result.push_back(inverse ? 2 / (1 / axis[i] + 1 / axis[i + 1]) : (axis[i] + axis[i + 1]) / 2);
    }
    return result.empty() ? axis : result;
  };
  const petzval::PsfSet::Axes cells{middles(set.axes().fields_deg, false), middles(set.axes().distances_mm, true),
                                    set.axes().wavelengths_nm, middles(set.axes().f_numbers, true)};
  examples::Progress progress("check", cells.size());
  std::vector<double> moved, noise, light;
  Json worst;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const PsfSetPoint point = cells.point(i);
    progress.step(petzval::psf_part_name(point));
    const petzval::PsfKernel between = set.at(point);
    const double half_width = between.pixels * between.pixel_mm / 2;
    // Separate seeds, because kernels and their interpolation have the same seed.
    const auto traced = scenes.kernel(point, 1, half_width), again = scenes.kernel(point, 2, half_width);
    moved.push_back(100 * petzval::total_variation(between, traced));
    noise.push_back(100 * petzval::total_variation(traced, again));
    light.push_back(traced.total > 0 ? 100 * std::abs(between.total / traced.total - 1) : 0.0);
    if (moved.back() >= *std::max_element(moved.begin(), moved.end())) {
      worst = {{"field_deg", point.field_deg},
               {"distance_mm", examples::finite_or_null(point.distance_mm)},
               {"wavelength_nm", point.wavelength_nm},
               {"f_number", point.f_number}};
    }
  }
  const auto summary = [](std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return Json{{"median", values[values.size() / 2]}, {"worst", values.back()}};
  };
  return {{"what", "interpolation at the centres of all grid cells compared with traced PSFs"},
          {"points", cells.size()},
          {"light_moved_percent", summary(moved)},
          {"worst_at", std::move(worst)},
          {"noise_of_two_traced_percent", summary(noise)},
          {"total_percent", summary(light)}};
}

/// Prints the paths of a set: EXR, index and contact sheet; with --json the index.
void say(const std::vector<fs::path>& files, const examples::Output& output) {
  for (const fs::path& file : files) output.file(file);
  if (output.json) output.report(Json::parse(examples::read_text(files[1])));
}

/// Throws before files are written, for points from which no ray can be sent and for fields without light at all
/// distances and f-numbers.
void want_light(const petzval::PsfSet::Axes& axes, Scenes& scenes) {
  std::vector<bool> lit(axes.fields_deg.size());
  for (std::size_t node = 0; node < axes.size(); ++node) {
    const PsfSetPoint point = axes.point(node);
    const examples::BokehScene scene = scenes.at(point);
    const auto field = std::ranges::find(axes.fields_deg, point.field_deg) - axes.fields_deg.begin();
    const auto at = lit.begin() + field;
    if (!*at) *at = examples::reached_by_light(scene.lens, scene.light);
  }
  const auto dark = std::ranges::find(lit, false);
  if (dark == lit.end()) return;
  throw petzval::Error("--fields = " + number(axes.fields_deg[static_cast<std::size_t>(dark - lit.begin())]) +
                       ": no light passes " + scenes.lens().name() + " from there; must be fields that the lens sees");
}

void compute(const Options& options) {
  petzval::PsfSet::Axes axes = options.axes;
  if (axes.f_numbers.empty()) axes.f_numbers = {1};  // replaced below
  petzval::PsfSet::validate(axes);
  if (options.pixels % 2 == 0) {
    throw petzval::Error("--size = \"" + std::to_string(options.pixels) +
                         "\"; must be odd, because the chief ray is at the centre of a pixel");
  }
  if ((options.check || options.output.json) && options.shard.count > 1) {
    throw petzval::Error(std::string(options.check ? "--check" : "--json") + " with --shard " + options.shard.text() +
                         "; must be used without --shard");
  }
  const auto loaded = examples::load_lens(options.setup.lens, options.axes.wavelengths_nm);
  const examples::PsfJob job = job_of(loaded, options);
  Scenes scenes(loaded, options);
  want_light(job.axes(), scenes);

  const fs::path folder = options.out_folder;
  job.begin(folder, options.shard);
  const std::vector<std::size_t> left = left_to_do(job, options);
  {
    examples::Progress progress("PSFs", left.size());
    for (const std::size_t node : left) {
      progress.step(job.name(node));
      job.write(folder, node, scenes.kernel(job.axes().point(node)));
      if (options.shard.count > 1) options.output.file(job.file(folder, node));
    }
  }
  if (options.shard.count > 1) return;
  const std::vector<petzval::ExrPart> parts = job.gather({folder});
  std::optional<Json> error;
  if (options.check) error = interpolation_error(parts, job, scenes);
  say(examples::write_psf_set(job, parts, folder / "psf_set.exr", error), options.output);
}

void merge(const std::vector<std::string>& names, const std::string& out, const examples::Output& output) {
  examples::want_ending("--out", out, ".exr");
  const std::vector<fs::path> folders(names.begin(), names.end());
  const auto job = examples::PsfJob::read(folders.front());
  for (const fs::path& folder : folders) {
    if (examples::PsfJob::read(folder).description() == job.description()) continue;
    throw petzval::Error(folder.string() + ": the set differs from the set in " + folders.front().string() +
                         "; must be a shard of the same set");
  }
  say(examples::write_psf_set(job, job.gather(folders), out), output);
}

/// point: with wavelength and f-number 0 if they are not given.
void query(const std::string& file, PsfSetPoint point, petzval::DistanceOrigin origin, const std::string& out) {
  examples::want_ending("--out", out, ".exr");
  std::vector<petzval::ExrPart> parts = petzval::read_exr_parts(file);
  const std::string of_set = examples::distance_from(parts.front());
  if (petzval::name(origin) != of_set) {
    throw petzval::Error("--from = " + std::string(petzval::name(origin)) + ": the distances of " + file +
                         " count from " + of_set + "; must be the same");
  }
  const petzval::PsfSet set = petzval::psf_set_of(std::move(parts), file);
  const auto& nm = set.axes().wavelengths_nm;
  const auto from_d = [](double a) { return std::abs(a - petzval::d_line_nm); };
  if (point.wavelength_nm == 0) point.wavelength_nm = *std::ranges::min_element(nm, {}, from_d);
  if (point.f_number == 0) point.f_number = set.axes().f_numbers.front();
  petzval::ExrPart part = petzval::to_exr_part(set.at(point), point);
  part.texts[examples::distance_from_key] = of_set;
  petzval::write_exr({&part, 1}, out);
  std::cout << out << '\n';
}

int main_compute(int argc, char** argv) {
  Options options;
  examples::App app(
      "Computes the images of point lights over a grid of fields, distances, wavelengths and f-numbers. Writes to DIR "
      "and prints the paths: psf_set.exr (one part for each PSF: channel Y is its light, hits.x and hits.y its rays), "
      "psf_set.json (index with units) and psf_set.svg (contact sheet). Each complete PSF is a file in DIR/psfs. With "
      "--shard only these files are written; petzval psf-set merge combines them, bit for bit as one run.\n"
      "petzval psf-set merge DIR... --out FILE.exr   merges the shards of one or several folders\n"
      "petzval psf-set query FILE.exr --fields F --at D --out PSF.exr   interpolates a PSF at any point",
      "petzval psf-set");
  examples::add_lens(app, options.setup.lens);
  examples::add_numbers(app, "--fields", options.axes.fields_deg, {0, 180, "an angle from 0 to 180 degrees"},
                        "angles of the light seen from the paraxial entrance pupil (degrees, ascending)")
      ->required();
  examples::add_lengths(app, "--at", options.axes.distances_mm, examples::positive_length,
                        "distances of the light (mm, ascending); the last may be inf")
      ->required();
  examples::add_wavelengths(app, "--wavelengths", options.axes.wavelengths_nm, "wavelengths, ascending");
  examples::add_numbers(app, "--f-number", options.axes.f_numbers, examples::positive_number,
                        "f-numbers, by exact rays (ascending)")
      ->default_str("wide open");
  examples::add_length(app, "--focus", options.focus_mm, examples::positive_length,
                       "focus distance (mm), or inf; the film is focused for each f-number");
  examples::add_focus(app, options.setup.focus);
  examples::add_iris_shape(app, options.setup);
  examples::add_samples(app, options.samples);
  examples::add_count(app, "--size", options.pixels, {3, 1025, "an odd number from 3 to 1025"},
                      "pixels along each side of an image, odd");
  app.add_option(
         "--shard", [&](const std::string& text) { options.shard = examples::parse_shard("--shard", text); },
         "compute part i of n, from 1/n to n/n")
      ->type_name("I/N")
      ->default_str("1/1");
  app.add_flag("--resume", options.resume, "keep the complete PSFs of an interrupted run in DIR");
  app.add_flag(
      "--check", options.check,
      "compare interpolated PSFs with traced PSFs at the centres of grid cells: interpolation_error in the index");
  options.output.add(app);
  examples::add_out_folder(app, options.out_folder)->required();
  return examples::run(app, argc, argv, [&] { compute(options); });
}

int main_merge(int argc, char** argv) {
  std::vector<std::string> folders;
  std::string out;
  examples::App app(
      "Merges the PSFs of shards. Writes FILE.exr with index and contact sheet next to it, like one run without "
      "shards. Names every missing or corrupt PSF and its shard; to repair it, run that shard with --resume.",
      "petzval psf-set merge");
  app.add_option("DIR", folders, "folders that petzval psf-set --shard wrote to")->required();
  examples::Output output;
  output.add(app);
  examples::add_out_file(app, out, "set of PSFs to write", "FILE.exr")->required();
  return examples::run(app, argc, argv, [&] { merge(folders, out, output); });
}

int main_query(int argc, char** argv) {
  std::string file, out;
  petzval::DistanceOrigin origin{};
  PsfSetPoint point;
  examples::App app("Looks up a PSF of a set: nodes are copied, other points are interpolated.",
                    "petzval psf-set query");
  app.add_option("FILE.exr", file, "set of PSFs written by petzval psf-set")->required();
  examples::add_number(app, "--fields", point.field_deg, examples::field_angle, "angle of the light (degrees)")
      ->required()
      ->default_str("");
  examples::add_length(app, "--at", point.distance_mm, examples::positive_length, "distance of the light (mm), or inf")
      ->required()
      ->default_str("");
  examples::add_distance_origin(app, origin);
  examples::add_wavelength(app, "--wavelengths", point.wavelength_nm, "wavelength")
      ->default_str("wavelength of the set nearest to the d line");
  examples::add_number(app, "--f-number", point.f_number, examples::positive_number, "f-number")
      ->default_str("smallest f-number of the set");
  examples::add_out_file(app, out, "PSF to write: a set of one part", "PSF.exr")->required();
  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] { query(file, point, origin, out); });
}

}  // namespace

int commands::psf_set(int argc, char** argv) {
  const std::string_view first = argc > 1 ? argv[1] : "";
  if (first == "merge") return main_merge(argc - 1, argv + 1);
  if (first == "query") return main_query(argc - 1, argv + 1);
  return main_compute(argc, argv);
}
