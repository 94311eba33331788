// SPDX-License-Identifier: Apache-2.0
// Renders the image of a point light for several focus distances: an EXR and a PNG for each, a contact sheet, and a
// JSON file of measurements.
//
//   petzval psf double_gauss_100mm_f1.35 --at 1m --focus 80cm,90cm,1m,1.1m,1.2m --out out
//   petzval psf planar_50mm_f1.4 double_gauss_52mm_f1.8 --at 5m --focus 2m --fields 0,10,20 --out out
#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "petzval/analysis/wavefront.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/bokeh.hpp"
#include "support/bokeh_flags.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/design.hpp"
#include "support/files.hpp"
#include "support/interrupt.hpp"
#include "support/load_lens.hpp"
#include "support/picture_files.hpp"
#include "support/svg_page.hpp"
#include "support/text.hpp"

namespace {

using examples::finite_or_null;
using examples::Json;

constexpr int picture_pixels = 512;

struct Options {
  std::vector<std::string> formats;
  std::vector<std::string> lenses;
  std::string out_folder, white_point = "D65";
  examples::CameraFlags setup;  ///< `lenses` has the names of its lens file
  std::vector<double> focus_mm, fields_deg{0};
  double subject_mm = 0, tolerance = 0, width_mm = 0, exposure = 1;
  bool diffraction = false;
  std::uint32_t samples = 1u << 21;
  petzval::Spectrum light;  ///< spectrum of the white point
  examples::Output output;

