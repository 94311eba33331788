// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "camera/exact_model.hpp"
#include "error_lines.hpp"
#include "petzval/analysis/choose_model.hpp"
#include "petzval/core/film.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace petzval::analysis_detail {

/// The pupils of a model: the positions of its samples, the samples that pass, and the lines that pass.
struct ModelPupils {
  FilmPupilTable map;
  Tracing within, tracing;
  bool point = false;           ///< a pinhole has no area
  std::optional<FilmPoint> of;  ///< if set, the samples of this film point are used for all film points
};
/// The model must outlive the result.
ModelPupils pupils_of(const RayModel& model);

/// Errors of pupils and exposures relative to a lens whose pupils are traced once. Areas and integrals are means over
/// uniform samples of a pupil times its area, so that the relative accuracy does not depend on the size of a pupil.
class PupilStudy {
 public:
  /// Uses its own film points. The exact model must outlive the study.
  PupilStudy(const camera_detail::ExactModel<double>& exact, const Film& film, std::size_t film_points,
             const ErrorSamples& samples);

  /// Largest errors over film points and wavelengths, with bounds for the other film points and samples: a sampled
  /// fraction p has a standard deviation of at most sqrt(p / samples), and the pupils of adjacent film points differ
  /// little.
  struct Measurement {
    double shape = 0, exposure = 0, shape_bound = 0, exposure_bound = 0;
  };
  Measurement measure(const ModelPupils& model) const;

 private:
  /// The exact pupil of a film point at a wavelength.
  struct Point {
    std::size_t index = 0;
    FilmPoint film;
    double area = 0, irradiance = 0;  ///< transmitted part of the pupil; without the factor n'^2
    std::vector<std::array<bool, lines_per_point>> passes{};
  };
  struct Errors {
    double shape = 0, exposure = 0;
  };
  Errors errors_of(const Point& point, const ModelPupils& model, std::size_t wavelength) const;
  double weight(const PointLines& lines, std::size_t line) const noexcept;

  const ErrorSamples samples_;
  const ModelPupils exact_;
  const double depth_;
  std::vector<std::size_t> wavelengths_;
  std::vector<std::vector<Point>> points_;  // [wavelength of the samples], lit points
};

}  // namespace petzval::analysis_detail
