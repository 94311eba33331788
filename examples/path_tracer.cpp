// SPDX-License-Identifier: Apache-2.0
// A small path tracer: three spheres on a checkered floor under a sky, seen through a double Gauss.
//
//   path_tracer [FOLDER]      writes path_tracer.png
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "petzval/image/image.hpp"
#include "petzval/petzval.hpp"

namespace {

using namespace petzval;
using Vec = Vec3<double>;
constexpr std::uint32_t columns = 480, rows = 320, samples = 64;
constexpr double floor_y = -120, tile = 100;  // mm, lens frame: the scene lies at negative z

struct Sphere {
  Vec centre, albedo;
  double radius;
};
constexpr std::array spheres{Sphere{{-110, -60, -1000}, {0.8, 0.25, 0.2}, 60},
                             Sphere{{10, -20, -1500}, {0.25, 0.6, 0.3}, 100},
                             Sphere{{290, 20, -2600}, {0.25, 0.35, 0.8}, 140}};

/// The sky: white at the horizon, blue above, with a bright region on the left behind the camera.
Vec sky(const Vec& d) {
  const double sun = std::pow(std::max(0.0, dot(d, normalize(Vec{-0.6, 0.7, 0.4}))), 16);
  return Vec{1, 1, 1} - std::sqrt(std::max(0.0, d.y)) * Vec{0.75, 0.55, 0.1} + 8 * sun * Vec{1, 0.85, 0.6};
}

/// Point `index` of the Sobol sequence number `pair` of a pixel. Each sequence has another order of its points, because
/// film points, pupil samples and directions would otherwise depend on each other.
Vec2<double> sobol(std::uint32_t index, std::uint32_t pixel, std::uint32_t pair) {
  const std::uint32_t seed = 0x9E3779B9u * (16 * pixel + pair);
  return owen_sobol(static_cast<std::uint32_t>(samples * owen_sobol(index, seed).x), seed + 1);
}

/// Radiance along one random path of diffuse reflections that begins with a camera ray.
Vec radiance(Ray<double> ray, std::uint32_t index, std::uint32_t pixel) {
  Vec throughput{1, 1, 1};
  for (std::uint32_t bounce = 0; bounce < 4; ++bounce) {
    double nearest = HUGE_VAL;
    Vec normal{0, 1, 0}, albedo{};
    if (ray.direction.y < 0) {
      nearest = (floor_y - ray.origin.y) / ray.direction.y;
      const Vec hit = (ray.origin + nearest * ray.direction) / tile;
      albedo = Vec{1, 1, 1} * (std::fmod(std::floor(hit.x) + std::floor(hit.z), 2) == 0 ? 0.7 : 0.3);
    }
    for (const Sphere& sphere : spheres) {
      const Vec to_centre = sphere.centre - ray.origin;
      const double along = dot(to_centre, ray.direction);
      const double root = std::sqrt(sphere.radius * sphere.radius + along * along - dot(to_centre, to_centre));
      if (!(root < along && along - root < nearest)) continue;  // also if root is NaN: the ray misses the sphere
      nearest = along - root;
      normal = (nearest * ray.direction - to_centre) / sphere.radius;
      albedo = sphere.albedo;
    }
    if (std::isinf(nearest)) return throughput * sky(ray.direction);
    throughput *= albedo;
    ray.origin += nearest * ray.direction + 1e-3 * normal;  // clear of the surface
    // A uniform point of the unit sphere plus the normal has the cosine distribution of diffuse light.
    const Vec2<double> sample = sobol(index, pixel, 2 + bounce);
    const double z = 1 - 2 * sample.x, r = std::sqrt(1 - z * z), angle = 2 * std::numbers::pi * sample.y;
    ray.direction = normalize(normal + Vec{r * std::cos(angle), r * std::sin(angle), z});
  }
  return {0, 0, 0};  // little light remains
}

}  // namespace

int main(int argc, char** argv) try {
  const std::filesystem::path file = std::filesystem::path(argc > 1 ? argv[1] : ".") / "path_tracer.png";
  const Lens lens = compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f2.0.json"));
  const Film film{.width_mm = 36, .height_mm = 36.0 * rows / columns, .columns = columns, .rows = rows};
  // Focused at the front of the second sphere. Radiance 1 gives the value 1 on the axis, and less under vignetting.
  const Camera camera(with_focus(lens, 1400), film, {.normalisation = Normalisation::unity_on_axis});
  RgbImage image(columns, rows);
  parallel_for(columns * rows, columns, processor_threads(), [&](std::size_t begin, std::size_t end) {
    for (auto pixel = static_cast<std::uint32_t>(begin); pixel < end; ++pixel) {
      Vec sum{0, 0, 0};
      for (std::uint32_t i = 0; i < samples; ++i) {
        const Vec2<double> in_pixel = sobol(i, pixel, 0), in_pupil = sobol(i, pixel, 1);
        const FilmPoint point = camera.film().point(pixel % columns + in_pixel.x, pixel / columns + in_pixel.y);
        const CameraRay r = camera.sample({.film = point, .pupil_u = in_pupil.x, .pupil_v = in_pupil.y});
        if (r) sum += r.weight * radiance(r.ray, i, pixel);  // a lost sample is black
      }
      for (int c = 0; c < 3; ++c) image.pixels[3 * pixel + c] = static_cast<float>(sum[c] / samples);
    }
  });
  write_png(to_srgb8(image, 0.8f), file);
  std::printf("%s\n", file.c_str());
} catch (const petzval::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
