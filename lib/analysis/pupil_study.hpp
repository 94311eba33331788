// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "camera/exact_model.hpp"
#include "error_lines.hpp"
#include "petzval/analysis/model_error.hpp"
#include "petzval/core/film.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"

namespace petzval::analysis_detail {

/// The pupils of a model: where its samples lie, which of these pass, and which lines in general.
struct ModelPupils {
  FilmPupilTable map;
  Tracing within, tracing;
  bool point = false;           ///< a pinhole has no area
  std::optional<FilmPoint> of;  ///< the samples are those of this film point, for all
};
/// The model must outlive the result.
ModelPupils pupils_of(const AnyRayModel& model);

/// Errors of pupils and exposures, compared with a lens whose pupils are traced once. All areas and integrals are means
/// over uniform samples of a pupil times its area, so nothing depends on how large a pupil is.
class PupilStudy {
 public:
  /// film_points are its own; the exact model must outlive the study.
  PupilStudy(const camera_detail::ExactModel<double>& exact, const Film& film, std::size_t film_points,
             const ErrorSamples& samples);

  /// Largest over film points and wavelengths. Other samples stay below the bounds: samples of a fraction p scatter by
  /// no more than sqrt(p / samples), and film points in between differ little.
  struct Found {
    double shape = 0, exposure = 0, shape_bound = 0, exposure_bound = 0;
  };
  Found measure(const ModelPupils& model) const;

 private:
  /// A film point's exact pupil at a wavelength.
  struct Point {
    std::size_t place = 0;
    FilmPoint film;
    double area = 0, irradiance = 0;  ///< of what passes; n'^2 left out
    std::vector<std::array<bool, lines_per_point>> passes{};
  };
  struct Errors {
    double shape = 0, exposure = 0;
  };
  Errors errors_of(const Point& point, const ModelPupils& model, std::size_t wavelength) const;
  double weight(const PointLines& lines, std::size_t line) const noexcept;

  const ErrorSamples samples_;
  const AnyRayModel any_;
  const ModelPupils exact_;
  const double depth_;
  std::vector<std::size_t> wavelengths_;
  std::vector<std::vector<Point>> points_;  // [wavelength of the samples], those with light
};

}  // namespace petzval::analysis_detail
