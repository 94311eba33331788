// SPDX-License-Identifier: Apache-2.0
// A complete renderer in one page: three round lamps of equal angular size at 0.7 m, 1 m and 5 m, seen through a lens
// that is focused at 1 m.
//
//   hello_camera
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <petzval/petzval.hpp>

namespace {

using namespace petzval;

constexpr int samples = 256;

/// Four numbers in [0, 1): a point of a Kronecker sequence, uniform in four dimensions.
std::array<double, 4> next_sample() {
  static std::array<double, 4> sample{};
  constexpr std::array<double, 4> steps{0.8566748838545029, 0.7338918566271259, 0.6287067210378087, 0.5385972572236101};
  for (std::size_t i = 0; i < 4; ++i) sample[i] = std::fmod(sample[i] + steps[i], 1.0);
  return sample;
}

/// The scene of the renderer: white discs on black.
double radiance(const Ray<double>& ray) {
  for (const auto& [x, z] : {std::array{-50.0, -552.0}, {0.0, -852.0}, {450.0, -4852.0}}) {
    const Vec3<double> hit = ray.origin + (z - ray.origin.z) / ray.direction.z * ray.direction;
    if (std::hypot(hit.x - x, hit.y) < 0.02 * std::abs(z)) return 1;
  }
  return 0;
}

}  // namespace

int main() {
  Lens lens = compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f2.0.json"));
  lens = with_focus(with_f_number(lens, 2.8), 1000, {.origin = DistanceOrigin::film});  // mm
  const Camera camera(lens, {.width_mm = 36, .height_mm = 6, .columns = 72, .rows = 6});
  double picture[6][72]{};
  for (int i = 0; i < 6 * 72 * samples; ++i) {
    const int row = i / samples / 72, column = i / samples % 72;
    const auto [x, y, u, v] = next_sample();
    const FilmPoint point = camera.film().point(column + x, row + y);
    const CameraRay r = camera.sample({.film = point, .pupil_u = u, .pupil_v = v});
    if (r) picture[row][column] += r.weight * radiance(r.ray) / samples;  // a lost ray has its reason in r.fate
  }

  const double white = *std::max_element(picture[0], picture[0] + 6 * 72);
  for (const auto& row : picture) {
    for (const double pixel : row) std::cout << " .:-=+*#%@"[static_cast<int>(9.99 * pixel / white)];
    std::cout << '\n';
  }
}
