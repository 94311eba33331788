// SPDX-License-Identifier: Apache-2.0
// Compiled once for each instruction set; PETZVAL_LOOPS names the result. A result depends only on its own line: the
// rest of a batch that does not fill a register uses the same vector code, and sum_of_products() and Horner's rule
// leave a compiler no choice of products to fuse.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/lanes.hpp"
#include "inverse.hpp"
#include "lens/look_up.hpp"
#include "loops.hpp"
#include "sums.hpp"

namespace petzval::polynomial_detail {
namespace {

using core_detail::Lanes;
using core_detail::load;
using core_detail::Native;

static_assert(OfMirrors<degree_count>::coefficients == most_coefficients);

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
  PETZVAL_INLINE Lanes<R> operator[](int) const noexcept { return core_detail::permute<2>(rows, indices); }
};

using HalfPositions = std::uint16_t __attribute__((vector_size(core_detail::lane_bytes / 4)));

/// Wavelengths of a batch: one for all rays, or a position or a number in nm for each ray.
enum class By { batch, position, nm };

/// Maps lines.
template <class Symmetry, class R, By wavelengths>
struct ToScene {
  static constexpr std::size_t inputs = 4, outputs = Symmetry::outputs;
  using V = Lanes<R>;
  using Variables = typename Symmetry::template Variables<V>;
  using Sums = std::array<V, Symmetry::sum_count>;
  using Bits = typename Native<R>::Bits;
  using Positions = std::conditional_t<sizeof(R) == 4, lens_detail::Positions, HalfPositions>;
  static constexpr std::size_t block = lens_detail::look_up_block;
  const Job<R>& job;
  R weights[wavelengths == By::nm ? most_modes : 1][block];  ///< of modes, for a block of rays

  explicit ToScene(const Job<R>& of) noexcept : job(of) {}

  /// Adds the sums of a fit or a mode, multiplied by a weight for each lane.
  static PETZVAL_INLINE void add(const R* coefficients, const V& weight, const Variables& variables,
                                 Sums& sums) noexcept {
    const Sums added = Symmetry::sums(coefficients, variables);
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] = sums[k] + weight * added[k];
  }

  // Sums of the lanes from ray `o` on. Lanes without a fit are removed from `inside`.

  PETZVAL_INLINE Sums by_nm(std::size_t o, const Variables& variables, core_detail::Mask<R>& inside) noexcept {
    const std::size_t in_block = o % block, left = job.count - o;
    if (in_block == 0) {
      lens_detail::look_up(job.modes.weights, job.wavelengths, o, left < block ? left : block, weights,
                           job.modes.count);
    }
    inside = all_of(inside, load(weights[0] + in_block) > V(0));
    Sums result{};
    for (std::size_t k = 0; k < job.modes.count; ++k) {
      add(job.modes.coefficients + k * Symmetry::coefficients, load(weights[k] + in_block), variables, result);
    }
    return result;
  }

  PETZVAL_INLINE Sums by_position(std::size_t o, const Variables& variables,
                                  core_detail::Mask<R>& inside) const noexcept {
    const std::uint16_t* const each = job.wavelengths.each + o;
    // Converted in one operation: stores of single elements would stall the load that follows.
    Positions positions;
    std::memcpy(&positions, each, sizeof positions);
    const Bits indices = __builtin_convertvector(positions, Bits);
    const V own = __builtin_convertvector(indices, typename V::Values);
    inside = all_of(inside, own < V(static_cast<R>(job.fits)));
    if constexpr (core_detail::permuted<R> != 0) {
      if (job.fits <= core_detail::permuted<R>) {
        return Symmetry::sums(CoefficientsByLane<R>{job.rows, job.row_length, indices}, variables);
      }
    }
    // All lanes are evaluated at each wavelength that occurs.
    Sums result{};
    for (int l = 0; l < V::width; ++l) {
      bool is_new = each[l] < job.fits;
      for (int k = 0; k < l; ++k) is_new &= each[k] != each[l];
      if (!is_new) continue;
      const V at(static_cast<R>(each[l]));
      add(job.coefficients + std::size_t{each[l]} * Symmetry::coefficients,
          select(all_of(own >= at, own <= at), V(1), V(0)), variables, result);
    }
    return result;
  }

  PETZVAL_INLINE auto operator()(std::size_t o, const Four<V>& line) noexcept {
    return map<Symmetry>(job.scales, line, [&](const auto& variables, core_detail::Mask<R>& inside) {
      if constexpr (wavelengths == By::nm) return by_nm(o, variables, inside);
      if constexpr (wavelengths == By::position) return by_position(o, variables, inside);
      if constexpr (wavelengths == By::batch) return Symmetry::sums(job.coefficients, variables);
    });
  }
};

