// SPDX-License-Identifier: Apache-2.0
// Short examples for the class pages of the API site: types that the programs of examples/ do not use.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "petzval/analysis/choose_model.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/exports/distortion.hpp"
#include "petzval/exports/lens_metadata.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/image/psf.hpp"
#include "petzval/petzval.hpp"

namespace {

using namespace petzval;

const Film film{.width_mm = 36, .height_mm = 24, .columns = 360, .rows = 240};

Prescription table(const std::string& id) { return read_prescription(data_directory() / ("lenses/" + id + ".json")); }

Lens double_gauss() { return with_focus(compile(table("double_gauss_100mm_f2.0")), 3000); }

bool near(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance * std::max(1.0, std::abs(b)); }

/// Adds a term of order 12 to the first aspheric surface of a phone lens.
bool aspheric_surface() {
  Prescription phone = table("phone_5.6mm_f3.5");
  std::size_t surface = 0;
  while (phone.surfaces[surface].aspheric.empty()) ++surface;
  const double before = sag(compile(phone), surface, 0, 0.5);
  const AsphereTerm term{.order = 12, .coefficient = 0.01};
  phone.surfaces[surface].aspheric.push_back(term);
  const double change = sag(compile(phone), surface, 0, 0.5) - before;
  std::cout << "asphere: the sag changes by " << change * 1e6 << " nm\n";
  return near(change * 1e6, term.coefficient * std::pow(0.5, term.order) * 1e6, 1e-6);
}

/// Sets a zoom lens to its last position, and prints the gap that this position changes first.
bool zoom_positions() {
  const Prescription zoom = table("zoom_70-210mm_f4");
  const Configuration& tele = zoom.configurations.back();
  const Prescription at_tele = configured(zoom, ConfigurationChoice(tele.name));
  const SurfaceChange& change = tele.changes[0];
  std::cout << "zoom: " << tele.name << ", gap " << change.surface << ' ' << change.thickness.value_or(0) << " mm\n";
  return at_tele.surfaces[static_cast<std::size_t>(change.surface)].thickness == change.thickness;
}

/// Focuses a zoom lens by its front group, which is 5 mm farther forward at a subject distance of 3 m.
bool moving_groups() {
  Prescription zoom = table("zoom_70-210mm_f4");
  Configuration close = zoom.configurations[0];
  close.name = "close";
  close.focus_of = zoom.configurations[0].name;
  close.subject_distance_mm = 3000;
  SurfaceChange& front_gap = close.changes[0];
  *front_gap.thickness += 5;
  zoom.configurations.push_back(close);
  const Lens lens = compile(zoom);
  const FocusPosition& nearest = lens.focus_positions().back();
  std::cout << "moving groups: gap " << nearest.thicknesses[4] << " mm at " << 1 / nearest.inverse_distance << " mm\n";
  return near(with_groups_at(lens, 1 / 3000.0).surfaces()[4].thickness, *front_gap.thickness, 1e-12);
}

/// Writes a lens as a Zemax file, reads the file, and prints the origin and the data that were lost.
bool imported_file() {
  const Prescription original = table("double_gauss_100mm_f2.0");
  const ExportedLens zemax = format_zemax(original);
  const ReadOptions options{.strict = true, .glasses = &glass_tables()};
  const Prescription lens = parse_lens(zemax.text, "double_gauss.zmx", options);
  const FileOrigin origin = lens.imported.value_or(FileOrigin{});
  std::cout << "imported: " << origin.format << " file in " << origin.units;
  for (const ImportWarning& loss : zemax.losses) std::cout << ", lost: " << loss.command;
  std::cout << '\n';
  const FirstOrder read = first_order(compile(lens)), written = first_order(compile(original));
  return origin.format == "zemax" && near(read.effective_focal_length, written.effective_focal_length, 1e-5);
}

/// Compiles a medium that states both an index and a glass, with the index of either source.
bool index_policies() {
  const Glass* glass = glass_tables().find("N-BK7", "schott");
  if (!glass || glass->formula != DispersionFormula::sellmeier) return false;
  Prescription singlet = table("singlet_50mm_biconvex");
  singlet.surfaces[0].medium = {.glass = glass->name, .catalogue = glass->catalogue, .nd = 1.52};
  const IndexPolicy policy = IndexPolicy::catalogue;
  const double printed = compile(singlet).index(1), catalogue = compile(singlet, {.index_policy = policy}).index(1);
  std::cout << "index: printed " << printed << ", catalogue " << catalogue << '\n';
  return printed == 1.52 && near(catalogue, refractive_index(*glass, d_line_nm), 1e-12);
}

/// The rays of a list that holds all x, then all y, z, dx, dy and dz.
template <class T>
RayArrays<T> arrays(std::vector<double>& numbers) {
  T* first = numbers.data();
  const std::size_t n = numbers.size() / 6;
  return {first, first + n, first + 2 * n, first + 3 * n, first + 4 * n, first + 5 * n};
}

/// Traces two rays with their derivatives by x and y of the origin. On the axis, d(dy)/dy is -1 / focal length.
bool traced_derivatives() {
  const Lens lens = double_gauss();
  std::vector<double> in{0, 0, 0, 10, -50, -50, 0, 0, 0, 0, 1, 1};  // origins (0, 0, -50) and (0, 10, -50)
  std::vector<double> by_x{1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, by_y{0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0};
  std::vector<double> out(12), out_by_x(12), out_by_y(12);
  const RayTangents<const double> tangents_in{arrays<const double>(by_x), arrays<const double>(by_y)};
  const RayTangents<double> tangents_out{arrays<double>(out_by_x), arrays<double>(out_by_y)};
  const RayArrays<double> rays = arrays<double>(out);
  const Arithmetic arithmetic = Arithmetic::reproducible;
  const BatchOptions options{.arithmetic = arithmetic};
  trace_differentials(lens, 2, arrays<const double>(in), tangents_in, rays, tangents_out, nullptr, nullptr, options);
  const TracedRay<double> single = trace(lens, Ray<double>{{0, 10, -50}, {0, 0, 1}});
  std::cout << "derivatives: " << name(arithmetic) << ", focal length " << -1 / tangents_out.v.dy[0] << " mm\n";
  return single.transmitted() && rays.y[1] == single.ray.origin.y &&
         near(-1 / tangents_out.v.dy[0], first_order(lens).effective_focal_length, 1e-9);
}

/// Aims rays of a field at the centre and at the rim of the stop.
bool aimed_rays() {
  const Lens lens = double_gauss();
  const FieldPoint point{.field_rad = radians(14), .z = -3000};
  const AimedRay chief = chief_ray(lens, point), rim = aim(lens, point, {0, -1});
  const AimStatus status = chief.status;
  std::cout << "aim: chief ray " << name(status) << ", ray through the rim " << name(rim.status) << '\n';
  return status == AimStatus::converged && chief.residual < 1e-9;
}

/// Images a point and a plane of the scene by the cardinal points of a lens.
bool ideal_image() {
  const IdealLens lens = thick_lens(double_gauss());
  const ScenePoint subject{.position = {100, 50, -3000}};
  const Plane wall{.normal = {0, 0, 1}, .offset = -3000};
  const std::optional<ImagePoint> found = lens.image(subject);
  const std::optional<Plane> image_plane = lens.image_of(wall);
  if (!found || !image_plane) return false;
  const ImagePoint& image = *found;
  const Film sharp = film_in(*image_plane, film);
  std::cout << "image: " << image.position.x << ", " << image.position.y << ", " << image.position.z << " mm\n";
  return near(image_plane->offset, image.position.z, 1e-9) && near(signed_blur(image, sharp), 0, 1e-9);
}

/// Focuses for the axis and, with half the weight, for a field of 10 degrees.
bool focus_of_fields() {
  const Lens lens = double_gauss();
  const FocusField axis{}, field{.field_rad = radians(10), .weight = 0.5};
  const FocusSolution on_axis = solve_focus(lens, 3000, {.fields = {axis}});
  const FocusSolution both = solve_focus(lens, 3000, {.fields = {axis, field}});
  std::cout << "focus: the field moves the film by " << both.film_z - on_axis.film_z << " mm\n";
  return on_axis && both;
}

/// Focuses on two points and measures their blurs on the film by exact rays.
bool blurs_of_targets() {
  const Lens lens = double_gauss();
  const std::vector<FocusTarget> targets{{.point = {{0, 0, -2900}}}, {.point = {{100, 0, -3100}}, .weight = 2}};
  const Autofocus focus = autofocus(lens, targets, film);
  const std::vector<ScenePoint> points{targets[0].point, targets[1].point};
  const std::vector<std::optional<ExactBlur>> blurs = exact_blurs(lens, focus.film, points);
  std::cout << "autofocus: " << name(focus.status);
  bool used = focus.status == FocusStatus::solved;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TargetBlur& target = focus.blurs[i];
    const ExactBlur blur = blurs[i].value_or(ExactBlur{});
    std::cout << ", blur " << target.blur_mm << " mm, RMS radius " << blur.rms_radius << " mm";
    used = used && target.status == TargetStatus::used && blur.rms_radius > 0;
  }
  std::cout << '\n';
  return used;
}

/// Moves a focus point over a triangle of a mesh, from its first to its second vertex.
bool animated_point() {
  const std::vector<Vec3<double>> mesh{{-400, 0, -3000}, {400, 0, -3000}, {0, 600, -3500}};
  const TrianglePoint first{{0, 1, 2}, {1, 0, 0}}, second{{0, 1, 2}, {0, 1, 0}};
  const FocusKey begin{.time = 0, .anchor = first}, end{.time = 2, .anchor = second};
  const std::vector<FocusPoint> points{{.keys = {begin, end}}};
  const FocusTime moment{.time = 1, .vertices = mesh};
  const std::vector<FocusTarget> targets = focus_targets(thick_lens(double_gauss()), points, moment);
  if (targets.size() != 1) return false;
  const Vec3<double>& position = targets[0].point.position;
  std::cout << "focus point: x " << position.x << ", z " << position.z << " mm\n";
  return near(position.x, 0, 1e-9) && near(position.z, -3000, 1e-9);
}

/// Interpolates the distance in focus between two points.
bool focal_surface() {
  const Lens lens = double_gauss();
  const Film frame = film_in({.offset = lens.film_z()}, film);
  const std::vector<FocalPoint> points{{.film_point = {-9, 0}, .inverse_distance = 1 / 1500.0},
                                       {.film_point = {9, 0}, .inverse_distance = 1 / 4000.0}};
  const FocalSurfaceOptions options{.kind = SurfaceKind::shepard, .beta = 2};
  const FocalSurface surface(thick_lens(lens), frame, points, options);
  const FocalSurface::Values at_point = surface.at({-9, 0});
  const FocalSurface::Slopes between = surface.slopes({0, 0});
  std::cout << "focal surface: slope " << between.inverse_distance.x << " /mm^2\n";
  const std::string svg = focal_surface_figure("double Gauss", "two points", thick_lens(lens), frame, surface, points);
  return near(at_point.inverse_distance * 1500, 1, 1e-6) && between.inverse_distance.x < 0 && !svg.empty();
}

/// Computes the derivatives of a ray by pixel, and the pixel of a scene point.
bool pixel_derivatives() {
  const Camera camera(double_gauss(), film, {.model = ModelKind::exact_double});
  const CameraRayDifferential ray = camera.sample_differential({.film = {3, 2}, .pupil_u = 0.3, .pupil_v = 0.6});
  const auto [by_x, by_y] = by_raster(ray, film);
  const Projection image = camera.project({100, 50, -3000});
  std::cout << "pixel: width " << by_x.direction.x << " rad, point at column " << image.raster.x << '\n';
  return ray.sample && image && by_x.direction.x > 0;
}

/// Measures the errors of a model of first order.
bool errors_of_a_model() {
  const ModelKind model = ModelKind::thick;
  const ModelKind::Family family = model.family();
  const ErrorSamples samples{.depths_z = {-3000, -5000}, .film_points = 16};
  const ModelError error = model_error(double_gauss(), film, model, samples);
  const RayErrors& rays = error.all;
  std::cout << name(model) << ": RMS error " << rays.rms_px << " px, exposure " << error.exposure << '\n';
  return family == ModelKind::Family::thick && rays.rays > 0 && rays.rms_px <= rays.max_px;
}

/// Computes the distortion of a lens: coefficients for OpenCV, and maps for compositors.
bool lens_distortion() {
  const LensDistortion distortion(Camera(double_gauss(), film, {.model = ModelKind::exact_double}));
  const Pinhole& pinhole = distortion.pinhole();
  const BrownConradyDirection direction = BrownConradyDirection::to_distorted;
  const BrownConrady fit = fit_brown_conrady(distortion, direction, RadialForm::polynomial);
  const StMaps maps = st_maps(distortion);
  const StMap& map = maps.redistort;
  std::cout << name(fit.direction) << ": k1 " << fit.k[0] << ", focal length " << pinhole.focal_length_mm.x
            << " mm, error " << fit.largest_px << " px, map of " << map.width << " columns\n";
  return fit.largest_px < 0.1 && map.has_source(180, 120) && maps.undistort.width >= film.columns;
}

/// Collects the metadata of a shot: names, settings and falloff.
bool metadata() {
  const Lens lens = with_coating(double_gauss(), Coating::quarter_wave());
  const LensIdentity identity = identity_of(table("double_gauss_100mm_f2.0"));
  const LensState state = lens_state(LensDistortion(Camera(lens, film)));
  const ExposureFalloff falloff = fit_exposure_falloff(lens, film);
  std::cout << identity.model << ": T" << state.t_number.value() << ", " << state.focus_distance_mm
            << " mm, light at 18 mm " << falloff.light(18) << '\n';
  return state.t_number > state.f_number && falloff.light(18) < 1;
}

/// Compares the blur of a lens at f/16 with its Airy disc.
bool diffraction_of_a_spot() {
  const Lens lens = with_focus(with_f_number(compile(table("double_gauss_100mm_f2.0")), 16), 3000);
  const std::vector<double> fields_rad{0};
  const Grid<Spot> spots = spot_diagram(lens, -3000, fields_rad, 256);
  const SpotSize& size = spots[0][0].size;
  const Diffraction influence = diffraction(airy_radius(lens), size);
  std::cout << "spot: RMS radius " << size.rms_radius << " mm, diffraction " << name(influence) << '\n';
  return influence == Diffraction::dominant;
}

/// Computes a kernel, writes it as a part of an EXR file in memory, and builds a PSF set from the part.
bool kernels() {
  const Lens lens = double_gauss();
  const PsfOptions options{.samples = 1u << 14, .pixels = 33};
  const PsfKernel kernel = psf_kernel(lens, lens, {.z = -2000}, lens.primary_wavelength(), options);
  const PsfSetPoint point{.distance_mm = 2000, .wavelength_nm = d_line_nm, .f_number = 2};
  const auto [part_point, part] = from_exr_part(to_exr_part(kernel, point));
  const PsfSet::Axes axes{{0}, {2000}, {d_line_nm}, {2}};
  const PsfSet set(axes, {part});
  std::cout << "kernel: " << psf_part_name(part_point) << ", light " << part.total << '\n';
  return set.at(point).total == kernel.total && total_variation(set.at(point), kernel) == 0;
}

/// Gives the blurs of a camera the rings of a moulded asphere.
bool onion_bokeh() {
  const OnionRings rings{.period = 0.1, .contrast = 0.3, .seed = 7};
  const IrisMap map = onion_rings(rings, 256);
  const Camera camera(double_gauss(), film, {.bokeh = {.weight_map = map}});
  const CameraRay ray = camera.sample({.film = {}, .pupil_u = 0.3, .pupil_v = 0.6});
  std::cout << "onion rings: brightest weight " << *std::max_element(map.values.begin(), map.values.end()) << '\n';
  return map.keep_mean && ray;
}

/// Blurs a wall of one colour by a round lens, whose rays are given as lines over inverse depth.
bool custom_blur() {
  const LayerCamera camera = layer_camera(48, 32, radians(30));
  const LensRays::Source lens = [&](int, const Vec2<double>& raster, std::span<const PupilPoint> points,
                                    std::span<LayerRay> rays) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const PupilPoint& point = points[i];
      const double angle = 2 * std::numbers::pi * point.u, radius_mm = 10 * std::sqrt(point.v);
      rays[i].slope = Vec2<double>(std::cos(angle), std::sin(angle)) * (radius_mm * camera.focal_px);
      rays[i].position = raster - rays[i].slope / 2000.0;  // in focus at 2000 mm
    }
  };
  const LensRays rays(camera, vogel_points(32), 1, lens, {.nearest_mm = 1000});
  const PeelPlan plan = plan_peel(rays, 1000, 5000);
  FragmentLists wall{plan.camera.layer_columns(), plan.camera.layer_rows(), {0}, {}};
  const FragmentLists::Fragment grey{.depth_mm = 4000, .red = 0.5f, .green = 0.5f, .blue = 0.5f};
  wall.fragments.assign(static_cast<std::size_t>(wall.columns) * static_cast<std::size_t>(wall.rows), grey);
  for (std::size_t i = 0; i < wall.fragments.size(); ++i) wall.offsets.push_back(i + 1);
  LayerSet layers;
  layers.peel_fragments(wall, plan.bias, 4);
  const GatherOptions options{.threads = 1, .highlights_above = 0};
  const BlurredImage picture = gather(layers, rays, options);
  std::cout << "blur: " << layers.count() << " layer, red " << picture.rgba[0] << '\n';
  return near(picture.rgba[0], 0.5, 1e-4);
}

