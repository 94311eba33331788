// SPDX-License-Identifier: Apache-2.0
// Evaluates a fitted transmittance for blocks of rays, compiled once for each instruction set. Names are local, and no
// other library is called, as in lib/core/lanes.hpp.
#include "transmission_loops.hpp"

#include "core/loop_math.hpp"
#include "lens/look_up.hpp"

namespace petzval::camera_detail {
namespace {

template <class T>
inline T limited(T x, T least, T most) noexcept {
  x = x > least ? x : least;
  return x < most ? x : most;
}

template <class T>
void of_lines(const TransmissionJob<T>& job, std::size_t count, const TwoPlaneRays<const T>& lines,
              const RayWavelengths& wavelengths, T* to) noexcept {
  constexpr std::size_t block = lens_detail::look_up_block;
  T coefficients[transmission_terms][block], monomials[transmission_terms][block], variables[6][block], sums[block];
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = count - begin < block ? count - begin : block;
    if (!job.shared) lens_detail::look_up(job.rows, wavelengths, begin, n, coefficients, job.terms);
    const T *const film_x = lines.film_x + begin, *const film_y = lines.film_y + begin;
    const T *const pupil_x = lines.pupil_x + begin, *const pupil_y = lines.pupil_y + begin;
    const T per_film = job.per_film, per_pupil = job.per_pupil;
    // A ray beyond the fitted rays gets the transmittance at the edge of the fit.
    const auto product = [](T* variable, const T* a, T scale_a, const T* b, T scale_b, std::size_t rays) {
      PETZVAL_INDEPENDENT
      for (std::size_t i = 0; i < rays; ++i) variable[i] = limited((scale_a * a[i]) * (scale_b * b[i]), T(-1), T(1));
    };
    product(variables[0], film_x, per_film, film_x, per_film, n);
    product(variables[1], film_y, per_film, film_y, per_film, n);
    product(variables[2], pupil_x, per_pupil, pupil_x, per_pupil, n);
    product(variables[3], pupil_y, per_pupil, pupil_y, per_pupil, n);
    product(variables[4], film_x, per_film, pupil_x, per_pupil, n);
    product(variables[5], film_y, per_film, pupil_y, per_pupil, n);
    if (job.revolution) {
      for (std::size_t k = 0; k < 3; ++k) {
        T *const variable = variables[k], *const first = variables[2 * k], *const second = variables[2 * k + 1];
        for (std::size_t i = 0; i < n; ++i) variable[i] = limited(first[i] + second[i], T(-1), T(1));
      }
    }
    const T constant = job.shared ? static_cast<T>(job.shared[0]) : T(0);
    for (std::size_t i = 0; i < n; ++i) monomials[0][i] = T(1);
    for (std::size_t i = 0; i < n; ++i) sums[i] = job.shared ? constant : coefficients[0][i];
    for (std::size_t k = 1; k < job.terms; ++k) {
      const T* const earlier = monomials[job.monomials[k].earlier];
      const T* const variable = variables[job.monomials[k].variable];
      T* const own = monomials[k];
      const T shared = job.shared ? static_cast<T>(job.shared[k]) : T(0);
      if (job.shared) {
        PETZVAL_INDEPENDENT
        for (std::size_t i = 0; i < n; ++i) {
          own[i] = earlier[i] * variable[i];
          sums[i] += shared * own[i];
        }
      } else {
        PETZVAL_INDEPENDENT
        for (std::size_t i = 0; i < n; ++i) {
          own[i] = earlier[i] * variable[i];
          sums[i] += coefficients[k][i] * own[i];
        }
      }
    }
    for (std::size_t i = 0; i < n; ++i) to[begin + i] = limited(sums[i], job.least, job.most);
  }
}

}  // namespace

const TransmissionLoops PETZVAL_LOOPS{of_lines<float>, of_lines<double>};

}  // namespace petzval::camera_detail
