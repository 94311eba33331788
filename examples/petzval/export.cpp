// SPDX-License-Identifier: Apache-2.0
// Writes a camera for programs that do not link petzval: calibrations in the models and formats of other programs.
//
//   petzval export double_gauss_52mm_f1.8 --camera camera.h
//   petzval export double_gauss_52mm_f1.8 --focus inf --calibration out
//   petzval export double_gauss_52mm_f1.8 --ray-map rays.exr --lens-samples 32
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <limits>
#include <string>

#include "commands.hpp"
#include "export_maps.hpp"
#include "export_table.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/exports/calibration.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/petzval_camera.h"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace {

using examples::number;
using json = examples::Json;

struct Options {
  std::string calibration, ray_map, camera;
  bool all = false;
  std::uint32_t lens_samples = 16;
  bool half = false;
  std::string wavelengths;
  std::uint32_t columns = 0, rows = 0;
  examples::CameraFlags setup;
  examples::Output output;
};

struct Format {
  petzval::CalibrationFormat format;
  const char* ending;
  const char* comment;  ///< begins a line of comment; null: one file for each calibration
};
constexpr std::array formats{Format{petzval::CalibrationFormat::opencv, "yml", nullptr},
                             Format{petzval::CalibrationFormat::colmap, "colmap.txt", "# "},
                             Format{petzval::CalibrationFormat::lensfun, "lensfun.xml", ""},
                             Format{petzval::CalibrationFormat::usd, "usda.txt", "# "}};

void print(const std::vector<petzval::Calibration>& all) {
  std::cout << "calibration           RMS, px  largest, px  parameters\n";
  for (const petzval::Calibration& one : all) {
    std::cout << std::left << std::setw(21) << one.name << std::right << std::setw(8) << number(one.rms, 2)
              << (one.of_irradiance ? '*' : ' ') << std::setw(12) << number(one.largest, 2)
              << (one.of_irradiance ? '*' : ' ') << ' ';
    for (const auto& [name, value] : one.values) {
      if (value != 0) std::cout << ' ' << name << ' ' << number(value, 5);
    }
    std::cout << '\n';
  }
  std::cout << "* fraction of the irradiance on the axis\n";
}

/// Writes a ray map and returns its report.
json write_map(const Options& options, const petzval::Lens& lens) {
  const petzval::Film film = options.setup.sized_film(options.columns, options.rows, 480);
  const petzval::Camera camera(lens, film, {.model = petzval::ModelKind::exact_double});
  const petzval::RayMap map = petzval::ray_map(
      camera,
      {.lens_samples = static_cast<int>(options.lens_samples), .half = options.half, .threads = examples::threads()});
  commands::write_ray_map(map, camera, options.ray_map);
  if (!options.output.json) {
    std::cout << "ray map of " << film.columns << " x " << film.rows << " pixels, " << map.lens_samples.size()
              << (map.chief_rays ? " lens sample (chief rays)" : " lens samples") << ": between pixels RMS "
              << number(map.rms_px, 2) << ", largest " << number(map.largest_px, 2) << " pixels; "
              << number(100 * map.left_out, 2) << " % of the places at dark pixels, without an error\n";
  }
  options.output.file(options.ray_map);
  return commands::head_of(map, camera);
}

std::vector<double> wavelengths_of(const Options& options, const std::string& usual) {
  return examples::parse_wavelengths("--wavelengths", options.wavelengths.empty() ? usual : options.wavelengths);
}

std::string title_of(const examples::LoadedLens& loaded, const petzval::Film& film) {
  std::string title =
      loaded.lens.name() + ", film " + number(film.width_mm, 4) + " x " + number(film.height_mm, 4) + " mm";
  for (const double nm : loaded.lens.wavelengths_nm()) title += ", " + number(nm, 7) + " nm";
  return title;
}

petzval::Camera table_camera(const Options& options, const petzval::Lens& lens, const petzval::Film& film) {
  return petzval::Camera(lens, film, {.model = options.setup.camera.model, .threads = examples::threads()});
}

/// Writes the table of a camera and returns its report.
json write_table(const Options& options) {
  const examples::LoadedLens loaded = examples::load_lens(options.setup.lens, wavelengths_of(options, "d"));
  const petzval::Lens lens = examples::focused(loaded, options.setup);
  const petzval::Film film = options.setup.sized_film(options.columns, options.rows, 1920);
  examples::say_what_does_not_fit(lens, film);
  const std::vector<float> table = camera_table(table_camera(options, lens, film));
  commands::write_camera_table(table, title_of(loaded, film), options.camera);
  options.output.file(options.camera);
  return {{"format", PZ_FORMAT}, {"numbers", table.size()}};
}

