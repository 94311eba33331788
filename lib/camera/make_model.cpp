// SPDX-License-Identifier: Apache-2.0
#include "make_model.hpp"

#include <string>

#include "camera/polynomial_model.hpp"
#include "exact_model.hpp"
#include "paraxial_model.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace camera_detail {

FilmPupilTable behind(const PupilRim& rim, const FilmPupilTable& pupils, const Lens& lens) {
  try {
    return pupils.clipped_by_rim(rim);
  } catch (const Error& error) {
    throw Error(lens.name() + ": " + error.what());
  }
}

std::shared_ptr<const RayModel> make_model(ModelKind model, const LensFacts& facts, double film_radius, int threads,
                                           const std::optional<PupilRim>& rim, bool paraxial_focus) {
  const auto behind_rim = [&](const FilmPupilTable& pupils) {
    return rim ? behind(*rim, pupils, facts.lens()) : pupils;
  };
  if (model.is_first_order()) return std::make_shared<ParaxialModel>(model, facts, film_radius, rim, paraxial_focus);
  if (model.is_polynomial()) {
    FilmPupilTable pupils = FilmPupilTable::equal_area(facts.lens(), film_radius, threads);
    return std::make_shared<PolynomialModel>(RayPolynomial::fit(facts.lens(), pupils, model.degree()),
                                             behind_rim(pupils));
  }
  const auto enclosing = [&] { return behind_rim(FilmPupilTable::enclosing(facts.lens(), film_radius, threads)); };
  if (model == ModelKind::exact_float) return std::make_shared<ExactModel<float>>(facts.lens(), enclosing());
  return std::make_shared<ExactModel<double>>(facts.lens(), enclosing());
}

}  // namespace camera_detail

}  // namespace petzval
