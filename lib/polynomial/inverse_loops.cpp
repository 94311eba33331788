// SPDX-License-Identifier: Apache-2.0
// Newton's method on lanes for the inverse of polynomials, compiled once for each instruction set.
#include "inverse.hpp"
#include "loops.hpp"
#include "trace/lanes.hpp"

namespace petzval::polynomial_detail {
namespace {

using V = trace_detail::Lanes<double>;

template <int n>
void invert(const double* coefficients, const InverseColumns& wanted, InverseColumns& at,
            std::array<double, inverse_block>& found) noexcept {
  using Symmetry = OfRevolution<n>;
  const V none(0.0), one(1.0);
  for (std::size_t o = 0; o < inverse_block; o += V::width) {
    const auto load = [o](const std::array<double, inverse_block>& from) {
      V v;
      __builtin_memcpy(&v.v, from.data() + o, sizeof v.v);
      return v;
    };
    const auto store = [o](const V& v, std::array<double, inverse_block>& to) {
      __builtin_memcpy(to.data() + o, &v.v, sizeof v.v);
    };
    const Four<V> line{load(wanted[0]), load(wanted[1]), load(wanted[2]), load(wanted[3])};
    Four<V> x = chief(Symmetry{}, coefficients, line), value;
    Slopes<V> slope;
    auto active = none < one, done = one < none;
    V last(1e300);
    constexpr int most = 12;  // iterations; converging ones take three or four
    for (int i = 0; i < most; ++i) {
      evaluate(Symmetry{}, coefficients, x, value, slope);
      const Four<V> move =
          solution(slope, Four<V>{line[0] - value[0], line[1] - value[1], line[2] - value[2], line[3] - value[3]});
      for (std::size_t k = 0; k < 4; ++k) x[k] = select(active, x[k] + move[k], x[k]);
      const V length = sqrt((move[0] * move[0] + move[1] * move[1]) + (move[2] * move[2] + move[3] * move[3]));
      active = active & within(x, far_square);
      const auto halved = length < last * V(0.5), stands = length < V(rounding);
      done = done | (active & (length < V(settled))) | without(active & stands, halved);
      active = without(active & halved, done);
      if (!any(active)) break;
      last = length;
    }
    for (std::size_t k = 0; k < 4; ++k) store(x[k], at[k]);
    store(select(done & within(x, within_domain), one, none), found);
  }
}

}  // namespace

const InverseLoops PETZVAL_LOOPS{invert<1>, invert<2>, invert<3>, invert<4>, invert<5>};

}  // namespace petzval::polynomial_detail
