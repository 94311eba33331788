// SPDX-License-Identifier: Apache-2.0
// A petzval camera behind the interface of a camera of pbrt-v4 (src/pbrt/cameras.h): include it after pbrt's headers.
#pragma once

#include <optional>
#include <petzval/petzval.hpp>
#include <utility>

namespace hosts {

/// pbrt's camera space has its origin on the axis in the film, x to the right, y up, z into the scene, in metres.
class PbrtCamera {
 public:
  PbrtCamera(petzval::Camera camera, pbrt::CameraTransform transform, pbrt::Float shutter_open,
             pbrt::Float shutter_close)
      : camera_(std::move(camera)),
        frame_(petzval::Host::pbrt, camera_.lens(), petzval::FrameOrigin::film),
        transform_(std::move(transform)),
        open_(shutter_open),
        close_(shutter_close) {}

  /// pFilm is a raster position; it may lie outside the picture if Film::margin_mm is wide enough for the pixel filter.
  std::optional<pbrt::CameraRay> GenerateRay(const pbrt::CameraSample& sample) const {
    const petzval::CameraRay r = camera_.sample(of(sample));
    if (!r) return {};
    return pbrt::CameraRay{transform_.RenderFromCamera(to_pbrt(r.ray, sample)),
                           pbrt::SampledSpectrum(static_cast<pbrt::Float>(r.weight))};
  }

  /// The ray with the rays of the adjacent pixels to the right and below.
  std::optional<pbrt::CameraRayDifferential> GenerateRayDifferential(const pbrt::CameraSample& sample) const {
    const petzval::CameraRayDifferential d = camera_.sample_differential(of(sample));
    if (!d.sample) return {};
    const auto [by_x, by_y] = petzval::by_raster(d, camera_.film());
    const auto adjacent_ray = [&](const petzval::Ray<double>& by) {
      return to_pbrt({d.sample.ray.origin + by.origin, d.sample.ray.direction + by.direction}, sample);
    };
    const pbrt::Ray right = adjacent_ray(by_x), below = adjacent_ray(by_y);
    pbrt::RayDifferential ray(to_pbrt(d.sample.ray, sample));
    ray.hasDifferentials = true;
    ray.rxOrigin = right.o, ray.rxDirection = right.d;
    ray.ryOrigin = below.o, ray.ryDirection = below.d;
    return pbrt::CameraRayDifferential{transform_.RenderFromCamera(ray),
                                       pbrt::SampledSpectrum(static_cast<pbrt::Float>(d.sample.weight))};
  }

 private:
  petzval::CameraSample of(const pbrt::CameraSample& sample) const {
    return {.film = camera_.film().point(sample.pFilm.x, sample.pFilm.y),
            .pupil_u = sample.pLens.x,
            .pupil_v = sample.pLens.y,
            .time = sample.time};
  }

  pbrt::Ray to_pbrt(const petzval::Ray<double>& lens_ray, const pbrt::CameraSample& sample) const {
    const petzval::Ray<double> ray = frame_.to_host(lens_ray);
    const auto number = [](double value) { return static_cast<pbrt::Float>(value); };
    return pbrt::Ray(pbrt::Point3f(number(ray.origin.x), number(ray.origin.y), number(ray.origin.z)),
                     pbrt::Vector3f(number(ray.direction.x), number(ray.direction.y), number(ray.direction.z)),
                     open_ + sample.time * (close_ - open_));
  }

  petzval::Camera camera_;
  petzval::HostFrame frame_;
  pbrt::CameraTransform transform_;
  pbrt::Float open_, close_;
};

}  // namespace hosts
