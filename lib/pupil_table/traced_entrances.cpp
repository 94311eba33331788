// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <glm/geometric.hpp>
#include <vector>

#include "pupil_table/entrance_pupil_table.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval {
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