/// The lens in focus, at infinity if it cannot be focused at the distance.
petzval::Lens focused_or_far(const examples::LoadedLens& loaded, examples::CameraFlags setup) {
  try {
    return examples::focused(loaded, setup);
  } catch (const petzval::Error&) {
    examples::note(loaded.id + " cannot be focused at " + number(*setup.focus_mm, 4) +
                   " mm; its table is focused at infinity");
    setup.focus_mm = std::numeric_limits<double>::infinity();
    return examples::focused(loaded, setup);
  }
}

/// Writes the tables of all shipped lenses. Unless --film is given, the film shrinks to the image circle.
void write_all(const Options& options) {
  examples::make_folder(options.camera);
  std::vector<std::filesystem::path> files = examples::entries(petzval::data_directory() / "lenses");
  std::erase_if(files, [](const auto& file) { return file.extension() != ".json"; });
  std::ranges::sort(files);
  std::size_t bytes = 0;
  json rows = json::array();
  for (const std::filesystem::path& file : files) {
    const examples::LoadedLens loaded = examples::load_lens({.file = file.string()}, wavelengths_of(options, "d"));
    const petzval::Lens lens = focused_or_far(loaded, options.setup);
    petzval::Film film = options.setup.sized_film(options.columns, options.rows, 1920);
    std::vector<float> table = camera_table(table_camera(options, lens, film));
    if (const double lit = table[PZ_REACH] / film.radius_mm(); !options.setup.film_given && lit < 1) {
      film.width_mm *= lit, film.height_mm *= lit;
      table = camera_table(table_camera(options, lens, film));
    }
    const std::filesystem::path out = std::filesystem::path(options.camera) / (loaded.id + ".bin");
    commands::write_camera_table(table, title_of(loaded, film), out);
    options.output.file(out);
    bytes += 4 * table.size();
    rows.push_back({{"file", out.string()}, {"numbers", table.size()}, {"film_mm", {film.width_mm, film.height_mm}}});
  }
  if (!options.output.json) {
    std::cout << files.size() << " tables, " << number(1e-6 * static_cast<double>(bytes), 3) << " MB\n";
  }
  options.output.report({{"tables", std::move(rows)}, {"bytes", bytes}});
}

