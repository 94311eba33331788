// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "camera/exact_model.hpp"
#include "carry_back.hpp"
#include "error_lines.hpp"
#include "petzval/analysis/model_error.hpp"
#include "petzval/core/film.hpp"

/// Models compared with a lens whose rays are traced once for all of them.
namespace petzval::analysis_detail {

/// The largest error allowed at a film point and depth: a length, or a fraction of the local blur where that is larger.
struct Tolerance {
  double mm = 0, of_blur = 0;
};

/// Errors of rays.
class RayStudy {
 public:
  /// Throws Error as model_error does; the exact model must outlive the study.
  RayStudy(const camera_detail::ExactModel<double>& exact, const Film& film, const ErrorSamples& samples,
           std::span<const Tolerance> tolerances = {});

  struct Found {
    RayErrors all;
    std::vector<RayErrors> wavelength;
    /// Largest of each film point, over lines, depths and wavelengths: mm, fractions of the blur, of each tolerance.
    std::vector<double> mm, of_blur;
    std::vector<std::vector<double>> of_tolerance;
  };
  Found measure(const Tracing& model) const;

  /// The largest of all errors, after a closer look at the film points where the largest were found: 16 times as many
  /// lines.
  struct Largest {
    double mm = 0, of_blur = 0;
    std::vector<double> of_tolerance;
  };
  Largest largest(const Found& found, const Tracing& model) const;

  /// The same film points, depths and blurs, but along chief rays alone.
  RayStudy chief_rays() const;

 private:
  struct Point {
    std::size_t place = 0;  ///< among the film points
    PointLines lines;
    PointRays exact{};
    ChiefRay chief{};
    std::vector<SceneView> views{};  ///< one for each depth, and for the sharpest where it is asked for
    std::vector<double> blur{};      ///< mm on the film, one for each view
  };
  struct Errors;
  void look(Point& point) const;
  Errors errors_of(const Point& point, const Tracing& model, std::size_t wavelength) const;
  std::uint64_t seed_of(const Point& point, std::uint64_t look) const noexcept;

  const camera_detail::ExactModel<double>* exact_;
  Film film_;
  ErrorSamples samples_;
  std::vector<Tolerance> tolerances_;
  std::vector<std::size_t> wavelengths_;
  std::vector<std::vector<Point>> points_;  // [wavelength of the samples], those with light
};

/// Wavelengths that samples name, checked.
std::vector<std::size_t> wavelengths_of(const Lens& lens, const ErrorSamples& samples);

}  // namespace petzval::analysis_detail
