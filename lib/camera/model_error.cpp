// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/model_error.hpp"

#include <algorithm>

#include "check_film.hpp"
#include "error_study.hpp"
#include "pupil_study.hpp"

namespace petzval::inline v0 {

ModelError model_error(const Lens& lens, const Film& film, ModelKind model, const ErrorSamples& samples) {
  const Lens placed = camera_detail::placed(lens, film).lens;
  camera_detail::check_upright_film(placed, film);
  const AnyModel built = make_model(model, placed, film.radius_mm());
  return model_errors(placed, film, std::span(&built, 1), samples).front();
}

std::vector<ModelError> model_errors(const Lens& given, const Film& film, std::span<const AnyModel> models,
                                     const ErrorSamples& samples) {
  const Lens lens = camera_detail::placed(given, film).lens;
  camera_detail::check_upright_film(lens, film);
  const ExactModel<double> exact(lens, film.radius_mm());
  const camera_detail::RayStudy rays(exact, film, samples);
  const camera_detail::PupilStudy pupils(exact, film, std::max<std::size_t>(16, samples.film_points / 8), samples);
  std::vector<ModelError> errors;
  for (const AnyModel& model : models) {
    const auto of_rays = rays.measure(camera_detail::tracing(model));
    const auto of_pupils = pupils.measure(camera_detail::pupils_of(model));
    errors.push_back({of_rays.all, of_rays.wavelength, of_pupils.shape, of_pupils.exposure});
  }
  return errors;
}

}  // namespace petzval::inline v0
