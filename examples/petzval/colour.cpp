// SPDX-License-Identifier: Apache-2.0
// Shows the colours of an out-of-focus point light: contact sheets over a spectral set of wavelengths and over one
// wavelength per channel, a spectral EXR for each picture, and longitudinal and lateral colour as numbers.
//
//   petzval colour data/lenses/double_gauss_100mm_f1.35.json --out out
#include "commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/image/psf.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/bokeh.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/design.hpp"
#include "support/files.hpp"
#include "support/interrupt.hpp"
#include "support/load_lens.hpp"
#include "support/svg_page.hpp"
#include "support/text.hpp"

namespace {

using examples::Json;
using Weights = std::vector<std::array<double, 3>>;

constexpr int picture_pixels = 320;

struct Options {
  std::string out_folder, white_point = "D65";
  double subject_mm = 0;                    ///< 0: twenty focal lengths
  std::vector<double> focus_mm, field_deg;  ///< if empty: distances around the light; the axis and 0.7 of the field
  examples::CameraFlags setup;
  std::uint32_t samples = 1u << 18;
  examples::Output output;

  examples::BokehSetup scene(double field) const {
    return {.light_mm = subject_mm, .focus = setup.focus, .field_rad = petzval::radians(field)};
  }
};

/// Wavelengths over the visible range, including the wavelengths of the RGB triple.
std::vector<double> wavelengths_nm() {
  std::vector<double> set = examples::parse_wavelengths("wavelengths", "visible");
  for (const double nm : petzval::rgb_triple_nm) {
    if (std::find(set.begin(), set.end(), nm) == set.end()) set.push_back(nm);
  }
  std::sort(set.begin(), set.end());
  return set;
}

/// Weights for the set: the weights of the RGB triple, 0 for the other wavelengths.
Weights triple_weights(const std::vector<double>& set) {
  Weights weights(set.size());
  for (std::size_t i = 0; i < petzval::rgb_triple_nm.size(); ++i) {
    const auto at = std::find(set.begin(), set.end(), petzval::rgb_triple_nm[i]);
    weights[static_cast<std::size_t>(at - set.begin())] = petzval::rgb_triple_weights[i];
  }
  return weights;
}

double rounded(double value, int digits) {
  return examples::parse_number("rounded", examples::number(value, digits), examples::finite_number);
}

/// Fills in the options that the command line does not set.
void complete(Options& options, const examples::LoadedLens& loaded) {
  const petzval::Meridian meridian = petzval::main_meridian(loaded.lens);
  const double focal_length = std::abs(petzval::first_order(loaded.lens, {}, meridian).effective_focal_length);
  if (!std::isfinite(focal_length))
    throw petzval::Error(loaded.lens.name() + ": afocal; must be a lens with a finite focal length");
  if (options.subject_mm == 0) options.subject_mm = rounded(20 * focal_length, 2);
  if (options.focus_mm.empty() && std::isinf(options.subject_mm)) {
    for (const double lengths : {25, 50, 100}) options.focus_mm.push_back(rounded(lengths * focal_length, 3));
    options.focus_mm.push_back(options.subject_mm);
  } else if (options.focus_mm.empty()) {
    for (const double ratio : {0.8, 0.9, 1.0, 1.1, 1.2})
      options.focus_mm.push_back(rounded(ratio * options.subject_mm, 3));
  }
  if (options.field_deg.empty())
    options.field_deg = {0, rounded(0.7 * examples::half_field_deg(loaded, loaded.lens), 2)};
}

struct Picture {
  double field_deg = 0, focus_mm = 0, half_width_mm = 0;
  examples::BokehScene scene;
  petzval::Psf image;
};

/// The pictures with their lenses, not traced. @throws petzval::Error  if a focus is out of reach or a field is dark
std::vector<Picture> prepared(const petzval::Lens& lens, const Options& options) {
  std::vector<Picture> pictures;
  for (const double field : options.field_deg) {
    double half_width_mm = 1e-4;  // largest of a field; not 0 for a perfect point
    const std::size_t first = pictures.size();
    for (const double focus : options.focus_mm) {
      const auto scene = examples::focused_scene(lens, focus, options.scene(field));
      examples::want_light(scene.lens, scene.light, "--fields");
      const auto sketch = petzval::point_image(scene.lens, scene.light, {.samples = 1u << 10, .pixels = 1});
      half_width_mm = std::max(half_width_mm, 1.08 * sketch.size.max_radius);
      pictures.push_back({field, focus, 0, scene, {}});
    }
    for (std::size_t i = first; i < pictures.size(); ++i) pictures[i].half_width_mm = half_width_mm;
  }
  return pictures;
}

examples::Sheet sheet(const std::vector<Picture>& pictures, const petzval::Lens& lens, const Options& options,
                      const Weights& spectral) {
  const auto set = wavelengths_nm();
  const std::string title =
      lens.name() + ", " +
      (std::isinf(options.subject_mm) ? std::string("a point light at infinity")
                                      : "a point light at " + examples::number(options.subject_mm) + " mm from the " +
                                            examples::in_words(options.setup.focus.origin));
  examples::Sheet result{
      title,
      {},
      {"The film is at the focus of the primary wavelength, " + examples::number(set[lens.primary_wavelength()]) +
           " nm (" + examples::in_words(options.setup.focus.criterion) +
           "). Tiles of a row have the same film scale and their own exposure.",
       "With three wavelengths each channel has its own image, without intermediate colours."}};
  for (const double field : options.field_deg) {
    for (const bool triple : {false, true}) {
      const Weights weights = triple ? triple_weights(set) : spectral;
      examples::SheetRow row{.title = (field == 0 ? "on the axis" : examples::number(field) + "° off the axis") +
                                      (triple ? ", 3 wavelengths" : ", " + std::to_string(set.size()) + " wavelengths"),
                             .subtitle = triple
                                             ? "650 nm in red, 510 nm in green, 475 nm in blue"
                                             : "white: " + options.white_point + ", weighted by the CIE 1931 functions",
                             .tiles = {}};
      for (const Picture& p : pictures) {
        if (p.field_deg != field) continue;
        std::vector<std::string> captions{examples::focus_caption(p.focus_mm)};
        if (!triple) captions.push_back("RMS radius " + examples::number(p.image.size.rms_radius, 3) + " mm");
        row.tiles.push_back({examples::expose(petzval::render(p.image, weights)).picture, std::move(captions),
                             picture_pixels * p.image.pixel_mm});
      }
      result.rows.push_back(std::move(row));
    }
  }
  return result;
}

Json to_json(const petzval::ChromaticAberration& colour, const Options& options) {
  const auto set = wavelengths_nm();
  Json longitudinal = Json::array(), lateral = Json::array();
  for (std::size_t w = 0; w < set.size(); ++w) {
    longitudinal.push_back({{"wavelength_nm", set[w]},
                            {"paraxial_focus_shift_mm", examples::or_null(colour.paraxial_focus_shift[w])},
                            {"sharpest_focus_shift_mm", examples::or_null(colour.sharpest_focus_shift[w])}});
  }
  for (std::size_t i = 0; i < options.field_deg.size(); ++i) {
    Json rows = Json::array();
    for (std::size_t w = 0; w < set.size(); ++w) {
      rows.push_back({{"wavelength_nm", set[w]}, {"chief_ray_shift_mm", examples::or_null(colour.lateral[i][w])}});
    }
    lateral.push_back({{"field_deg", options.field_deg[i]}, {"wavelengths", std::move(rows)}});
  }
  return {{"longitudinal", std::move(longitudinal)}, {"lateral", std::move(lateral)}};
}

std::string right(const std::string& text, std::size_t width) {
  return std::string(width > text.size() ? width - text.size() : 0, ' ') + text;
}

/// A length in micrometres, rounded to a tenth, with its sign.
std::string micrometres(const std::optional<double>& mm) {
  if (!mm) return "-";
  const double tenths = std::round(*mm * 1e4);
  std::string text = examples::number(std::abs(tenths) / 10);
  if (text.find('.') == std::string::npos) text += ".0";
  return (tenths < 0 ? "-" : tenths > 0 ? "+" : "") + text;
}

std::string table(const petzval::ChromaticAberration& colour, const Options& options) {
  const auto set = wavelengths_nm();
  std::string text = "wavelength   paraxial focus   sharpest film";
  for (const double field : options.field_deg) text += right("height at " + examples::number(field) + " deg", 22);
  text += "\n";
  for (std::size_t w = 0; w < set.size(); ++w) {
    text += right(examples::number(set[w]), 7) + " nm" + right(micrometres(colour.paraxial_focus_shift[w]), 14) +
            " um" + right(micrometres(colour.sharpest_focus_shift[w]), 13) + " um";
    for (const auto& lateral : colour.lateral) text += right(micrometres(lateral[w]), 19) + " um";
    text += "\n";
  }
  return text;
}

}  // namespace

