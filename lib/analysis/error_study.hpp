// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "camera/exact_model.hpp"
#include "error_lines.hpp"
#include "petzval/analysis/choose_model.hpp"
#include "petzval/core/film.hpp"
#include "scene_view.hpp"

/// Comparison of models with a lens whose rays are traced once for all models.
namespace petzval::analysis_detail {

/// The largest error allowed at a film point and depth: the larger value of a length and a fraction of the local blur.
struct Tolerance {
  double mm = 0, of_blur = 0;
};

/// Ray errors of models.
class RayStudy {
 public:
  /// Throws the errors of model_error(). The exact model must outlive the study.
  RayStudy(const camera_detail::ExactModel<double>& exact, const Film& film, const ErrorSamples& samples,
           std::span<const Tolerance> tolerances = {});

  struct Measurement {
    RayErrors all;
    std::vector<RayErrors> wavelength;
    /// Largest errors of each film point over lines, depths and wavelengths: mm, fractions of the blur, fractions of
    /// each tolerance.
    std::vector<double> mm, of_blur;
    std::vector<std::vector<double>> of_tolerance;
  };
  Measurement measure(const Tracing& model) const;

  /// The largest errors, refined with 16 times as many lines at the film points with the largest errors.
  struct Largest {
    double mm = 0, of_blur = 0;
    std::vector<double> of_tolerance;
  };
  Largest largest(const Measurement& found, const Tracing& model) const;

  /// The same film points, depths and blurs, but only chief rays.
  RayStudy chief_rays() const;

 private:
  struct Point {
    std::size_t index = 0;  ///< index of the film point
    PointLines lines;
    PointRays exact{};
    ChiefRay chief{};
    std::vector<SceneView> views{};  ///< per depth, then for the sharpest depth if sampled
    std::vector<double> blur{};      ///< mm on the film, per view
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
  std::vector<std::vector<Point>> points_;  // [wavelength of the samples], lit points
};

/// The wavelength indices of the samples without duplicates; all if empty. Throws Error if out of range.
std::vector<std::size_t> wavelengths_of(const Lens& lens, const ErrorSamples& samples);

}  // namespace petzval::analysis_detail