/// Maps rays to lines.
template <class Symmetry>
struct ToFilm {
  static constexpr std::size_t inputs = 6, outputs = 4;
  const Job<double>& job;

  PETZVAL_INLINE auto operator()(std::size_t, const LocalRay<Lanes<double>>& ray) const noexcept {
    return to_film(Symmetry{}, job.scales, job.coefficients, ray);
  }
};

/// Maps a number of rays that fills all lanes. Not inlined: all rays then run through the same code.
template <class Rule, class R>
__attribute__((noinline)) void map_lanes(const Job<R>& job) noexcept {
  using V = Lanes<R>;
  Rule rule{job};
  for (std::size_t o = 0; o < job.count; o += V::width) {
    std::array<V, Rule::inputs> numbers;
    for (std::size_t k = 0; k < Rule::inputs; ++k) numbers[k] = load(job.in[k] + o);
    const auto [inside, out] = rule(o, numbers);
    for (std::size_t k = 0; k < Rule::outputs; ++k) store(job.out[k] + o, out[k]);
    if constexpr (Rule::outputs == 1) continue;
    static_assert(sizeof(RayFate) == 1 && static_cast<int>(RayFate::transmitted) == 0);
    typename Native<R>::Bits fates = {};
    fates += static_cast<typename Native<R>::Bit>(RayFate::outside_fit);
    core_detail::keep(fates, inside, typename Native<R>::Bits{});
    const auto bytes = __builtin_convertvector(fates, typename Native<R>::Bytes);
    std::memcpy(job.fates + o, &bytes, sizeof bytes);
  }
}

/// Maps all rays. Unused lanes hold copies of the first remaining ray.
template <std::size_t inputs, std::size_t outputs, class R>
void map_rays(const Job<R>& job, void (*map_whole)(const Job<R>&) noexcept) noexcept {
  constexpr std::size_t lanes = Lanes<R>::width;
  Job<R> part = job;
  const std::size_t rest = job.count % lanes, o = job.count - rest;
  part.count = o;
  if (o > 0) map_whole(part);
  if (rest == 0) return;
  R in[inputs][lanes], out[outputs][lanes];
  std::uint16_t each[lanes];
  float each_nm[lanes];
  RayFate fates[lanes];
  const auto fill = [&]<class T>(const T*& from, T(&to)[lanes]) {
    if (!from) return;
    for (std::size_t l = 0; l < lanes; ++l) to[l] = from[o + (l < rest ? l : 0)];
    from = to;
  };
  for (std::size_t k = 0; k < inputs; ++k) fill(part.in[k], in[k]);
  for (std::size_t k = 0; k < outputs; ++k) part.out[k] = out[k];
  fill(part.wavelengths.each, each), fill(part.wavelengths.each_nm, each_nm);
  part.count = lanes;
  part.fates = fates;
  map_whole(part);
  for (std::size_t l = 0; l < rest; ++l) {
    for (std::size_t k = 0; k < outputs; ++k) job.out[k][o + l] = out[k][l];
    if constexpr (outputs > 1) job.fates[o + l] = fates[l];
  }
}

template <class Symmetry, class R>
void to_scene(const Job<R>& job) noexcept {
  map_rays<4, Symmetry::outputs>(job, job.wavelengths.each_nm ? map_lanes<ToScene<Symmetry, R, By::nm>, R>
                                      : job.wavelengths.each  ? map_lanes<ToScene<Symmetry, R, By::position>, R>
                                                              : map_lanes<ToScene<Symmetry, R, By::batch>, R>);
}

template <class Symmetry>
void to_film(const Job<double>& job) noexcept {
  map_rays<6, 4>(job, map_lanes<ToFilm<Symmetry>, double>);
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
constexpr auto to_scene_by = []<class Symmetry>(Symmetry) { return to_scene<Symmetry, R>; };

}  // namespace

extern const PolynomialLoops PETZVAL_LOOPS;
const PolynomialLoops PETZVAL_LOOPS{
    {by_symmetry_and_degree(to_scene_by<float>), by_symmetry_and_degree(to_scene_by<double>)},
    {by_transmittance(to_scene_by<float>), by_transmittance(to_scene_by<double>)},
    by_symmetry_and_degree([]<class Symmetry>(Symmetry) { return one_to_scene<Symmetry>; }),
    by_symmetry_and_degree([]<class Symmetry>(Symmetry) { return to_film<Symmetry>; })};

}  // namespace petzval::polynomial_detail
