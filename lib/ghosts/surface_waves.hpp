// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/kernel_vec.hpp"
#include "lens/lens_view.hpp"
#include "lens/path_lens.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/coating.hpp"

namespace petzval::ghosts_detail {

using Vec = kernel::Vec<double>;

/// The electric fields at a ray of unpolarised light, for two incoherent polarisations of the light that entered.
struct Wave {
  Vec first, second;  ///< perpendicular to the ray; their squared lengths are powers

  /// Unpolarised light of power 1 along a unit direction.
  static Wave along(const Vec& direction) noexcept;
  double power() const noexcept { return (dot(first, first) + dot(second, second)) / 2; }
};

/// A ray at a surface: the point, the normal, and the light that the surface reflects and transmits.
struct Contact {
  Vec point, normal;  ///< lens frame; unit normal, to +z at the vertex
  double cosine = 1;  ///< cosine of the angle of incidence
  SurfaceLight light;
  double sign_p = -1;  ///< sign of the reflected p field relative to the s field
};

/// The surfaces of a lens at one wavelength, met in either direction, with the light that they reflect.
///
/// Fields are real. Uncoated surfaces flip the reflected p field beyond Brewster's angle. Phases of coatings and of
/// total reflection are not known: s and p keep the phase difference of normal incidence. Powers of s and p are exact.
class PETZVAL_API Surfaces {
 public:
  /// @param film_reflectance of the film, surface_count()
  /// @throws Error if the lens does not cover the wavelength
  Surfaces(const Lens& lens, Wavelength wavelength, double film_reflectance);

  std::size_t count() const noexcept { return rows_.size() - 1; }
  double wavelength_nm() const noexcept { return nm_; }
  const Lens& lens() const noexcept { return lens_; }

  /// Finds where the line of a ray meets a surface, or the film.
  /// @param forward true if light travels in the order of the surfaces
  /// @param apertures true: rims, obscurations and the iris clip
  /// @return transmitted, or the reason why the ray is lost
  RayFate meet(std::size_t surface, bool forward, const Vec& origin, const Vec& direction, bool apertures,
               Contact& contact) const;

  /// Turn the direction and the wave into the reflected or the refracted ray; false on total reflection.
  static void reflect(const Contact& contact, Vec& direction, Wave& wave) noexcept;
  bool refract(std::size_t surface, bool forward, const Contact& contact, Vec& direction, Wave& wave) const noexcept;

  bool mirror(std::size_t surface) const noexcept { return surface == count() || view_.surfaces[surface].mirror; }
  /// Absorption of a space, 1/mm.
  double absorption(std::size_t space) const noexcept { return absorptions_[space]; }
  /// Reflectance at normal incidence.
  double reflectance(std::size_t surface) const;

  /// Power of a ray of unpolarised light of power 1 at the end of a path, without rims; nullopt if the ray is lost.
  std::optional<double> power(std::span<const lens_detail::Passage> path, Vec origin, Vec direction) const;

 private:
  struct Row {
    Coating coating, reversed;
    double before = 1, behind = 1;  ///< indices
    bool plain = true;              ///< light passes without a change
  };

  Lens lens_;
  const kernel::LensView<double>& view_;
  double nm_ = 0, film_reflectance_ = 0;
  std::vector<Row> rows_;  // the film is the last
  std::vector<double> absorptions_;
};

}  // namespace petzval::ghosts_detail