int commands::colour(int argc, char** argv) {
  Options options;
  examples::App app(
      "Shows the colours of an out-of-focus point light, on and off the axis, over 26 wavelengths and over one "
      "wavelength per channel (650, 510, 475 nm).\n"
      "Prints longitudinal and lateral colour: shifts of focus and chief ray against the primary wavelength (nearest "
      "to the d line); positive: farther from the lens, or towards +y on the film. Writes to DIR and prints the "
      "paths: LENS_chromatic.svg (contact sheet), LENS_<F>deg_focus_<D>mm.exr (a channel S0.<wavelength>nm for each "
      "wavelength: fraction of its light in the paraxial entrance pupil, per mm^2 of film; R, G, B: sum of all "
      "wavelengths for the light of the white point) and LENS_chromatic.json. Images show the film as a photograph "
      "does.",
      "petzval colour");
  examples::add_lens(app, options.setup.lens);
  examples::add_length(app, "--at", options.subject_mm, examples::positive_length, "distance of the light (mm), or inf")
      ->default_str("20 focal lengths");
  examples::add_lengths(app, "--focus", options.focus_mm, examples::positive_length, "focus distances (mm), or inf")
      ->default_str("0.8, 0.9, 1, 1.1, 1.2 of the light's distance; for inf 25, 50, 100 focal lengths, and inf");
  examples::add_focus(app, options.setup.focus);
  examples::add_numbers(app, "--fields", options.field_deg, examples::field_angle,
                        "angles of the light towards +y, seen from the paraxial entrance pupil (degrees)")
      ->default_str("0 and 0.7 of the lens's half field");
  examples::add_iris(app, options.setup);
  examples::add_white_point(app, options.white_point);
  examples::add_samples(app, options.samples);
  options.output.add(app);
  examples::add_out_folder(app, options.out_folder)->required();

  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] {
    const auto set = wavelengths_nm();
    const Weights weights = examples::rgb_weights(set, examples::white_light(options.white_point));
    const auto loaded = examples::load_lens(options.setup.lens, set);
    complete(options, loaded);
    const petzval::Lens lens = examples::stopped_down(loaded.lens, options.setup);
    auto pictures = prepared(lens, options);
    const auto in_focus = examples::focused_scene(lens, options.subject_mm, options.scene(0));
    std::vector<double> fields_rad;
    for (const double field : options.field_deg) fields_rad.push_back(petzval::radians(field));
    const auto colour = petzval::chromatic_aberration(in_focus.lens, in_focus.light.z, fields_rad);
    if (!options.output.json) std::cout << table(colour, options) << std::flush;

    Json json{{"lens", lens.name()},
              {"dispersion", petzval::name(lens.dispersion())},
              {"f_number_real", petzval::real_f_number(lens)},
              {"subject_distance_mm", examples::finite_or_null(options.subject_mm)},
              {"distance_from", petzval::name(options.setup.focus.origin)},
              {"criterion", petzval::name(options.setup.focus.criterion)},
              {"white_point", options.white_point},
              {"primary_nm", set[lens.primary_wavelength()]},
              {"rgb_weights", weights},
              {"frame", examples::picture_frame}};
    json.update(to_json(colour, options));
    const std::filesystem::path folder = options.out_folder;
    examples::make_folder(folder);
    const std::filesystem::path numbers = folder / (loaded.id + "_chromatic.json");
    {
      // Each complete picture is written at once, so that an interrupted run loses only the current picture.
      examples::Progress progress("chromatic bokeh", pictures.size());
      for (Picture& p : pictures) {
        progress.step(examples::number(p.field_deg) + "°, " + examples::focus_caption(p.focus_mm));
        p.image = petzval::point_image(p.scene.lens, p.scene.light,
                                       {.samples = options.samples,
                                        .pixels = picture_pixels,
                                        .half_width_mm = p.half_width_mm,
                                        .threads = examples::threads()});
        const auto name =
            loaded.id + "_" + examples::number(p.field_deg) + "deg_focus_" + examples::number(p.focus_mm) + "mm.exr";
        const examples::Together uninterrupted;
        petzval::ExrPart part = petzval::spectral_image(p.image, weights);
        part.texts.merge(examples::parameters());
        petzval::write_exr({&part, 1}, folder / name);
        options.output.file(folder / name);
        json["pictures"].push_back(
            {{"file", name},
             {"field_deg", p.field_deg},
             {"focus_mm", examples::finite_or_null(p.focus_mm)},
             {"film_z_mm", p.scene.lens.film_z()},
             {"throughput", p.image.mean_throughput},
             {"rms_radius_mm", p.image.mean_throughput > 0 ? Json(p.image.size.rms_radius) : Json()},
             {"picture_centre_mm", {p.image.centre.x, p.image.centre.y}},
             {"picture_pixel_mm", p.image.pixel_mm}});
        examples::write_text(numbers, json.dump(1) + '\n');
      }
    }
    examples::write_svg(examples::draw_sheet(sheet(pictures, lens, options, weights)),
                        folder / (loaded.id + "_chromatic.svg"));
    options.output.file(folder / (loaded.id + "_chromatic.svg"));
    options.output.file(numbers);
    options.output.report(json);
  });
}
