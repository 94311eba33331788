// SPDX-License-Identifier: Apache-2.0
#include "focal_surface_setup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "camera_setup.hpp"
#include "json_input.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "text.hpp"

namespace examples {
namespace {

using petzval::Vec3;

constexpr std::array kinds{petzval::SurfaceKind::affine, petzval::SurfaceKind::shepard};
constexpr Range weight_range{0, std::numeric_limits<double>::max(), "a finite number, 0 or more"};
constexpr Range fraction_range{0, 1, "a number from 0 to 1"};

std::vector<petzval::FocalPoint> points_of(const Json& list, const std::string& file, const petzval::Camera& camera,
                                           petzval::DistanceOrigin origin, const WorldToLens& to_lens) {
  if (list.empty()) refuse(file + ": points", list, "a list of one point or more");
  const double entrance_z = petzval::pupils(camera.lens()).entrance.z,
               counted_from = petzval::origin_z(camera.lens(), origin);
  std::vector<petzval::FocalPoint> result;
  for (const Json& json : list) {
    const JsonEntry entry{file + ": point " + std::to_string(result.size() + 1), json};
    entry.keys({"pixel", "world_mm", "position_mm", "distance_mm", "extent_stops", "blur_px", "weight", "fade"});
    const auto pixel = entry.numbers<2>("pixel", "two finite numbers, [x, y]");
    const char* world_key = entry.has("position_mm") ? "position_mm" : "world_mm";
    const auto world = entry.numbers<3>(world_key, "three finite numbers, [x, y, z]");
    if (pixel.has_value() == world.has_value()) {
      throw petzval::Error(entry.where + ": has " + (pixel ? "both of" : "neither of") +
                           " pixel and world_mm; must have one of them");
    }
    petzval::FocalPoint point;
    if (pixel) {
      point.film_point = camera.film().point((*pixel)[0], (*pixel)[1]);
    } else {
      const Vec3<double> position = to_lens({(*world)[0], (*world)[1], (*world)[2]});
      const petzval::Projection seen = camera.project(position);
      if (seen.status == petzval::ProjectionStatus::not_visible) {
        entry.refuse(world_key, "a point that the camera images on or outside its film");
      }
      point.film_point = seen.film;
      point.inverse_distance = 1 / (entrance_z - position.z);
    }
    if (entry.has("distance_mm") && json["distance_mm"].is_null()) {
      point.inverse_distance = 0;
    } else if (const auto distance = entry.number("distance_mm", positive_number)) {
      const double from_pupil = *distance + entrance_z - counted_from;
      if (!(from_pupil > 0)) {
        entry.refuse("distance_mm",
                     "more than " + number(counted_from - entrance_z) + ", the distance of the entrance pupil");
      }
      point.inverse_distance = 1 / from_pupil;
    }
    point.extent_stops = entry.number("extent_stops", {-20, 20, "a number from -20 to 20"});
    if (!point.inverse_distance && !point.extent_stops) {
      throw petzval::Error(entry.where + ": has neither distance_mm nor extent_stops; must have one of them");
    }
    if (const auto blur = entry.number("blur_px", finite_number)) {
      if (!point.inverse_distance) entry.refuse("blur_px", "left out if distance_mm is not given");
      point.blur_mm = *blur * camera.film().pixel_mm();
    }
    point.weight = entry.number("weight", weight_range).value_or(1);
    point.fade = entry.number("fade", fraction_range).value_or(1);
    result.push_back(point);
  }
  return result;
}

}  // namespace

void add_surface_kind(App& app, petzval::CameraSetup& setup, Option* points) {
  petzval::FocalSurfaceOptions& options = setup.focal_surface;
  add_choice(app, "--kind", options.kind, kinds,
             "interpolation of distances between points: affine (by planes, which are reproduced) or shepard "
             "(weighted means, flat at the points)",
             names(kinds));
  add_number(app, "--beta", options.beta, {1, 8, "a number from 1 to 8"},
             "exponent of the weights: a point's weight is its distance in the picture to the power -beta");
  app.add_check([&app, &setup, points] {
    if (points->given() || !setup.focal_points.empty()) return;
    for (const char* flag : {"--kind", "--beta"}) {
      if (app.given(flag)) throw petzval::Error(std::string(flag) + " needs --points");
    }
  });
}

petzval::FocalSurface read_focal_surface(const std::string& file, petzval::CameraSetup& setup,
                                         const petzval::Camera& camera, const WorldToLens& to_lens) {
  return focal_surface_through(examples::points_of(file, read_json(file)), file, setup, camera, to_lens);
}

petzval::FocalSurface focal_surface_through(const Json& list, const std::string& file, petzval::CameraSetup& setup,
                                            const petzval::Camera& camera, const WorldToLens& to_lens) {
  const petzval::Lens& lens = camera.lens();
  setup.focal_points = points_of(list, file, camera, setup.focus.origin, to_lens);
  setup.focal_surface.default_inverse_distance =
      1 / (*setup.focus_mm + petzval::pupils(lens).entrance.z - petzval::origin_z(lens, setup.focus.origin));
  try {
    return {petzval::thick_lens(lens), camera.film(), setup.focal_points, setup.focal_surface};
  } catch (const petzval::Error& error) {
    throw petzval::Error(file + ": " + error.what());
  }
}

}  // namespace examples
