// SPDX-License-Identifier: Apache-2.0
// Compares highlights over the field of the real lens with highlights of an artist's power spline, curvature of field
// and dispersion.
//
//   petzval expressive data/lenses/double_gauss_100mm_f1.35.json --focus 1000 --from-lens 2 --out out
//   petzval expressive data/lenses/double_gauss_100mm_f2_28deg.json --power-spline 0:1 0.7:1.02 1:0.97
//                   --dispersion 4 --out out
#include "commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/image/image.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/bokeh.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/load_lens.hpp"
#include "support/svg_page.hpp"
#include "support/text.hpp"

namespace {

using examples::Json;
using examples::number;

constexpr std::array film_fractions{0.0, 0.3, 0.55, 0.75, 0.9};  // fractions of the distance to the film's corner
int tile_pixels() { return examples::tile_pixels(film_fractions.size()); }

struct Options {
  std::string out_folder, model = "thin_two_disc";
  std::vector<double> light_mm;  // if empty: one nearer and one farther than the focus
  examples::CameraFlags setup;
  std::uint32_t samples = 1u << 17;
  examples::Output output;
};

/// One wavelength, or a set over the visible range if the dispersion is changed.
std::vector<double> wavelengths_nm(const Options& options) {
  if (options.setup.camera.expressive.dispersion.empty()) return {petzval::d_line_nm};
  std::vector<double> set;
  for (int nm = 430; nm <= 670; nm += 20) set.push_back(nm);
  return set;
}

/// Mean directions, by exact rays, in which film points between the axis and the corner see the scene, as angles to the
/// axis. Skips film points without light.
/// @throws petzval::Error if no film point has light
std::vector<double> fields_rad(const petzval::Lens& lens, const petzval::Film& film) {
  const petzval::Camera exact(lens, film, {.model = petzval::ModelKind::exact_double});
  std::vector<double> fields;
  for (const double fraction : film_fractions) {
    const petzval::FilmPoint film_point{fraction * film.width_mm / 2, fraction * film.height_mm / 2};
    double weight = 0, x = 0, y = 0, z = 0;
    constexpr std::uint32_t count = 256;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto pupil = petzval::owen_sobol(i, 0);
      const petzval::CameraRay ray = exact.sample({.film = film_point, .pupil_u = pupil.x, .pupil_v = pupil.y});
      const petzval::Vec3<double>& direction = ray.ray.direction;
      if (ray)
        weight += ray.weight, x += ray.weight * direction.x, y += ray.weight * direction.y,
            z -= ray.weight * direction.z;
    }
    if (weight > 0) fields.push_back(fraction == 0 ? 0 : std::atan2(std::hypot(x, y), z));
  }
  if (fields.empty()) throw petzval::Error(lens.name() + ": no light reaches the film");
  if (fields.size() < film_fractions.size()) {
    std::cerr << "note: " << film_fractions.size() - fields.size() << " of " << film_fractions.size()
              << " film points have no light; --film sets a smaller film\n";
  }
  return fields;
}

/// A light in front of the lens, with a separate camera for each field.
class Highlights {
 public:
  Highlights(const petzval::Lens& lens, double light_mm, double origin_z, const Options& options)
      : lens_(lens), z_(origin_z - light_mm), samples_(options.samples) {}

  petzval::Psf image(double field_rad, const petzval::CameraOptions& camera, double half_width_mm,
                     std::uint32_t samples) const {
    const examples::BokehScene scene{lens_, {field_rad, z_}};
    return petzval::point_image(
        examples::camera_of(scene, camera), scene.light,
        {.samples = samples, .pixels = tile_pixels(), .half_width_mm = half_width_mm, .threads = examples::threads()});
  }
  double radius_mm(double field_rad, const petzval::CameraOptions& camera) const {
    return image(field_rad, camera, 0, 1 << 12).size.max_radius;
  }
  examples::Tile tile(double field_rad, const petzval::CameraOptions& camera, double half_width_mm,
                      Json& described) const {
    const petzval::Psf found = image(field_rad, camera, half_width_mm, samples_);
    described["field_deg"] = petzval::degrees(field_rad);
    described["rms_mm"] = found.size.rms_radius;
    return {examples::expose(examples::irradiance(found)).picture,
            {number(petzval::degrees(field_rad), 3) + " degrees",
             found.mean_throughput > 0 ? "RMS " + number(found.size.rms_radius, 3) + " mm" : "no light"},
            2 * half_width_mm};
  }

 private:
  petzval::Lens lens_;
  double z_;
  std::uint32_t samples_;
};

Json description(const petzval::ExpressiveLens& expressive) {
  Json power = Json::array(), offsets = Json::array();
  for (const auto& [radius, value] : expressive.power) power.push_back({radius, value});
  for (const auto& [film_point, offset, weight] : expressive.film_offsets)
    offsets.push_back({film_point.x, film_point.y, offset});
  return {{"power", power},
          {"film_offsets_mm", offsets},
          {"dispersion", expressive.dispersion.empty() ? 1 : expressive.dispersion.front()}};
}

