// SPDX-License-Identifier: Apache-2.0
#include "renderer/sky_light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <glm/glm.hpp>

#include "petzval/core/error.hpp"
#include "renderer/luminance.hpp"

namespace renderer {

using std::numbers::pi;

SkyLight::SkyLight(const Sky& sky) : sky_(sky) {
  if (sky.image) {
    if (sky.image->width < 1 || sky.image->height < 1) throw petzval::Error("sky: image has no pixels");
    columns_ = static_cast<std::size_t>(sky.image->width), rows_ = static_cast<std::size_t>(sky.image->height);
  }
  ends_.reserve(columns_ * rows_);
  for (std::size_t row = 0; row < rows_; ++row) {
    const double solid_angle = 2 * pi / static_cast<double>(columns_) * (sine_above(row) - sine_above(row + 1));
    for (std::size_t column = 0; column < columns_; ++column) {
      const float* const pixel =
          sky.image ? sky.image->pixel(static_cast<int>(column), static_cast<int>(row)) : &sky.colour[0];
      for (int c = 0; c < 3; ++c) {
        if (!(std::isfinite(pixel[c]) && pixel[c] >= 0)) {
          throw petzval::Error("sky: radiance = " + std::to_string(pixel[c]) + " at pixel (" + std::to_string(column) +
                               ", " + std::to_string(row) + "); must be 0 or more");
        }
      }
      const Rgb colour = sky.image ? sky.colour * Rgb(pixel[0], pixel[1], pixel[2]) : sky.colour;
      ends_.push_back(total_ += luminance(colour) * solid_angle);
    }
  }
}

double SkyLight::sine_above(std::size_t row) const noexcept {
  return std::cos(pi * static_cast<double>(row) / static_cast<double>(rows_));
}

std::size_t SkyLight::pixel_of(const glm::vec3& travel) const noexcept {
  const glm::dvec3 to = -glm::dvec3(travel);
  const double across = 0.5 + std::atan2(to.x, -to.z) / (2 * pi);
  const double down = std::acos(std::clamp(to.y, -1.0, 1.0)) / pi;
  const auto cell_index = [](double fraction, std::size_t count) {
    return std::min(static_cast<std::size_t>(std::max(fraction, 0.0) * static_cast<double>(count)), count - 1);
  };
  return cell_index(down, rows_) * columns_ + cell_index(across, columns_);
}

Rgb SkyLight::radiance(const glm::vec3& travel) const noexcept {
  if (!sky_.image) return sky_.colour;
  const float* const pixel = &sky_.image->pixels[3 * pixel_of(travel)];
  return sky_.colour * Rgb(pixel[0], pixel[1], pixel[2]);
}

glm::vec3 SkyLight::sample(float u, float v) const noexcept {
  const double drawn = std::min(static_cast<double>(u), 1 - 1e-9) * total_;
  const auto pixel = static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end() - 1, drawn) - ends_.begin());
  const double begin = pixel > 0 ? ends_[pixel - 1] : 0, fraction = ends_[pixel] - begin;
  const double across = (static_cast<double>(pixel % columns_) + (fraction > 0 ? (drawn - begin) / fraction : 0.5)) /
                        static_cast<double>(columns_);
  const std::size_t row = pixel / columns_;
  const double sine = sine_above(row) + double{v} * (sine_above(row + 1) - sine_above(row));
  const double azimuth = 2 * pi * (across - 0.5), radius = std::sqrt(std::max(0.0, 1 - sine * sine));
  return -glm::vec3(radius * std::sin(azimuth), sine, -radius * std::cos(azimuth));
}

double SkyLight::pdf(const glm::vec3& travel) const noexcept {
  if (!(total_ > 0)) return 0;
  const std::size_t pixel = pixel_of(travel), row = pixel / columns_;
  const double solid_angle = 2 * pi / static_cast<double>(columns_) * (sine_above(row) - sine_above(row + 1));
  return (ends_[pixel] - (pixel > 0 ? ends_[pixel - 1] : 0)) / total_ / solid_angle;
}

}  // namespace renderer
