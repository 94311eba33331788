// SPDX-License-Identifier: Apache-2.0

#include "core/dual.hpp"
#include "data.hpp"
#include "sums.hpp"

namespace petzval {
namespace {

using kernel::Dual;
using namespace polynomial_detail;

using Map = Mapped<Dual> (*)(const Scales<double>&, const Four<Dual>& line, const double* coefficients) noexcept;
constexpr auto maps = by_symmetry_and_degree([]<class Symmetry>(Symmetry) -> Map { return map<Symmetry, Dual>; });

}  // namespace

RayDerivatives RayPolynomial::to_scene(const TwoPlaneRayDerivatives& line, Wavelength at) const noexcept {
  WavelengthFits::Buffer<double> buffer;
  const auto [coefficients, scales] = data_->by_wavelength.fitted<double>(at, buffer);
  const auto jet = [&](double TwoPlaneRay::*component) {
    return Dual(line.line.*component, {line.by_u.*component, line.by_v.*component});
  };
  const auto [inside, ray] = maps[data_->loop()](
      scales,
      {jet(&TwoPlaneRay::film_x), jet(&TwoPlaneRay::film_y), jet(&TwoPlaneRay::pupil_x), jet(&TwoPlaneRay::pupil_y)},
      coefficients);
  const auto of_ray = [&rays = ray](const auto& number) -> Ray<double> {
    return {{number(rays[0]), number(rays[1]), number(rays[2])}, {number(rays[3]), number(rays[4]), number(rays[5])}};
  };
  return {inside ? RayFate::transmitted : RayFate::outside_fit, of_ray([](const Dual& x) { return x.a; }),
          of_ray([](const Dual& x) { return x.v.x; }), of_ray([](const Dual& x) { return x.v.y; })};
}

}  // namespace petzval
