// SPDX-License-Identifier: Apache-2.0
#include "analysis/model_errors.hpp"

#include <algorithm>

#include "camera/check_film.hpp"
#include "camera/make_model.hpp"
#include "error_study.hpp"
#include "pupil_study.hpp"

namespace petzval {

namespace {

/// @param film an upright film with its position set
std::vector<ModelError> measured(const Lens& lens, const Film& film,
                                 std::span<const std::shared_ptr<const RayModel>> models, const ErrorSamples& samples) {
  const camera_detail::ExactModel<double> exact(lens, film.radius_mm());
  const analysis_detail::RayStudy rays(exact, film, samples);
  const analysis_detail::PupilStudy pupils(exact, film, std::max<std::size_t>(16, samples.film_points / 8), samples);
  const TransmissionError transmission = transmission_error(lens, film);
  std::vector<ModelError> errors;
  for (const auto& model : models) {
    const auto of_rays = rays.measure(analysis_detail::tracing(*model));
    const auto of_pupils = pupils.measure(analysis_detail::pupils_of(*model));
    errors.push_back({of_rays.all, of_rays.wavelength, of_pupils.shape, of_pupils.exposure, transmission});
  }
  return errors;
}

}  // namespace

ModelError model_error(const Lens& lens, const Film& film, ModelKind model, const ErrorSamples& samples) {
  const auto [placed_lens, placed_film] = camera_detail::placed(lens, film);
  camera_detail::check_upright_film(placed_lens, placed_film);
  const std::shared_ptr<const RayModel> built = camera_detail::make_model(model, placed_lens, film.radius_mm());
  return measured(placed_lens, placed_film, std::span(&built, 1), samples).front();
}

std::vector<ModelError> model_errors(const Lens& lens, const Film& film,
                                     std::span<const std::shared_ptr<const RayModel>> models,
                                     const ErrorSamples& samples) {
  const auto [placed_lens, placed_film] = camera_detail::placed(lens, film);
  camera_detail::check_upright_film(placed_lens, placed_film);
  return measured(placed_lens, placed_film, models, samples);
}

}  // namespace petzval
