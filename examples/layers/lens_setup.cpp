// SPDX-License-Identifier: Apache-2.0
#include "layers/lens_setup.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>
#include <sstream>
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
#include "support/load_lens.hpp"
#include "support/text.hpp"

namespace lens_blur {
namespace {

using examples::number;
using petzval::Error;

/// A singlet from "R1,R2,thickness,glass" with the stop on its first surface.
petzval::Prescription singlet_of(const std::string& text, const petzval::GlassCatalogue& glasses) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
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

void add_ghosts(examples::App& app, std::uint32_t& ghosts, const std::string& more) {
  examples::add_count(app, "--ghosts", ghosts, ghost_counts,
                      "add the ghosts of so many parts of the picture, those with most light in highlights: "
                      "reflections between the surfaces of the lens, as of petzval ghosts; 8 suit most pictures. " +
                          more)
      ->default_str("0");
}

void add_lens(examples::App& app, LensFlags& flags, const std::string& frames_help) {
  examples::add_setup(app, flags.setup);
  examples::add_thin_lens(app, flags.setup.lens.thin_mm);
  examples::add_lens(app, flags.setup.lens, "LENS", "traced by exact rays");
  app.add_option("--singlet", flags.singlet,
                 "two spherical surfaces, traced by exact rays; f/2 unless --f-number is given")
      ->type_name("R1,R2,THICKNESS,GLASS");
  examples::add_focus_pull(app, flags.setup.pull, flags.setup.focus_mm, frames_help);
  examples::add_focus(app, flags.setup.focus);
  examples::add_tilt(app, flags.setup, {-60, 60, "a number from -60 to 60"});
  app.add_option(
         "--rays",
         [&flags](const std::string& text) {
           constexpr examples::Range rays{1, 16384, "whole numbers from 1 to 16384"};
           flags.ray_counts.clear();
           for (const double count : examples::parse_numbers("--rays", text, rays)) {
             if (count != std::floor(count)) throw Error("--rays = " + number(count) + "; must be " + rays.words);
             flags.ray_counts.push_back(static_cast<std::uint32_t>(count));
           }
           flags.pattern.rays = flags.ray_counts.back();
         },
         "rays through the lens per pixel of the picture; several numbers with --compare-rays")
      ->type_name("N,...")
      ->default_str("256; 512 for LENS and --singlet with --jitter");
  app.add_flag("--jitter", flags.pattern.jitter,
               "16 sets of rays, alternating over the pixels: grain instead of patterns");
  app.add_option(
         "--wavelengths", flags.wavelengths,
         "wavelengths of the rays; d: the d line; rgb: separate rays for red, green and blue, at 650, 510 and 475 nm")
      ->one_of({"d", "rgb"})
      ->default_str("d");
  add_iris(app, flags.setup);
  add_bokeh(app, flags.setup);
  examples::add_focal_surface(app, flags.setup,
                              "focal surface: the distances in focus at points of the picture; with --frames, focus "
                              "points with keys. A real lens is replaced by its thick lens");
  add_expressive(app, flags.setup);
}

namespace {

/// The lens of the flags, stopped down. Completes the set-up.
petzval::Lens lens_of(LensFlags& flags) {
  examples::CameraFlags& setup = flags.setup;
  petzval::LensSource& source = setup.lens;
  const int kinds = flags.thin() + (!source.file.empty() || source.prescription) + !flags.singlet.empty();
  if (kinds != 1) {
    throw Error("lens: " + std::to_string(kinds) + " of --thin-lens, LENS and --singlet are given; must be 1");
  }
  if (flags.thin() && !setup.f_number) throw Error("--thin-lens needs --f-number");
  if (flags.thin()) setup.focus.criterion = petzval::FocusCriterion::paraxial;  // a thin lens has no other focus
  const bool coloured = flags.coloured();
  const std::vector<double> stated = source.wavelengths_nm;
  // The focus is set at the d line, even if the colours have their own wavelengths.
  source.wavelengths_nm = {petzval::d_line_nm};
  if (coloured) std::ranges::copy(petzval::rgb_triple_nm, std::back_inserter(source.wavelengths_nm));
  if (!setup.file.empty() && !stated.empty() && stated != source.wavelengths_nm) {
    examples::note(setup.file + ": lens.wavelengths_nm are not used by blur; --wavelengths is " + flags.wavelengths);
  }
  if (!flags.singlet.empty()) {
    source.prescription = singlet_of(flags.singlet, petzval::glass_tables());
    if (!setup.f_number) setup.f_number = 2;
  }
  const petzval::Lens compiled = examples::load_lens(setup, source.wavelengths_nm).lens;
  petzval::Lens lens = examples::stopped_down(compiled, setup);
  const petzval::CameraSetup used = setup.used_with(compiled);
  setup.f_number = used.f_number, source.primary_nm = used.lens.primary_nm;
  return lens;
}

/// The lens focused at a distance, without a focal surface.
///
/// angle_rad       vertical angle of the picture; 0: by the height of the film
/// film_height_mm  0: by the angle, or of the set-up
LensView view_of(const LensFlags& flags, const petzval::Lens& unfocused, double focus_mm, int columns, int rows,
                 double angle_rad, double film_height_mm = 0) {
  const examples::CameraFlags& setup = flags.setup;
  const double thin_mm = setup.lens.thin_mm;
  if (thin_mm > 0 && !(focus_mm > thin_mm)) {
    throw Error("--focus = " + number(focus_mm) + "; must be more than the focal length, " + number(thin_mm) +
                ": nearer subjects have no real image");
  }
  const petzval::Lens lens =
      examples::for_flag("--focus", [&] { return petzval::with_focus(unfocused, focus_mm, setup.focus); });
  LensView view{.lens = lens,
                .setup = setup,
                .vertical_angle_rad = angle_rad,
                .coloured = flags.coloured(),
                .first_order_only = !setup.file.empty() && setup.camera.model.is_first_order()};
  view.setup.coating.reset();
  view.setup.camera = {.bokeh = controls_of(setup), .paraxial_focus = setup.camera.paraxial_focus};
  petzval::Film& film = view.setup.film;
  if (film_height_mm > 0) film.height_mm = film_height_mm;
  if (film_height_mm == 0 && angle_rad > 0) film.height_mm = petzval::film_height_for_angle(lens, angle_rad);
  if (thin_mm > 0 && angle_rad == 0) {
    const double half = std::atan(film.height_mm / petzval::film_height_for_angle(lens, std::numbers::pi / 2));
    view.vertical_angle_rad = petzval::radians(std::round(2e9 * petzval::degrees(half)) / 1e9);  // as of --fov
  }
  film.width_mm = film.height_mm * columns / rows;
  film.columns = columns, film.rows = rows;
  film.z_mm = film.z_mm.value_or(lens.film_z());
  // Depths of layers count from the entrance pupil.
  view.focus_depth_mm = focus_mm + petzval::pupils(lens).entrance.z - petzval::origin_z(lens, setup.focus.origin);
  view.setup.camera.expressive = expressive_of(setup, lens, film);
  return view;
}

/// Vertical angle of the flags; 0: as the film of --setup, or a film 24 mm high, covers it.
double angle_of(const LensFlags& flags) {
  const bool usual = flags.thin() && !flags.setup.film_given;
  return petzval::radians(flags.fov_deg > 0 ? flags.fov_deg : usual ? 30 : 0);
}

}  // namespace

BlurLens::BlurLens(const LensFlags& flags, int columns, int rows, const renderer::Pose& pose, bool keyed)
    : flags_(flags),
      pose_(pose),
      keyed_(keyed),
      unfocused_(lens_of(flags_)),
      view_(view_of(flags_, unfocused_, *flags.setup.focus_mm, columns, rows, angle_of(flags_))),
      layers_(view_.layers(flags.pattern.supersample)) {
  if (flags.pattern.rays == 0) {
    flags_.pattern.rays = view_.thin() ? 256 : 512;
    flags_.pattern.jitter = flags.pattern.jitter || !view_.thin();
  }
  if (!view_.thin()) examples::say_what_does_not_fit(view_.lens, view_.setup.film);
  if (keyed_ && !flags.setup.points_file.empty()) {
    points_ = examples::read_focus_points(flags.setup.points_file, world_to_lens(view_.camera()));
  }
  view_.surface = surface_at(0, 0);
  if (model() == petzval::ModelKind::thick && !view_.first_order_only) {
    examples::note(std::string(view_.surface ? "a focal surface" : "an expressive lens") + ": " + name() +
                   " is replaced by its thick lens, without aberrations and vignetting");
  }
}

double BlurLens::focal_length_mm() const { return petzval::first_order(view_.lens).effective_focal_length; }

void BlurLens::focus_at(double focus_mm, bool keep_film) {
  const petzval::Film film = view_.setup.film;
  view_ = view_of(flags_, unfocused_, focus_mm, film.columns, film.rows, view_.vertical_angle_rad,
                  keep_film ? film.height_mm : 0);
  view_.surface = surface_at(0, 0);
  layers_ = view_.layers(flags_.pattern.supersample);
}

petzval::CameraSetup BlurLens::setup() const {
  petzval::CameraSetup result = view_.setup;
  result.film.z_mm = flags_.setup.film.z_mm;
  result.camera.model = model(), result.camera.normalisation = petzval::Normalisation::unity_on_axis;
  result.camera.paraxial_focus = view_.thin() || result.camera.paraxial_focus;
  return result;
}

examples::WorldToLens BlurLens::world_to_lens(const petzval::Camera& camera) const {
  return [in_world = renderer::LensCamera(camera, pose_)](const petzval::Vec3<double>& p) {
    return in_world.to_lens(glm::vec3(p));
  };
}

std::optional<petzval::FocalSurface> BlurLens::surface_at(double time, double travelled_mm) {
  const std::string& file = flags_.setup.points_file;
  petzval::CameraSetup& setup = view_.setup;
  if (file.empty() && setup.focal_points.empty()) return {};
  const petzval::Camera plain = view_.camera();
  if (!keyed_ && !file.empty()) return examples::read_focal_surface(file, setup, plain, world_to_lens(plain));
  const petzval::IdealLens ideal = petzval::thick_lens(plain.lens());
  if (!points_.empty()) {
    std::vector<petzval::FocusPoint> points = points_;
    for (petzval::FocusPoint& point : points) {
      for (petzval::FocusKey& key : point.keys) {
        auto& [position, at_infinity] = std::get<petzval::ScenePoint>(key.anchor);
        if (!at_infinity) position.x -= travelled_mm;
      }
    }
    const petzval::FocusTime moment{.time = time, .film = setup.film};
    std::vector<petzval::FocalPoint> seen = petzval::focal_points(ideal, setup.film, points, moment);
    if (seen.empty()) return view_.surface;  // keep the previous surface
    setup.focal_points = std::move(seen);
  }
  return examples::focal_surface(file.empty() ? flags_.setup.file : file, ideal, plain.film(), setup);
}

petzval::LensRays BlurLens::rays(double nearest_mm, int threads, double time, double travelled_mm) {
  if (keyed_) view_.surface = surface_at(time, travelled_mm);
  return view_.rays(layers_, flags_.pattern, nearest_mm, threads);
}

}  // namespace lens_blur