/// Draws a tilted film, a focus pull and a comparison of two models as SVG.
bool figures() {
  const Lens lens = double_gauss();
  const Film upright = film_in({.offset = lens.film_z()}, film);
  Film tilted = upright;
  tilted.tilt_rad = radians(3);
  const FocusTarget point{.point = {{0, -500, -4000}}};
  const TiltView view{"double Gauss", "3 degrees", thick_lens(lens), &lens, upright, tilted, {}, 0.03, {&point, 1}};
  const FocusPullFrame frame{.time = 0, .film = upright, .subject_distance = 3000, .rms_mm = 0.01};
  const ParetoPoint fast{.name = "thin", .ns_per_ray = 5, .max_um = 90, .rms_um = 30, .on_front = true};
  const ParetoPoint exact{.name = "exact_double", .ns_per_ray = 500, .on_front = true};
  const std::string tilt = tilt_figure(view);
  const std::string pull = focus_pull_figure("double Gauss", "held", std::array{frame}, {});
  const std::string pareto = pareto_figure("double Gauss", "example", std::array{fast, exact});
  std::cout << "figures: " << tilt.size() << ", " << pull.size() << " and " << pareto.size() << " bytes\n";
  return tilt.starts_with("<svg") && pull.starts_with("<svg") && pareto.starts_with("<svg");
}

}  // namespace

int main() {
  // Each example prints one line and returns true if its result is right. The first wrong result ends the program.
  if (!aspheric_surface() || !zoom_positions() || !moving_groups() || !imported_file() || !index_policies()) return 1;
  if (!traced_derivatives() || !aimed_rays() || !ideal_image() || !focus_of_fields() || !blurs_of_targets()) return 1;
  if (!animated_point() || !focal_surface() || !pixel_derivatives() || !errors_of_a_model()) return 1;
  if (!lens_distortion() || !metadata() || !diffraction_of_a_spot() || !kernels()) return 1;
  if (!onion_bokeh() || !custom_blur() || !figures()) return 1;
}
