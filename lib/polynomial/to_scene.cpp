// SPDX-License-Identifier: Apache-2.0
// Compiled once for each instruction set; PETZVAL_LOOPS names the result. A result depends only on its own line: the
// rest of a batch that does not fill a block uses the same vector code.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/simd.hpp"
#include "lens/look_up.hpp"
#include "loops.hpp"
#include "sums.hpp"

namespace petzval::polynomial_detail {
namespace {

using core_detail::lane_count;
using core_detail::Native;

template <class Symmetry, class R>
using Variables = typename Symmetry::template Variables<typename Native<R>::Values>;
template <class R>
using Sums = FourSums<typename Native<R>::Values>;

static_assert(OfMirrors<degree_count>::coefficients == most_coefficients);

/// Sums with one wavelength per lane: all lanes are evaluated at each wavelength that occurs, in ascending order, and
/// the lanes of that wavelength are kept.
/// @param known lanes whose wavelength has a fit
template <class Symmetry, class R>
PETZVAL_INLINE Sums<R> mixed_sums(const ToSceneJob<R>& job, const std::uint16_t* each,
                                  const Variables<Symmetry, R>& variables_of_ray,
                                  typename Native<R>::Bits& known) noexcept {
  using Bit = typename Native<R>::Bit;
  constexpr std::size_t lanes = lane_count<R>;
  constexpr Bit max_fits = 1 << 16;
  const Bit fits = job.fits < max_fits ? static_cast<Bit>(job.fits) : max_fits;
  Bit own[lanes];
  for (std::size_t l = 0; l < lanes; ++l) own[l] = each[l];
  const auto next = [&](Bit last) {
    Bit smallest = max_fits;
    for (std::size_t l = 0; l < lanes; ++l) smallest = own[l] > last && own[l] < smallest ? own[l] : smallest;
    return smallest;
  };
  typename Native<R>::Bits owns;
  __builtin_memcpy(&owns, own, sizeof owns);
  known = owns < fits;
  Sums<R> result{};
  for (Bit at = next(-1); at < fits; at = next(at)) {
    const auto theirs = owns == at;
    const Sums<R> found = Symmetry::sums(job.coefficients + Symmetry::coefficients * at, variables_of_ray);
    result.first = theirs ? found.first : result.first;
    result.second = theirs ? found.second : result.second;
    result.third = theirs ? found.third : result.third;
    result.fourth = theirs ? found.fourth : result.fourth;
  }
  return result;
}

/// Coefficients of each lane's own wavelength, read like a pointer to the coefficients of one wavelength. Rows always
/// have two registers, because the code for one register is slower.
template <class R>
struct CoefficientsByLane {
  const R* rows;
  std::size_t length;
  typename Native<R>::Bits indices;

