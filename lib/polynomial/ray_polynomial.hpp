// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "core/dual.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval {

/// Rays of a lens as polynomials of the film point f and the pupil point p, of degree 3, 5, 7, 9 or 11.
///
///     auto pupils = petzval::FilmPupilTable::equal_area(lens, 21.6);
///     auto polynomial = petzval::RayPolynomial::fit(lens, pupils, 7);
///     polynomial.to_scene<float>(count, lines, {}, rays, fates);
///
/// Wavelengths in nm between the fits are interpolated from up to four neighbouring fits, equal to a fit at its
/// wavelength within a twentieth of the fit's largest error and 6e-7 rad. Immutable, cheap to copy, thread-safe.
///
/// Accuracy: RMS angle errors times focal length, for degrees 3, 5, 7, 9 and 11 (tests/polynomial). Float adds up to
/// 4e-7 rad and 3e-5 mm.
///
///     double Gauss 100 mm f/2, 80 mm of film            32, 7.1, 1.17, 0.16, 0.022 um
///     anamorphic 60 mm (cylinders), f/3, 29 mm of film  41, 7.2, 1.6, 0.32, 0.069 um
///     the same at f/8                                   33, 3.0, 0.31, 0.033, 0.004 um
class PETZVAL_API RayPolynomial {
 public:
  /// Copies. Moves also copy, so that a RayPolynomial is never empty.
  RayPolynomial(const RayPolynomial&) = default;
  RayPolynomial& operator=(const RayPolynomial&) = default;

  /// The coefficients of one wavelength, as in files; public for export to shaders.
  ///
  /// f and p are scaled to the domain: |f| <= 1 and, about the centre of the pupil, |p| <= 1. Two vectors s and o give
  /// the ray in object space. Its direction is d = (2 s, s.s - 1) / (1 + s.s), a stereographic projection. Its origin
  /// lies at (o, 0) + 2 (s.o) (-s, 1) / (1 + s.s) from the centre of the entrance pupil: this is o, rotated as -z to d.
  /// Each vector is A f + B p, with polynomials A and B of u = f.f, v = f.p, w = p.p. With cylinders, each vector is
  /// (Ax fx + Bx px, Ay fy + By py).
  struct Fit {
    double wavelength_nm = 0;
    /// A and B of s: coefficients of u^i v^j w^k with i + j + k <= (degree - 1) / 2; k changes slowest, i fastest. With
    /// mirror symmetry along x, then along y: coefficients of f^2i p^2j f'^2k p'^2l with i + j + k + l <=
    /// (degree - 1) / 2, and f' and p' along the other axis; l changes slowest, i fastest. Then come f' p' times the
    /// terms of degree - 2.
    std::vector<double> direction_by_film = {}, direction_by_pupil = {};
    std::vector<double> offset_by_film = {}, offset_by_pupil = {};  ///< A and B of o, mm
    /// Errors of angle and offset for rays that were not fitted, uniform over film and pupils. max_rad and max_mm are
    /// bounds: the largest errors plus 10 %, including rays along the rims of the pupils and from the edge of the film
    /// (no ray of thirteen lenses exceeds the bounds: tests/polynomial/fit_test.cpp).
    double rms_rad = 0, max_rad = 0, rms_mm = 0, max_mm = 0;
  };
  /// The film points and pupil points that the fits cover.
  struct Domain {
    TwoPlanes space;
    double film_radius = 0;   ///< |f| <= film_radius, mm
    double pupil_shift = 0;   ///< the pupil of the domain has its centre at pupil_shift * f
    double pupil_radius = 0;  ///< mm
    double reference_z = 0;   ///< z of the entrance pupil, the origin of offsets
    struct Section {
      double pupil_shift, pupil_radius;
    };
    /// Set for a lens with mirror symmetry: shift and radius along x; the members above are then along y.
    std::optional<Section> along_x = {};
  };
  /// Fits polynomials to exact rays through the pupils, for all compiled wavelengths.
  ///
  /// Least squares by QR in double. The focus of the film's centre is the focus at which exact rays are sharpest (with
  /// cylinders, in both sections). The domain is the smallest that contains the pupils. For an iris with blades, the
  /// rays of the round stop are fitted. Takes up to 20 ms per wavelength; with cylinders, 60 ms up to degree 7 and 0.4
  /// s for degree 11.
  ///
  /// @param lens     the lens
  /// @param pupils   pupils of its film points (FilmPupilTable::equal_area())
  /// @param degree   3, 5, 7, 9 or 11
  /// @throws Error   if the degree is another number, the pupils have other wavelengths or a film radius of 0, or fewer
  ///                 rays pass the lens than there are coefficients
  static RayPolynomial fit(const Lens& lens, const FilmPupilTable& pupils, int degree);
  /// A polynomial from data.
  ///
  /// @param degree              3, 5, 7, 9 or 11
  /// @param domain              domain of all fits
  /// @param fits                one fit per wavelength
  /// @param primary_wavelength  position of the default fit
  /// @throws Error              if the degree is another number or a coefficient is too large for float
  RayPolynomial(int degree, const Domain& domain, std::vector<Fit> fits, std::size_t primary_wavelength = 0);

  int degree() const noexcept;
  const Domain& domain() const noexcept;
  const std::vector<Fit>& fits() const noexcept;

  /// Maps N image-space rays to rays towards the scene.
  ///
  /// Outside the domain, and for a wavelength without a fit, the fate is outside_fit and the ray starts at the
  /// reference point along the axis. The result of a ray is independent of the other rays, to the bit.
  template <class T>
  void to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                const RayArrays<T>& rays, RayFate* fates) const noexcept;
  /// Maps one image-space ray; equal to the batch up to rounding.
  RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray) const noexcept;
  /// Maps one image-space ray with its derivatives, in double.
  RayOf<kernel::Dual> to_scene(const TwoPlaneRayOf<kernel::Dual>& line, Wavelength wavelength,
                               RayFate& fate) const noexcept;
  /// Inverts to_scene() by Newton's iteration: maps N scene rays, given anywhere on their lines, to image-space rays.
  ///
  /// If no ray in the domain is found, the fate is outside_fit and the result is the axis.
  ///
  /// Accuracy: 1e-9 mm.
  ///
  /// Limitations: if the film is far wider than the image circle, up to 4 % of the rays at the edge of the light are
  /// not found (phone lens, degree 7; most lenses lose no ray). Far outside the declared field of a single lens two
  /// image-space rays may map to the same scene ray; the result is either of these rays.
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
               const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval
