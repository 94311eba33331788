// SPDX-License-Identifier: Apache-2.0
// Computes a focal surface: the distance in focus at each point of a picture, given by an artist's focus points. Writes
// it as a map, in section and as numbers.
//
//   petzval surface data/lenses/double_gauss_52mm_f1.8.json --points examples/scenes/statues_focus.json --size 600
//                 --film 36x24 --out out
#include "commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/image/image.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/blur_map.hpp"
#include "support/camera_setup.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/focus_points.hpp"
#include "support/load_lens.hpp"
#include "support/map_sheet.hpp"
#include "support/number_csv.hpp"
#include "support/text.hpp"

namespace {

using examples::number;

constexpr std::uint32_t usual_width = 600;

struct Options {
  std::string queries_file, out_folder;
  std::uint32_t width = 0, height = 0;  // 0: not given
  examples::CameraFlags setup;
};

/// The surface through the points, with distances from the origin of the options.
class Surface {
 public:
  explicit Surface(Options options)
      : loaded_(examples::load_lens(options.setup.lens, std::array{petzval::d_line_nm})),
        lens_(examples::focused(loaded_, options.setup)) {
    const petzval::Film film = options.setup.sized_film(options.width, options.height, usual_width);
    const petzval::Camera camera(lens_, film, {.model = petzval::ModelKind::thick});
    const petzval::DistanceOrigin origin = options.setup.focus.origin;
    film_ = camera.film();
    ideal_ = petzval::thick_lens(camera.lens());
    surface_ = examples::read_focal_surface(options.setup.points_file, options.setup, camera,
                                            [](const petzval::Vec3<double>& point) { return point; });
    points_ = options.setup.focal_points;
    beyond_pupil_ = petzval::origin_z(camera.lens(), origin) - surface_->origin_z();
  }

  const petzval::Lens& lens() const { return lens_; }
  const petzval::IdealLens& ideal() const { return ideal_; }
  const petzval::Film& film() const { return film_; }
  const petzval::FocalSurface& surface() const { return *surface_; }
  const std::vector<petzval::FocalPoint>& points() const { return points_; }

  /// Converts 1 / distance from the entrance pupil to 1 / distance from the origin.
  double inverse(double from_pupil) const { return from_pupil / (1 + from_pupil * beyond_pupil_); }

  /// Values of all pixels of a film, row by row from the upper left.
  struct Frame {
    std::vector<double> inverses, extents;
  };
  Frame frame(const petzval::Film& film) const {
    const std::size_t pixels = static_cast<std::size_t>(film.columns) * static_cast<std::size_t>(film.rows);
    Frame result{std::vector<double>(pixels), std::vector<double>(pixels)};
    surface_->frame<double>(film, examples::threads(), result.inverses.data(), result.extents.data());
    for (double& value : result.inverses) value = inverse(value);
    return result;
  }
  bool has_extents() const {
    return std::any_of(points_.begin(), points_.end(), [](const auto& p) { return p.extent_stops.has_value(); });
  }

 private:
  examples::LoadedLens loaded_;
  petzval::Lens lens_;
  petzval::Film film_;
  petzval::IdealLens ideal_;
  std::vector<petzval::FocalPoint> points_;
  std::optional<petzval::FocalSurface> surface_;
  double beyond_pupil_ = 0;
};

std::string distance_in_words(double inverse) {
  if (std::abs(inverse) < 1e-9) return "infinity";
  const double mm = 1 / inverse;
  return std::abs(mm) >= 1000 ? number(mm / 1000, 4) + " m" : number(mm, 4) + " mm";
}
std::string stops_in_words(double stops) { return number(stops, 4) + " stops"; }

/// Round distances within a range of inverse distances, farthest first, with a minimum spacing.
std::vector<examples::MapLevel> distance_levels(double least, double most) {
  std::vector<examples::MapLevel> result;
  constexpr double lines = 12;
  const auto add = [&](double inverse, const std::string& words) {
    const double before = result.empty() ? least : result.back().value;
    if (inverse < most && inverse - before >= (most - least) / lines) result.push_back({inverse, words});
  };
  add(0, "infinity");
  for (double decade = 1e6; decade >= 10; decade /= 10) {
    for (const double digits : {1.0, 0.8, 0.6, 0.5, 0.4, 0.3, 0.25, 0.2, 0.15, 0.12}) {
      const double mm = digits * decade;
      add(1 / mm, distance_in_words(1 / mm));
    }
  }
  return result;
}

std::vector<examples::MapLevel> stop_levels(double least, double most) {
  std::vector<examples::MapLevel> result;
  double step = 0.25;
  while ((most - least) / step > 10) step *= 2;
  for (double stops = std::ceil(least / step) * step; stops < most; stops += step) {
    if (stops > least) result.push_back({stops, number(stops + 0.0)});
  }
  return result;
}

std::string map_of(const Surface& surface, const Options& options) {
  const petzval::Film film = examples::with_pixels(surface.film(), 300);
  examples::MapSheet sheet{.scale = 3};
  sheet.title = "Focal surface";
  sheet.subtitle = surface.lens().name() + " at f/" + number(petzval::real_f_number(surface.lens()), 3) + ", " +
                   std::to_string(surface.points().size()) + (surface.points().size() == 1 ? " point, " : " points, ") +
                   std::string(name(options.setup.focal_surface.kind)) + ", beta " +
                   number(options.setup.focal_surface.beta);
  sheet.width = film.columns, sheet.height = film.rows;
  const Surface::Frame frame = surface.frame(film);
  const auto add = [&](std::string title, std::vector<double> values, auto levels_of, auto in_words, const char* low,
                       const char* high, std::optional<double> petzval::FocalPoint::*fixed) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    auto levels = levels_of(*least, *most);
    if (levels.empty()) title += ": constant, " + in_words(*least);
    // From deep blue through green and yellow to near white, of increasing lightness.
    auto& map = sheet.maps.emplace_back(examples::Map{
        .title = std::move(title),
        .low = *least,
        .high = *most,
        .colours = {{46, 30, 96}, {44, 84, 150}, {38, 134, 142}, {82, 178, 116}, {184, 210, 80}, {250, 236, 150}},
        .contours = levels,
        .ticks = levels,
        .scale_words = {low, "", high}});
    map.values = std::move(values);
    for (std::size_t i = 0; i < surface.points().size(); ++i) {
      const petzval::FocalPoint& point = surface.points()[i];
      const petzval::Vec2<double> at = film.raster(point.film_point);
      if (point.*fixed) map.points.push_back({at.x, at.y, i + 1});
    }
  };
  add("Distance in focus from the " + examples::in_words(options.setup.focus.origin) + ", on a scale of 1/distance",
      frame.inverses, distance_levels, distance_in_words, "farther", "nearer", &petzval::FocalPoint::inverse_distance);
  if (surface.has_extents()) {
    add("Extent of the depth of field, in stops: deeper above 0, shallower below 0", frame.extents, stop_levels,
        stops_in_words, "less is sharp", "more is sharp", &petzval::FocalPoint::extent_stops);
  }
  const std::string points_file = std::filesystem::path(options.setup.points_file).filename().string();
  sheet.notes = {"Points have their numbers in " + points_file + "; the picture is upright."};
  return examples::draw_map_sheet(sheet);
}