  PETZVAL_INLINE CoefficientsByLane operator+(int coefficients) const noexcept {
    return {rows + static_cast<std::ptrdiff_t>(length) * coefficients, length, indices};
  }
  PETZVAL_INLINE typename Native<R>::Values operator[](int) const noexcept {
    return core_detail::permute<2>(rows, indices);
  }
};

/// lens_detail::Positions for the lanes of doubles.
using HalfPositions = std::uint16_t __attribute__((vector_size(core_detail::lane_bytes / 4)));

/// mixed_sums() for registers that hold a coefficient of all fits.
template <class Symmetry, class R>
PETZVAL_INLINE Sums<R> permuted_sums(const ToSceneJob<R>& job, const std::uint16_t* each,
                                     const Variables<Symmetry, R>& variables_of_ray,
                                     typename Native<R>::Bits& known) noexcept {
  using Bit = typename Native<R>::Bit;
  // Converted in one operation: stores of single elements would stall the load that follows.
  using Positions = std::conditional_t<sizeof(R) == 4, lens_detail::Positions, HalfPositions>;
  Positions positions;
  __builtin_memcpy(&positions, each, sizeof positions);
  typename Native<R>::Bits indices = __builtin_convertvector(positions, typename Native<R>::Bits);
  known = indices < static_cast<Bit>(job.fits);
  indices &= known;
  return Symmetry::sums(CoefficientsByLane<R>{job.rows, job.row_length, indices}, variables_of_ray);
}

/// Weights of modes for a block of rays.
template <class R>
using ModeWeights = R[most_modes][lens_detail::look_up_block];

/// Sums for any wavelengths.
/// @param weights mode weights; the lanes start at the index `at`
template <class Symmetry, class R>
PETZVAL_INLINE Sums<R> mode_sums(const ToSceneJob<R>& job, const ModeWeights<R>& weights, std::size_t at,
                                 const Variables<Symmetry, R>& variables_of_ray,
                                 typename Native<R>::Bits& known) noexcept {
  const auto weight_of = [&](std::size_t mode) {
    typename Native<R>::Values weight;
    __builtin_memcpy(&weight, weights[mode] + at, sizeof weight);
    return weight;
  };
  known = weight_of(0) > R(0);
  Sums<R> result = Symmetry::sums(job.modes.coefficients, variables_of_ray);
  for (std::size_t k = 1; k < job.modes.count; ++k) {
    const auto weight = weight_of(k);
    const Sums<R> found = Symmetry::sums(job.modes.coefficients + Symmetry::coefficients * k, variables_of_ray);
    result.first += weight * found.first;
    result.second += weight * found.second;
    result.third += weight * found.third;
    result.fourth += weight * found.fourth;
  }
  return result;
}

/// Maps as many rays as there are lanes.
template <class Symmetry, class R>
PETZVAL_INLINE void map_lanes(const ToSceneJob<R>& job, std::size_t o, const ModeWeights<R>& weights) noexcept {
  using Values = typename Native<R>::Values;
  const auto load = [&](const R* from) {
    Values v;
    __builtin_memcpy(&v, from + o, sizeof v);
    return v;
  };
  const Scales<R>& scales = job.scales;
  const Values film_x = load(job.lines.film_x), film_y = load(job.lines.film_y);
  const FilmAndPupil<Values> film_and_pupil =
      in_domain<R, Values>(scales, {film_x, film_y, load(job.lines.pupil_x), load(job.lines.pupil_y)});
  const Variables<Symmetry, R> variables = Symmetry::variables(film_and_pupil);
  typename Native<R>::Bits inside = (film_and_pupil.film_square() <= static_cast<R>(within_domain)) &
                                    (film_and_pupil.pupil_square() <= static_cast<R>(within_domain));

  Sums<R> sums{};
  if (job.wavelengths.each_nm) {
    typename Native<R>::Bits known;
    sums = mode_sums<Symmetry, R>(job, weights, o % lens_detail::look_up_block, variables, known);
    inside &= known;
  } else if (const std::uint16_t* const each = job.wavelengths.each) {
    typename Native<R>::Bits known;
    if constexpr (Symmetry::same_bits && core_detail::permuted<R> != 0) {
      sums = job.fits <= core_detail::permuted<R> ? permuted_sums<Symmetry, R>(job, each + o, variables, known)
                                                  : mixed_sums<Symmetry, R>(job, each + o, variables, known);
    } else {
      sums = mixed_sums<Symmetry, R>(job, each + o, variables, known);
    }
    inside &= known;
  } else if (const std::size_t all = job.wavelengths.all.position(job.primary); all < job.fits) {
    sums = Symmetry::sums(job.coefficients + static_cast<std::ptrdiff_t>(all) * Symmetry::coefficients, variables);
  } else {
    inside = inside != inside;
  }
  const LocalRay<Values> found = out_of_chart<R>(Symmetry::line(sums, film_and_pupil));
  const auto store = [&](R* to, const Values& ray, R otherwise) {
    const Values result = inside ? ray : Values{} + otherwise;
    __builtin_memcpy(to + o, &result, sizeof result);
  };
  store(job.rays.x, found.x, 0);
  store(job.rays.y, found.y, 0);
  store(job.rays.z, found.z + scales.reference_z, scales.reference_z);
  store(job.rays.dx, found.dx, 0);
  store(job.rays.dy, found.dy, 0);
  store(job.rays.dz, found.dz, -1);

  static_assert(sizeof(RayFate) == 1 && static_cast<int>(RayFate::transmitted) == 0);
  const auto fates =
      __builtin_convertvector(~inside & static_cast<int>(RayFate::outside_fit), typename Native<R>::Bytes);
  __builtin_memcpy(job.fates + o, &fates, sizeof fates);
}

/// Maps a number of rays that fills all lanes. Not inlined: all rays then run through the same code, in which the
/// compiler decided once which of two products is fused.
template <class Symmetry, class R>
__attribute__((noinline)) void map_whole(const ToSceneJob<R>& job) noexcept {
  constexpr std::size_t lanes = lane_count<R>, block = lens_detail::look_up_block;
  ModeWeights<R> weights;
  for (std::size_t begin = 0; begin < job.count; begin += block) {
    const std::size_t end = job.count - begin < block ? job.count : begin + block;
    if (job.wavelengths.each_nm) {
      lens_detail::look_up(job.modes.weights, job.wavelengths, begin, end - begin, weights, job.modes.count);
    }
    for (std::size_t o = begin; o < end; o += lanes) map_lanes<Symmetry>(job, o, weights);
  }
}

/// Fills unused lanes with copies of the first remaining ray.
template <class Symmetry, class R>
void to_scene(const ToSceneJob<R>& job) noexcept {
  constexpr std::size_t lanes = lane_count<R>;
  ToSceneJob<R> job_part = job;
  job_part.count = job.count - job.count % lanes;
  map_whole<Symmetry>(job_part);
  const std::size_t o = job_part.count, rest = job.count - o;
  if (rest == 0) return;
  R in[4][lanes], out[6][lanes];
  std::uint16_t each[lanes];
  float each_nm[lanes];
  RayFate fates[lanes];
  const auto fill = [&](const auto* from, auto& to) {
    for (std::size_t l = 0; l < lanes; ++l) to[l] = from[o + (l < rest ? l : 0)];
  };
  fill(job.lines.film_x, in[0]), fill(job.lines.film_y, in[1]);
  fill(job.lines.pupil_x, in[2]), fill(job.lines.pupil_y, in[3]);
  if (job.wavelengths.each) {
    fill(job.wavelengths.each, each);
    job_part.wavelengths.each = each;
  }
  if (job.wavelengths.each_nm) {
    fill(job.wavelengths.each_nm, each_nm);
    job_part.wavelengths.each_nm = each_nm;
  }
  job_part.count = lanes;
  job_part.lines = {in[0], in[1], in[2], in[3]};
  job_part.rays = {out[0], out[1], out[2], out[3], out[4], out[5]};
  job_part.fates = fates;
  map_whole<Symmetry>(job_part);
  R* const to[] = {job.rays.x, job.rays.y, job.rays.z, job.rays.dx, job.rays.dy, job.rays.dz};
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t l = 0; l < rest; ++l) to[k][o + l] = out[k][l];
  }
  for (std::size_t l = 0; l < rest; ++l) job.fates[o + l] = fates[l];
}

