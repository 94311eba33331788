// SPDX-License-Identifier: Apache-2.0

#include "core/dual.hpp"
#include "data.hpp"
#include "sums.hpp"

namespace petzval {
namespace {

using kernel::Dual;

using polynomial_detail::ChartLine;
using DualPoint = polynomial_detail::FilmAndPupil<Dual>;

using Evaluate = ChartLine<Dual> (*)(const double*, const DualPoint&);
constexpr auto evaluators = polynomial_detail::by_symmetry_and_degree([]<class Symmetry>(Symmetry) -> Evaluate {
  return [](const double* c, const DualPoint& at) {
    return Symmetry::line(Symmetry::sums(c, Symmetry::variables(at)), at);
  };
});

}  // namespace

RayDerivatives RayPolynomial::to_scene(const TwoPlaneRayDerivatives& line, Wavelength at) const noexcept {
  Data::CoefficientBuffer<double> buffer;
  const double* coefficients = data_->coefficients(at, buffer);
  const Domain& domain = data_->domain;
  RayDerivatives result{RayFate::outside_fit, {{0, 0, domain.reference_z}, {0, 0, -1}}};
  if (!coefficients) return result;
  const auto jet = [&](double TwoPlaneRay::*component, double scale) {
    Dual x(line.line.*component * scale);
    x.v[0] = line.by_u.*component * scale;
    x.v[1] = line.by_v.*component * scale;
    return x;
  };
  const auto pupil = [&](double TwoPlaneRay::*component, const Dual& film, const Domain::Section& section) {
    const double per_pupil = 1 / section.pupil_radius;
    return jet(component, per_pupil) + Dual(-section.pupil_shift * domain.film_radius * per_pupil) * film;
  };
  const auto [along_x, along_y] = polynomial_detail::sections(domain);
  const double per_film = 1 / domain.film_radius;
  const Dual fx = jet(&TwoPlaneRay::film_x, per_film), fy = jet(&TwoPlaneRay::film_y, per_film);
  const DualPoint film_and_pupil{fx, fy, pupil(&TwoPlaneRay::pupil_x, fx, along_x),
                                 pupil(&TwoPlaneRay::pupil_y, fy, along_y)};
  if (!(fx.a * fx.a + fy.a * fy.a <= polynomial_detail::within_domain &&
        film_and_pupil.px.a * film_and_pupil.px.a + film_and_pupil.py.a * film_and_pupil.py.a <=
            polynomial_detail::within_domain))
    return result;

  const ChartLine<Dual> chart = evaluators[data_->loop()](coefficients, film_and_pupil);
  const auto [x, y, along, dx, dy, dz] = polynomial_detail::out_of_chart<double>(chart);
  const Dual z = along + domain.reference_z;
  const auto component = [&, x = x, y = y, dx = dx, dy = dy, dz = dz](int k) -> Ray<double> {
    return {{x.v[k], y.v[k], z.v[k]}, {dx.v[k], dy.v[k], dz.v[k]}};
  };
  return {RayFate::transmitted, {{x.a, y.a, z.a}, {dx.a, dy.a, dz.a}}, component(0), component(1)};
}

}  // namespace petzval