  /// True for rays of the unmodified lens, false for rays of a camera.
  bool plain() const noexcept {
    return setup.camera.model == petzval::ModelKind::exact_double && setup.camera.expressive.empty() &&
           examples::plain_bokeh(setup);
  }
};

struct Picture {
  double field_deg = 0, focus_mm = 0;
  examples::BokehScene scene;
  std::optional<petzval::Camera> camera;
  petzval::Psf image;
  std::optional<petzval::DiffractionPsf> waves;  ///< with --diffraction
  examples::Tile tile;                           ///< of the contact sheet
};

/// A lens and its pictures, by field and focus.
struct Subject {
  examples::LoadedLens loaded;
  petzval::CameraSetup setup;  ///< of the first focus
  std::vector<Picture> pictures;
};

petzval::DiffractionPsf waves_of(const Picture& picture, double half_width_mm) {
  return examples::for_flag("--diffraction", [&] {
    return petzval::diffraction_psf(picture.scene.lens, picture.scene.light,
                                    {.pixels = picture_pixels,
                                     .half_width_mm = half_width_mm,
                                     .centre = picture.image.size.centroid,
                                     .threads = examples::threads()});
  });
}

petzval::Psf image_of(const Picture& picture, const petzval::PsfOptions& options) {
  if (picture.camera) return petzval::point_image(*picture.camera, picture.scene.light, options);
  return petzval::point_image(picture.scene.lens, picture.scene.light, options);
}

/// Half of the width of all pictures: the given width, or the largest blur, with diffraction at least 15 Airy radii.
/// 0 for the pictures of one field of one lens by rays, which fit their own blur.
double common_half_width(std::span<const Subject> subjects, const Options& options) {
  if (options.width_mm > 0) return options.width_mm / 2;
  double half_width = 0;
  if (!options.diffraction && subjects.size() * options.fields_deg.size() == 1) return half_width;
  for (const Subject& subject : subjects) {
    for (const Picture& p : subject.pictures) {
      const double blur = image_of(p, {.samples = 1u << 12, .pixels = 16}).size.max_radius;
      half_width =
          std::max({half_width, 1.1 * blur, options.diffraction ? 15 * petzval::airy_radius(p.scene.lens) : 0});
    }
  }
  return half_width;
}

/// Removes from a set-up what PSFs do not use, with a note.
void leave_out_unused(examples::CameraFlags& setup) {
  std::string names;
  const auto leave_out = [&names](bool found, const char* name) {
    if (found) names += (names.empty() ? "" : ", ") + std::string(name);
  };
  petzval::Film& film = setup.film;
  leave_out(film.tilted(), "tilt and swing of the film");
  leave_out(film.shift_x_mm != 0 || film.shift_y_mm != 0, "shift of the film");
  leave_out(film.z_mm || film.travel_mm != 0, "position of the film");
  leave_out(setup.coating || setup.camera.transmission, "coatings");
  leave_out(!setup.focal_points.empty(), "focal points");
  film = {.width_mm = film.width_mm, .height_mm = film.height_mm, .columns = film.columns, .rows = film.rows};
  setup.coating.reset(), setup.camera.transmission = false;
  setup.focal_points.clear(), setup.focal_surface = {};
  if (!names.empty()) examples::note(setup.file + ": not used by psf: " + names);
}

/// The focused lenses, before tracing. @throws petzval::Error if a focus is out of reach
std::vector<Picture> focused(const examples::LoadedLens& loaded, const Options& options,
                             const petzval::BokehControls& controls) {
  const petzval::Lens lens = examples::stopped_down(loaded.lens, options.setup);
  std::vector<Picture> pictures;
  petzval::CameraOptions camera = options.setup.camera;
  camera.normalisation = petzval::Normalisation::irradiance, camera.bokeh = controls;
  camera.bokeh.rate_of_change *= 36 / std::max(options.setup.film.width_mm, options.setup.film.height_mm);
  for (const double field : options.fields_deg) {
    const examples::BokehSetup setup{
        .light_mm = options.subject_mm, .focus = options.setup.focus, .field_rad = petzval::radians(field)};
    for (const double focus : options.focus_mm) {
      Picture picture{field, focus, examples::focused_scene(lens, focus, setup), {}, {}, {}, {}};
      examples::want_light(picture.scene.lens, picture.scene.light, "--fields");
      if (!options.plain()) {
        picture.camera = examples::camera_of(picture.scene, camera);
      }
      pictures.push_back(std::move(picture));
    }
  }
  return pictures;
}

/// The contact sheet of a lens, at one scale: a row for each field. Moves the tiles of the pictures.
examples::Sheet sheet_of(Subject& subject, const Options& options) {
  examples::Sheet sheet{"Bokeh of a point light", {}, examples::bokeh_notes()};
  for (std::size_t i = 0; i < subject.pictures.size(); i += options.focus_mm.size()) {
    sheet.rows.push_back(
        {.title = subject.loaded.lens.name(),
         .subtitle =
             "point light at " + examples::number(options.subject_mm) + " mm, " +
             examples::number(subject.pictures[i].field_deg) + "°; distances from the " +
             examples::in_words(options.setup.focus.origin) + "; focus " +
             examples::in_words(options.setup.focus.criterion) +
             (options.setup.f_number ? "; f/" + examples::number(*options.setup.f_number) : "; wide open") +
             (options.setup.iris.blades > 0 ? "; " + std::to_string(options.setup.iris.blades) + " blades" : "") +
             (options.setup.camera.model == petzval::ModelKind::exact_double
                  ? ""
                  : "; " + std::string(petzval::name(options.setup.camera.model))) +
             (options.diffraction ? "; with diffraction" : ""),
         .tiles = {}});
    for (Picture& p : std::span(subject.pictures).subspan(i, options.focus_mm.size())) {
      sheet.rows.back().tiles.push_back(std::move(p.tile));
    }
  }
  return sheet;
}

Json to_json(std::span<const Picture> pictures, const Subject& subject, const Options& options,
             const petzval::BokehControls& controls) {
  const examples::LoadedLens& loaded = subject.loaded;
  Json json{{"setup", Json::parse(petzval::to_json(subject.setup))},
            {"lens", loaded.lens.name()},
            {"model", petzval::name(options.setup.camera.model)},
            {"lens_ratio", controls.lens_ratio},
            {"rate_of_change", controls.rate_of_change},
            {"weight_distribution", controls.weight_distribution},
            {"weight_strength", controls.weight_strength},
            {"keep_light", controls.keep_light},
            {"iris_image", controls.weight_map.keep_mean ? "" : options.setup.iris_map},
            {"weight_map", controls.weight_map.keep_mean ? options.setup.iris_map : ""},
            {"weights_add_light", controls.edge().light_added()},
            {"dispersion", petzval::name(loaded.lens.dispersion())},
            {"wavelengths_nm", options.setup.lens.wavelengths_nm},
            {"white_point", options.white_point},
            {"subject_distance_mm", finite_or_null(options.subject_mm)},
            {"distance_from", petzval::name(options.setup.focus.origin)},
            {"f_number_real", petzval::real_f_number(examples::stopped_down(loaded.lens, options.setup))},
            {"fields_deg", options.fields_deg},
            {"samples", options.samples},
            {"with_diffraction", options.diffraction},
            {"frame", examples::picture_frame},
            {"results", Json::array()}};
  const auto sum = [](const auto& rays) { return std::accumulate(rays.begin(), rays.end(), std::uint64_t(0)); };
  for (const Picture& p : pictures) {
    const auto pair = [](const petzval::Vec2<double>& v) { return std::array{v.x, v.y}; };
    const auto if_any = [&](const auto& size) { return p.image.mean_throughput > 0 ? Json(size) : Json(); };
    const double airy_radius = petzval::airy_radius(p.scene.lens);
    const petzval::Iris& iris = p.scene.lens.iris();
    const bool image = !options.setup.iris_map.empty() && !controls.weight_map.keep_mean;
    const double iris_area = image ? petzval::iris_area(iris, controls.weight_map) : petzval::iris_area(iris);
    json["results"].push_back(
        {{"field_deg", p.field_deg},
         {"focus_mm", finite_or_null(p.focus_mm)},
         {"film_z_mm", p.scene.lens.film_z()},
         {"criterion", petzval::name(options.setup.focus.criterion)},
         {"throughput", p.image.mean_throughput},
         {"throughput_of_round_iris", options.setup.iris_area == "equal"
                                          ? p.image.mean_throughput * std::numbers::pi / petzval::iris_area(iris)
                                          : p.image.mean_throughput},
         {"centroid_mm", if_any(pair(p.image.size.centroid))},
         {"rms_radius_mm", if_any(p.image.size.rms_radius)},
         {"second_moments_mm2", if_any(std::array{p.image.size.xx, p.image.size.yy, p.image.size.xy})},
         {"radius_mm", if_any(p.image.size.max_radius)},
         {"iris_area_share", iris_area / std::numbers::pi},
         {"airy_radius_mm", finite_or_null(airy_radius)},
         {"diffraction", if_any(petzval::name(petzval::diffraction(airy_radius, p.image.size)))},
         {"rays", sum(p.image.sent)},
         {"rays_sent", sum(p.image.sent)},
         {"rays_transmitted", sum(p.image.transmitted) / p.image.units_per_ray},
         {"radial_profile", p.image.radial_profile},
         {"error", p.image.error},
         {"strehl", p.waves ? Json(p.waves->strehl) : Json()},
         {"picture_centre_mm", pair(p.waves ? p.waves->centre : p.image.centre)},
         {"picture_pixel_mm", p.waves ? p.waves->pixel_mm : p.image.pixel_mm}});
  }
  return json;
}

/// A table of all results, from their JSON. Infinite distances are empty.
std::string to_csv(const Json& lenses, std::span<const Subject> subjects) {
  constexpr std::array keys{"field_deg", "focus_mm",      "film_z_mm",       "throughput",
                            "radius_mm", "rms_radius_mm", "picture_pixel_mm"};
  std::ostringstream csv;
  csv << "lens";
  for (const char* key : keys) csv << ',' << key;
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    for (const Json& result : lenses[i]["results"]) {
      csv << '\n' << std::quoted(subjects[i].loaded.id, '"', '"');
      for (const char* key : keys) csv << ',' << (result[key].is_null() ? "" : result[key].dump());
    }
  }
  csv << '\n';
  return csv.str();
}

