// SPDX-License-Identifier: Apache-2.0
#include "layers/lens_setup.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "petzval/analysis/colour.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "renderer/lens_camera.hpp"
#include "support/camera_setup.hpp"
#include "support/focus_json.hpp"
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace lens_blur {
namespace {

using examples::number;
using petzval::Error;

/// A singlet from "R1,R2,thickness,glass" with the stop on its first surface.
petzval::Prescription singlet_of(const std::string& text, const petzval::GlassCatalogue& glasses) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() != 4) throw Error("--singlet = \"" + text + "\"; must be R1,R2,thickness,glass");
  const auto radius = [&](std::size_t i) {
    return examples::parse_number("--singlet", parts[i], examples::finite_number);
  };
  const double thickness = examples::parse_number("--singlet", parts[2], examples::positive_number);
  const auto found = std::find_if(glasses.glasses().begin(), glasses.glasses().end(),
                                  [&](const petzval::Glass& g) { return g.name == parts[3]; });
  if (found == glasses.glasses().end()) {
    throw Error("--singlet: glass = " + parts[3] + "; must be in a table of data/glass");
  }
  const petzval::Medium glass{.glass = found->name, .catalogue = found->catalogue, .nd = found->nd};
  petzval::Prescription p;
  p.id = "singlet", p.name = "singlet " + text;
  p.surfaces = {{.radius = radius(0), .thickness = thickness, .medium = glass, .stop = true},
                {.radius = radius(1), .thickness = 1}};
  // As wide as both spheres allow; the f-number stops the lens down.
  double widest = std::numeric_limits<double>::infinity();
  for (const petzval::SurfaceRow& row : p.surfaces) {
    if (row.radius != 0) widest = std::min(widest, 0.8 * std::abs(row.radius));
  }
  for (petzval::SurfaceRow& row : p.surfaces) row.semi_diameter = std::isfinite(widest) ? widest : 10;
  return p;
}

/// A singlet so thin that its first-order model is a thin lens of BK7.
petzval::Prescription thin_singlet(double focal_length, double diameter) {
  const double radius = 2 * 0.5168 * focal_length;
  petzval::Prescription p;
  p.id = "thin", p.name = "thin lens of " + number(focal_length) + " mm";
  p.surfaces = {{.radius = radius,
                 .medium = {.glass = "N-BK7", .nd = 1.5168},
                 .semi_diameter = std::min(diameter / 2, 0.9 * radius),
                 .stop = true},
                {.radius = -radius, .thickness = focal_length}};
  return p;
}

}  // namespace

void add_lens(examples::App& app, LensFlags& flags) {
  examples::add_thin_lens(app, flags.thin_lens_mm);
  examples::add_lens(app, flags.lens_file, "LENS", "traced by exact rays");
  app.add_option("--singlet", flags.singlet,
                 "two spherical surfaces, traced by exact rays; f/2 unless --f-number is given")
      ->type_name("R1,R2,THICKNESS,GLASS");
  add_length(app, "--focus", flags.focus_mm, examples::positive_length,
             "distance of the subject in focus (mm), or inf; depths of layers count from the entrance pupil")
      ->required();
  examples::add_focus(app, flags.focus);
  constexpr examples::Range angle{1e-3, 120, "more than 0 and at most 120"};
  add_number(
      app, "--fov", flags.fov_deg, angle,
      "vertical angle of the picture (degrees); default: 30 for a thin lens, else the angle of a film 24 mm high")
      ->default_str("");
  constexpr examples::Range tilt{-60, 60, "a number from -60 to 60"};
  add_number(app, "--tilt", flags.tilt_deg, tilt, "tilt of the film about the horizontal axis (degrees)");
  add_number(app, "--swing", flags.swing_deg, tilt, "swing of the film about the vertical axis (degrees)");
  app.add_option(
         "--rays",
         [&flags](const std::string& text) {
           constexpr examples::Range rays{1, 16384, "whole numbers from 1 to 16384"};
           flags.ray_counts.clear();
           for (const double count : examples::parse_numbers("--rays", text, rays)) {
             if (count != std::floor(count)) throw Error("--rays = " + number(count) + "; must be " + rays.words);
             flags.ray_counts.push_back(static_cast<std::uint32_t>(count));
           }
           flags.rays = flags.ray_counts.back();
         },
         "rays through the lens per pixel of the picture; several numbers with --compare-rays")
      ->type_name("N,...")
      ->default_str("256; 512 for LENS and --singlet with --jitter");
  app.add_flag("--jitter", flags.jitter, "16 sets of rays, alternating over the pixels: grain instead of patterns");
  app.add_option(
         "--wavelengths", flags.wavelengths,
         "wavelengths of the rays; d: the d line; rgb: separate rays for red, green and blue, at 650, 510 and 475 nm")
      ->one_of({"d", "rgb"})
      ->capture_default_str();
  add_iris(app, flags.iris);
  add_bokeh(app, flags.bokeh);
  auto* points =
      app.add_option(
             "--points", flags.surface.points_file,
             "focal surface: the distances in focus at points of the picture; with --frames, focus points with keys")
          ->type_name("POINTS.json");
  add_surface_kind(app, flags.surface, points);
  add_expressive(app, flags.expressive);
}

