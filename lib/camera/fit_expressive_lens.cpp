// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "check_film.hpp"
#include "core/meet_plane.hpp"
#include "local_focus.hpp"
#include "paraxial_model.hpp"
#include "petzval/camera/bokeh.hpp"
#include "petzval/core/error.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil/pupil_nodes.hpp"

namespace petzval {
namespace {

/// Focus of the exact rays from a film point, as the change of slope per height in the plane z: a least-squares fit
/// weighted by irradiance over the pupil. nullopt if no ray passes.
std::optional<double> in_focus(const Lens& lens, const FilmPoint& film, double z) {
  const PupilBoundary boundary = exit_pupil_boundary(lens, film, lens.primary_wavelength());
  double light = 0;
  Vec2<double> height{0, 0}, slope{0, 0};
  double across = 0, along = 0;
  pupil_detail::for_each_node<32>(boundary, [&](const Vec2<double>& p, double area, double weight) {
    const Ray<double> start = boundary.plane.ray(p.x, p.y);
    const auto end = trace(lens, start, {.travel = Travel::to_scene});
    if (!end.transmitted()) return;
    const auto line = core_detail::slope_ray(end.ray, z);
    const double contribution = area * weight * std::pow(start.direction.z, 4);
    light += contribution;
    height += Vec2<double>{line.x, line.y} * contribution,
        slope += Vec2<double>{line.slope_x, line.slope_y} * contribution;
    across += contribution * (line.x * line.x + line.y * line.y);
    along += contribution * (line.x * line.slope_x + line.y * line.slope_y);
  });
  if (!(light > 0)) return {};
  height /= light, slope /= light;
  const double focus = (along / light - glm::dot(height, slope)) / (across / light - glm::dot(height, height));
  return std::isfinite(focus) ? std::optional(focus) : std::nullopt;
}

/// Largest radius, up to `radius`, at which rays reach the film.
double lit_radius(const Lens& lens, double radius, double z) {
  if (in_focus(lens, {0, radius}, z)) return radius;
  double lit = 0, dark = radius;
  constexpr int halvings = 8;
  for (int i = 0; i < halvings; ++i) {
    const double middle = (lit + dark) / 2;
    (in_focus(lens, {0, middle}, z) ? lit : dark) = middle;
  }
  return lit;
}

}  // namespace

ExpressiveLens fit_expressive_lens(const Lens& given, const Film& given_film) {
  using camera_detail::EntranceMaps;
  const auto [lens, film] = camera_detail::placed(given, given_film);
  camera_detail::check_film(lens, film);
  if (camera_detail::has_cylinders(lens)) {
    throw Error(lens.name() + ": fit_expressive_lens: the lens has cylinders; must be a lens of revolution");
  }
  const camera_detail::LensFacts facts(lens);
  const camera_detail::ParaxialModel model(ModelKind::thick, facts, film.radius_mm());
  const std::size_t primary = lens.primary_wavelength();
  const auto [middle, radius] = camera_detail::iris_images(ModelKind::thick, facts).images[primary];
  const EntranceMaps<double> maps =
      camera_detail::entrance_maps(model.maps()[primary].y, model.z(), middle.y, radius.y);
  const TwoPlanes& space = model.pupils().space();
  const double own = maps.d / maps.b, focal_length = facts.first_order(primary).effective_focal_length;

  ExpressiveLens found;
  constexpr int knots = 12;
  for (int i = 0; i <= knots; ++i) {
    const double fraction = i == 0 ? 1e-3 : static_cast<double>(i) / knots, height_on_film = fraction * radius.y;
    const Vec3<double> along{0, height_on_film, space.depth()};
    const Ray<double> start{{0, height_on_film, space.pupil_z},
                            along * (towards_scene(lens, space) / glm::length(along))};
    const auto end = trace(lens, start, {.travel = Travel::to_scene, .apertures = false});
    if (!end.transmitted()) break;
    // The exact ray defines the power: in the plane of focus, the model's ray must have the same distance from the
    // axis.
    const auto line = core_detail::slope_ray(end.ray, maps.z);
    const double added_power = (line.slope_y - own * line.y) / (maps.b * height_on_film);
    found.power.push_back({i == 0 ? 0 : fraction, 1 + added_power * focal_length});
  }

  // Film points on rings about the axis, out to the farthest corner, with more points in outer rings.
  const auto centre = in_focus(lens, {}, maps.z);
  constexpr int rings = 4, first_ring = 6;
  const double reach = centre ? lit_radius(lens, film.radius_mm(), maps.z) : 0;
  for (int ring = 0; ring <= rings && centre; ++ring) {
    const double height = reach * ring / rings;
    const auto focus = in_focus(lens, {0, height}, maps.z);
    if (!focus) break;
    // Inverse of in_focus(maps, nearer).
    const double asked = own + *focus - *centre, excess = (maps.b * asked - maps.d) / (maps.a * asked - maps.c);
    const double relative_offset = 1 / (1 + excess) - 1, offset = relative_offset * -space.depth();
    constexpr double max_relative_offset = 0.2;
    if (!(std::abs(relative_offset) <= max_relative_offset)) break;
    const int azimuths = ring == 0 ? 1 : first_ring * ring;
    for (int k = 0; k < azimuths; ++k) {
      const double azimuth = 2 * std::numbers::pi * k / azimuths;
      found.film_offsets.push_back({{height * std::sin(azimuth), height * std::cos(azimuth)}, offset});
    }
  }
  return found;
}

}  // namespace petzval
