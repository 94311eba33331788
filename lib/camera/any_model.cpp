// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/any_model.hpp"

#include <type_traits>

namespace petzval {

AnyModel make_model(Model model, const Lens& lens, double film_radius) {
  if (model == Model::exact_float) return ExactModel<float>(lens, film_radius);
  if (model == Model::exact_double) return ExactModel<double>(lens, film_radius);
  if (model <= Model::thick) return ParaxialModel(model, lens, film_radius);
  const int degree = 3 + 2 * (static_cast<int>(model) - static_cast<int>(Model::polynomial_3));
  PupilMap pupils = PupilMap::matching(lens, film_radius);
  return PolynomialModel(RayPolynomial::fit(lens, pupils, degree), pupils);
}

const PupilMap& pupil_map_of(const AnyModel& model) noexcept {
  return std::visit([](const auto& m) -> const PupilMap& { return m.pupils(); }, model);
}

Model kind_of(const AnyModel& model) noexcept {
  struct Kind {
    Model operator()(const ParaxialModel& m) const noexcept { return m.model(); }
    Model operator()(const PolynomialModel& m) const noexcept {
      return static_cast<Model>(static_cast<int>(Model::polynomial_3) + (m.polynomial().degree() - 3) / 2);
    }
    Model operator()(const ExactModel<float>&) const noexcept { return Model::exact_float; }
    Model operator()(const ExactModel<double>&) const noexcept { return Model::exact_double; }
  };
  return std::visit(Kind{}, model);
}

}  // namespace petzval