/// Traces the pictures. Each complete picture is written at once, with the measurements of all complete pictures, so
/// that an interrupted run loses only the current picture.
void render(std::vector<Subject> subjects, const Options& options, const petzval::BokehControls& controls) {
  const std::filesystem::path folder = options.out_folder;
  examples::make_folder(folder);
  const bool one = subjects.size() == 1;
  const std::filesystem::path numbers = folder / ((one ? subjects.front().loaded.id + '_' : "") + "bokeh.json");
  const double half_width = common_half_width(subjects, options);
  Json lenses = Json::array();
  const auto report = [&] { return one ? lenses.front() : Json{{"lenses", lenses}}; };
  {
    examples::Progress progress("bokeh", subjects.size() * subjects.front().pictures.size());
    for (Subject& subject : subjects) {
      const examples::LoadedLens& loaded = subject.loaded;
      lenses.emplace_back();
      for (std::size_t i = 0; i < subject.pictures.size(); ++i) {
        Picture& p = subject.pictures[i];
        progress.step((one ? "" : loaded.id + ", ") + examples::focus_caption(p.focus_mm));
        p.image = image_of(p, {.samples = options.samples,
                               .tolerance = options.tolerance,
                               .pixels = picture_pixels,
                               .half_width_mm = half_width,
                               .threads = examples::threads()});
        if (options.diffraction) p.waves = waves_of(p, half_width);
        const std::string field = options.fields_deg.size() > 1 ? '_' + examples::number(p.field_deg) + "deg" : "",
                          stem = loaded.id + field + "_focus_" + examples::number(p.focus_mm) + "mm";
        const examples::Together uninterrupted;
        const petzval::RgbImage image =
            p.waves ? examples::irradiance(*p.waves, options.light) : examples::irradiance(p.image, options.light);
        p.tile = examples::bokeh_tile(p.focus_mm, p.image, examples::expose(image, options.exposure));
        for (const auto& file : examples::write_picture(image, p.tile.picture, options.formats, folder / stem)) {
          options.output.file(file);
        }
        if (p.waves) p.tile.width_mm = picture_pixels * p.waves->pixel_mm;
        p.image.counts = {};  // many lenses and fields must fit into memory
        lenses.back() = to_json(std::span(subject.pictures).first(i + 1), subject, options, controls);
        examples::write_text(numbers, report().dump(1) + '\n');
      }
      const std::filesystem::path file = folder / (loaded.id + "_bokeh.svg");
      examples::write_svg(examples::draw_sheet(sheet_of(subject, options)), file);
      options.output.file(file);
    }
  }
  if (!one || options.fields_deg.size() > 1) {
    const std::filesystem::path table = std::filesystem::path(numbers).replace_extension(".csv");
    examples::write_text(table, to_csv(lenses, subjects));
    options.output.file(table);
  }
  options.output.file(numbers);
  options.output.report(report());
}

}  // namespace

