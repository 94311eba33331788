// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lens/path_lens.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "surface_waves.hpp"

namespace petzval::ghosts_detail {

/// A rectangle of the entrance plane, mm.
struct Box {
  Vec2<double> low{0, 0}, high{0, 0};
};

/// The plane through the front vertex that faces a light; its points parametrise the rays of the light.
class Entrance {
 public:
  /// @throws Error if the light is not finite, lies behind the front surface or so close that it sees parts of this
  ///               surface at more than 87 degrees from the vertex; if the front surface has no rim
  Entrance(const Lens& lens, const ScenePoint& light);

  /// Contains all rays that enter the front surface within its rim.
  const Box& box() const noexcept { return box_; }
  /// Power per area of the plane at a point, for an irradiance of 1 at the front vertex.
  double flux(const Vec2<double>& at) const noexcept;
  Ray<double> ray(const Vec2<double>& at) const noexcept { return differential(at)[0]; }
  /// The ray and its derivatives by x and y.
  std::array<Ray<double>, 3> differential(const Vec2<double>& at) const noexcept;

 private:
  Vec3<double> towards_{0, 0, -1}, x_axis_{1, 0, 0}, y_axis_{0, 1, 0};
  double distance_;  ///< of the light, mm
  Box box_;
};

/// A part of the light of a pair on the film: its energy is uniform over a polygon.
struct Deposit {
  std::array<Vec2<double>, 6> corners{};  ///< film points, mm
  int count = 0;
  double energy = 0;      ///< for an irradiance of 1 at the front vertex, times mm^2
  bool mirrored = false;  ///< true if the map from the entrance plane to the film inverts the orientation

  std::span<Vec2<double>> polygon() noexcept { return {corners.data(), static_cast<std::size_t>(count)}; }
  std::span<const Vec2<double>> polygon() const noexcept { return {corners.data(), static_cast<std::size_t>(count)}; }
  Box bounds() const noexcept;
};

struct Footprint {
  std::vector<Deposit> deposits;
  std::size_t cells = 0;  ///< number of cells whose rays pass the rims
  double energy = 0;
  double weight_error = 0;  ///< largest error of interpolated transmittances, relative to their mean
  double mismatch_mm = 0;   ///< largest distance between common edges of adjacent deposits
  double cell_mm = 0;       ///< longest side of a deposit
  Box lit;                  ///< the part of the entrance plane from which the deposits come, with one cell of margin
};

/// A path of light through a lens to the film, with its rims.
class LightPath {
 public:
  LightPath(const Lens& lens, std::vector<lens_detail::Passage> path);

  /// The part of a box, enlarged by a margin, whose rays pass all rims; an empty box if no ray is known to pass.
  Box region(const Entrance& entrance, Wavelength wavelength) const;
  /// Traces cells^2 rays through the middles of the cells of a box. Cells are clipped at the rims.
  /// @param film with its position
  /// @param frame film points, mm; deposits outside it are left out
  Footprint footprint(const Entrance& entrance, const Box& box, std::size_t cells, const Surfaces& surfaces,
                      Wavelength wavelength, const Film& film, const Box& frame) const;
  /// The light to first order: paraxial_footprint().
  Footprint paraxial(const Entrance& entrance, const Surfaces& surfaces, Wavelength wavelength, const Film& film) const;
  /// Area of the box whose rays pass the rims, times Entrance::flux().
  double entering(const Entrance& entrance, const Box& box, std::size_t cells, Wavelength wavelength) const;

 private:
  /// Distances of rays from the rims, positive inside, in units of the rim.
  std::vector<double> margins(const Entrance& entrance, std::span<const Vec2<double>> positions,
                              Wavelength wavelength) const;

  std::vector<lens_detail::Passage> path_;
  Lens lens_;
  double film_sense_;  ///< direction of light along z at the film
};

}  // namespace petzval::ghosts_detail
