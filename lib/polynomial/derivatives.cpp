// SPDX-License-Identifier: Apache-2.0

#include "core/dual.hpp"
#include "data.hpp"
#include "sums.hpp"

namespace petzval {
namespace {

using kernel::Dual;

using polynomial_detail::ChartLine;
using Place = polynomial_detail::FilmAndPupil<Dual>;

using Evaluate = ChartLine<Dual> (*)(const double*, const Place&);
constexpr auto evaluators = polynomial_detail::by_symmetry_and_degree([]<class Symmetry>(Symmetry) -> Evaluate {
  return
      [](const double* c, const Place& at) { return Symmetry::line(Symmetry::sums(c, Symmetry::variables(at)), at); };
});

}  // namespace

RayDerivatives RayPolynomial::to_scene(const TwoPlaneRayDerivatives& line, Wavelength at) const noexcept {
  Data::Room<double> room;
  const double* coefficients = data_->coefficients(at, room);
  const Domain& domain = data_->domain;
  RayDerivatives result{RayFate::outside_fit, {{0, 0, domain.reference_z}, {0, 0, -1}}};
  if (!coefficients) return result;
  const auto jet = [&](double TwoPlaneRay::*part, double scale) {
    Dual x(line.line.*part * scale);
    x.v[0] = line.by_u.*part * scale;
    x.v[1] = line.by_v.*part * scale;
    return x;
  };
  const auto pupil = [&](double TwoPlaneRay::*part, const Dual& film, const Domain::Section& section) {
    const double per_pupil = 1 / section.pupil_radius;
    return jet(part, per_pupil) + Dual(-section.pupil_shift * domain.film_radius * per_pupil) * film;
  };
  const auto [along_x, along_y] = polynomial_detail::sections(domain);
  const double per_film = 1 / domain.film_radius;
  const Dual fx = jet(&TwoPlaneRay::film_x, per_film), fy = jet(&TwoPlaneRay::film_y, per_film);
  const Place place{fx, fy, pupil(&TwoPlaneRay::pupil_x, fx, along_x), pupil(&TwoPlaneRay::pupil_y, fy, along_y)};
  if (!(fx.a * fx.a + fy.a * fy.a <= polynomial_detail::within_domain &&
        place.px.a * place.px.a + place.py.a * place.py.a <= polynomial_detail::within_domain))
    return result;

  const ChartLine<Dual> chart = evaluators[data_->loop()](coefficients, place);
  const auto [x, y, along, dx, dy, dz] = polynomial_detail::out_of_chart<double>(chart);
  const Dual z = along + domain.reference_z;
  const auto part = [&, x = x, y = y, dx = dx, dy = dy, dz = dz](int k) -> Ray<double> {
    return {{x.v[k], y.v[k], z.v[k]}, {dx.v[k], dy.v[k], dz.v[k]}};
  };
  return {RayFate::transmitted, {{x.a, y.a, z.a}, {dx.a, dy.a, dz.a}}, part(0), part(1)};
}

}  // namespace petzval
