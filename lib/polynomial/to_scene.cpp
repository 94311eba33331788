// SPDX-License-Identifier: Apache-2.0
// Compiled once for each instruction set; PETZVAL_LOOPS names the result. A result depends only on its own line: the
// rest of a batch that does not fill a register uses the same vector code, and sum_of_products() and Horner's rule
// leave a compiler no choice of products to fuse.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/lanes.hpp"
#include "lens/look_up.hpp"
#include "loops.hpp"
#include "sums.hpp"

namespace petzval::polynomial_detail {
namespace {

using core_detail::Lanes;
using core_detail::Native;

template <class Symmetry, class R>
using Variables = typename Symmetry::template Variables<Lanes<R>>;
template <class Symmetry, class R>
using Sums = std::array<Lanes<R>, Symmetry::sum_count>;
template <class R>
using Bits = typename Native<R>::Bits;

static_assert(OfMirrors<degree_count>::coefficients == most_coefficients);

/// Adds the sums of a fit or a mode, multiplied by a weight for each lane.
template <class Symmetry, class R>
PETZVAL_INLINE void add_sums(const R* coefficients, Lanes<R> weight, const Variables<Symmetry, R>& variables,
                             Sums<Symmetry, R>& sums) noexcept {
  const Sums<Symmetry, R> added = Symmetry::sums(coefficients, variables);
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] = sums[k] + weight * added[k];
}

/// Coefficients of each lane's own wavelength, read like a pointer to the coefficients of one wavelength. Rows always
/// have two registers, because the code for one register is slower.
template <class R>
struct CoefficientsByLane {
  const R* rows;
  std::size_t length;
  Bits<R> indices;

  PETZVAL_INLINE CoefficientsByLane operator+(int coefficients) const noexcept {
    return {rows + static_cast<std::ptrdiff_t>(length) * coefficients, length, indices};
  }
  PETZVAL_INLINE Lanes<R> operator[](int) const noexcept { return core_detail::permute<2>(rows, indices); }
};

// The wavelengths of a batch give the sums of the lanes from ray `o` on and remove lanes without a fit from `inside`.

/// One position for each ray.
template <class Symmetry, class R>
struct WavelengthsByPosition {
  using V = Lanes<R>;
  using HalfPositions = std::uint16_t __attribute__((vector_size(core_detail::lane_bytes / 4)));
  using Positions = std::conditional_t<sizeof(R) == 4, lens_detail::Positions, HalfPositions>;
  const Job<R>& job;

  PETZVAL_INLINE Sums<Symmetry, R> sums(std::size_t o, const Variables<Symmetry, R>& variables,
                                        core_detail::Mask<R>& inside) noexcept {
    const std::uint16_t* const each = job.wavelengths.each + o;
    // Converted in one operation: stores of single elements would stall the load that follows.
    Positions positions;
    __builtin_memcpy(&positions, each, sizeof positions);
    const Bits<R> indices = __builtin_convertvector(positions, Bits<R>);
    const V own = __builtin_convertvector(indices, typename V::Values);
    inside = all_of(inside, own < V(static_cast<R>(job.fits)));
    if constexpr (core_detail::permuted<R> != 0) {
      if (job.fits <= core_detail::permuted<R>) {
        return Symmetry::sums(CoefficientsByLane<R>{job.rows, job.row_length, indices}, variables);
      }
    }
    // All lanes are evaluated at each wavelength that occurs.
    Sums<Symmetry, R> result{};
    for (int l = 0; l < V::width; ++l) {
      bool is_new = each[l] < job.fits;
      for (int k = 0; k < l; ++k) is_new &= each[k] != each[l];
      if (!is_new) continue;
      const V at(static_cast<R>(each[l])), none(R(0));
      add_sums<Symmetry>(job.coefficients + std::size_t{each[l]} * Symmetry::coefficients,
                         select(all_of(own >= at, own <= at), V(R(1)), none), variables, result);
    }
    return result;
  }
};

/// One wavelength in nm for each ray.
template <class Symmetry, class R>
struct WavelengthsInNm {
  using V = Lanes<R>;
  const Job<R>& job;
  R weights[most_modes][lens_detail::look_up_block];  ///< of modes, for a block of rays

