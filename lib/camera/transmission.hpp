// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "camera/ray_model.hpp"
#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::camera_detail {

/// The part of the light that the rays of a camera keep on their way through the lens. Exact models find it surface by
/// surface while they trace; for other models it is a polynomial of film and pupil position, fitted to exact rays.
/// Immutable, cheap to copy.
class PETZVAL_API Transmission {
 public:
  /// Not modelled: all light passes.
  Transmission() = default;
  /// @throws Error  if a compiled wavelength is outside a table of reflectances
  Transmission(const Lens& lens, const RayModel& model);

  explicit operator bool() const noexcept { return data_ != nullptr; }
  /// Largest error, relative to all light; 0 if not modelled.
  double error() const noexcept;

  /// For the functions of a model, which writes the transmittances of exact rays; null if not modelled.
  const trace_detail::LensLight* light() const noexcept;
  /// Writes the transmittances of image-space rays. Does nothing for an exact model: light() makes it write its own.
  template <class T>
  void fill(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
            T* transmittances) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval::camera_detail