/// Answers to queries x_px,y_px. At a focus point, blur_px for an object at the point's own distance is the requested
/// blur.
std::string answers(const Surface& surface, const std::string& queries_file) {
  constexpr std::array columns{examples::CsvColumn{"x_px"}, examples::CsvColumn{"y_px"}};
  const auto queries = examples::parse_columns(examples::read_text(queries_file), columns, queries_file);
  std::string csv = "x_px,y_px,distance_mm,extent_stops,blur_px\n";
  for (std::size_t i = 0; i < queries[0].size(); ++i) {
    const double x = queries[0][i], y = queries[1][i];
    const auto at = surface.surface().at(surface.film().point(x, y));
    csv += number(x) + ',' + number(y) + ',' + number(1 / surface.inverse(at.inverse_distance)) + ',' +
           number(at.extent_stops) + ',' + number(at.blur_mm / surface.film().pixel_mm()) + '\n';
  }
  return csv;
}

void write(const Options& options) {
  const Surface surface(options);
  const std::string map = map_of(surface, options);
  const std::string side = petzval::focal_surface_figure(
      surface.lens().name(),
      "f/" + number(petzval::real_f_number(surface.lens()), 3) + ", film " + number(surface.film().width_mm) + " x " +
          number(surface.film().height_mm) + " mm.",
      surface.ideal(), surface.film(), surface.surface(), surface.points());
  const std::vector<double> inverses = surface.frame(surface.film()).inverses;
  const std::string found = options.queries_file.empty() ? "" : answers(surface, options.queries_file);

  const std::filesystem::path folder = options.out_folder;
  examples::make_folder(folder);
  const auto say = [&](const char* name) { std::cout << (folder / name).string() << '\n'; };
  examples::write_svg(map, folder / "surface.svg");
  say("surface.svg");
  examples::write_text(folder / "side.svg", side);
  say("side.svg");
  petzval::write_pfm(surface.film().columns, surface.film().rows, std::vector<float>(inverses.begin(), inverses.end()),
                     folder / "surface.pfm");
  say("surface.pfm");
  if (options.queries_file.empty()) return;
  examples::write_text(folder / "answers.csv", found);
  say("answers.csv");
}

}  // namespace

int commands::surface(int argc, char** argv) {
  Options options;
  examples::App app(
      "Sets the distance in focus at each point of a picture from focus points. Writes to DIR: surface.svg (distance "
      "over the picture, and extent of the depth of field if points give one), side.svg (section of lens, film and "
      "surface), surface.pfm (1/distance of each pixel in 1/mm, rows from the bottom as in all PFM files) and with "
      "--table answers.csv (x_px,y_px,distance_mm,extent_stops,blur_px). Distances count from "
      "--from; infinity is inf, and distances beyond infinity, which a blur can cause, are negative. blur_px "
      "is the signed diameter of the requested blur for an object at the distance of the points, negative in front of "
      "the focus. Points that fix a distance override --focus.",
      "petzval surface");
  examples::add_lens(app, options.setup.lens);
  examples::add_focal_surface(app, options.setup,
                              "focus points; pixels from the upper left corner, centres at halves; positions in the "
                              "lens frame, with the scene at negative z")
      ->required();
  examples::add_picture_size(app, options.width, options.height, usual_width);
  examples::add_camera(app, options.setup);
  app.add_option("--table", options.queries_file, "CSV file of picture points: x_px,y_px")->type_name("Q.csv");
  examples::add_out_folder(app, options.out_folder)->required();
  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] { write(options); });
}