  PETZVAL_INLINE Sums<Symmetry, R> sums(std::size_t o, const Variables<Symmetry, R>& variables,
                                        core_detail::Mask<R>& inside) noexcept {
    const std::size_t in_block = o % lens_detail::look_up_block, left = job.count - o;
    if (in_block == 0) {
      lens_detail::look_up(job.modes.weights, job.wavelengths, o,
                           left < lens_detail::look_up_block ? left : lens_detail::look_up_block, weights,
                           job.modes.count);
    }
    inside = all_of(inside, core_detail::load(weights[0] + in_block) > V(R(0)));
    Sums<Symmetry, R> result{};
    for (std::size_t k = 0; k < job.modes.count; ++k) {
      add_sums<Symmetry>(job.modes.coefficients + Symmetry::coefficients * k, core_detail::load(weights[k] + in_block),
                         variables, result);
    }
    return result;
  }
};

/// Maps a number of rays that fills all lanes. Not inlined: all rays then run through the same code.
/// @param by the coefficients of all rays, or one of the types above
template <class Symmetry, class R, class By>
__attribute__((noinline)) void map_lanes(const Job<R>& job, By& by) noexcept {
  using V = Lanes<R>;
  for (std::size_t o = 0; o < job.count; o += V::width) {
    const auto from = [&](int k) { return core_detail::load(job.lines[k] + o); };
    const Four<V> line{from(0), from(1), from(2), from(3)};
    const auto [inside, out] = [&] {
      if constexpr (std::is_pointer_v<By>) {
        return map<Symmetry>(job.scales, line, by);
      } else {
        return map<Symmetry>(job.scales, line, [&](const auto& variables, core_detail::Mask<R>& known) {
          return by.sums(o, variables, known);
        });
      }
    }();
    for (std::size_t k = 0; k < out.size(); ++k) core_detail::store(job.out[k] + o, out[k]);
    if constexpr (Symmetry::outputs == 1) continue;
    static_assert(sizeof(RayFate) == 1 && static_cast<int>(RayFate::transmitted) == 0);
    Bits<R> fates = Bits<R>{} + static_cast<typename Native<R>::Bit>(RayFate::outside_fit);
    core_detail::keep(fates, inside, Bits<R>{});
    const auto bytes = __builtin_convertvector(fates, typename Native<R>::Bytes);
    __builtin_memcpy(job.fates + o, &bytes, sizeof bytes);
  }
}

template <class Symmetry, class R>
void map_whole(const Job<R>& job) noexcept {
  if (job.wavelengths.each_nm) {
    WavelengthsInNm<Symmetry, R> by{job, {}};
    map_lanes<Symmetry>(job, by);
  } else if (job.wavelengths.each) {
    WavelengthsByPosition<Symmetry, R> by{job};
    map_lanes<Symmetry>(job, by);
  } else {
    map_lanes<Symmetry>(job, job.coefficients);
  }
}

/// Fills unused lanes with copies of the first remaining ray.
template <class Symmetry, class R>
void map_all(const Job<R>& job) noexcept {
  constexpr std::size_t lanes = Lanes<R>::width;
  Job<R> part = job;
  const std::size_t rest = job.count % lanes, o = job.count - rest;
  part.count = o;
  map_whole<Symmetry>(part);
  if (rest == 0) return;
  R in[4][lanes], out[Symmetry::outputs][lanes];
  std::uint16_t each[lanes];
  float each_nm[lanes];
  RayFate fates[lanes];
  const auto fill = [&]<class T>(const T*& from, T(&to)[lanes]) {
    if (!from) return;
    for (std::size_t l = 0; l < lanes; ++l) to[l] = from[o + (l < rest ? l : 0)];
    from = to;
  };
  for (std::size_t k = 0; k < 4; ++k) fill(part.lines[k], in[k]);
  for (std::size_t k = 0; k < Symmetry::outputs; ++k) part.out[k] = out[k];
  fill(part.wavelengths.each, each), fill(part.wavelengths.each_nm, each_nm);
  part.count = lanes;
  part.fates = fates;
  map_whole<Symmetry>(part);
  for (std::size_t l = 0; l < rest; ++l) {
    for (std::size_t k = 0; k < Symmetry::outputs; ++k) job.out[k][o + l] = out[k][l];
    if constexpr (Symmetry::outputs > 1) job.fates[o + l] = fates[l];
  }
}

template <class Symmetry>
RayFate one_to_scene(const double* coefficients, const Scales<double>& scales, const TwoPlaneRay& line,
                     Ray<double>& ray) noexcept {
  const auto [inside, found] =
      map<Symmetry, double>(scales, {line.film_x, line.film_y, line.pupil_x, line.pupil_y}, coefficients);
  auto& [o, d] = ray;
  o.x = found[0], o.y = found[1], o.z = found[2];
  d.x = found[3], d.y = found[4], d.z = found[5];
  return inside ? RayFate::transmitted : RayFate::outside_fit;
}

template <class R>
constexpr auto map_each = []<class Symmetry>(Symmetry) { return map_all<Symmetry, R>; };

}  // namespace

extern const PolynomialLoops PETZVAL_LOOPS;
const PolynomialLoops PETZVAL_LOOPS{
    {by_symmetry_and_degree(map_each<float>), by_symmetry_and_degree(map_each<double>)},
    {by_transmittance(map_each<float>), by_transmittance(map_each<double>)},
    by_symmetry_and_degree([]<class Symmetry>(Symmetry) { return one_to_scene<Symmetry>; })};

}  // namespace petzval::polynomial_detail
