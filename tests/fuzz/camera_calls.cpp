// SPDX-License-Identifier: Apache-2.0
// Calls of cameras that are built once: samples, importance, connections and projections with any numbers.
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <glm/geometric.hpp>

#include "camera_laws.hpp"
#include "fixed_lenses.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace {

using namespace petzval;

constexpr std::size_t count = 5;

Camera focused(const char* id, const CameraOptions& options, const Film& film, const Iris& iris = {}) {
  return {with_focus(with_iris(fuzz::coloured(id), iris), 10000), film, options};
}

/// Cameras with each kind of model, pupil and film.
const Camera& some_camera(fuzz::Bytes& bytes) {
  using Make = std::function<Camera()>;
  constexpr const char *usual = "double_gauss_100mm_f2.0", *wide = "fisheye_8mm_f2.8", *flat = "anamorphic_60mm_2x";
  const Film film{.columns = 36, .rows = 24}, small{.width_mm = 16, .height_mm = 12, .columns = 40, .rows = 30},
      tilted{.columns = 36, .rows = 24, .margin_mm = 1, .tilt_rad = 0.1, .swing_rad = -0.05},
      moving{.columns = 36, .rows = 24, .shift_x_mm = 5, .travel_mm = 0.5};
  static const std::vector<Make> makers{
      [=] { return focused(usual, {.model = ModelKind::pinhole}, film); },
      [=] { return focused(usual, {.model = ModelKind::thin}, tilted, {.blades = 6, .roundness = 0.3}); },
      [=] { return focused(usual, {.model = ModelKind::thin_two_disc}, film); },
      [=] { return focused(usual, {.model = ModelKind::thick}, moving); },
      [=] {
        const ExpressiveLens bent{.power = {{0, 1}, {1, 1.2}}, .film_offsets = {{{5, 5}, 1, 1}}, .dispersion = {2}};
        return focused(usual, {.model = ModelKind::thick, .expressive = bent}, film);
      },
      [=] {
        Film placed = film;
        const Lens lens = with_focus(fuzz::coloured(usual), 10000);
        placed.z_mm = lens.film_z();
        const std::vector<FocalPoint> points{{.film_point = {-9, 0}, .inverse_distance = 1 / 2000.0},
                                             {.film_point = {9, 2}, .inverse_distance = 1 / 9000.0},
                                             {.film_point = {0, -8}, .inverse_distance = 0, .extent_stops = 2}};
        return Camera(lens, placed,
                      {.model = ModelKind::thick, .focal_surface = FocalSurface(thick_lens(lens), placed, points)});
      },
      [=] { return focused(usual, {.model = ModelKind::polynomial(5)}, film); },
      [=] { return focused(usual, {.model = ModelKind::polynomial(3)}, tilted, {.blades = 8}); },
      [=] {
        const IrisMap map{.width = 2, .height = 2, .values = {1, 0.5f, 0.25f, 0}};
        return focused(usual, {.bokeh = {.weight_map = map}}, moving);
      },
      [=] { return focused(usual, {}, film); },
      [=] { return focused(usual, {.normalisation = Normalisation::unity_on_axis}, tilted); },
      [=] { return focused(usual, {.transmission = true}, tilted); },
      [=] { return focused(flat, {.model = ModelKind::thick, .transmission = true}, small); },
      [=] { return focused(usual, {.model = ModelKind::exact_double}, moving, {.blades = 5, .rotation_rad = 0.2}); },
      [=] {
        const BokehControls bokeh{.blades = 7, .weight_distribution = 3, .weight_strength = 0.5};
        return focused(usual, {.bokeh = bokeh}, film);
      },
      [=] { return focused(usual, {.bokeh = {.lens_ratio = 1.2, .rate_of_change = 0.5}}, film); },
      [=] { return focused(wide, {}, small); },
      [=] { return focused(wide, {.model = ModelKind::polynomial(3)}, small); },
      [=] { return focused(flat, {}, small); },
      [=] { return focused(flat, {.model = ModelKind::thick}, small); },
      [=] { return focused("catadioptric_mangin_1000mm_f7.5", {.model = ModelKind::exact_double}, small); },
  };
  static std::vector<std::unique_ptr<Camera>> cameras(makers.size());
  auto& camera = cameras[bytes.byte() % cameras.size()];
  if (!camera) camera = std::make_unique<Camera>(makers[static_cast<std::size_t>(&camera - cameras.data())]());
  return *camera;
}

CameraSample wild_sample(const Film& film, fuzz::Bytes& bytes) {
  CameraSample s;
  s.film = {bytes.number(-0.6, 0.6) * film.width_mm + film.shift_x_mm, bytes.number(-0.6, 0.6) * film.height_mm};
  s.pupil_u = bytes.number(0, 1), s.pupil_v = bytes.number(0, 1);
  s.wavelength = fuzz::wild_wavelength(bytes), s.time = bytes.number(0, 1);
  return s;
}

Vec3<double> wild_point(fuzz::Bytes& bytes) {
  const double beside = bytes.one_in(4) ? 40 : 800;
  return {bytes.number(-beside, beside), bytes.number(-beside, beside), bytes.number(-3000, 0)};
}

Vec3<double> wild_direction(fuzz::Bytes& bytes) {
  if (bytes.byte() < 16) return {bytes.wild(), bytes.wild(), bytes.wild()};
  const double x = bytes.between(-0.7, 0.7), y = bytes.between(-0.7, 0.7);
  return {x, y, std::sqrt(1 - x * x - y * y)};
}

