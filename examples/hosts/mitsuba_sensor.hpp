// SPDX-License-Identifier: Apache-2.0
// A petzval camera behind the interface of a sensor of Mitsuba 3 (include/mitsuba/render/sensor.h), in its scalar
// variants: include it after Mitsuba's headers.
#pragma once

#include <petzval/petzval.hpp>
#include <utility>

namespace hosts {

/// Mitsuba's camera space has its origin on the axis in the film, x to the left, y up, z into the scene, in metres.
/// Types: Mitsuba's Float, Point2f, Point3f, Vector3f, Ray3f and Transform4f.
template <class Types>
class MitsubaSensor {
 public:
  using Float = typename Types::Float;
  using Point2f = typename Types::Point2f;
  using Point3f = typename Types::Point3f;
  using Vector3f = typename Types::Vector3f;
  using Ray3f = typename Types::Ray3f;

  MitsubaSensor(petzval::Camera camera, typename Types::Transform4f to_world)
      : camera_(std::move(camera)),
        frame_(petzval::Host::mitsuba, camera_.lens(), petzval::FrameOrigin::film),
        to_world_(std::move(to_world)) {}

  /// Samples a ray at the primary wavelength of the lens. The weight of a lost ray is 0.
  ///
  /// @param time             fraction of the exposure time, 0 to 1
  /// @param position_sample  position in the picture from (0, 0), upper left, to (1, 1), lower right
  std::pair<Ray3f, Float> sample_ray(Float time, Float /* wavelength_sample */, const Point2f& position_sample,
                                     const Point2f& aperture_sample) const {
    const petzval::Film& film = camera_.film();
    const petzval::CameraRay r =
        camera_.sample({.film = film.point(position_sample.x() * film.columns, position_sample.y() * film.rows),
                        .pupil_u = aperture_sample.x(),
                        .pupil_v = aperture_sample.y(),
                        .time = double{time}});
    const petzval::Ray<double> ray = frame_.to_host(r.ray);
    const auto number = [](double value) { return static_cast<Float>(value); };
    const Point3f origin(number(ray.origin.x), number(ray.origin.y), number(ray.origin.z));
    const Vector3f direction(number(ray.direction.x), number(ray.direction.y), number(ray.direction.z));
    return {Ray3f(to_world_ * origin, to_world_ * direction, time), number(r.weight)};
  }

 private:
  petzval::Camera camera_;
  petzval::HostFrame frame_;
  typename Types::Transform4f to_world_;
};

}  // namespace hosts