void write(const Options& options) {
  if (options.calibration.empty() && options.ray_map.empty() && options.camera.empty()) {
    throw petzval::Error("--camera, --calibration or --ray-map is required");
  }
  const bool others = !options.calibration.empty() || !options.ray_map.empty();
  if (options.all && (others || !options.setup.lens.file.empty())) {
    throw petzval::Error("--all: found LENS, --calibration or --ray-map as well; must be given with --camera DIR only");
  }
  if (options.all) return write_all(options);
  if (options.setup.lens.file.empty()) throw petzval::Error("LENS is required (or --all)");
  if (!options.ray_map.empty()) examples::want_ending("--ray-map", options.ray_map, ".exr");
  json report;
  if (!options.camera.empty()) {
    commands::check_table_name(options.camera);
    report["table"] = write_table(options);
  }
  if (!others) return options.output.report(report);
  const examples::LoadedLens loaded = examples::load_lens(options.setup.lens, wavelengths_of(options, "F,d,C"));
  const petzval::Lens lens = examples::focused(loaded, options.setup);
  report["lens"] = lens.name();
  if (!options.ray_map.empty()) report["ray_map"] = write_map(options, lens);
  if (options.calibration.empty()) return options.output.report(report);
  const petzval::Film film = options.setup.sized_film(options.columns, options.rows, 1920);
  const petzval::Camera camera(lens, film, {.model = petzval::ModelKind::exact_double});
  std::vector<petzval::Calibration> all = petzval::calibrations(camera);
  const petzval::OmniverseTables tables = petzval::omniverse_tables(camera, {}, 2049, examples::threads());
  all.push_back(tables.fit);
  examples::make_folder(options.calibration);
  const std::filesystem::path stem = std::filesystem::path(options.calibration) / loaded.id;
  const auto written = [&](const std::string& ending, const std::string& text) {
    const std::filesystem::path file = stem.string() + '.' + ending;
    examples::write_text(file, text);
    options.output.file(file);
  };
  const std::filesystem::path enter = stem.string() + ".omniverse.enter.exr",
                              exit = stem.string() + ".omniverse.exit.exr";
  json rows = json::array();
  for (const petzval::Calibration& one : all) {
    json values = json::array();
    for (const auto& [name, value] : one.values) values.push_back({{"name", name}, {"value", value}});
    rows.push_back({{"name", one.name},
                    {"values", values},
                    {one.of_irradiance ? "rms_irradiance" : "rms_px", one.rms},
                    {one.of_irradiance ? "largest_irradiance" : "largest_px", one.largest},
                    {"field_deg", petzval::degrees(one.widest_field_rad)}});
  }
  if (!options.output.json) print(all);
  for (const Format& format : formats) {
    std::string joined;
    for (const petzval::Calibration& one : all) {
      const bool lut = one.name == tables.fit.name && format.format == petzval::CalibrationFormat::usd;
      const std::string text = lut ? tables.usd(enter.filename().string(), exit.filename().string())
                                   : format_calibration(one, camera, format.format);
      if (text.empty()) continue;
      if (!format.comment) {
        written(one.name + '.' + format.ending, text);
        continue;
      }
      const std::string errors = one.name + ": RMS " + number(one.rms, 2) + ", largest " + number(one.largest, 2);
      const bool xml = *format.comment == 0;
      joined += xml ? "<!-- " + errors + " -->\n" : format.comment + errors + '\n';
      joined += text;
    }
    if (format.format == petzval::CalibrationFormat::lensfun && !joined.empty()) {
      joined = "<calibration> <!-- for a <lens> of a Lensfun database; keep one of the distortion models -->\n" +
               joined + "</calibration>\n";
    }
    if (!joined.empty()) written(format.ending, joined);
  }
  commands::write_omniverse(tables, enter, exit);
  options.output.file(enter), options.output.file(exit);
  report["columns"] = film.columns, report["rows"] = film.rows;
  report["calibrations"] = std::move(rows);
  options.output.report(report);
}

}  // namespace

int commands::export_camera(int argc, char** argv) {
  Options options;
  examples::App app(
      "Writes a camera for programs that do not link petzval: a table for petzval_camera.h, in C, GLSL, HLSL or CUDA "
      "(--camera), an image of its rays (--ray-map), or the parameters of OpenCV, COLMAP, Lensfun, USD and others, "
      "with "
      "the error of each model over the picture (--calibration).",
      "petzval export");
  examples::add_lens(app, options.setup.lens, "LENS", "or --all");
  examples::Option* const camera =
      app.add_option("--camera", options.camera,
                     "writes the table of the camera: surfaces, pupils, iris and film as floats; .h: C source, .bin: "
                     "little-endian floats, .json: with names. With --all a folder")
          ->type_name("FILE");
  app.add_flag("--all", options.all, "writes the tables of all shipped lenses, as .bin")->needs(camera);
  examples::add_out_folder(
      app, options.calibration,
      "folder for the calibrations: OpenCV (.yml), COLMAP (.colmap.txt), Lensfun (.lensfun.xml), USD (.usda.txt), "
      "tables of Omniverse (.omniverse.enter.exr, .omniverse.exit.exr)",
      "--calibration");
  examples::Option* const map = examples::add_out_file(
      app, options.ray_map,
      "writes the origin, direction and weight of the ray of each pixel and lens sample, with the attribute ray_map "
      "that describes them; 480 pixels across unless --size is given",
      "FILE.exr", "--ray-map");
  constexpr examples::Range lens_samples{1, 256, "a whole number from 1 to 256"};
  examples::add_count(app, "--lens-samples", options.lens_samples, lens_samples,
                      "lens samples of the ray map; 1: chief rays")
      ->needs(map);
  app.add_flag("--half", options.half, "values of the ray map are 16-bit floats")->needs(map);
  examples::add_camera(app, options.setup);
  examples::add_picture_size(app, options.columns, options.rows, 1920);
  examples::add_model(app, options.setup.camera.model)->needs(camera);
  app.add_option("--wavelengths", options.wavelengths,
                 "wavelengths of the table (default d) and of the lateral colour (default F,d,C), in nm or as spectral "
                 "lines")
      ->type_name("NM,...");
  options.output.add(app);
  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] { write(options); });
}
