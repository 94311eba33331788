// SPDX-License-Identifier: Apache-2.0
// Compiled once for each instruction set; PETZVAL_LOOPS names the result. A result depends on its own line alone: the
// remainder of a batch goes through the same vectors as the rest.
#include <cstddef>
#include <cstdint>

#include "core/simd.hpp"
#include "loops.hpp"
#include "sums.hpp"

namespace petzval::inline v0::polynomial_detail {
namespace {

using core_detail::lane_count;
using core_detail::Native;

template <class R>
using Place = FilmAndPupil<typename Native<R>::Values>;
template <class R>
using Sums = FourSums<typename Native<R>::Values>;

static_assert(OfMirrors<degree_count>::coefficients == most_coefficients);

/// The sums for a wavelength for each lane: all lanes are evaluated at each wavelength that occurs, smallest first, and
/// the lanes of that wavelength are kept. known: the lanes whose wavelength has a fit.
template <class Symmetry, class R>
PETZVAL_INLINE Sums<R> mixed_sums(const ToSceneJob<R>& job, const std::uint16_t* each, std::size_t count,
                                  const Place<R>& place, typename Native<R>::Bits& known) noexcept {
  using Bit = typename Native<R>::Bit;
  constexpr std::size_t lanes = lane_count<R>;
  constexpr Bit none = 1 << 16;
  const Bit fits = job.fits < none ? static_cast<Bit>(job.fits) : none;
  Bit own[lanes];
  for (std::size_t l = 0; l < lanes; ++l) own[l] = l < count ? each[l] : none;
  const auto next = [&](Bit last) {
    Bit smallest = none;
    for (std::size_t l = 0; l < lanes; ++l) smallest = own[l] > last && own[l] < smallest ? own[l] : smallest;
    return smallest;
  };
  typename Native<R>::Bits owns;
  __builtin_memcpy(&owns, own, sizeof owns);
  known = owns < fits;
  Sums<R> result{};
  for (Bit at = next(-1); at < fits; at = next(at)) {
    const auto theirs = owns == at;
    const Sums<R> found = Symmetry::sums(job.coefficients + Symmetry::coefficients * at, place);
    result.first = theirs ? found.first : result.first;
    result.second = theirs ? found.second : result.second;
    result.third = theirs ? found.third : result.third;
    result.fourth = theirs ? found.fourth : result.fourth;
  }
  return result;
}

/// The same for lanes between the wavelengths of fits: every fit that has a weight in a lane is evaluated for all.
template <class Symmetry, class R>
PETZVAL_INLINE Sums<R> blended_sums(const ToSceneJob<R>& job, std::size_t o, std::size_t count, const Place<R>& place,
                                    typename Native<R>::Bits& known) noexcept {
  using Bit = typename Native<R>::Bit;
  constexpr std::size_t lanes = lane_count<R>;
  constexpr Bit each = 4;
  const MixedFits<R>& mixed = job.mixed;
  Bit first[lanes], lowest = static_cast<Bit>(job.fits), highest = -1;
  for (std::size_t l = 0; l < lanes; ++l) {
    first[l] = l < count ? mixed.first[o + l] : -1;
    lowest = first[l] >= 0 && first[l] < lowest ? first[l] : lowest;
    highest = first[l] > highest ? first[l] : highest;
  }
  typename Native<R>::Bits from;
  __builtin_memcpy(&from, first, sizeof from);
  known = from >= 0;
  Sums<R> result{};
  for (Bit rank = lowest; rank < highest + each && rank < static_cast<Bit>(job.fits); ++rank) {
    R weights[lanes];
    bool any = false;
    for (std::size_t l = 0; l < lanes; ++l) {
      const Bit k = rank - first[l];
      const bool has = first[l] >= 0 && k >= 0 && k < each;
      weights[l] = has ? mixed.weights[each * static_cast<Bit>(o + l) + k] : R(0);
      any |= weights[l] != R(0);
    }
    if (!any) continue;
    typename Native<R>::Values weight;
    __builtin_memcpy(&weight, weights, sizeof weight);
    const Sums<R> found = Symmetry::sums(job.coefficients + Symmetry::coefficients * mixed.positions[rank], place);
    result.first += weight * found.first;
    result.second += weight * found.second;
    result.third += weight * found.third;
    result.fourth += weight * found.fourth;
  }
  return result;
}

/// `count` rays, at most as many as there are lanes.
template <class Symmetry, class R>
PETZVAL_INLINE void map_lanes(const ToSceneJob<R>& job, std::size_t o, std::size_t count) noexcept {
  using Values = typename Native<R>::Values;
  const auto load = [&](const R* from) {
    Values v{};
    __builtin_memcpy(&v, from + o, count * sizeof(R));
    return v;
  };
  const Scales<R>& scales = job.scales;
  const Values film_x = load(job.lines.film_x), film_y = load(job.lines.film_y);
  const Place<R> place =
      in_domain<R, Values>(scales, {film_x, film_y, load(job.lines.pupil_x), load(job.lines.pupil_y)});
  typename Native<R>::Bits inside =
      (place.film_square() <= static_cast<R>(within_domain)) & (place.pupil_square() <= static_cast<R>(within_domain));

  Sums<R> sums{};
  if (job.mixed.first) {
    typename Native<R>::Bits known;
    sums = blended_sums<Symmetry, R>(job, o, count, place, known);
    inside &= known;
  } else if (job.wavelengths.each) {
    typename Native<R>::Bits known;
    sums = mixed_sums<Symmetry, R>(job, job.wavelengths.each + o, count, place, known);
    inside &= known;
  } else if (const std::size_t all = job.wavelengths.all.position(job.primary); all < job.fits) {
    sums = Symmetry::sums(job.coefficients + static_cast<std::ptrdiff_t>(all) * Symmetry::coefficients, place);
  } else {
    inside = inside != inside;
  }
  const LocalRay<Values> found = out_of_chart<R>(Symmetry::line(sums, place));
  const auto store = [&](R* to, const Values& ray, R otherwise) {
    const Values result = inside ? ray : Values{} + otherwise;
    __builtin_memcpy(to + o, &result, count * sizeof(R));
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
  __builtin_memcpy(job.fates + o, &fates, count);
}

template <class Symmetry, class R>
void to_scene(const ToSceneJob<R>& job) noexcept {
  constexpr std::size_t lanes = lane_count<R>;
  std::size_t o = 0;
  for (; o + lanes <= job.count; o += lanes) map_lanes<Symmetry>(job, o, lanes);
  if (o < job.count) map_lanes<Symmetry>(job, o, job.count - o);
}

template <class Symmetry>
RayFate one_to_scene(const double* coefficients, const Scales<double>& scales, const TwoPlaneRay& line,
                     Ray<double>& ray) noexcept {
  const auto place = in_domain<double, double>(scales, {line.film_x, line.film_y, line.pupil_x, line.pupil_y});
  const bool inside = place.film_square() <= within_domain && place.pupil_square() <= within_domain;
  LocalRay<double> found{0, 0, 0, 0, 0, -1};
  const bool fitted = inside && coefficients;
  if (fitted) found = out_of_chart<double>(Symmetry::line(Symmetry::sums(coefficients, place), place));
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

}  // namespace petzval::inline v0::polynomial_detail