BlurLens::BlurLens(const LensFlags& flags, int columns, int rows, const renderer::Pose& pose, bool keyed)
    : flags_(flags), columns_(columns), rows_(rows), pose_(pose), keyed_(keyed), controls_(controls_of(flags.bokeh)) {
  const int kinds = (flags.thin_lens_mm > 0) + !flags.lens_file.file.empty() + !flags.singlet.empty();
  if (kinds != 1) {
    throw Error("lens: " + std::to_string(kinds) + " of --thin-lens, LENS and --singlet are given; must be 1");
  }
  thin_ = flags.thin_lens_mm > 0;
  if (thin_ && !(flags.iris.f_number > 0)) throw Error("--thin-lens needs --f-number");
  if (flags.rays == 0) {
    flags_.rays = thin_ ? 256 : 512;
    flags_.jitter = flags_.jitter || !thin_;
  }
  load();
  const petzval::Camera plain = camera({}, flags.supersample);
  film_ = plain.film();
  shown_ = camera({}, 1).film();
  if (!thin_) examples::say_what_does_not_fit(*lens_, film_);
  layers_ = thin_ ? petzval::layer_camera(columns, rows, petzval::radians(fov_deg())) : petzval::layer_camera(plain);
  if (keyed_ && !flags.surface.points_file.empty()) points_ = examples::read_focus_points(flags.surface.points_file);
  surface_ = surface_at(0);
}

double BlurLens::fov_deg() const { return flags_.fov_deg > 0 ? flags_.fov_deg : 30; }

void BlurLens::load() {
  // The focus is set at the d line, even if the colours have their own wavelengths.
  std::vector<double> wavelengths{petzval::d_line_nm};
  if (flags_.coloured()) std::ranges::copy(petzval::rgb_triple_nm, std::back_inserter(wavelengths));
  examples::IrisSetup iris = flags_.iris;
  petzval::Lens lens = [&] {
    if (!flags_.lens_file.file.empty()) return examples::load_lens(flags_.lens_file, wavelengths).lens;
    const petzval::GlassCatalogue& glasses = petzval::glass_tables();
    if (!thin_ && iris.f_number == 0) iris.f_number = 2;
    return petzval::compile(
        thin_ ? thin_singlet(flags_.thin_lens_mm, flags_.diameter_mm()) : singlet_of(flags_.singlet, glasses),
        wavelengths, {.glasses = &glasses});
  }();
  if (thin_) iris.f_number = 0;  // the lens has this f-number
  lens = examples::stopped_down(lens, iris);
  if (thin_ && !(flags_.focus_mm > flags_.thin_lens_mm)) {
    throw Error("--focus = " + number(flags_.focus_mm) + "; must be more than the focal length, " +
                number(flags_.thin_lens_mm) + ": nearer subjects have no real image");
  }
  petzval::FocusOptions focus = flags_.focus.options();
  if (thin_) focus.criterion = petzval::FocusCriterion::paraxial;  // a thin lens has no other focus
  lens_ = examples::for_flag("--focus", [&] { return petzval::with_focus(lens, flags_.focus_mm, focus); });
  // Depths of layers count from the entrance pupil.
  focus_depth_mm_ = flags_.focus_mm + petzval::pupils(*lens_).entrance.z - petzval::origin_z(*lens_, focus.origin);
  name_ = lens_->name();
}

