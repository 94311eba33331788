// SPDX-License-Identifier: Apache-2.0
// The code of renderers.md. Each function is a section of the guide.
#include <array>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <numbers>
#include <vector>

#include "petzval/analysis/choose_model.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "petzval/image/image.hpp"
#include "petzval/petzval.hpp"

namespace {

using namespace petzval;

/// The scene: a uniform sky of radiance 1, without obstacles.
double radiance(const Ray<double>&) { return 1; }
bool visible(const Vec3<double>&, const Vec3<double>&) { return true; }

/// The next point of a uniform sequence in the unit square.
std::array<double, 2> next_pair() {
  static std::array<double, 2> pair{0.5, 0.5};
  return pair = {std::fmod(pair[0] + 0.7548776662466927, 1.0), std::fmod(pair[1] + 0.5698402909980532, 1.0)};
}

const Film film{.width_mm = 36, .height_mm = 24, .columns = 1920, .rows = 1280};

Lens focused_lens() {
  const Lens lens = compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f2.0.json"));
  return with_focus(with_f_number(lens, 2.8), 3000, {.origin = DistanceOrigin::film});
}

void first_camera() {
  Lens lens = compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f2.0.json"));
  lens = with_f_number(lens, 2.8);
  lens = with_focus(lens, 3000, {.origin = DistanceOrigin::film});  // mm
  const Camera camera(lens, {.width_mm = 36, .height_mm = 24, .columns = 1920, .rows = 1280});

  const FilmPoint point = camera.film().point(960, 640);  // column, row: the centre of the picture
  double irradiance = 0;
  for (int i = 0; i < 1024; ++i) {
    const auto [u, v] = next_pair();
    const CameraRay r = camera.sample({.film = point, .pupil_u = u, .pupil_v = v});
    if (r) irradiance += r.weight * radiance(r.ray) / 1024;
  }
  std::cout << "irradiance " << irradiance << ", f-number " << std::sqrt(std::numbers::pi / irradiance) / 2 << '\n';
}

void save(const Lens& lens) {
  const Camera seven_blades(lens, film, {.bokeh = {.blades = 7}});
  RgbImage picture(film.columns, film.rows);
  picture.pixel(960, 640)[1] = 0.09f;              // green of column 960, row 640
  write_exr(picture, "picture.exr");               // linear
  write_png(to_srgb8(picture, 8), "picture.png");  // sRGB, eight times as bright
}

void batches(const Camera& camera, std::size_t count) {
  std::vector<float> film_x(count), film_y(count), u(count, 0.3f), v(count, 0.6f), weights(count);
  std::vector<float> x(count), y(count), z(count), dx(count), dy(count), dz(count);
  const CameraSamples<float> samples{film_x.data(), film_y.data(), u.data(), v.data()};
  const CameraRays<float> rays{{x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}, weights.data()};
  camera.sample(count, samples, rays);  // no allocation, no lock
}

void connections(const Camera& camera) {
  const Vec3<double> point{100, 50, -3000};  // mm, a point lamp of intensity 1 W/sr
  double irradiance = 0;
  for (int i = 0; i < 1024; ++i) {
    const auto [u, v] = next_pair();
    const ImportanceSample c = camera.sample_importance(point, u, v);
    if (c && visible(point, c.on_front)) irradiance += c.importance.we / c.pdf / 1024;
  }
  const Projection image = camera.project(point);
  std::cout << "mean irradiance " << irradiance << " W/mm^2, pixel " << static_cast<int>(image.raster.x) << ' '
            << static_cast<int>(image.raster.y) << '\n';
}

/// Balance heuristic of a film sample whose ray meets a surface at `hit`. Light paths have vertices at this point with
/// the density `pdf_area` (1/mm^2).
double film_weight(const Camera& camera, const CameraRay& r, const Vec3<double>& hit, double cosine, double pdf_area) {
  const Vec3<double> to_lens = -r.ray.direction;
  const Importance i = camera.importance({hit, to_lens});
  const double by_film = i.pdf_position * i.pdf_direction * cosine;  // both in 1/(mm^2 sr)
  const double by_light = pdf_area * camera.pdf_importance(hit, to_lens);
  return by_light > 0 ? by_film / (by_film + by_light) : 1;  // 1 for a pinhole
}

void choice(const Lens& lens) {
  const SceneRequirements scene{.near_mm = 1500, .far_mm = 10000, .film = film};
  const ModelChoice choice = choose_model(lens, scene, {.max_px = 0.5});
  for (const std::string& reason : choice.reasons) std::cerr << reason << '\n';
  const Camera camera(lens, film, {.model = choice.model});
  std::cout << "model " << name(camera.model()) << '\n';
}

void spectrum(const Prescription& prescription) {
  const std::vector<double> nm{400, 440, 480, 520, 560, 600, 650, 700};
  Lens lens = compile(prescription, nm, {.clamp_wavelengths = true});
  lens = with_focus(lens, 3000, {.origin = DistanceOrigin::film});
  for (const std::string& glass : lens.clamped_glasses()) std::cerr << glass << '\n';
  const Camera camera(lens, film);
  const CameraRay r = camera.sample({.film = {}, .pupil_u = 0.3, .pupil_v = 0.6, .wavelength = Wavelength::nm(512.5)});
  std::cout << "at 512.5 nm: " << name(r.fate) << '\n';
}

void host(const Camera& camera) {
  const HostFrame pbrt(Host::pbrt, camera.lens(), DistanceOrigin::entrance_pupil);
  const CameraRay r = camera.sample({.film = {}, .pupil_u = 0.3, .pupil_v = 0.6});
  const Ray<double> camera_space = pbrt.to_host(r.ray);  // metres, +z ahead
  std::cout << "direction " << (camera_space.direction.z > 0 ? "+z" : "-z") << '\n';
}

void focus_pull(const Lens& lens) {
  const FocusOptions from_film{.origin = DistanceOrigin::film};
  Film moving = film;
  moving.z_mm = with_focus(lens, 3000, from_film).film_z();
  moving.travel_mm = with_focus(lens, 1500, from_film).film_z() - *moving.z_mm;
  const Camera camera(lens, moving);
  const CameraRay r = camera.sample({.film = {}, .pupil_u = 0.3, .pupil_v = 0.6, .time = 0.25});
  std::cout << "travel " << moving.travel_mm << " mm, " << name(r.fate) << '\n';
}

void tilted_film(const Lens& lens) {
  const std::vector<FocusTarget> floor{
      {.point = {{-300, -800, -7000}}}, {.point = {{400, -800, -7000}}}, {.point = {{0, -800, -15000}}}};  // mm
  const TiltFit fit = fit_tilt(thick_lens(lens), floor, {.film = film});
  if (!fit) throw Error("floor: " + std::string(name(fit.status)));
  const Camera camera(lens, fit.film);
  std::cout << name(fit.status) << ", tilt " << fit.film.angle() * 180 / std::numbers::pi << " degrees\n";
}

void focal_surface(const Lens& lens) {
  Film frame = film;
  frame.z_mm = lens.film_z();
  const std::vector<FocalPoint> points{{.film_point = {-9, 0}, .inverse_distance = 1 / 1500.0},
                                       {.film_point = {9, 2}, .inverse_distance = 1 / 4000.0},
                                       {.film_point = {0, -8}, .inverse_distance = 1 / 3000.0, .extent_stops = 2}};
  const FocalSurface surface(thick_lens(lens), frame, points);
  const Camera camera(lens, frame, {.model = ModelKind::thin_two_disc, .focal_surface = surface});
  std::cout << "steepness " << camera.focal_steepness() << '\n';
}

void errors(const Lens& lens) {
  try {
    const Camera camera(lens, {.width_mm = 36, .height_mm = -24});
  } catch (const Error& error) {
    std::cout << error.what() << '\n';
  }
  const Camera camera(lens, film);
  const CameraRay r = camera.sample({.film = {40, 0}, .pupil_u = 0.3, .pupil_v = 0.6});
  std::cout << name(r.fate) << ", weight " << r.weight << '\n';
}

}  // namespace

int main() {
  std::cout.precision(3);
  const Prescription prescription = read_prescription(data_directory() / "lenses/double_gauss_100mm_f2.0.json");
  const Lens lens = focused_lens();
  const Camera camera(lens, film);
  first_camera();
  save(lens);
  batches(camera, 1000);
  connections(camera);
  const CameraRay r = camera.sample({.film = {}, .pupil_u = 0.3, .pupil_v = 0.6});
  const Vec3<double> hit = r.ray.origin + 3000.0 * r.ray.direction;
  std::cout << "weight of the film sample " << film_weight(camera, r, hit, 1, 1e-6) << '\n';
  choice(lens);
  spectrum(prescription);
  host(camera);
  focus_pull(lens);
  tilted_film(lens);
  focal_surface(lens);
  errors(lens);
}
