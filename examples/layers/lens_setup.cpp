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

}  // namespace

void add_lens(examples::App& app, LensFlags& flags, const std::string& frames_help) {
  examples::add_thin_lens(app, flags.thin_lens_mm);
  examples::add_lens(app, flags.lens_file, "LENS", "traced by exact rays");
  app.add_option("--singlet", flags.singlet,
                 "two spherical surfaces, traced by exact rays; f/2 unless --f-number is given")
      ->type_name("R1,R2,THICKNESS,GLASS");
  examples::add_focus_pull(app, flags.pull, flags.focus_mm, frames_help);
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
             "focal surface: the distances in focus at points of the picture; with --frames, focus points with keys. A "
             "real lens is replaced by its thick lens")
          ->type_name("POINTS.json");
  add_surface_kind(app, flags.surface, points);
  add_expressive(app, flags.expressive);
}

namespace {

/// The lens of the flags, stopped down.
petzval::Lens lens_of(const LensFlags& flags) {
  const int kinds = (flags.thin_lens_mm > 0) + !flags.lens_file.file.empty() + !flags.singlet.empty();
  if (kinds != 1) {
    throw Error("lens: " + std::to_string(kinds) + " of --thin-lens, LENS and --singlet are given; must be 1");
  }
  const bool thin = flags.thin_lens_mm > 0;
  if (thin && !(flags.iris.f_number > 0)) throw Error("--thin-lens needs --f-number");
  // The focus is set at the d line, even if the colours have their own wavelengths.
  std::vector<double> wavelengths{petzval::d_line_nm};
  if (flags.coloured()) std::ranges::copy(petzval::rgb_triple_nm, std::back_inserter(wavelengths));
  examples::IrisSetup iris = flags.iris;
  petzval::Lens lens = [&] {
    if (!flags.lens_file.file.empty()) return examples::load_lens(flags.lens_file, wavelengths).lens;
    const petzval::GlassCatalogue& glasses = petzval::glass_tables();
    if (!thin && iris.f_number == 0) iris.f_number = 2;
    return petzval::compile(
        thin ? petzval::thin_elements(flags.thin_lens_mm, flags.iris.f_number) : singlet_of(flags.singlet, glasses),
        wavelengths, {.glasses = &glasses});
  }();
  if (thin) iris.f_number = 0;  // the lens has this f-number
  return examples::stopped_down(lens, iris);
}

/// The lens focused at a distance, without a focal surface. film_height_mm: 0: by --fov.
LensView view_of(const LensFlags& flags, const petzval::Lens& unfocused, double focus_mm, int columns, int rows,
                 double film_height_mm = 0) {
  const bool thin = flags.thin_lens_mm > 0;
  if (thin && !(focus_mm > flags.thin_lens_mm)) {
    throw Error("--focus = " + number(focus_mm) + "; must be more than the focal length, " +
                number(flags.thin_lens_mm) + ": nearer subjects have no real image");
  }
  petzval::FocusOptions focus = flags.focus.options();
  if (thin) focus.criterion = petzval::FocusCriterion::paraxial;  // a thin lens has no other focus
  const petzval::Lens lens =
      examples::for_flag("--focus", [&] { return petzval::with_focus(unfocused, focus_mm, focus); });
  LensView view{.lens = lens,
                .thin_diameter_mm = thin ? flags.thin_lens_mm / flags.iris.f_number : 0,
                .coloured = flags.coloured(),
                .controls = controls_of(flags.bokeh)};
  view.vertical_angle_rad = petzval::radians(flags.fov_deg > 0 ? flags.fov_deg : 30);
  const double height = film_height_mm > 0          ? film_height_mm
                        : thin || flags.fov_deg > 0 ? petzval::film_height_for_angle(lens, view.vertical_angle_rad)
                                                    : 24;
  view.film = {.width_mm = height * columns / rows,
               .height_mm = height,
               .columns = columns,
               .rows = rows,
               .z_mm = lens.film_z(),
               .tilt_rad = petzval::radians(flags.tilt_deg),
               .swing_rad = petzval::radians(flags.swing_deg)};
  // Depths of layers count from the entrance pupil.
  view.focus_depth_mm = focus_mm + petzval::pupils(lens).entrance.z - petzval::origin_z(lens, focus.origin);
  if (!flags.expressive.change_nothing()) view.expressive = expressive_of(flags.expressive, lens, view.film);
  return view;
}

}  // namespace

BlurLens::BlurLens(const LensFlags& flags, int columns, int rows, const renderer::Pose& pose, bool keyed)
    : flags_(flags),
      pose_(pose),
      keyed_(keyed),
      unfocused_(lens_of(flags)),
      view_(view_of(flags, unfocused_, flags.focus_mm, columns, rows)),
      pattern_{flags.rays, flags.supersample, flags.jitter, flags.over_pixels},
      layers_(view_.layers(flags.supersample)) {
  if (flags.rays == 0) {
    pattern_.rays = view_.thin() ? 256 : 512;
    pattern_.jitter = flags.jitter || !view_.thin();
  }
  if (!view_.thin()) examples::say_what_does_not_fit(view_.lens, view_.film);
  if (keyed_ && !flags.surface.points_file.empty()) points_ = examples::read_focus_points(flags.surface.points_file);
  view_.surface = surface_at(0);
  if (model() == petzval::ModelKind::thick) {
    examples::note(std::string(view_.surface ? "--points" : "an expressive lens") + ": " + name() +
                   " is replaced by its thick lens, without aberrations and vignetting");
  }
}

double BlurLens::focal_length_mm() const { return petzval::first_order(view_.lens).effective_focal_length; }

void BlurLens::focus_at(double focus_mm, bool keep_film) {
  const petzval::Film film = view_.film;
  view_ = view_of(flags_, unfocused_, focus_mm, film.columns, film.rows, keep_film ? film.height_mm : 0);
  layers_ = view_.layers(flags_.supersample);
}

std::optional<petzval::FocalSurface> BlurLens::surface_at(double time) const {
  if (flags_.surface.points_file.empty()) return {};
  if (!keyed_) {
    const petzval::Camera plain = view_.camera(1);
    const renderer::LensCamera in_world(plain, pose_);
    return examples::read_focal_surface(flags_.surface, plain, flags_.focus.distance_origin(), flags_.focus_mm,
                                        [&](const petzval::Vec3<double>& p) { return in_world.to_lens(glm::vec3(p)); })
        .surface;
  }
  const petzval::IdealLens ideal = petzval::thick_lens(view_.lens);
  const std::vector<petzval::FocalPoint> seen =
      petzval::focal_points(ideal, view_.film, points_, {.time = time, .film = view_.film});
  if (seen.empty()) return view_.surface;  // keep the previous surface
  return petzval::FocalSurface(
      ideal, view_.film, seen,
      {.kind = flags_.surface.kind == "shepard" ? petzval::SurfaceKind::shepard : petzval::SurfaceKind::affine,
       .beta = flags_.surface.beta});
}

petzval::LensRays BlurLens::rays(double nearest_mm, int threads, double time) {
  if (keyed_) view_.surface = surface_at(time);
  return view_.rays(layers_, pattern_, nearest_mm, threads);
}

}  // namespace lens_blur
