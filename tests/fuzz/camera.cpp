// SPDX-License-Identifier: Apache-2.0
// Cameras of any lens, by every ray model, with blades, weights and tilted films.
#include "petzval/camera/camera.hpp"
#include "petzval/petzval_camera.h"

#include <array>
#include <span>
#include <type_traits>

#include "camera_laws.hpp"
#include "wild_lens.hpp"

namespace {

using namespace petzval;

constexpr std::size_t count = 5;

Film wild_film(fuzz::Bytes& bytes) {
  Film film{.width_mm = bytes.number(1, 40),
            .height_mm = bytes.number(1, 30),
            .columns = bytes.count(1, 64),
            .rows = bytes.count(1, 64)};
  const int kind = bytes.byte();
  if (kind < 32) film.tilt_rad = bytes.number(-0.3, 0.3), film.swing_rad = bytes.number(-0.3, 0.3);
  if (kind % 32 == 1) film.travel_mm = bytes.number(-1, 1);
  if (kind % 16 == 2) film.shift_x_mm = bytes.number(-20, 20), film.margin_mm = bytes.number(0, 4);
  if (kind % 16 == 3) film.z_mm = bytes.number(0, 300);
  return film;
}

/// Models with fits are rare, because they take a hundred times as long as the others.
ModelKind wild_model(fuzz::Bytes& bytes) {
  const int kind = bytes.byte();
  const ModelKind model = models()[static_cast<std::size_t>(kind) % models().size()];
  const bool fitted = model.is_polynomial();
  return fitted && kind < 240 ? ModelKind::exact_float : model;
}

CameraOptions wild_options(fuzz::Bytes& bytes) {
  CameraOptions options{.model = wild_model(bytes)};
  options.normalisation = static_cast<Normalisation>(bytes.count(0, 2));
  const int kind = bytes.byte();
  if (kind < 32)
    options.bokeh.weight_distribution = bytes.number(-20, 20), options.bokeh.weight_strength = bytes.number(0, 1);
  if (kind % 16 == 1) options.bokeh.blades = bytes.count(0, 21);
  if (kind % 16 == 2)
    options.bokeh.lens_ratio = bytes.number(0.5, 3), options.bokeh.rate_of_change = bytes.number(0, 2);
  if (kind % 64 == 3) {  // rare, because maps take most of the time
    options.bokeh.weight_map = {.width = 2, .height = 3, .values = {}, .keep_mean = bytes.one_in(2)};
    for (int i = 0; i < 6; ++i) options.bokeh.weight_map.values.push_back(static_cast<float>(bytes.number(0, 1)));
  }
  options.transmission = kind % 16 == 5;
  if (kind % 16 == 4) {
    for (int i = bytes.count(0, 4); i > 0; --i)
      options.expressive.power.push_back({bytes.number(0, 1), bytes.number(0, 2)});
    options.expressive.dispersion = {bytes.number(0, 2)};
  }
  return options;
}

template <class T>
void samples(const Camera& camera, fuzz::Bytes& bytes) {
  testing::Samples<T> samples;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2<double> raster{bytes.number(0, 1) * camera.film().columns, bytes.number(0, 1) * camera.film().rows};
    const FilmPoint film = camera.film().point(raster.x, raster.y);
    const double u = bytes.number(0, 1), v = bytes.number(0, 1);
    samples.add(film.x, film.y, u, v);
  }
  samples.run(camera);
  fuzz::check(samples);
}

void from_the_scene(const Camera& camera, fuzz::Bytes& bytes) {
  const Vec3<double> point{bytes.number(-500, 500), bytes.number(-500, 500), bytes.number(-2000, -10)};
  const double u = bytes.number(0, 1), v = bytes.number(0, 1);
  const ImportanceSample found = camera.sample_importance(point, u, v);
  fuzz::check(found, 1e-9);
  if (found) fuzz::check(camera.importance({point, found.direction}));
  fuzz::check(camera.project(point));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const CameraOptions options = wild_options(bytes);
    const Film film = wild_film(bytes);
    const bool scene = bytes.one_in(8), derivatives = bytes.one_in(8), tables = bytes.one_in(8);
    const Camera camera(fuzz::wild_lens(bytes), film, options);
    samples<float>(camera, bytes);
    samples<double>(camera, bytes);
    if (derivatives) {
      const auto ray =
          camera.sample_differential({.film = camera.film().point(0.5, 0.5), .pupil_u = 0.3, .pupil_v = 0.6});
      fuzz::require(fuzz::finite(ray.sample.ray), "a camera ray with derivatives is finite");
    }
    if (tables) {
      fuzz::done([&] {
        const std::vector<float> table = camera_table(camera);
        for (const float number : table) fuzz::require(!std::isnan(number), "tables contain no NaN");
        const float nm = table[static_cast<std::size_t>(table[PZ_WAVELENGTHS])];
        const pz_point at = pz_film_point(table.data(), 0.3f * table[PZ_COLUMNS], 0.6f * table[PZ_ROWS]);
        const pz_ray ray = pz_sample(table.data(), at.x, at.y, 0.2f, 0.7f, nm);
        const float sum = ray.origin.x + ray.origin.y + ray.origin.z + ray.direction.x + ray.direction.z + ray.weight;
        fuzz::require(ray.fate != 0 || std::isfinite(sum), "a ray of petzval_camera.h is finite");
        const pz_connection c = pz_connect(table.data(), {100, 50, -2000}, 0.2f, 0.7f, nm);
        fuzz::require(c.arrival.fate != 0 || std::isfinite(c.arrival.we + c.arrival.film.x), "a connection is finite");
      });
    }
    if (scene) from_the_scene(camera, bytes);
  });
  return 0;
}
