// SPDX-License-Identifier: Apache-2.0
#include "model_timing.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "camera/lens_facts.hpp"
#include "camera/sample_rays.hpp"
#include "core/low_discrepancy.hpp"
#include "error_lines.hpp"

namespace petzval::analysis_detail {
namespace {

constexpr std::size_t rays = 8192;  // 0.5 MB in float, which fits the second-level cache
constexpr int rounds = 9;

/// Samples over the whole film, and memory for the rays.
template <class T>
class Work {
 public:
  Work(const Film& film, std::size_t wavelengths)
      : film_(film), scale_(wavelengths, 1.0), values_(11 * rays), fates_(rays) {
    const core_detail::Kronecker<2> film_sequence(0), pupil(1);
    for (std::size_t i = 0; i < rays; ++i) {
      const FilmPoint point = film.point(film_sequence(i)[0] * film.columns, film_sequence(i)[1] * film.rows);
      const double sample[] = {point.x, point.y, pupil(i)[0], pupil(i)[1]};
      for (std::size_t k = 0; k < 4; ++k) values_[k * rays + i] = static_cast<T>(sample[k]);
    }
  }

  double ns_per_ray(const RayModel& model) {
    const auto at = [this](std::size_t k) { return &values_[k * rays]; };
    const CameraSamples<T> in{at(0), at(1), at(2), at(3)};
    const CameraRays<T> out{{at(4), at(5), at(6), at(7), at(8), at(9)}, at(10), fates_.data()};
    const camera_detail::WavelengthFacts facts(model, scale_);
    const auto start = std::chrono::steady_clock::now();
    camera_detail::sample_rays<T>({model, film_, nullptr, facts}, rays, in, out);
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
    return time.count() / static_cast<double>(rays);
  }

 private:
  Film film_;
  std::vector<double> scale_;
  std::vector<T> values_;
  std::vector<RayFate> fates_;
};

/// Times by tests/bench/camera_bench on an AMD EPYC (AVX2), divided by the time of a thin lens.
constexpr double two_discs = 2.5, polynomial = 2.6, polynomial_term = 0.006;
constexpr double exact_rays = 2.4, sphere = 0.28, quadric = 0.8, asphere = 1.8, double_by_float = 2.2;

}  // namespace

double cost(ModelKind model, const Lens& lens) {
  if (model.is_first_order()) return model == ModelKind::thin_two_disc ? two_discs : 1;
  if (model.is_polynomial()) {
    const int n = (model.degree() - 1) / 2, terms = 4 * (n + 1) * (n + 2) * (n + 3) / 6;
    return polynomial + polynomial_term * terms * (camera_detail::has_cylinders(lens) ? n + 2 : 1);
  }
  double sum = exact_rays;
  for (const LensSurface& s : lens.surfaces()) {
    const bool quadratic = s.curvature != 0 && (s.conic != 0 || s.curved_in != Section::both);
    sum += !s.aspheric.empty() ? asphere : quadratic ? quadric : sphere;
  }
  return model == ModelKind::exact_double ? double_by_float * sum : sum;
}

std::vector<double> time_rays(std::span<const std::shared_ptr<const RayModel>> models, const Film& film) {
  std::vector<double> best(models.size(), std::numeric_limits<double>::infinity());
  if (models.empty()) return best;
  const std::size_t wavelengths = models[0]->pupils().wavelengths();
  Work<float> in_float(film, wavelengths);
  Work<double> in_double(film, wavelengths);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < models.size(); ++k) {
      const bool exact = models[k]->kind() == ModelKind::exact_double;
      best[k] = std::min(best[k], exact ? in_double.ns_per_ray(*models[k]) : in_float.ns_per_ray(*models[k]));
    }
  }
  return best;
}

}  // namespace petzval::analysis_detail
