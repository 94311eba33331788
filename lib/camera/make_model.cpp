// SPDX-License-Identifier: Apache-2.0
#include "make_model.hpp"

#include <string>

#include "exact_model.hpp"
#include "paraxial_model.hpp"
#include "petzval/camera/polynomial_model.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

constexpr int least_degree = 3, degree_step = 2;

}  // namespace

namespace camera_detail {

FilmPupilTable behind(const PupilRim& rim, const FilmPupilTable& pupils, const Lens& lens) {
  try {
    return pupils.cut_by_rim(rim);
  } catch (const Error& error) {
    throw Error(lens.name() + ": " + error.what());
  }
}

bool is_first_order(ModelKind model) noexcept {
  using enum ModelKind;
  return model == pinhole || model == thin || model == thin_two_disc || model == thick;
}

bool is_polynomial(ModelKind model) noexcept {
  return model >= ModelKind::polynomial_3 && model <= ModelKind::polynomial_11;
}

AnyRayModel make_model(ModelKind model, const LensFacts& facts, double film_radius, int threads,
                       const std::optional<PupilRim>& rim) {
  const auto behind_rim = [&](const FilmPupilTable& pupils) {
    return rim ? behind(*rim, pupils, facts.lens()) : pupils;
  };
  if (is_first_order(model)) return ParaxialModel(model, facts, film_radius, rim);
  if (is_polynomial(model)) {
    const int steps = static_cast<int>(model) - static_cast<int>(ModelKind::polynomial_3);
    FilmPupilTable pupils = FilmPupilTable::equal_area(facts.lens(), film_radius, threads);
    return PolynomialModel(RayPolynomial::fit(facts.lens(), pupils, least_degree + degree_step * steps),
                           behind_rim(pupils));
  }
  const auto enclosing = [&] { return behind_rim(FilmPupilTable::enclosing(facts.lens(), film_radius, threads)); };
  if (model == ModelKind::exact_float) return ExactModel<float>(facts.lens(), enclosing());
  if (model == ModelKind::exact_double) return ExactModel<double>(facts.lens(), enclosing());
  throw Error(facts.lens().name() + ": camera: model is " + std::string(name(model)) +
              ", wanted one of models(), or an AnyRayModel");
}

}  // namespace camera_detail

ModelKind PolynomialModel::kind() const noexcept {
  const int steps = (polynomial_.degree() - least_degree) / degree_step;
  return static_cast<ModelKind>(static_cast<int>(ModelKind::polynomial_3) + steps);
}

}  // namespace petzval
