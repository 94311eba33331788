// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::detail {

/// Where the blur of an axial point is least, by exact rays through the whole clear aperture.
///
/// The rays fill what passes every rim, equally by area of the pupil. The edges of that region are found to the last
/// bit and the rays lie at the nodes of a quadrature inside it, so that the result is a smooth function of the subject
/// and can be solved for.
class LeastBlur {
 public:
  /// Throws Error where no surface limits the beam.
  LeastBlur(const Lens& lens, std::size_t wavelength);

  /// The film, lens frame, for a subject at subject_z < 0 (-inf: far away). Infinite where the rays leave parallel;
  /// none where nothing gets through.
  std::optional<double> operator()(double subject_z) const;

 private:
  struct Rim {
    double semi_diameter;
    RayMatrix y, x;  ///< from the first vertex to the rim, in each meridian
  };
  struct Azimuth {
    double x, y;
  };
  struct Ray {
    double weight, x, y, z, slope_x, slope_y;
  };
  struct Interval {
    double from, to;
  };

  std::optional<Ray> trace(double subject_z, const Azimuth& azimuth, double height) const;
  double bound(double subject_z, const Azimuth& azimuth) const;
  std::vector<Interval> passing(double subject_z, const Azimuth& azimuth) const;

  const Lens& lens_;
  std::size_t wavelength_;
  std::vector<Rim> rims_;
  std::vector<Azimuth> azimuths_;
};

}  // namespace petzval::detail
