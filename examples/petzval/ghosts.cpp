// SPDX-License-Identifier: Apache-2.0
// Computes the ghosts of a light: reflections between the surfaces of a lens, in the unit of the picture.
//
//   petzval ghosts double_gauss_52mm_f1.8 --light 15,10 --out ghosts
//   petzval ghosts data/lenses/double_gauss_100mm_f2.0.json --light 300px,120px --coatings mgf2 --f-number 4 --json
//   --out ghosts
#include "petzval/ghosts/ghosts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "commands.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/image/image.hpp"
#include "petzval/pupil/aim.hpp"
#include "support/bokeh.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/lens_light.hpp"
#include "support/load_lens.hpp"
#include "support/picture_files.hpp"
#include "support/text.hpp"

namespace {

using examples::Json;
using examples::number;
using petzval::Error;
using petzval::GhostPair;

constexpr std::uint32_t usual_columns = 960;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Options {
  examples::CameraFlags setup;
  std::string light, coatings, pairs = "all", model = "exact", white_point = "D65", out_folder;
  std::vector<double> wavelengths_nm{430, 460, 490, 520, 550, 580, 610, 640, 670};
  std::uint32_t width = 0, height = 0;
  double film_reflectance = 0, exposure = 1;
  std::vector<std::string> formats;
  examples::Output output;
};

/// A light by its angles from the axis.
struct Light {
  double x_deg = 0, y_deg = 0, distance_mm = infinity;
  petzval::ScenePoint point{};
};

petzval::FieldPoint field_of(const Light& light, const petzval::Lens& lens, petzval::DistanceOrigin origin) {
  return {petzval::radians(std::hypot(light.x_deg, light.y_deg)), petzval::origin_z(lens, origin) - light.distance_mm,
          std::atan2(light.x_deg, light.y_deg)};
}

/// Sets the angles of a light whose image is a point of the film.
void image_at(Light& light, const petzval::FilmPoint& image, const petzval::Camera& camera,
              petzval::DistanceOrigin origin) {
  const petzval::Lens& lens = camera.lens();
  const petzval::IdealLens ideal = petzval::thick_lens(lens);
  petzval::FilmPoint aim = image;
  for (int i = 0; i < 40; ++i) {
    const petzval::ScenePoint scene = ideal.scene_of({aim.x, aim.y, lens.film_z()});
    petzval::Vec3<double> from = scene.position;
    if (!scene.at_infinity) from.z -= ideal.pupils.entrance.z;
    if (from.z > 0) from = -from;  // a virtual object lies behind the lens
    const double angle = petzval::degrees(std::atan2(std::hypot(from.x, from.y), -from.z)),
                 across = std::max(std::hypot(from.x, from.y), 1e-300);
    light.x_deg = angle * from.x / across, light.y_deg = angle * from.y / across;
    const petzval::ScenePoint point = petzval::scene_point(lens, field_of(light, lens, origin));
    const petzval::Projection seen = camera.project(point.at_infinity ? point.position * 1e12 : point.position);
    const petzval::Vec2<double> off{image.x - seen.film.x, image.y - seen.film.y};
    if (seen.status == petzval::AimStatus::no_ray) break;
    if (std::hypot(off.x, off.y) < 1e-6) return;
    aim.x += off.x, aim.y += off.y;
  }
  throw Error("--light: no light of the scene is imaged there");
}

Light light_of(const Options& options, const petzval::Camera& camera) {
  const std::string &text = options.light, rule = "X,Y[,DISTANCE] in degrees, or Xpx,Ypx[,DISTANCE]";
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
  const bool two_or_three = (parts.size() == 2 || parts.size() == 3) && !text.ends_with(',');
  if (!two_or_three || parts[0].ends_with("px") != parts[1].ends_with("px")) {
    throw Error("--light = \"" + text.substr(0, 60) + "\"; must be " + rule);
  }
  Light light;
  if (parts.size() == 3) light.distance_mm = examples::parse_length("--light", parts[2], examples::positive_length);
  const petzval::Lens& lens = camera.lens();
  const petzval::DistanceOrigin origin = options.setup.focus.origin;
  const bool pixels = parts[0].ends_with("px");
  std::array<double, 2> at{};
  for (std::size_t i = 0; i < 2; ++i) {
    if (pixels) parts[i].resize(parts[i].size() - 2);
    constexpr examples::Range degrees{-180, 180, "degrees from -180 to 180"};
    at[i] = examples::parse_number("--light", parts[i], pixels ? examples::finite_number : degrees);
  }
  if (pixels) {
    image_at(light, camera.film().point(at[0], at[1]), camera, origin);
  } else {
    light.x_deg = at[0], light.y_deg = at[1];
  }
  light.point =
      examples::for_flag("--light", [&] { return petzval::scene_point(lens, field_of(light, lens, origin)); });
  return light;
}

Json to_json(const petzval::GhostAudit& audit) {
  return {{"image", audit.image},
          {"ghosts", audit.ghosts},
          {"higher_order", audit.higher_order},
          {"absorbed", audit.absorbed},
          {"stopped", audit.stopped},
          {"back_out", audit.back_out},
          {"sum", audit.sum}};
}

Json to_json(const GhostPair& pair) {
  return {{"first", pair.first},
          {"second", pair.second},
          {"energy", pair.energy},
          {"centre_mm", {pair.centre.x, pair.centre.y}},
          {"rms_radius_mm", pair.rms_radius_mm},
          {"peak_per_mm2", pair.peak_per_mm2},
          {"caustic", pair.caustic},
          {"error", pair.error}};
}

std::string table_of(const petzval::Ghosts& ghosts, const petzval::GhostAudit& audit) {
  std::ostringstream out;
  const auto rounded = [](double mm) { return std::abs(mm) < 1e-9 ? 0 : mm; };
  out << std::setprecision(3) << "Light that enters: image " << 100 * audit.image << " %, ghosts " << 100 * audit.ghosts
      << " %, more reflections " << 100 * audit.higher_order << " %, back out " << 100 * audit.back_out
      << " %, absorbed " << 100 * rounded(audit.absorbed) << " %, stopped " << 100 * audit.stopped
      << " %\n\nsurfaces   energy    centre (mm)      rms radius (mm)  peak per mm2\n";
  for (const GhostPair& pair : ghosts.pairs) {
    out << std::setw(3) << pair.first << std::setw(4) << pair.second << "  " << std::setw(10) << pair.energy << "  "
        << std::setw(8) << rounded(pair.centre.x) << ' ' << std::setw(8) << rounded(pair.centre.y) << "  "
        << std::setw(12) << pair.rms_radius_mm << "  " << std::setw(12) << pair.peak_per_mm2
        << (pair.caustic ? "  caustic" : "") << '\n';
  }
  return out.str();
}

}  // namespace

