// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "core/bisect.hpp"
#include "core/low_discrepancy.hpp"
#include "petzval/core/parallel.hpp"
#include "pupil_table/entrance_pupil_table.hpp"

namespace petzval {
namespace {

struct FilmSamples {
  std::vector<double> film_x, film_y, pupil_x, pupil_y;
};

FilmSamples film_samples(const FilmPupilTable& pupils, bool equal_azimuths, std::size_t wavelength) {
  constexpr int radii = 32, samples_around = 16, azimuths = 128;
  // Radius of the lit film for each azimuth.
  const auto lit_at = [&](double turn) {
    const auto seen = [&](double radius) {
      return pupils.area({radius * std::sin(turn), radius * std::cos(turn)}, wavelength) > 0;
    };
    const double dark = pupils.film_radius();
    if (seen(dark)) return dark;
    double last = 0;
    for (int i = 1; i <= radii && seen(dark * i / radii); ++i) last = dark * i / radii;
    return core_detail::last_with(last, std::min(last + dark / radii, dark), seen);
  };
  std::vector<double> lit{lit_at(0)};
  for (int k = 1; k <= azimuths && !equal_azimuths; ++k) lit.push_back(lit_at(2 * std::numbers::pi * k / azimuths));
  FilmSamples samples;
  const auto add = [&](double radius, double turn, double u, double v) {
    const FilmPoint film{radius * std::sin(turn), radius * std::cos(turn)};
    const PupilSample s = pupils.sample(film, u, v, wavelength);
    if (!(s.area > 0)) return;
    samples.film_x.push_back(film.x), samples.film_y.push_back(film.y);
    samples.pupil_x.push_back(s.x), samples.pupil_y.push_back(s.y);
  };
  const core_detail::Kronecker<3> points;
  std::size_t index = 0;
  for (int i = 0; i <= radii; ++i) {
    // Denser near the largest lit radius.
    const double fraction = 1 - std::pow(1 - static_cast<double>(i) / radii, 1.5);
    if (equal_azimuths) {
      // Pupils are symmetric. Each radius has other sectors, and the rays of the smallest v pass a central obscuration.
      const double shift = points(static_cast<std::size_t>(i))[0] - 0.5;
      for (int k = 0; k <= samples_around / 2; ++k) {
        const double u = std::clamp((k + shift) / samples_around, 0.0, 0.5);
        for (const double v : {0.0005, 0.85, 0.95, 0.99}) add(fraction * lit[0], 0, u, v);
      }
      continue;
    }
    // The pupil may be the union over many film points, of which a single point uses a small part: sample all of it,
    // and its edge more densely.
    for (int k = 0; k < 32 * samples_around; ++k, ++index) {
      const auto [turn, u, v] = points(index);
      const double azimuth = turn * azimuths;
      const auto before = static_cast<std::size_t>(azimuth);
      const double radius = lit[before] + (azimuth - static_cast<double>(before)) * (lit[before + 1] - lit[before]);
      add(fraction * radius, 2 * std::numbers::pi * turn, u, k % 2 ? v : 1 - 0.1 * v);
    }
  }
  return samples;
}

}  // namespace

std::vector<std::vector<Ray<double>>> leaving_rays(const FilmPupilTable& pupils, bool equal_azimuths,
                                                   const TwoPlaneRaysToScene& to_scene, int threads) {
  std::vector<std::vector<Ray<double>>> result(pupils.wavelengths());
  parallel_for(result.size(), 1, threads, [&](std::size_t w, std::size_t) {
    const auto [film_x, film_y, pupil_x, pupil_y] = film_samples(pupils, equal_azimuths, w);
    const std::size_t count = film_x.size();
    std::array<std::vector<double>, 6> ray;
    for (auto& values : ray) values.resize(count);
    std::vector<RayFate> fates(count);
    to_scene(count, {film_x.data(), film_y.data(), pupil_x.data(), pupil_y.data()}, w,
             {ray[0].data(), ray[1].data(), ray[2].data(), ray[3].data(), ray[4].data(), ray[5].data()}, fates.data());
    for (std::size_t i = 0; i < count; ++i) {
      if (fates[i] != RayFate::transmitted) continue;
      result[w].push_back({{ray[0][i], ray[1][i], ray[2][i]}, {ray[3][i], ray[4][i], ray[5][i]}});
    }
  });
  return result;
}

ScenePassing traced_passing(const Lens& lens) {
  return [&lens](std::size_t count, const RayArrays<const double>& rays, std::size_t wavelength, std::uint8_t* passes) {
    std::array<std::vector<double>, 6> ray;
    for (auto& values : ray) values.resize(count);
    std::vector<RayFate> fates(count);
    trace<double>(lens, count, rays,
                  {ray[0].data(), ray[1].data(), ray[2].data(), ray[3].data(), ray[4].data(), ray[5].data()},
                  fates.data(), nullptr, {.wavelengths = {wavelength}});
    for (std::size_t i = 0; i < count; ++i) passes[i] = fates[i] == RayFate::transmitted;
  };
}

EntrancePupilTable traced_entrances(const Lens& bladed, const FilmPupilTable& of_iris, int threads) {
  const Lens lens = with_iris(bladed, {});  // the pupils of a round iris enclose the pupils of any iris
  const FilmPupilTable pupils = of_iris.with_round_stop();
  const TwoPlanes& space = pupils.space();
  const double towards = towards_scene(lens, space);
  const auto to_scene = [&](std::size_t count, const TwoPlaneRays<const double>& lines, std::size_t wavelength,
                            const RayArrays<double>& rays, RayFate* fates) {
    const auto [x, y, z, dx, dy, dz] = rays;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3<double> line{lines.pupil_x[i] - lines.film_x[i], lines.pupil_y[i] - lines.film_y[i], space.depth()};
      const Vec3<double> d = glm::normalize(line) * towards;
      x[i] = lines.pupil_x[i], y[i] = lines.pupil_y[i], z[i] = space.pupil_z;
      dx[i] = d.x, dy[i] = d.y, dz[i] = d.z;
    }
    trace<double>(lens, count, {x, y, z, dx, dy, dz}, rays, fates, nullptr,
                  {.travel = Travel::to_scene, .wavelengths = {wavelength}});
  };
  return EntrancePupilTable(lens, leaving_rays(pupils, lens.rotationally_symmetric(), to_scene, threads),
                            traced_passing(lens), threads);
}

}  // namespace petzval
