// SPDX-License-Identifier: Apache-2.0
#include "renderer/lens_camera.hpp"

#include <array>
#include <cmath>

#include <glm/glm.hpp>

#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace renderer {

using petzval::Vec3;

LensCamera::LensCamera(petzval::Camera camera, const Pose& pose) : camera_(std::move(camera)) {
  const glm::dvec3 ahead = pose.look_at - pose.position, right = glm::cross(ahead, pose.up);
  const double length = glm::length(ahead), across = glm::length(right);
  if (!(std::isfinite(length) && std::isfinite(across) && across > 1e-9 * length * glm::length(pose.up))) {
    throw petzval::Error("camera: position_mm and look_at_mm must differ, and up must not be parallel to the view");
  }
  const glm::dvec3 z = -ahead / length, x = right / across;
  turn_ = {x, glm::cross(z, x), z};
  const double pupil_z = petzval::pupils(camera_.lens()).entrance.z;
  origin_ = pose.position - z * (std::isfinite(pupil_z) ? pupil_z : 0.0);
}

Vec3<double> LensCamera::turn_to_lens(const glm::vec3& direction) const noexcept {
  // In double: the rounding of a float direction, although far below petzval::unit_direction_tolerance, moves the ray.
  return glm::normalize(glm::dvec3(direction) * turn_);
}
Vec3<double> LensCamera::to_lens(const glm::vec3& point) const noexcept {
  return (glm::dvec3(point) - origin_) * turn_;
}
glm::vec3 LensCamera::turn_to_world(const Vec3<double>& direction) const noexcept {
  return turn_ * glm::dvec3(direction);
}
glm::vec3 LensCamera::to_world(const Vec3<double>& point) const noexcept { return origin_ + turn_ * glm::dvec3(point); }

double LensCamera::depth(const glm::vec3& point) const noexcept { return -to_lens(point).z; }

void LensCamera::Batch::resize(std::size_t count, bool with_nm) {
  for (auto* column : {&raster_x, &raster_y, &u, &v, &weights, &x_, &y_}) column->resize(count);
  for (auto& column : lens_) column.resize(count);
  nm.resize(with_nm ? count : 0);
  rays.resize(count);
}

void LensCamera::sample(Batch& batch) const noexcept {
  auto& [x, y, z, dx, dy, dz] = batch.lens_;
  film().points(batch.size(), batch.raster_x.data(), batch.raster_y.data(), batch.x_.data(), batch.y_.data());
  petzval::RayWavelengths wavelengths;
  if (!batch.nm.empty()) wavelengths.each_nm = batch.nm.data();
  camera_.sample<float>(batch.size(), {batch.x_.data(), batch.y_.data(), batch.u.data(), batch.v.data(), wavelengths},
                        {{x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()},
                         batch.weights.data(),
                         nullptr,
                         nullptr,
                         nullptr});
  for (std::size_t i = 0; i < batch.size(); ++i) {
    batch.rays[i] = {to_world({x[i], y[i], z[i]}), turn_to_world({dx[i], dy[i], dz[i]})};
  }
}

void LensCamera::importance(const Batch& batch, std::span<const float> nm, std::span<petzval::Importance> found) const {
  std::array<std::vector<double>, 6> columns;
  for (std::size_t c = 0; c < 6; ++c) columns[c].assign(batch.lens_[c].begin(), batch.lens_[c].end());
  auto& [x, y, z, dx, dy, dz] = columns;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const double length = -std::sqrt(dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]);
    dx[i] /= length, dy[i] /= length, dz[i] /= length;
  }
  petzval::RayWavelengths wavelengths;
  if (!nm.empty()) wavelengths.each_nm = nm.data();
  camera_.importance(batch.size(), {x.data(), y.data(), z.data(), dx.data(), dy.data(), dz.data()}, wavelengths,
                     found.data());
}

petzval::Importance LensCamera::importance(const glm::vec3& point, const glm::vec3& direction,
                                           petzval::Wavelength wavelength) const noexcept {
  return camera_.importance({to_lens(point), turn_to_lens(direction)}, wavelength);
}

LensCamera::Connection LensCamera::connection(const petzval::ImportanceSample& sample) const noexcept {
  return {turn_to_world(sample.direction), to_world(sample.on_front), sample.pdf, sample.importance};
}

LensCamera::Connection LensCamera::connect(const glm::vec3& point, float u, float v,
                                           petzval::Wavelength wavelength) const noexcept {
  return connection(camera_.sample_importance(to_lens(point), u, v, wavelength));
}

std::vector<LensCamera::Connection> LensCamera::connect(std::span<const Request> requests,
                                                        std::span<const float> nm) const {
  std::vector<Vec3<double>> points;
  std::vector<double> u, v;
  for (const Request& request : requests) {
    points.push_back(to_lens(request.point));
    u.push_back(static_cast<double>(request.u)), v.push_back(static_cast<double>(request.v));
  }
  petzval::RayWavelengths wavelengths;
  if (!nm.empty()) wavelengths.each_nm = nm.data();
  std::vector<petzval::ImportanceSample> samples(requests.size());
  camera_.sample_importance(requests.size(), points.data(), u.data(), v.data(), wavelengths, samples.data());
  std::vector<Connection> result;
  result.reserve(samples.size());
  for (const petzval::ImportanceSample& sample : samples) result.push_back(connection(sample));
  return result;
}

LensCamera::Connection LensCamera::connect_distant(const glm::vec3& travel, float u, float v,
                                                   petzval::Wavelength wavelength) const noexcept {
  return connection(camera_.sample_distant_importance(turn_to_lens(travel), u, v, wavelength));
}

double LensCamera::pdf_connection(const glm::vec3& point, const glm::vec3& direction,
                                  petzval::Wavelength wavelength) const noexcept {
  return camera_.pdf_importance(to_lens(point), turn_to_lens(direction), wavelength);
}

double LensCamera::pdf_distant_connection(const WorldRay& travel, petzval::Wavelength wavelength) const noexcept {
  return camera_.pdf_distant_importance({to_lens(travel.origin), turn_to_lens(travel.direction)}, wavelength);
}

}  // namespace renderer