int commands::ghosts(int argc, char** argv) {
  Options options;
  *options.setup.focus_mm = infinity;
  bool layers = false, starburst = false;
  examples::App app(
      "Computes the ghosts of a light: light that two surfaces of the lens reflect towards the film. Energies are "
      "fractions of the light that enters the first surface within its rim, at the primary wavelength. The picture "
      "is the irradiance of the film for a light whose irradiance across its beam is 1, and adds to a picture of "
      "petzval render --normalisation irradiance.\n"
      "Writes to DIR and prints the paths: ghosts.exr and ghosts.png, LENS_ghosts.svg (the paths of the brightest "
      "pairs), ghosts.txt (a table) and ghosts.json.",
      "petzval ghosts");
  examples::add_lens(app, options.setup.lens);
  app.add_option("--light", options.light,
                 "position of the light: angles from the axis towards +x (right) and +y (up) in degrees, or a pixel as "
                 "Xpx,Ypx in which its image lies; and its distance (mm; inf if left out)")
      ->type_name("X,Y[,DISTANCE]")
      ->required();
  examples::add_coatings(app, options.coatings, "the coatings of the file; other surfaces are uncoated");
  examples::add_wavelengths(app, "--wavelengths", options.wavelengths_nm, "wavelengths of the picture");
  examples::add_white_point(app, options.white_point);
  examples::add_camera(app, options.setup);
  examples::add_picture_size(app, options.width, options.height, usual_columns);
  app.add_option(
         "--model", options.model,
         "exact rays, or paraxial: first order, one polygon of uniform light for each pair, in a fraction of the "
         "time")
      ->one_of({"exact", "paraxial"})
      ->capture_default_str();
  app.add_option("--pairs", options.pairs, "number of pairs, the brightest ones, or all")
      ->type_name("all|N")
      ->default_str("all");
  app.add_flag(
      "--starburst", starburst,
      "adds the light that the edges of the pupil diffract: spikes of the blades about the image of the light");
  app.add_flag("--pair-layers", layers, "one layer of ghosts.exr for each pair: pair_I_J.R, .G and .B");
  examples::add_number(app, "--film-reflectance", options.film_reflectance, {0, 1, "a number from 0 to 1"},
                       "reflectance of the film, which is then the first mirror of more pairs");
  examples::add_number(app, "--exposure", options.exposure, examples::positive_number,
                       "brightness of the PNG: 1 shows the 99th percentile of the lit pixels as white");
  examples::add_threads(app);
  options.output.add(app);
  examples::add_formats(app, options.formats, "png (sRGB)");
  examples::add_out_folder(app, options.out_folder)->required();

  return examples::run(app, argc, argv, [&] {
    constexpr examples::Range counts{1, 1e6, "all, or a whole number from 1 to 1000000"};
    const bool all = options.pairs == "all";
    const double most = all ? infinity : examples::parse_number("--pairs", options.pairs, counts);
    if (most != std::floor(most)) throw Error("--pairs = " + options.pairs + "; must be " + counts.words);
    const examples::LoadedLens loaded = examples::load_lens(options.setup, options.wavelengths_nm);
    petzval::Lens lens = examples::focused(loaded, options.setup);
    const std::optional<petzval::Lens> coated = examples::coated(lens, options.coatings);
    if (coated) lens = *coated;
    petzval::Film film = options.setup.sized_film(options.width, options.height, usual_columns);
    examples::say_what_does_not_fit(lens, film);
    const petzval::Camera camera(lens, film, {.model = petzval::ModelKind::exact_double});
    const Light light = light_of(options, camera);

    petzval::GhostOptions ghost{.film_reflectance = options.film_reflectance, .threads = examples::threads()};
    if (options.model == "paraxial") ghost.model = petzval::GhostModel::paraxial;
    petzval::Ghosts ghosts = petzval::ghost_pairs(lens, light.point, ghost);
    if (!coated && !petzval::uncoated_surfaces(lens).empty()) {
      examples::note(lens.name() + ": the file states no coatings; all surfaces are uncoated");
    }
    if (static_cast<double>(ghosts.pairs.size()) > most) ghosts.pairs.resize(static_cast<std::size_t>(most));
    if (ghosts.left_out > 0) {
      const std::string held =
          ghosts.left_out_energy < 1 ? "at most " + number(ghosts.left_out_energy, 3) : "an unknown part";
      examples::note(std::to_string(ghosts.left_out) + " pairs are left out; they hold " + held + " of the light");
    }
    const petzval::GhostAudit audit = petzval::ghost_audit(lens, light.point, ghost);

    const auto weights = examples::rgb_weights(options.wavelengths_nm, examples::white_light(options.white_point));
    const auto picture = [&] { return examples::ghost_picture(lens, light.point, film, weights, ghost); };
    std::map<std::string, std::vector<float>> channels;
    if (layers) {
      for (const GhostPair& pair : ghosts.pairs) {
        ghost.only = {{pair.first, pair.second}};
        examples::add_channels(channels, "pair_" + std::to_string(pair.first) + '_' + std::to_string(pair.second) + '.',
                               picture());
      }
    }
    ghost.only.clear();
    for (const GhostPair& pair : ghosts.pairs) {
      if (!all) ghost.only.push_back({pair.first, pair.second});
    }
    ghost.starburst = starburst;
    const petzval::RgbImage image = picture();

    Json report{{"lens", loaded.id},
                {"light",
                 {{"x_deg", light.x_deg},
                  {"y_deg", light.y_deg},
                  {"distance_mm", examples::finite_or_null(light.distance_mm)}}},
                {"entering_w_per_w_m2", ghosts.entering_mm2 * 1e-6},
                {"wavelength_nm", lens.wavelengths_nm()[lens.primary_wavelength()]},
                {"audit", to_json(audit)},
                {"left_out", ghosts.left_out},
                {"left_out_energy", ghosts.left_out_energy},
                {"pairs", Json::array()}};
    for (const GhostPair& pair : ghosts.pairs) report["pairs"].push_back(to_json(pair));

    const std::filesystem::path folder = options.out_folder;
    examples::make_folder(folder);
    const auto write = [&](const std::string& name, const std::string& text) {
      examples::write_text(folder / name, text);
      options.output.file(folder / name);
    };
    for (const auto& file : examples::write_picture(image, examples::expose(image, options.exposure).picture,
                                                    options.formats, folder / "ghosts", {}, {}, channels)) {
      options.output.file(file);
    }
    const petzval::FieldPoint field = field_of(light, lens, options.setup.focus.origin);
    constexpr std::size_t drawn = 5;
    const std::span<const GhostPair> brightest(ghosts.pairs.data(), std::min(drawn, ghosts.pairs.size()));
    write(loaded.id + "_ghosts.svg", petzval::ghost_figure(lens, field.z, field.field_rad, brightest));
    write("ghosts.txt", table_of(ghosts, audit));
    write("ghosts.json", report.dump(1) + '\n');
    options.output.report(report);
  });
}
