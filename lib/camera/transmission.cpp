// SPDX-License-Identifier: Apache-2.0
#include "transmission.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/least_squares.hpp"
#include "lens_facts.hpp"
#include "polynomial/data.hpp"
#include "polynomial/least_squares.hpp"
#include "polynomial/sums.hpp"
#include "trace/lens_light.hpp"

namespace petzval::camera_detail {
namespace {

using polynomial_detail::Lines, polynomial_detail::Rays, polynomial_detail::WavelengthFits;
using trace_detail::LensLight;

/// Error at which a degree suffices.
constexpr double tolerance = 2e-3;
/// Largest difference of coefficients between wavelengths.
constexpr double mode_tolerance = 1e-5;

constexpr auto coefficient_counts =
    polynomial_detail::by_transmittance([]<class Light>(Light) { return Eigen::Index{Light::coefficients}; });

template <class T>
auto loops_of() noexcept {
  return std::get<polynomial_detail::Loops<T, coefficient_counts.size()>>(
      polynomial_detail::polynomial_loops().transmittances);
}

/// Image-space rays of a model, and their exact transmittances; 0 for a ray that does not pass.
struct LitLines {
  Lines lines;
  std::vector<double> light;

  LitLines(const Lens& lens, const TwoPlanes& space, const LensLight& of_lens, Lines all, Wavelength wavelength)
      : lines(std::move(all)), light(lines.size()) {
    Rays rays = polynomial_detail::rays_along(lens, space, lines);
    trace_detail::trace_light<double>(lens, of_lens, rays.size(), rays.arrays<const double>(), rays.arrays<double>(),
                                      rays.fates.data(), light.data(),
                                      {.travel = Travel::to_scene, .wavelengths = {wavelength}});
  }
};

}  // namespace

struct Transmission::Data {
  LensLight light;
  bool traced;  ///< by an exact model, together with its rays
  std::size_t loop = 0;
  WavelengthFits fits = {};
  double least = 1, most = 0;  ///< limits, for rays of the model that the lens does not pass
  double error = 0;

  Data(const Lens& lens, const RayModel& model) : light(lens), traced(model.kind().is_exact()), error(light.error()) {
    if (!traced) fit(lens, model.pupils());
  }

  template <class T>
  void evaluate(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                T* to) const noexcept {
    WavelengthFits::Buffer<T> between;
    auto job = fits.job<T>(count, wavelengths, between);
    job.in = {lines.film_x, lines.film_y, lines.pupil_x, lines.pupil_y};
    job.out = {to};
    loops_of<T>()[loop](job);
    for (std::size_t i = 0; i < count; ++i) to[i] = std::clamp(to[i], static_cast<T>(least), static_cast<T>(most));
  }