int commands::psf(int argc, char** argv) {
  Options options;
  examples::App app(
      "Renders the point spread function of a lens for a point light, focused at several distances: by rays, or with "
      "--diffraction by waves.\n"
      "Writes to DIR and prints the paths, each picture as soon as it is complete: LENS_focus_<D>mm.exr (float, "
      "linear: fraction of the light in the paraxial entrance pupil, per mm^2 of film), LENS_focus_<D>mm.png (each "
      "with its own exposure), LENS_bokeh.svg (all at one scale) and LENS_bokeh.json. Several lenses or fields: "
      "pictures LENS_<F>deg_focus_<D>mm of one scale, and one table of all, bokeh.csv and bokeh.json (one lens: "
      "LENS_bokeh). Images show the film as a "
      "photograph does, rotated by 180 degrees (+x to the left, +y down); centroids are in the axes of the film. "
      "throughput is the light on the film divided by the light on the paraxial entrance pupil of the open stop; "
      "throughput_of_round_iris is divided by the light on the pupil of a round iris with the same f-number, which is "
      "smaller with --iris-area equal. The lens is focused at the primary wavelength, which is nearest to the d line "
      "(587.5618 nm).",
      "petzval psf");
  options.setup.camera.model = petzval::ModelKind::exact_double;
  options.setup.lens.wavelengths_nm = {petzval::d_line_nm};
  examples::add_setup(app, options.setup);
  examples::add_lenses(app, options.setup.lens, options.lenses);
  examples::add_length(app, "--at", options.subject_mm, examples::positive_length,
                       "distance of the light (mm), or inf; at --fields of 90 degrees and more, along the ray from the "
                       "entrance pupil")
      ->required()
      ->default_str("");
  examples::add_lengths(app, "--focus", options.focus_mm, examples::positive_length, "focus distances (mm), or inf")
      ->required();
  examples::add_focus(app, options.setup.focus);
  const auto* const wavelengths = examples::add_wavelengths(
      app, "--wavelengths", options.setup.lens.wavelengths_nm,
      "wavelengths of the light; several, from 420 to 680 nm, are weighted to RGB by the CIE 1931 functions");
  examples::add_white_point(app, options.white_point);
  const auto* const model = examples::add_model(app, options.setup.camera.model);
  examples::add_iris(app, options.setup);
  examples::add_bokeh(app, options.setup);
  examples::add_numbers(app, "--fields", options.fields_deg, examples::field_angle,
                        "angles of the light towards +y, seen from the paraxial entrance pupil (degrees)");
  examples::add_samples(app, options.samples);
  examples::add_number(
      app, "--tolerance", options.tolerance, {std::numeric_limits<double>::min(), 1, "a number above 0, at most 1"},
      "largest relative error of the radial profile: rays are added, from 2^14 by doubling, until it is reached, or "
      "--rays")
      ->default_str("all samples");
  auto* const diffraction = app.add_flag(
      "--diffraction", options.diffraction,
      "pictures with diffraction, for stopped-down lenses and the spikes of an iris. Wide pictures in colour need "
      "many wavelengths (--wavelengths visible:2). Numbers of the JSON other than strehl are of rays");
  examples::add_number(app, "--width", options.width_mm, examples::positive_number,
                       "width of each picture on the film (mm)")
      ->default_str("fits the blur");
  examples::add_number(app, "--exposure", options.exposure, examples::positive_number,
                       "brightness of the PNG: 1 shows the 99th percentile of the lit pixels as white; spikes of an "
                       "iris need 100 and more")
      ->capture_default_str();
  examples::add_formats(app, options.formats, "each with its own exposure");
  options.output.add(app);
  examples::add_out_folder(app, options.out_folder)->required();

  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] {
    leave_out_unused(options.setup);
    options.setup.film = options.setup.sized_film(0, 0, 600);
    // Set-ups of pictures have the fast form of exact rays.
    petzval::ModelKind& kind = options.setup.camera.model;
    if (diffraction->given() && !model->given() && kind == petzval::ModelKind::exact_float) {
      kind = petzval::ModelKind::exact_double;
    }
    if (diffraction->given() && !options.plain()) {
      throw petzval::Error(
          "--diffraction needs exact rays of the lens as it is; must be without --model and bokeh controls" +
          (options.setup.file.empty() ? "" : "; with " + options.setup.file + " model = " + std::string(name(kind))));
    }
    petzval::LensSource& source = options.setup.lens;
    if (options.focus_mm.empty()) options.focus_mm = {*options.setup.focus_mm};
    std::vector<double>& nm = source.wavelengths_nm;
    if (nm.empty()) nm = {petzval::d_line_nm};
    if (!wavelengths->given()) std::ranges::sort(nm);
    options.light = examples::white_light(options.white_point);
    try {  // before the work
      examples::rgb_weights(nm, options.light);
    } catch (const petzval::Error& error) {
      if (wavelengths->given() || options.setup.file.empty()) throw;
      examples::note(options.setup.file + ": " + error.what() + "; psf uses the d line, or --wavelengths");
      nm = {petzval::d_line_nm};
    }
    const petzval::BokehControls controls = examples::controls_of(options.setup);
    std::vector<Subject> subjects;
    options.setup.focus_mm = options.focus_mm.front();
    if (options.lenses.empty()) options.lenses = {source.file};
    for (const std::string& lens : options.lenses) {
      source.file = lens;
      Subject subject{examples::load_lens(options.setup, nm), {}, {}};
      for (const Subject& other : subjects) {
        if (other.loaded.id == subject.loaded.id) {
          throw petzval::Error("LENS = " + lens + ": another lens is named " + subject.loaded.id +
                               "; names must differ");
        }
      }
      subject.pictures = focused(subject.loaded, options, controls);
      subject.setup = options.setup.used_with(subject.loaded.lens);
      subjects.push_back(std::move(subject));
    }
    render(std::move(subjects), options, controls);
  });
}
