// SPDX-License-Identifier: Apache-2.0
// Newton's method on lanes for the inverse of polynomials, compiled once for each instruction set.
#include "core/lanes.hpp"
#include "inverse.hpp"
#include "loops.hpp"

namespace petzval::polynomial_detail {
namespace {

using V = core_detail::Lanes<double>;

template <int n>
void invert(const double* coefficients, const InverseColumns& target, InverseColumns& at,
            std::array<double, inverse_block>& found) noexcept {
  constexpr OfRevolution<n> symmetry;
  const V none(0.0), one(1.0);
  for (std::size_t o = 0; o < inverse_block; o += V::width) {
    const auto at_o = [o](const std::array<double, inverse_block>& from) { return core_detail::load(from.data() + o); };
    const Four<V> line{at_o(target[0]), at_o(target[1]), at_o(target[2]), at_o(target[3])};
    const auto converge_from = [&](Four<V>& x) {
      return converge(symmetry, coefficients, line, evaluate(symmetry, coefficients, x), x);
    };
    Four<V> x = chief(symmetry, coefficients, line);
    const auto done = converge_from(x);
    auto lit = done & within(x, within_domain), lost = one < none;
    if (any(without(none < one, lit))) {
      Four<V> y{none, none, none, none};
      const auto again = converge_from(y);
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
