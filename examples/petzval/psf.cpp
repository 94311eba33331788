// SPDX-License-Identifier: Apache-2.0
// Renders the image of a point light for several focus distances: an EXR and a PNG for each, a contact sheet, and a
// JSON file of measurements.
//
//   petzval psf data/lenses/double_gauss_100mm_f1.35.json --at 1000
//             --focus 800,900,1000,1100,1200 --out out
#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
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
#include "support/iris_setup.hpp"
#include "support/load_lens.hpp"
#include "support/picture_files.hpp"
#include "support/text.hpp"

namespace {

using examples::finite_or_null;
using examples::Json;

constexpr int picture_pixels = 512;

struct Options {
  std::vector<std::string> formats;
  examples::LensInput lens_file;
  std::string model = "exact_double", out_folder, white_point = "D65";
  examples::FocusFlags focus;
  std::vector<double> focus_mm, wavelengths_nm{petzval::d_line_nm};
  double subject_mm = 0, field_deg = 0, tolerance = 0, width_mm = 0, exposure = 1;
  bool diffraction = false;
  examples::IrisSetup iris;
  examples::BokehFlags bokeh;
  std::uint32_t samples = 1u << 21;
  petzval::Spectrum light;  ///< spectrum of the white point
  examples::Output output;

  /// True for rays of the unmodified lens, false for rays of a camera.
  bool plain() const noexcept { return model == "exact_double" && bokeh.change_nothing(); }
};

struct Picture {
  double focus_mm = 0;
  examples::BokehScene scene;
  std::optional<petzval::Camera> camera;
  petzval::PointImage image;
  std::optional<petzval::DiffractionPsf> waves;  ///< with --diffraction
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

petzval::PointImage image_of(const Picture& picture, const petzval::PsfOptions& options) {
  if (picture.camera) return petzval::point_image(*picture.camera, picture.scene.light, options);
  return petzval::point_image(picture.scene.lens, picture.scene.light, options);
}

/// Half of the width of all pictures with diffraction: the given width, or 15 Airy radii and the blur of the rays.
double half_width_of_waves(std::span<const Picture> pictures, const Options& options) {
  if (options.width_mm > 0) return options.width_mm / 2;
  double half_width = 0;
  for (const Picture& p : pictures) {
    const double blur = image_of(p, {.samples = 1u << 12, .pixels = 16}).size.max_radius;
    half_width = std::max({half_width, 1.1 * blur, 15 * petzval::airy_radius(p.scene.lens)});
  }
  return half_width;
}

/// The focused lenses, before tracing. @throws petzval::Error if a focus is out of reach
std::vector<Picture> focused(const examples::LoadedLens& loaded, const Options& options,
                             const petzval::BokehControls& controls) {
  const petzval::Lens lens = examples::stopped_down(loaded.lens, options.iris);
  const examples::BokehSetup setup{.light_mm = options.subject_mm,
                                   .origin = options.focus.distance_origin(),
                                   .criterion = options.focus.options().criterion,
                                   .field_rad = petzval::radians(options.field_deg)};
  std::vector<Picture> pictures;
  for (const double focus : options.focus_mm) {
    Picture picture{focus, examples::focused_scene(lens, focus, setup), {}, {}, {}};
    examples::want_light(picture.scene.lens, picture.scene.light, "--fields");
    if (!options.plain()) {
      picture.camera =
          examples::camera_of(picture.scene, {.model = *petzval::model_named(options.model), .bokeh = controls});
    }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

/// The contact sheet. All tiles have the scale of the largest blur.
examples::Sheet contact_sheet(const std::vector<Picture>& pictures, const examples::LoadedLens& loaded,
                              const Options& options) {
  double half_width = std::max(options.width_mm / 2, 1e-4);  // a perfect point has no size
  for (const Picture& p : pictures) {
    if (p.waves) half_width = p.waves->pixel_mm * p.waves->pixels / 2;
    if (!p.waves && options.width_mm == 0) half_width = std::max(half_width, 1.08 * p.image.size.max_radius);
  }
  const int tile_pixels = examples::tile_pixels(pictures.size());
  examples::SheetRow row{
      .title = loaded.lens.name(),
      .subtitle = "point light at " + examples::number(options.subject_mm) + " mm, " +
                  examples::number(options.field_deg) + "°; distances from the " + options.focus.from() + "; focus " +
                  options.focus.criterion +
                  (options.iris.f_number > 0 ? "; f/" + examples::number(options.iris.f_number) : "; wide open") +
                  (options.iris.blades > 0 ? "; " + std::to_string(options.iris.blades) + " blades" : "") +
                  (options.model == "exact_double" ? "" : "; " + options.model) +
                  (options.diffraction ? "; with diffraction" : ""),
      .pixel_mm = 2 * half_width / tile_pixels,
      .tiles = {}};
  examples::Progress progress("contact sheet", pictures.size());
  for (const Picture& p : pictures) {
    progress.step(examples::focus_caption(p.focus_mm));
    // Waves replace the picture below; only the numbers of the rays are needed.
    const auto image = p.waves ? p.image
                               : image_of(p, {.samples = options.samples,
                                              .pixels = tile_pixels,
                                              .half_width_mm = half_width,
                                              .threads = examples::threads()});
    examples::Tile tile = examples::bokeh_tile(p.focus_mm, image, options.light);
    if (p.waves) {
      const petzval::RgbImage waves = examples::irradiance(*p.waves, options.light);
      const auto shown = examples::expose(examples::with_width(waves, tile_pixels), options.exposure);
      tile.picture = shown.picture;
      tile.captions.back() = examples::white_caption(shown);
    }
    row.tiles.push_back(std::move(tile));
  }
  return {"Bokeh of a point light", {std::move(row)}, examples::bokeh_notes()};
}

Json to_json(std::span<const Picture> pictures, const examples::LoadedLens& loaded, const Options& options,
             const petzval::BokehControls& controls) {
  Json json{{"lens", loaded.lens.name()},
            {"model", options.model},
            {"lens_ratio", controls.lens_ratio},
            {"rate_of_change", controls.rate_of_change},
            {"weight_distribution", controls.weight_distribution},
            {"weight_strength", controls.weight_strength},
            {"keep_light", controls.keep_light},
            {"iris_image", options.bokeh.iris_image},
            {"weight_map", options.bokeh.weight_map},
            {"weights_add_light", controls.edge().light_added()},
            {"dispersion", petzval::name(loaded.lens.dispersion())},
            {"wavelengths_nm", options.wavelengths_nm},
            {"white_point", options.white_point},
            {"subject_distance_mm", finite_or_null(options.subject_mm)},
            {"distance_from", options.focus.origin},
            {"f_number_real", petzval::real_f_number(examples::stopped_down(loaded.lens, options.iris))},
            {"field_deg", options.field_deg},
            {"samples", options.samples},
            {"with_diffraction", options.diffraction},
            {"results", Json::array()}};
  const auto sum = [](const auto& rays) { return std::accumulate(rays.begin(), rays.end(), std::uint64_t(0)); };
  for (const Picture& p : pictures) {
    const auto pair = [](const petzval::Vec2<double>& v) { return std::array{v.x, v.y}; };
    const auto if_any = [&](const auto& size) { return p.image.throughput > 0 ? Json(size) : Json(); };
    const double airy_radius = petzval::airy_radius(p.scene.lens);
    const petzval::Iris& iris = p.scene.lens.iris();
    const double iris_area =
        options.bokeh.iris_image.empty() ? petzval::iris_area(iris) : petzval::iris_area(iris, controls.weight_map);
    json["results"].push_back(
        {{"focus_mm", finite_or_null(p.focus_mm)},
         {"film_z_mm", p.scene.lens.film_z()},
         {"criterion", options.focus.criterion},
         {"throughput", p.image.throughput},
         {"throughput_of_round_iris", options.iris.area == "equal"
                                          ? p.image.throughput * std::numbers::pi / petzval::iris_area(iris)
                                          : p.image.throughput},
         {"centroid_mm", if_any(pair(p.image.size.centroid))},
         {"rms_radius_mm", if_any(p.image.size.rms_radius)},
         {"second_moments_mm2", if_any(std::array{p.image.size.xx, p.image.size.yy, p.image.size.xy})},
         {"radius_mm", if_any(p.image.size.max_radius)},
         {"iris_area_share", iris_area / std::numbers::pi},
         {"airy_radius_mm", finite_or_null(airy_radius)},
         {"diffraction", if_any(petzval::name(petzval::diffraction(airy_radius, p.image.size)))},
         {"rays", sum(p.image.psf.sent)},
         {"rays_sent", sum(p.image.psf.sent)},
         {"rays_transmitted", sum(p.image.psf.transmitted) / p.image.psf.units_per_ray},
         {"radial_profile", p.image.radial_profile},
         {"error", p.image.error},
         {"strehl", p.waves ? Json(p.waves->strehl) : Json()},
         {"picture_centre_mm", pair(p.waves ? p.waves->centre : p.image.psf.centre)},
         {"picture_pixel_mm", p.waves ? p.waves->pixel_mm : p.image.psf.pixel_mm}});
  }
  return json;
}

/// Traces the pictures. Each complete picture is written at once, with the measurements of all complete pictures, so
/// that an interrupted run loses only the current picture.
void render(std::vector<Picture> pictures, const examples::LoadedLens& loaded, const Options& options,
            const petzval::BokehControls& controls) {
  const std::filesystem::path folder = options.out_folder;
  examples::make_folder(folder);
  const std::filesystem::path numbers = folder / (loaded.id + "_bokeh.json");
  {
    const double half_width = options.diffraction ? half_width_of_waves(pictures, options) : 0;
    examples::Progress progress("bokeh", pictures.size());
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      Picture& p = pictures[i];
      progress.step(examples::focus_caption(p.focus_mm));
      p.image = image_of(p, {.samples = options.samples,
                             .tolerance = options.tolerance,
                             .pixels = picture_pixels,
                             .half_width_mm = options.width_mm / 2,
                             .threads = examples::threads()});
      if (options.diffraction) p.waves = waves_of(p, half_width);
      const std::string stem = loaded.id + "_focus_" + examples::number(p.focus_mm) + "mm";
      const petzval::RgbImage image =
          p.waves ? examples::irradiance(*p.waves, options.light) : examples::irradiance(p.image.psf, options.light);
      for (const auto& file : examples::write_picture(image, examples::expose(image, options.exposure).picture,
                                                      options.formats, folder / stem)) {
        options.output.file(file);
      }
      const std::span whole = std::span(pictures).first(i + 1);
      examples::write_text(numbers, to_json(whole, loaded, options, controls).dump(1) + '\n');
    }
  }
  examples::write_png(examples::draw_sheet(contact_sheet(pictures, loaded, options)),
                      folder / (loaded.id + "_bokeh.png"));
  options.output.file(folder / (loaded.id + "_bokeh.png"));
  options.output.file(numbers);
  options.output.report(to_json(pictures, loaded, options, controls));
}

}  // namespace

int commands::psf(int argc, char** argv) {
  Options options;
  examples::App app(
      "Renders the point spread function of a lens for a point light, focused at several distances: by rays, or with "
      "--diffraction by waves.\n"
      "Writes to DIR and prints the paths, each picture as soon as it is complete: LENS_focus_<D>mm.exr (float, "
      "linear: fraction of the light in the paraxial entrance pupil, per mm^2 of film), LENS_focus_<D>mm.png (each "
      "with its own exposure), LENS_bokeh.png (all at one scale) and LENS_bokeh.json. Images show the film as a "
      "photograph does, rotated by 180 degrees (+x to the left, +y down); centroids are in the axes of the film. "
      "throughput is the light on the film divided by the light on the paraxial entrance pupil of the open stop; "
      "throughput_of_round_iris is divided by the light on the pupil of a round iris with the same f-number, which is "
      "smaller with --iris-area equal. The lens is focused at the primary wavelength, which is nearest to the d line "
      "(587.5618 nm).",
      "petzval psf");
  examples::add_lens(app, options.lens_file);
  examples::add_length(app, "--at", options.subject_mm, examples::positive_length, "distance of the light (mm), or inf")
      ->required()
      ->default_str("");
  examples::add_lengths(app, "--focus", options.focus_mm, examples::positive_length, "focus distances (mm), or inf")
      ->required();
  examples::add_focus(app, options.focus);
  examples::add_wavelengths(
      app, "--wavelengths", options.wavelengths_nm,
      "wavelengths of the light; several, from 420 to 680 nm, are weighted to RGB by the CIE 1931 functions");
  examples::add_white_point(app, options.white_point);
  examples::add_model(app, options.model)->capture_default_str();
  examples::add_iris(app, options.iris);
  examples::add_bokeh(app, options.bokeh);
  examples::add_number(app, "--fields", options.field_deg, examples::field_angle,
                       "angle of the light towards +y, seen from the paraxial entrance pupil (degrees)");
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
    if (diffraction->given() && !options.plain()) {
      throw petzval::Error(
          "--diffraction needs exact rays of the lens as it is; must be without --model and bokeh controls");
    }
    options.light = examples::white_light(options.white_point);
    examples::rgb_weights(options.wavelengths_nm, options.light);  // throws for invalid wavelengths before the work
    const auto loaded = examples::load_lens(options.lens_file, options.wavelengths_nm);
    const petzval::BokehControls controls = examples::controls_of(options.bokeh);
    render(focused(loaded, options, controls), loaded, options, controls);
  });
}
