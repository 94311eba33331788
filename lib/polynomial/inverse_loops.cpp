// SPDX-License-Identifier: Apache-2.0
// Newton's method on lanes for the inverse of polynomials, compiled once for each instruction set.
#include "core/lanes.hpp"
#include "inverse.hpp"
#include "loops.hpp"

namespace petzval::polynomial_detail {
namespace {

using V = core_detail::Lanes<double>;

/// Newton's iteration with full steps. Returns the lanes that converged, inside or outside the domain.
template <int n>
auto converge(const double* coefficients, const Four<V>& line, Four<V>& x) noexcept {
  const V none(0.0), one(1.0);
  Four<V> value;
  Slopes<V> slope;
  auto active = none < one, done = one < none;
  V last(1e300);
  constexpr int max_iterations = 12;  // iterations that converge take three or four steps
  for (int i = 0; i < max_iterations && any(active); ++i) {
    evaluate(OfRevolution<n>{}, coefficients, x, value, slope);
    const Four<V> move =
        solution(slope, Four<V>{line[0] - value[0], line[1] - value[1], line[2] - value[2], line[3] - value[3]});
    for (std::size_t k = 0; k < 4; ++k) x[k] = select(active, x[k] + move[k], x[k]);
    const V length = sqrt((move[0] * move[0] + move[1] * move[1]) + (move[2] * move[2] + move[3] * move[3]));
    active = active & within(x, divergence_square);
    const auto halved = length < last * V(0.5), stands = length < V(rounding);
    done = done | (active & (length < V(converged_step))) | without(active & stands, halved);
    active = without(active & halved, done);
    last = length;
  }
  return done;
}

template <int n>
void invert(const double* coefficients, const InverseColumns& target, InverseColumns& at,
            std::array<double, inverse_block>& found) noexcept {
  const V none(0.0), one(1.0);
  for (std::size_t o = 0; o < inverse_block; o += V::width) {
    const auto at_o = [o](const std::array<double, inverse_block>& from) { return core_detail::load(from.data() + o); };
    const Four<V> line{at_o(target[0]), at_o(target[1]), at_o(target[2]), at_o(target[3])};
    Four<V> x = chief(OfRevolution<n>{}, coefficients, line);
    const auto done = converge<n>(coefficients, line, x);
    auto lit = done & within(x, within_domain), lost = one < none;
    if (any(without(none < one, lit))) {
      Four<V> y{none, none, none, none};
      const auto again = converge<n>(coefficients, line, y);
      const auto second = without(again & within(y, within_domain), lit);
      for (std::size_t k = 0; k < 4; ++k) x[k] = select(second, y[k], x[k]);
      lit = lit | second;
      lost = without(done & again, lit);
    }
    for (std::size_t k = 0; k < 4; ++k) store(at[k].data() + o, x[k]);
    store(found.data() + o, select(lit, one, select(lost, -one, none)));
  }
}

}  // namespace

const InverseLoops PETZVAL_LOOPS{invert<1>, invert<2>, invert<3>, invert<4>, invert<5>};

}  // namespace petzval::polynomial_detail