template <class Symmetry>
RayFate one_to_scene(const double* coefficients, const Scales<double>& scales, const TwoPlaneRay& line,
                     Ray<double>& ray) noexcept {
  const auto film_and_pupil = in_domain<double, double>(scales, {line.film_x, line.film_y, line.pupil_x, line.pupil_y});
  const bool inside = film_and_pupil.film_square() <= within_domain && film_and_pupil.pupil_square() <= within_domain;
  LocalRay<double> found{0, 0, 0, 0, 0, -1};
  const bool fitted = inside && coefficients;
  if (fitted)
    found = out_of_chart<double>(
        Symmetry::line(Symmetry::sums(coefficients, Symmetry::variables(film_and_pupil)), film_and_pupil));
  auto& [o, d] = ray;
  o.x = found.x, o.y = found.y, o.z = found.z + scales.reference_z;
  d.x = found.dx, d.y = found.dy, d.z = found.dz;
  return fitted ? RayFate::transmitted : RayFate::outside_fit;
}

constexpr OneToScene one = by_symmetry_and_degree([]<class Symmetry>(Symmetry) { return one_to_scene<Symmetry>; });

template <class R>
constexpr ToSceneLoops<R> loops = by_symmetry_and_degree([]<class Symmetry>(Symmetry) {
  return to_scene<Symmetry, R>;
});

}  // namespace

extern const PolynomialLoops PETZVAL_LOOPS;
const PolynomialLoops PETZVAL_LOOPS{loops<float>, loops<double>, one};

}  // namespace petzval::polynomial_detail