petzval::Camera BlurLens::camera(const std::optional<petzval::FocalSurface>& surface, std::uint32_t supersample) const {
  const int columns = columns_ / static_cast<int>(flags_.supersample) * static_cast<int>(supersample),
            rows = rows_ / static_cast<int>(flags_.supersample) * static_cast<int>(supersample);
  // Film height for the angle of the picture, by the ideal lens.
  double height = 24;
  if (thin_ || flags_.fov_deg > 0) {
    const petzval::ScenePoint seen = petzval::thick_lens(*lens_).scene_of({0, -1, lens_->film_z()});
    const double origin = petzval::pupils(*lens_).entrance.z;
    const double per_mm =
        std::abs(seen.at_infinity ? seen.position.y / seen.position.z : seen.position.y / (origin - seen.position.z));
    height = 2 * std::tan(petzval::radians(fov_deg()) / 2) / per_mm;
  }
  const petzval::Film film{.width_mm = height * columns / rows,
                           .height_mm = height,
                           .columns = columns,
                           .rows = rows,
                           .tilt_rad = petzval::radians(flags_.tilt_deg),
                           .swing_rad = petzval::radians(flags_.swing_deg)};
  const bool first_order = surface || !flags_.expressive.change_nothing();
  const petzval::ModelKind model = thin_         ? petzval::ModelKind::thin
                                   : first_order ? petzval::ModelKind::thick
                                                 : petzval::ModelKind::exact_float;
  petzval::CameraOptions options{.model = model,
                                 .normalisation = petzval::Normalisation::unity_on_axis,
                                 .bokeh = controls_,
                                 .focal_surface = surface};
  if (!flags_.expressive.change_nothing()) options.expressive = expressive_of(flags_.expressive, *lens_, film);
  return petzval::Camera(*lens_, film, options);
}

std::optional<petzval::FocalSurface> BlurLens::surface_at(double time) {
  if (flags_.surface.points_file.empty()) return {};
  if (!keyed_) {
    if (surface_) return surface_;
    const petzval::Camera plain = camera({}, 1);
    const renderer::LensCamera in_world(plain, pose_);
    return examples::read_focal_surface(flags_.surface, plain, flags_.focus.distance_origin(), flags_.focus_mm,
                                        [&](const petzval::Vec3<double>& p) { return in_world.to_lens(glm::vec3(p)); })
        .surface;
  }
  const petzval::IdealLens ideal = petzval::thick_lens(*lens_);
  const std::vector<petzval::FocalPoint> seen =
      petzval::focal_points(ideal, film_, points_, {.time = time, .film = shown_});
  if (seen.empty()) return surface_;  // keep the previous surface
  return petzval::FocalSurface(
      ideal, shown_, seen,
      {.kind = flags_.surface.kind == "shepard" ? petzval::SurfaceKind::shepard : petzval::SurfaceKind::affine,
       .beta = flags_.surface.beta});
}

petzval::LensRays BlurLens::rays(double nearest_mm, int threads, double time) {
  if (keyed_) surface_ = surface_at(time);
  // Each subpixel has its own rays; all subpixels together have the number of rays that --rays gives.
  const auto parts = static_cast<int>(flags_.supersample * flags_.supersample);
  const int sets = flags_.jitter ? 16 : parts;
  const std::vector<petzval::PupilPoint> points =
      petzval::vogel_sets((static_cast<int>(flags_.rays) + parts - 1) / parts, sets);
  const petzval::LensRaysOptions options{.nearest_mm = nearest_mm, .set_count = sets, .threads = threads};
  if (!thin_ || controls_.vignettes() || !flags_.expressive.change_nothing()) {
    std::vector<petzval::Wavelength> wavelengths;
    for (std::size_t i = 1; flags_.coloured() && i <= petzval::rgb_triple_nm.size(); ++i) wavelengths.emplace_back(i);
    return petzval::LensRays::of(camera(surface_, flags_.supersample), layers_, points, wavelengths, options);
  }

  petzval::ThinLens thin{.radius_mm = flags_.diameter_mm() / 2,
                         .inverse_focus = 1 / focus_depth_mm_,
                         .iris = flags_.iris.iris(),
                         .edge = controls_.edge(),
                         .map = controls_.weight_map};
  if (flags_.coloured()) {
    const double power = 1 / petzval::first_order(*lens_).effective_focal_length;
    for (int c = 0; c < 3; ++c) {
      thin.colour_shift[c] =
          1 / petzval::first_order(*lens_, static_cast<std::size_t>(c + 1)).effective_focal_length - power;
    }
  }
  if (surface_) {
    thin.focus = [surface = *surface_, film = film_](const petzval::Vec2<double>& raster) {
      const petzval::FocalSurface::Values at = surface.at(film.point(raster.x, raster.y));
      return petzval::FocusAt{at.inverse_distance, std::exp2(-at.extent_stops / 2)};
    };
  } else if (film_.tilted()) {
    // The inverse distance in focus of a tilted film is linear over the picture; the picture keeps its frame.
    const double power = 1 / flags_.thin_lens_mm, image = power - 1 / focus_depth_mm_;
    thin.focus = [=, normal = film_.normal(), camera = layers_](const petzval::Vec2<double>& raster) {
      const petzval::Vec2<double> run = (raster - camera.axis) / camera.focal_px;
      return petzval::FocusAt{power - image * (1 - (normal.x * run.x - normal.y * run.y) / normal.z), 1};
    };
  }
  return petzval::LensRays::thin(layers_, thin, points, options);
}

}  // namespace lens_blur