/// Checks equality up to rounding in the precision of the model. Rays at an edge may have either fate. A film point may
/// be on the axis in float and off the axis in double, which rotates its pupil polygon by a fraction of a sector.
void alike(const CameraRay& one, const Ray<double>& other, double weight) {
  constexpr double rounding = 1e-2;
  if (!one || !(weight > 0)) return;
  const double size = 10 + glm::length(one.ray.origin);  // mm
  fuzz::require(glm::length(one.ray.direction - other.direction) <= rounding &&
                    glm::length(one.ray.origin - other.origin) <= rounding * size &&
                    std::abs(one.weight - weight) <= rounding * (one.weight + 1e-3),
                "a ray of a batch equals the single call");
}

template <class T>
void samples(const Camera& camera, fuzz::Bytes& bytes) {
  testing::Samples<T> samples;
  const bool by_nm = bytes.one_in(4);
  samples.wavelength = fuzz::wild_wavelength(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const CameraSample s = wild_sample(camera.film(), bytes);
    samples.add(s.film.x, s.film.y, s.pupil_u, s.pupil_v);
    samples.times.push_back(static_cast<T>(s.time));
    const auto nm = static_cast<float>(bytes.number(430, 670));
    if (by_nm) samples.nm.push_back(nm);
  }
  samples.run(camera);
  fuzz::check(samples);
  for (std::size_t i = 0; i < count; ++i) {
    const CameraRay alone = camera.sample(samples.one(i));
    fuzz::check(alone);
    alike(alone, samples.ray(i), samples.weights[i]);
  }
}

void differentials(const Camera& camera, fuzz::Bytes& bytes) {
  const CameraRayDifferential found = camera.sample_differential(wild_sample(camera.film(), bytes));
  fuzz::check(found.sample);
  fuzz::require(fuzz::finite(found.by_film_x) && fuzz::finite(found.by_film_y), "derivatives are finite");
}

void importance(const Camera& camera, fuzz::Bytes& bytes) {
  std::array<std::array<double, count>, 7> in;
  std::array<Importance, count> together;
  const Wavelength wavelength = fuzz::wild_wavelength(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3<double> start = wild_point(bytes), towards = wild_direction(bytes);
    for (int k : {0, 1, 2})
      in[static_cast<std::size_t>(k)][i] = start[k], in[static_cast<std::size_t>(k) + 3][i] = towards[k];
    in[6][i] = bytes.number(0, 1);
  }
  camera.importance(count, {in[0].data(), in[1].data(), in[2].data(), in[3].data(), in[4].data(), in[5].data()},
                    {.all = wavelength}, together.data(), in[6].data());
  for (std::size_t i = 0; i < count; ++i) {
    const Ray<double> ray{{in[0][i], in[1][i], in[2][i]}, {in[3][i], in[4][i], in[5][i]}};
    const Importance alone = camera.importance(ray, wavelength, in[6][i]);
    fuzz::check(alone), fuzz::check(together[i]);
    if (alone && together[i]) {
      fuzz::require(std::abs(alone.we - together[i].we) <= 1e-3 * alone.we, "importance equals the single call");
    }
    fuzz::require(fuzz::density(camera.pdf_distant_importance(ray, wavelength)), "the density of a ray is not NaN");
  }
}

void connections(const Camera& camera, fuzz::Bytes& bytes) {
  const Vec3<double> point = wild_point(bytes), direction = wild_direction(bytes);
  const double u = bytes.number(0, 1), v = bytes.number(0, 1), time = bytes.number(0, 1);
  const Wavelength wavelength = fuzz::wild_wavelength(bytes);
  const ImportanceSample found = camera.sample_importance(point, u, v, wavelength, time);
  fuzz::check(found, 1e-9);
  if (found) {
    const double again = camera.pdf_importance(point, found.direction, wavelength);
    fuzz::require(fuzz::density(again), "the density of a direction is not NaN");
    // Rays from far away are too inaccurate to compare.
    constexpr double farthest = 1e9;  // mm
    const bool near = glm::length(point) < farthest;
    // Densities have steps between the 64 sectors of a pupil, which meet in its centre.
    const double in_sector = 64 * u - std::floor(64 * u);
    const bool inside = u > 0 && u < 1 && in_sector > 1e-6 && in_sector < 1 - 1e-6 && v > 1e-6 && v < 1 - 1e-6;
    if (near && inside && camera.model() != ModelKind::pinhole) {
      fuzz::require(std::abs(again - found.pdf) <= 1e-6 * found.pdf, "a connection has the density of its direction");
    }
    const Importance met = camera.importance({point, found.direction}, wavelength, time);
    fuzz::check(met);
    // At an edge a ray may have either fate.
    if (met && near) {
      fuzz::require(std::abs(met.we - found.importance.we) <= 1e-3 * met.we,
                    "a connection has the importance of its ray");
    }
  }
  constexpr double as_given = 1.001e-3;  // accepted deviation from unit length
  fuzz::check(camera.sample_distant_importance(direction, u, v, wavelength, time), as_given);
  fuzz::require(fuzz::density(camera.pdf_importance(point, direction, wavelength)),
                "the density of a direction is not NaN");
}

void projections(const Camera& camera, fuzz::Bytes& bytes) {
  const Vec3<double> point = wild_point(bytes);
  const Wavelength wavelength = fuzz::wild_wavelength(bytes);
  const Projection seen = camera.project(point, wavelength, bytes.number(0, 1));
  fuzz::check(seen);
  if (seen) fuzz::require(camera.film().contains(seen.film), "visible points lie on the film");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  const Camera& camera = some_camera(bytes);
  switch (bytes.count(0, 5)) {
    case 0: samples<float>(camera, bytes); break;
    case 1: samples<double>(camera, bytes); break;
    case 2: differentials(camera, bytes); break;
    case 3: importance(camera, bytes); break;
    case 4: connections(camera, bytes); break;
    default: projections(camera, bytes);
  }
  return 0;
}
