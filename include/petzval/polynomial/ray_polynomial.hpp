// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {

/// Rays of a lens as polynomials of film point f and pupil point p, of degree 3, 5, 7, 9 or 11.
///
///     auto pupils = petzval::FilmPupilTable::equal_area(lens, 21.6);
///     auto polynomial = petzval::RayPolynomial::fit(lens, pupils, 7);
///     polynomial.to_scene<float>(count, lines, {}, rays, fates);
///     petzval::write_ray_polynomial(polynomial, "lens_polynomial.json");
///
/// Two vectors with the symmetry of the lens, s and o, describe a ray in object space for any field below 180 degrees:
/// its direction in stereographic projection from the axis, d = (2 s, s.s - 1) / (1 + s.s), and its offset from the
/// centre of the entrance pupil across that direction, (o, 0) + 2 (s.o) (-s, 1) / (1 + s.s), where the ray begins (o,
/// turned by the turn that takes -z to d). f and p are scaled to the domain: |f| <= 1, |p| <= 1 about the centre of the
/// pupil.
///
/// Of a lens of revolution such a vector is A f + B p with A and B polynomials of u = f.f, v = f.p, w = p.p. A lens
/// with cylinders only has two mirror symmetries, x to -x and y to -y. Its vectors have the components Ax fx + Bx px
/// and Ay fy + By py, with coefficients of their own along x and y, and the domain's pupil is an ellipse.
///
/// Angle errors times focal length of the double Gauss 100 mm f/2 over 80 mm of film: RMS 32, 7.1, 1.17, 0.16 and
/// 0.022 um for degrees 3 to 11 (tests/polynomial). Of the anamorphic 60 mm, with cylinders, wide open (f/3) and at
/// f/8, over 29 mm of film: 41, 7.2, 1.6, 0.32 and 0.069, and 33, 3.0, 0.31, 0.033 and 0.004 um. Float adds up to 4e-7
/// rad and 3e-5 mm. With mirror symmetry there are 3 to 7 times as many coefficients, and a batch takes 2 to 6 times as
/// long.
///
/// Wavelengths in nm between those of fits get the combination of up to four neighbouring fits: a cubic in 1 / nm, or a
/// straight line where neighbours stand very unevenly. It is a sum of modes in which the coefficients of all fits vary
/// together (their singular vectors, eight at most): at the wavelength of a fit what the fit is, within a twentieth of
/// the largest error of a fit and 6e-7 rad. A batch of such wavelengths evaluates each mode; a lens has 3 to 5 of them.
///
/// Immutable, cheap to copy, free to share between threads.
class PETZVAL_API RayPolynomial {
 public:
  /// Copies. Moves copy too, so that no RayPolynomial is ever empty.
  RayPolynomial(const RayPolynomial&) = default;
  RayPolynomial& operator=(const RayPolynomial&) = default;

  /// The coefficients of one wavelength. Plain data, as in files; public so that it can be exported to shaders.
  struct Fit {
    double wavelength_nm = 0;
    /// In the order of terms(degree); with mirror symmetry in that of mirror_terms(degree), those along x, then y.
    std::vector<double> direction_by_film = {}, direction_by_pupil = {};
    std::vector<double> offset_by_film = {}, offset_by_pupil = {};  ///< mm
    /// Errors of rays that were not fitted, uniformly over film and pupils: of their angles, and of their offsets from
    /// the reference point. The largest are bounds: those found, also along the rims of the pupils and from the film's
    /// farthest point, and 10 % to spare (tests/polynomial/fit_test.cpp: no ray of thirteen lenses exceeds them).
    double rms_rad = 0, max_rad = 0, rms_mm = 0, max_mm = 0;
  };
  struct Domain {
    TwoPlanes space;
    double film_radius = 0;   ///< |f| <= film_radius, mm
    double pupil_shift = 0;   ///< the centre of the domain in the pupil lies at pupil_shift * f
    double pupil_radius = 0;  ///< mm
    double reference_z = 0;   ///< of the centre of the entrance pupil, from which offsets count
    struct Section {
      double pupil_shift, pupil_radius;
    };
    /// Set for a lens with mirror symmetry instead of that of revolution: those above are along y, these along x.
    std::optional<Section> along_x = {};
  };
  struct Term {
    int u, v, w;  ///< exponents
  };
  /// The terms u^i v^j w^k with i + j + k <= (degree - 1) / 2, in the order of coefficients: k changes slowest, i
  /// fastest. Throws Error for another degree than 3, 5, 7, 9 or 11.
  static std::vector<Term> terms(int degree);
  /// Exponents of film and pupil point along a component's own axis, and along the other one.
  struct MirrorTerm {
    int film, pupil, other_film, other_pupil;
  };
  /// The terms f^2i p^2j f'^2k p'^2l with i + j + k + l <= (degree - 1) / 2, f' and p' along the other axis, in the
  /// order of coefficients: l changes slowest, then k and j, i fastest. Behind them f' p' times those of degree - 2.
  /// Throws Error as terms() does.
  static std::vector<MirrorTerm> mirror_terms(int degree);

  /// Fits all compiled wavelengths by least squares (QR, in double) to exact rays through the pupils, with the focus of
  /// the film's centre where exact rays are sharpest, with cylinders in both sections. The domain is the smallest that
  /// holds all of them. Within 20 ms for each wavelength; with cylinders within 60 ms for degrees up to 7, 0.4 s for
  /// degree 11. Those of a lens with a bladed iris are fitted to all rays through its round stop. Throws Error for
  /// another degree, pupils of other wavelengths, a film of one point, and if fewer rays pass the lens than there are
  /// coefficients.
  static RayPolynomial fit(const Lens& lens, const FilmPupilTable& pupils, int degree);
  /// From data. primary_wavelength: position of the fit that is used by default; if unset, the one nearest to the d
  /// line. Throws Error, which names the entry, for inconsistent data and a wavelength that two fits have.
  RayPolynomial(int degree, const Domain& domain, std::vector<Fit> fits,
                std::optional<std::size_t> primary_wavelength = {});

  int degree() const noexcept;
  const Domain& domain() const noexcept;
  const std::vector<Fit>& fits() const noexcept;
  /// Position of the fit for the lens's primary wavelength, the default of all calls.
  std::size_t primary_wavelength() const noexcept;

  /// Maps lines to rays towards the scene. Outside the domain, and for a wavelength without a fit, the fate is
  /// outside_fit and the ray runs along the axis from the reference point. A ray depends on its own line alone, to the
  /// bit.
  template <class T>
  void to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                const RayArrays<T>& rays, RayFate* fates) const noexcept;
  /// The same for one line, within rounding.
  RayFate to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray) const noexcept;
  /// The same for one line with its derivatives, in double.
  RayDerivatives to_scene(const TwoPlaneRayDerivatives& line, Wavelength wavelength = {}) const noexcept;
  /// The inverse: maps rays from the scene, at any point on them, to the lines that to_scene maps to them, within 1e-9
  /// mm, by Newton's iteration. If no line in the domain is found, the fate is outside_fit and the line is the axis: of
  /// rays that to_scene gives, up to 4 % at the edge of the light of a phone's lens at degree 7, where a film is far
  /// wider than the light, and none of most lenses. Far beyond the declared field of a single lens the polynomial may
  /// give one ray for two lines; either may be found.
  void to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
               const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval
