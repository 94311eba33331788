// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "polynomial/ray_polynomial.hpp"

namespace petzval::polynomial_detail {

/// Lines from the film points that represent all others by symmetry: points on the axis +y for a lens of revolution,
/// points in the quadrant x, y >= 0 for a lens with mirror symmetry.
struct Lines {
  std::vector<double> film_x, film_y, pupil_x, pupil_y;

  std::size_t size() const noexcept { return film_y.size(); }
  TwoPlaneRays<const double> rays() const noexcept {
    return {film_x.data(), film_y.data(), pupil_x.data(), pupil_y.data()};
  }
};

/// Lines over film and pupils, from index `first` on: uniform by area or, if `dense`, denser towards the edges of film
/// and pupil, like Chebyshev nodes. Denser lines reduce the largest errors by some tenths and raise the RMS by one
/// tenth.
Lines spread(const FilmPupilTable& pupils, bool mirrors, std::size_t first, std::size_t count, bool dense,
             std::size_t wavelength);
/// Sets the smallest disc that contains some lines or, with mirror symmetry, an ellipse around the smallest rectangle.
void enclose(const std::vector<Lines>& lines, bool mirrors, RayPolynomial::Domain& domain);

/// Exponents of film and pupil point along the component's own axis and along the other axis, for mirror symmetry, in
/// the order of coefficients.
std::vector<std::array<int, 4>> mirror_terms(int degree);

/// Rays as separate arrays.
struct Rays {
  std::array<std::vector<double>, 6> v;
  std::vector<RayFate> fates;

  explicit Rays(std::size_t count) : fates(count) { v.fill(std::vector<double>(count)); }
  std::size_t size() const noexcept { return fates.size(); }
  template <class T>
  RayArrays<T> arrays() noexcept {
    return {v[0].data(), v[1].data(), v[2].data(), v[3].data(), v[4].data(), v[5].data()};
  }
  Vec3<double> origin(std::size_t i) const noexcept { return {v[0][i], v[1][i], v[2][i]}; }
  Vec3<double> direction(std::size_t i) const noexcept { return {v[3][i], v[4][i], v[5][i]}; }
};
/// Rays along lines towards the scene. They start at the last vertex, so that a distant film or pupil does not lose
/// digits.
Rays rays_along(const Lens& lens, const TwoPlanes& space, const Lines& lines);

struct FitLines {
  Lines fitted;
  Lines axial;  ///< from the film centre, uniform over its pupil
  Lines fresh;  ///< lines that the fit does not use, to measure errors
  Lines rims;   ///< lines on the rims of the pupils, for the largest errors
  Lines edges;  ///< lines near the rims and from the edge of the film, for the largest errors
};

/// Fits the lines that pass the lens at one wavelength. The film centre is in focus in the plane in which exact rays
/// are sharpest; with mirror symmetry, in the plane of each section.
RayPolynomial::Fit fit(const Lens& lens, const RayPolynomial::Domain& domain, int degree, std::size_t wavelength,
                       const FitLines& lines);

}  // namespace petzval::polynomial_detail
