// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/renderer_cameras.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "core/text.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {
namespace {

/// Centre of the black ball, in the frame of POV-Ray: 100 m behind the lens.
constexpr double dark_z = -1e5;

/// Rays in the frame of POV-Ray, from `first_row` to the last row; the samples of a pixel are adjacent.
struct Samples {
  std::vector<Ray<double>> rays;
  std::vector<double> weights;
};

Samples sampled(const Camera& camera, int first_row, std::uint32_t samples) {
  const Film& film = camera.film();
  const HostFrame frame(Host::pbrt, camera.lens(), DistanceOrigin::front_vertex, 1);
  const auto width = static_cast<std::size_t>(film.columns), count = width * samples;
  std::array<std::vector<double>, 11> columns;
  for (auto& column : columns) column.resize(count);
  auto& [film_x, film_y, u, v, x, y, z, dx, dy, dz, weights] = columns;
  std::uint32_t power = 1;  // the power of two that is not below `samples`
  while (power < samples) power *= 2;

  Samples result;
  for (int row = first_row; row < film.rows; ++row) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto column = static_cast<std::uint32_t>(i / samples), index = static_cast<std::uint32_t>(i % samples);
      const std::uint32_t seed = 0x9E3779B9u * (4 * (static_cast<std::uint32_t>(row) * 0x10000u + column));
      const auto in_pixel = owen_sobol(index, seed);
      // Another order of the points, because pupil samples would otherwise depend on film points.
      const auto other = static_cast<std::uint32_t>(power * owen_sobol(index, seed + 1).x);
      const auto pupil = owen_sobol(other, seed + 2);
      film_x[i] = column + in_pixel.x, film_y[i] = row + in_pixel.y;
      u[i] = pupil.x, v[i] = pupil.y;
    }
    film.points(count, film_x.data(), film_y.data(), film_x.data(), film_y.data());
    camera.sample<double>(
        count, {film_x.data(), film_y.data(), u.data(), v.data(), {}},
        {{x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}, weights.data(), nullptr, nullptr, nullptr});
    for (std::size_t i = 0; i < count; ++i) {
      result.rays.push_back(frame.to_host({{x[i], y[i], z[i]}, {dx[i], dy[i], dz[i]}}));
    }
    result.weights.insert(result.weights.end(), weights.begin(), weights.end());
  }
  return result;
}

/// Drops rays so that the density of the kept rays is proportional to their weights. The remainder of the sum of the
/// weights passes on to the next ray and to the next pixel: the mean of a region is exact, and the noise is fine.
/// @return the weight of a kept ray
double drop_by_weight(Samples& samples) {
  const double most = *std::max_element(samples.weights.begin(), samples.weights.end());
  double sum = 0.5;
  for (std::size_t i = 0; i < samples.rays.size() && most > 0; ++i) {
    sum += samples.weights[i] / most;
    if (sum >= 1) {
      sum -= 1;
    } else {
      samples.rays[i] = {{0, 0, dark_z}, {0, 0, 1}};
    }
  }
  return most;
}

void append(std::string& text, double value) {
  char digits[400];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, 5).ptr);
}

void append_triangle(std::string& text, const Ray<double>& ray) {
  // The size fixes the error of the direction, 1e-7 with 5 digits. The normal is (P3 - P1) x (P2 - P1).
  constexpr double radius = 100;
  const Vec3<double>& d = ray.direction;
  const Vec3<double> across =
      glm::normalize(glm::cross(d, std::abs(d.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0}));
  const Vec3<double> up = glm::cross(across, d);
  text += "triangle{";
  for (int corner = 0; corner < 3; ++corner) {
    const double angle = corner * 2 * std::numbers::pi / 3;
    const Vec3<double> at = ray.origin + radius * (std::cos(angle) * across + std::sin(angle) * up);
    text += corner == 0 ? "<" : ",<";
    append(text, at.x), text += ',', append(text, at.y), text += ',', append(text, at.z);
    text += '>';
  }
  text += "}\n";
}

}  // namespace

std::string format_povray_camera(const Camera& camera, int samples_per_pixel) {
  const Film& film = camera.film();
  if (std::min({samples_per_pixel, film.columns, film.rows}) < 1) {
    throw Error("POV-Ray camera: " + std::to_string(samples_per_pixel) + " samples of " + std::to_string(film.columns) +
                " x " + std::to_string(film.rows) + " pixels; must be 1 or more");
  }
  const auto samples = static_cast<std::uint32_t>(samples_per_pixel);
  // Row r of a picture shows row max(r - 1, 0) of the mesh: POV-Ray 3.7.0 subtracts half a row and rounds down
  // (CreateCameraRay() in source/backend/render/tracepixel.cpp).
  Samples all = sampled(camera, std::min(1, film.rows - 1), samples);
  const double scale = drop_by_weight(all);
  if (!(scale > 0)) throw Error(camera.lens().name() + ": no ray passes the lens");
  const std::string size = " +W" + std::to_string(film.columns) + " +H" + std::to_string(film.rows);

  std::string text = "// " + one_line(camera.lens().name()) + ", a camera for POV-Ray 3.7.\n//\n//   povray scene.pov" +
                     size + " -A +FE   (this size, without antialiasing)\n//\n";
  text +=
      "// Frame: left-handed, mm; origin at the first vertex of the lens, +x right, +y up, view along +z.\n"
      "// Declare petzval_pose before the #include to move the camera: a transform without scale.\n"
      "// Linear picture of petzval render = picture of POV-Ray * ";
  append(text, scale);
  text += ". The first row of the picture repeats the second one.\n";
  text += "#ifndef (petzval_pose) #declare petzval_pose = transform {} #end\n";
  text += "sphere { <0,0,";
  append(text, dark_z);
  text +=
      ">, 10 hollow on pigment { rgb 0 } finish { ambient 0 diffuse 0 emission 0 }\n"
      "  no_shadow no_reflection no_radiosity transform { petzval_pose } } // lost rays start inside\n";
  for (std::uint32_t sample = 0; sample < samples; ++sample) {
    text += "#declare petzval_mesh_" + std::to_string(sample) + " = mesh {\n";
    for (std::size_t i = sample; i < all.rays.size(); i += samples) append_triangle(text, all.rays[i]);
    text += "hierarchy off transform { petzval_pose } }\n";
  }
  text += "camera { mesh_camera { " + std::to_string(samples) + " 0\n";
  for (std::uint32_t sample = 0; sample < samples; ++sample) {
    text += "mesh { petzval_mesh_" + std::to_string(sample) + " }\n";
  }
  text += "} }\n";
  return text;
}

}  // namespace petzval