 private:
  /// Fits polynomials of rising degree until one suffices.
  void fit(const Lens& lens, const FilmPupilTable& pupils) {
    const bool mirrors = has_cylinders(lens);
    const std::size_t fitted_lines = mirrors ? 2000 : 600, test_lines = mirrors ? 1900 : 400;
    const TwoPlanes& space = pupils.space();
    RayPolynomial::Domain domain{.space = space, .film_radius = pupils.film_radius()};
    std::vector<Lines> all;
    std::vector<LitLines> fitted, fresh;
    for (std::size_t w = 0; w < pupils.wavelengths(); ++w) {
      const auto spread = [&](std::size_t first, std::size_t count) {
        return polynomial_detail::spread(pupils, mirrors, first, count, true, w);
      };
      all.push_back(spread(0, fitted_lines));
      fitted.emplace_back(lens, space, light, all.back(), w);
      fresh.emplace_back(lens, space, light, spread(fitted_lines, test_lines), w);
      for (const double value : fitted.back().light) {
        if (value > 0) least = std::min(least, value), most = std::max(most, value);
      }
    }
    most = std::max(least, most);
    polynomial_detail::enclose(all, mirrors, domain);
    const double least_radius = 1e-6 * domain.film_radius;  // for a pinhole
    domain.pupil_radius = std::max(domain.pupil_radius, least_radius);
    if (mirrors) domain.along_x->pupil_radius = std::max(domain.along_x->pupil_radius, least_radius);

    const auto nm = lens.wavelengths_nm();
    loop = mirrors ? polynomial_detail::revolution_transmittances : 0;
    const std::size_t last = (mirrors ? coefficient_counts.size() : polynomial_detail::revolution_transmittances) - 1;
    double fit_error = 0;
    for (;; ++loop) {
      std::vector<std::vector<double>> coefficients;
      for (const LitLines& lit : fitted) coefficients.push_back(least_squares(domain, lit));
      fits = {domain, nm, lens.primary_wavelength(), coefficients, {mode_tolerance, mode_tolerance}};
      fit_error = 0;
      for (std::size_t w = 0; w < fresh.size(); ++w) fit_error = std::max(fit_error, error_of(fresh[w], w));
      if (fit_error <= tolerance || loop == last) break;
    }
    // Midway between compiled wavelengths.
    std::vector<double> sorted(nm.begin(), nm.end());
    std::ranges::sort(sorted);
    for (std::size_t k = 1; k < sorted.size(); ++k) {
      const Wavelength middle = Wavelength::nm((sorted[k - 1] + sorted[k]) / 2);
      fit_error = std::max(fit_error, error_of({lens, space, light, fresh.front().lines, middle}, middle));
    }
    error += fit_error;
  }

  /// Largest error of the lines that pass.
  double error_of(const LitLines& lit, Wavelength wavelength) const {
    std::vector<double> found(lit.light.size());
    evaluate<double>(found.size(), lit.lines.rays(), {.all = wavelength}, found.data());
    double worst = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (lit.light[i] > 0) worst = std::max(worst, std::abs(found[i] - lit.light[i]));
    }
    return worst;
  }

  /// Coefficients that fit the lines that pass.
  std::vector<double> least_squares(const RayPolynomial::Domain& domain, const LitLines& lit) const {
    const auto lines = static_cast<Eigen::Index>(lit.light.size());
    Eigen::MatrixXd columns(lines, coefficient_counts[loop]);
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(columns.cols());
    polynomial_detail::Job<double> job{};
    job.coefficients = unit.data();
    job.scales = polynomial_detail::scales_of<double>(domain);
    job.count = lit.light.size();
    const auto [film_x, film_y, pupil_x, pupil_y] = lit.lines.rays();
    job.in = {film_x, film_y, pupil_x, pupil_y};
    for (Eigen::Index k = 0; k < columns.cols(); ++k) {
      unit[k] = 1;
      job.out[0] = columns.col(k).data();
      loops_of<double>()[loop](job);
      unit[k] = 0;
    }
    const auto light_of = Eigen::VectorXd::Map(lit.light.data(), lines);
    columns.array().colwise() *= (light_of.array() > 0).cast<double>();
    const Eigen::VectorXd found = core_detail::least_squares(columns, light_of);
    return {found.begin(), found.end()};
  }
};

Transmission::Transmission(const Lens& lens, const RayModel& model)
    : data_(std::make_shared<const Data>(lens, model)) {}

double Transmission::error() const noexcept { return data_ ? std::min(data_->error, 1.0) : 0; }
const LensLight* Transmission::light() const noexcept { return data_ ? &data_->light : nullptr; }

template <class T>
void Transmission::fill(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                        T* transmittances) const noexcept {
  if (!data_->traced) data_->evaluate(count, lines, wavelengths, transmittances);
}

template void Transmission::fill(std::size_t, const TwoPlaneRays<const float>&, const RayWavelengths&,
                                 float*) const noexcept;
template void Transmission::fill(std::size_t, const TwoPlaneRays<const double>&, const RayWavelengths&,
                                 double*) const noexcept;

}  // namespace petzval::camera_detail
