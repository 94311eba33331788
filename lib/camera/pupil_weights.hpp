// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "iris/iris_weights.hpp"
#include "petzval/camera/bokeh_controls.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::camera_detail {

/// The weights of a bokeh (BokehControls): which samples of pupils are drawn, and what each counts.
///
/// Immutable, cheap to copy, shared freely between threads.
class PupilWeights {
 public:
  /// No weights.
  PupilWeights() = default;
  /// Of a model of the lens. Throws Error for a weight map with weights that are not finite or negative, of a size that
  /// does not fit them, of more than 2^26 pixels or black, and for an edge out of range.
  PupilWeights(const Lens& lens, const AnyRayModel& model, const BokehControls& controls);

  /// The pupils to sample instead of the pupils of the model; nullopt if there are no weights.
  PETZVAL_API std::optional<FilmPupilTable> pupils() const;
  explicit operator bool() const noexcept { return data_ != nullptr; }

  /// Samples of the pupil for uniform numbers, N each.
  template <class T>
  void draw(std::size_t count, const T* u, const T* v, T* to_u, T* to_v, T* densities) const noexcept;
  using Drawn = iris_detail::IrisWeights::Drawn;
  /// Without weights: the same numbers.
  Drawn draw(double u, double v) const noexcept { return data_ ? drawn(u, v) : Drawn{u, v, 1}; }
  /// Of the samples drawn, over that of uniform ones.
  double density(const Vec2<double>& sample) const noexcept;

  /// The weights of samples of the model's own pupils. lines: their rays, N, as of an upright film.
  template <class T>
  void of_samples(std::size_t count, const T* u, const T* v, const TwoPlaneRays<const T>& lines,
                  const RayWavelengths& wavelengths, T* weights) const noexcept;
  /// Those of any rays that pass: of a tilted film, or from the scene.
  template <class T>
  void of_lines(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                T* weights) const noexcept;
  double of_sample(double u, double v, const TwoPlaneRay& line, Wavelength wavelength) const noexcept;
  double of_line(const TwoPlaneRay& line, Wavelength wavelength) const noexcept;

 private:
  Drawn drawn(double u, double v) const noexcept;

  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval::camera_detail