void draw(const Options& options) {
  const examples::LoadedLens loaded = examples::load_lens(options.setup.lens, wavelengths_nm(options));
  const petzval::Lens lens = examples::focused(loaded, options.setup);
  const petzval::Film& film = options.setup.film;
  const petzval::ExpressiveLens expressive = examples::expressive_of(options.setup, lens, film);
  const petzval::ModelKind model = *petzval::model_named(options.model);
  const petzval::Camera bent(lens, film, {.model = model, .expressive = expressive});

  struct Row {
    const char *title, *subtitle;
    petzval::CameraOptions camera;
  };
  const std::vector<Row> rows{{"real lens", "exact rays", {.model = petzval::ModelKind::exact_float}},
                              {"expressive lens", options.model.c_str(), {.model = model, .expressive = expressive}},
                              {"without aberrations", options.model.c_str(), {.model = model}}};
  const double focus = *options.setup.focus_mm;
  std::vector<double> lights = options.light_mm;
  if (lights.empty()) lights = std::isinf(focus) ? std::vector<double>{10000} : std::vector{0.85 * focus, 1.2 * focus};
  const double from_z = petzval::origin_z(lens, options.setup.focus.origin);
  const std::vector<double> fields = fields_rad(lens, film);
  examples::Sheet sheet{
      "Highlights of an expressive lens",
      {},
      {lens.name() + " at f/" + number(petzval::real_f_number(lens), 3) + ", " + examples::focus_caption(focus) +
           " from the " + examples::in_words(options.setup.focus.origin) +
           ". A point light over the field, as in a photograph. The tiles of a light have one scale, and each its own "
           "exposure.",
       "Fields of film points on the diagonal of " + number(film.width_mm) + 'x' + number(film.height_mm) +
           " mm. RMS: distance between the film points of rays and their centroid."}};
  Json highlights_json = Json::array();
  examples::Progress progress("expressive lens", lights.size() * rows.size());
  for (const double light_mm : lights) {
    const Highlights highlights(lens, light_mm, from_z, options);
    double half_width = 0;
    for (const Row& row : rows) {
      for (const double field : fields) half_width = std::max(half_width, highlights.radius_mm(field, row.camera));
    }
    half_width = 1.08 * std::max(half_width, 0.01);
    for (const auto& [title, subtitle, camera] : rows) {
      progress.step(std::string(title) + ", light at " + number(light_mm) + " mm");
      auto& row = sheet.rows.emplace_back(examples::SheetRow{
          .title = title, .subtitle = "light at " + number(light_mm) + " mm, " + subtitle, .tiles = {}});
      for (const double field : fields) {
        Json& tile =
            highlights_json.emplace_back(Json{{"row", title}, {"light_mm", examples::finite_or_null(light_mm)}});
        row.tiles.push_back(highlights.tile(field, camera, half_width, tile));
      }
    }
  }
  const std::filesystem::path folder = options.out_folder;
  examples::make_folder(folder);
  examples::write_svg(examples::draw_sheet(sheet), folder / "highlights.svg");
  Json document = description(expressive);
  document["lens"] = lens.name();
  document["highlights"] = highlights_json;
  examples::write_text(folder / "expressive.json", document.dump(1) + '\n');
  for (const char* name : {"highlights.svg", "expressive.json"}) options.output.file(folder / name);
  options.output.report(document);
}

}  // namespace

int commands::expressive(int argc, char** argv) {
  Options options;
  examples::App app(
      "Draws highlights over the field of a lens, of its first-order model with expressive aberrations, and of the "
      "model without aberrations: DIR/highlights.svg, with the numbers of aberrations and highlights in "
      "DIR/expressive.json. The default aberrations are the real lens's.",
      "petzval expressive");
  examples::add_lens(app, options.setup.lens);
  examples::add_camera(app, options.setup);
  examples::add_expressive(app, options.setup);
  app.add_option("--model", options.model, "first-order model that gets the aberrations")
      ->one_of({"thin", "thick", "thin_two_disc"})
      ->capture_default_str();
  examples::add_lengths(app, "--at", options.light_mm, examples::positive_length, "distances of the lights (mm)")
      ->default_str("0.85 and 1.2 of the focus");
  examples::add_samples(app, options.samples);
  options.output.add(app);
  examples::add_out_folder(app, options.out_folder)->required();
  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] {
    const bool usual = options.setup.camera.expressive.empty() && !app.given("--from-lens");
    if (usual) options.setup.from_lens = 1;
    draw(options);
    if (usual) examples::note("no aberrations are given; the aberrations of the lens are used (--from-lens 1)");
  });
}
