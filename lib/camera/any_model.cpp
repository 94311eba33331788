// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/any_model.hpp"

#include <type_traits>

namespace petzval::inline v0 {

AnyModel make_model(ModelKind model, const Lens& lens, double film_radius) {
  if (model == ModelKind::exact_float) return ExactModel<float>(lens, film_radius);
  if (model == ModelKind::exact_double) return ExactModel<double>(lens, film_radius);
  if (model <= ModelKind::thick) return ParaxialModel(model, lens, film_radius);
  const int degree = 3 + 2 * (static_cast<int>(model) - static_cast<int>(ModelKind::polynomial_3));
  FilmPupilTable pupils = FilmPupilTable::equal_area(lens, film_radius);
  return PolynomialModel(RayPolynomial::fit(lens, pupils, degree), pupils);
}

const FilmPupilTable& film_pupil_table_of(const AnyModel& model) noexcept {
  return std::visit([](const auto& m) -> const FilmPupilTable& { return m.pupils(); }, model);
}

ModelKind kind_of(const AnyModel& model) noexcept {
  struct Kind {
    ModelKind operator()(const ParaxialModel& m) const noexcept { return m.model(); }
    ModelKind operator()(const PolynomialModel& m) const noexcept {
      return static_cast<ModelKind>(static_cast<int>(ModelKind::polynomial_3) + (m.polynomial().degree() - 3) / 2);
    }
    ModelKind operator()(const ExactModel<float>&) const noexcept { return ModelKind::exact_float; }
    ModelKind operator()(const ExactModel<double>&) const noexcept { return ModelKind::exact_double; }
  };
  return std::visit(Kind{}, model);
}

}  // namespace petzval::inline v0
