// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "camera/ray_model.hpp"
#include "iris/iris_weights.hpp"
#include "petzval/camera/bokeh.hpp"
#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::camera_detail {

/// Weights of the bokeh controls (BokehControls): the density of pupil samples and the weight of each sample.
///
/// Immutable, cheap to copy, thread-safe.
class PupilWeights {
 public:
  /// No weights.
  PupilWeights() = default;
  /// @throws Error  if the weight map is black, has more than 2^26 pixels, a size that does not match, or weights that
  /// are negative or not finite; or if the edge is out of range
  PupilWeights(const Lens& lens, const RayModel& model, const BokehControls& controls);

  /// The pupils to sample instead of the pupils of the model; nullopt if there are no weights.
  PETZVAL_API std::optional<FilmPupilTable> pupils() const;
  explicit operator bool() const noexcept { return data_ != nullptr; }

  /// Samples of the pupil for uniform numbers, N each.
  template <class T>
  void draw(std::size_t count, const T* u, const T* v, T* to_u, T* to_v, T* densities) const noexcept;
  using IrisSample = iris_detail::IrisWeights::IrisSample;
  /// Returns u and v unchanged if there are no weights.
  IrisSample draw(double u, double v) const noexcept { return data_ ? drawn(u, v) : IrisSample{u, v, 1}; }
  /// Density of the drawn samples relative to uniform samples.
  double density(const Vec2<double>& sample) const noexcept;

  /// Weights of samples of the model's pupils.
  /// @param lines the N rays of the samples, in terms of the upright film
  template <class T>
  void of_samples(std::size_t count, const T* u, const T* v, const TwoPlaneRays<const T>& lines,
                  const RayWavelengths& wavelengths, T* weights) const noexcept;
  /// Weights of any rays that pass: rays of a tilted film, or rays from the scene.
  template <class T>
  void of_lines(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                T* weights) const noexcept;
  double of_sample(double u, double v, const TwoPlaneRay& line, Wavelength wavelength) const noexcept;
  double of_line(const TwoPlaneRay& line, Wavelength wavelength) const noexcept;

 private:
  IrisSample drawn(double u, double v) const noexcept;

  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval::camera_detail
