// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/pupil_plane.hpp"
#include "sines.hpp"

namespace petzval::pupil_detail {

/// A place of a plane and about how far it is to the places beside it that are tried.
struct SeenPlace {
  Vec2<double> at{0, 0}, beside{0, 0};
};

/// Of values in rows, one for each place, those that are negative and that no neighbour exceeds: a part of a pupil may
/// slip between these places. Places at the border do not count.
std::vector<std::size_t> summits(std::span<const double> values, std::size_t row);

/// What x and y of a place are: those of the plane, mm, or the angles under which its point, at a finite distance, sees
/// it (sines.hpp), rad.
enum class Coordinates { plane, angles };

/// The rays of one point, many at a time. Keeps the memory for them.
class Sight {
 public:
  Sight(const Lens& lens, const PupilPlane& plane, std::size_t wavelength, Coordinates coordinates);

  const Lens& lens() const noexcept { return lens_; }
  const PupilPlane& plane() const noexcept { return plane_; }
  Coordinates coordinates() const noexcept { return coordinates_; }

  /// Of the rays through some places: trace/clearances.hpp, reproducible. x, y: N each. Returns N values, valid until
  /// the next call. apertures: as in BatchOptions.
  std::span<const double> clearances(std::span<const double> x, std::span<const double> y, bool apertures = true);

  /// Where the rays through some places end: fates and surfaces of N each, valid until the next call.
  struct Ends {
    std::span<const RayFate> fates;
    std::span<const int> surfaces;
  };
  Ends ends(std::span<const double> x, std::span<const double> y);

  /// How far from 0 the coordinates of places are that see the surface through which rays enter.
  double reach() const;

  /// Place of the chief ray, which apertures may stop; nullopt if no ray goes through the centre of the stop.
  std::optional<Vec2<double>> chief() const;

  /// Looks for rays that pass, over all that can be seen of the surface through which they enter: at 48 x 48 places
  /// and, where few of them pass, about those of 96 x 96 at which the clearance has a maximum. Of several parts it
  /// returns the one nearest to the chief ray, without a chief ray the largest.
  std::vector<SeenPlace> passing_places();

 private:
  RayArrays<double> rays(std::span<const double> x, std::span<const double> y);

  const Lens& lens_;
  PupilPlane plane_;
  Sines sines_;
  Coordinates coordinates_;
  std::size_t wavelength_;
  std::array<std::vector<double>, 2> places_;
  std::array<std::vector<double>, 6> rays_;
  std::vector<double> values_;
  std::vector<RayFate> fates_;
  std::vector<int> surfaces_;
};

}  // namespace petzval::pupil_detail
