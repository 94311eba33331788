// SPDX-License-Identifier: Apache-2.0
#include "transmission.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/least_squares.hpp"
#include "core/low_discrepancy.hpp"
#include "lens/between_wavelengths.hpp"
#include "lens_facts.hpp"
#include "trace/lens_light.hpp"
#include "transmission_loops.hpp"

namespace petzval::camera_detail {
namespace {

using trace_detail::LensLight;
using Coefficients = std::array<double, transmission_terms>;

constexpr std::size_t block = 256;
/// Error at which a degree suffices.
constexpr double tolerance = 2e-3;

/// Monomials up to a degree in three or six variables.
struct Basis {
  std::array<Monomial, transmission_terms> monomials{};
  std::size_t count = 1;

  static int highest(bool revolution) noexcept { return revolution ? 4 : 2; }

  Basis(bool revolution, int degree) {
    const std::uint8_t variables = revolution ? 3 : 6;
    std::size_t from = 0;
    for (int d = 1; d <= degree; ++d) {
      const std::size_t to = count;
      for (std::size_t earlier = from; earlier < to; ++earlier) {
        // Variables in ascending order, so that each product appears once.
        for (std::uint8_t v = earlier == 0 ? 0 : monomials[earlier].variable; v < variables; ++v) {
          monomials[count++] = {static_cast<std::uint8_t>(earlier), v};
        }
      }
      from = to;
    }
  }
};

/// Image-space rays of a model, and their exact transmittances.
struct Lines {
  std::vector<double> film_x, film_y, pupil_x, pupil_y, light;

  std::size_t size() const noexcept { return light.size(); }
  TwoPlaneRays<const double> rays() const noexcept {
    return {film_x.data(), film_y.data(), pupil_x.data(), pupil_y.data()};
  }
};

/// The exact transmittance along an image-space ray; nullopt if it does not pass.
std::optional<double> light_along(const Lens& lens, const TwoPlanes& space, const LensLight& light,
                                  const TwoPlaneRay& line, Wavelength wavelength) {
  const double x = line.pupil_x - line.film_x, y = line.pupil_y - line.film_y, depth = space.depth();
  const double per_length = towards_scene(lens, space) / std::hypot(x, y, depth);
  double passes = 0;
  const auto end = trace_detail::trace_light<double>(
      lens, light, {{line.pupil_x, line.pupil_y, space.pupil_z}, {x * per_length, y * per_length, depth * per_length}},
      passes, {.travel = Travel::to_scene, .wavelength = wavelength});
  return end.transmitted() ? std::optional(passes) : std::nullopt;
}

/// Lines from film points of several radii and directions, through points spread over their pupils, that pass the lens.
Lines traced_lines(const Lens& lens, const RayModel& model, const LensLight& light, double radius, bool revolution,
                   std::size_t wavelength, std::size_t radii, std::size_t pupil_points) {
  const TwoPlanes& space = model.pupils().space();
  const std::size_t directions = revolution ? 1 : 5;
  Lines found;
  for (std::size_t r = 0; r < radii; ++r) {
    const double height = radius * (static_cast<double>(r) + 0.5) / (static_cast<double>(radii) - 0.5);
    for (std::size_t d = 0; d < directions; ++d) {
      const double angle = directions == 1
                               ? std::numbers::pi / 2
                               : std::numbers::pi / 2 * static_cast<double>(d) / static_cast<double>(directions - 1);
      const FilmPoint film{std::min(height, radius) * std::cos(angle), std::min(height, radius) * std::sin(angle)};
      for (std::size_t k = 0; k < pupil_points; ++k) {
        const auto [u, v] = core_detail::fibonacci_point(k, pupil_points);
        const PupilSample at = model.pupils().sample(film, u, v, wavelength);
        if (!(at.area > 0)) continue;
        const auto passes = light_along(lens, space, light, {film.x, film.y, at.x, at.y}, wavelength);
        if (!passes) continue;
        found.film_x.push_back(film.x), found.film_y.push_back(film.y);
        found.pupil_x.push_back(at.x), found.pupil_y.push_back(at.y);
        found.light.push_back(*passes);
      }
    }
  }
  return found;
}

double largest(const std::vector<double>& x, const std::vector<double>& y) noexcept {
  double result = 0;
  for (std::size_t i = 0; i < x.size(); ++i) result = std::max(result, std::hypot(x[i], y[i]));
  return result > 0 ? result : 1;
}

}  // namespace

struct Transmission::Data {
  LensLight light;
  bool traced;  ///< by an exact model, together with its rays
  TransmissionJob<float> in_float;
  TransmissionJob<double> in_double;
  lens_detail::BetweenWavelengths<transmission_terms> coefficients;
  std::vector<Coefficients> compiled;
  std::size_t primary;
  double error = 0;

  Data(const Lens& lens, const RayModel& model, double radius)
      : light(lens), traced(model.kind().is_exact()), primary(lens.primary_wavelength()), error(light.error()) {
    if (!traced) fit(lens, model, radius);
  }

  template <class T>
  void evaluate(TransmissionJob<T> job, std::size_t count, const TwoPlaneRays<const T>& lines,
                const RayWavelengths& wavelengths, T* to) const noexcept {
    Coefficients own;
    if (wavelengths.shared()) {
      const auto nm = wavelengths.all.in_nm();
      const std::size_t position = wavelengths.all.position(primary);
      own = nm && coefficients.covers(*nm) ? coefficients(*nm)
            : position < compiled.size()   ? compiled[position]
                                           : Coefficients{};
      job.shared = own.data();
    }
    if constexpr (sizeof(T) == sizeof(float)) {
      transmission_loops().single(job, count, lines, wavelengths, to);
    } else {
      transmission_loops().twice(job, count, lines, wavelengths, to);
    }
  }

 private:
  /// Fits polynomials of rising degree until one suffices.
  void fit(const Lens& lens, const RayModel& model, double radius) {
    const bool revolution = !has_cylinders(lens);
    const auto lines_at = [&](std::size_t w, bool fresh) {
      return fresh ? traced_lines(lens, model, light, radius, revolution, w, 7, 55)
                   : traced_lines(lens, model, light, radius, revolution, w, 10, revolution ? 60 : 40);
    };
    std::vector<Lines> fitted, fresh;
    double per_pupil = std::numeric_limits<double>::infinity(), least = 1, most = 0;
    for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
      const Lines& own = fitted.emplace_back(lines_at(w, false));
      fresh.push_back(lines_at(w, true));
      per_pupil = std::min(per_pupil, 1 / largest(own.pupil_x, own.pupil_y));
      for (const double value : own.light) least = std::min(least, value), most = std::max(most, value);
    }
    // The limits also serve rays of the model that the lens does not pass.
    in_double.revolution = revolution;
    in_double.per_film = radius > 0 ? 1 / radius : 1, in_double.per_pupil = per_pupil;
    double fit_error = 0;
    for (int degree = 1; degree <= Basis::highest(revolution); ++degree) {
      const Basis basis(revolution, degree);
      in_double.monomials = basis.monomials, in_double.terms = basis.count;
      in_double.least = -std::numeric_limits<double>::infinity(), in_double.most = -in_double.least;
      compiled.clear();
      for (const Lines& own : fitted) compiled.push_back(coefficients_for(own));
      in_double.least = least, in_double.most = std::max(least, most);
      fit_error = 0;
      for (std::size_t w = 0; w < fresh.size(); ++w) {
        std::vector<double> found(fresh[w].size());
        evaluate(in_double, found.size(), fresh[w].rays(), {.all = w}, found.data());
        for (std::size_t i = 0; i < found.size(); ++i) {
          fit_error = std::max(fit_error, std::abs(found[i] - fresh[w].light[i]));
        }
      }
      if (fit_error <= tolerance) break;
    }
    const bool any = std::isfinite(lens.index_error());
    coefficients = {any ? lens_detail::CompiledWavelengths(lens.wavelengths_nm()) : lens_detail::CompiledWavelengths(),
                    compiled};
    in_double.rows = coefficients.rows<double>();
    in_float = {.rows = coefficients.rows<float>(),
                .monomials = in_double.monomials,
                .terms = in_double.terms,
                .revolution = revolution,
                .per_film = static_cast<float>(in_double.per_film),
                .per_pupil = static_cast<float>(in_double.per_pupil),
                .least = static_cast<float>(in_double.least),
                .most = static_cast<float>(in_double.most)};
    if (any) fit_error = std::max(fit_error, error_between(lens, model.pupils().space(), fresh.front()));
    error += fit_error;
  }

  /// Largest error of the lines midway between compiled wavelengths.
  double error_between(const Lens& lens, const TwoPlanes& space, const Lines& lines) const {
    std::vector<double> nm(lens.wavelengths_nm().begin(), lens.wavelengths_nm().end());
    std::ranges::sort(nm);
    double worst = 0;
    std::vector<double> found(lines.size());
    for (std::size_t k = 1; k < nm.size(); ++k) {
      const Wavelength middle = Wavelength::nm((nm[k - 1] + nm[k]) / 2);
      evaluate(in_double, lines.size(), lines.rays(), {.all = middle}, found.data());
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const TwoPlaneRay line{lines.film_x[i], lines.film_y[i], lines.pupil_x[i], lines.pupil_y[i]};
        const auto passes = light_along(lens, space, light, line, middle);
        if (passes) worst = std::max(worst, std::abs(found[i] - *passes));
      }
    }
    return worst;
  }

  /// Least squares with the monomials of in_double.
  Coefficients coefficients_for(const Lines& lines) const {
    Coefficients solution{};
    if (lines.size() == 0) return solution;
    const auto count = static_cast<Eigen::Index>(lines.size());
    Eigen::MatrixXd rows(count, static_cast<Eigen::Index>(in_double.terms));
    TransmissionJob<double> job = in_double;
    for (std::size_t k = 0; k < in_double.terms; ++k) {
      Coefficients unit{};
      unit[k] = 1;
      job.shared = unit.data();
      transmission_loops().twice(job, lines.size(), lines.rays(), {}, rows.col(static_cast<Eigen::Index>(k)).data());
    }
    const Eigen::VectorXd found = core_detail::least_squares(rows, Eigen::VectorXd::Map(lines.light.data(), count));
    std::ranges::copy(found, solution.begin());
    return solution;
  }
};

Transmission::Transmission(const Lens& lens, const RayModel& model, double radius)
    : data_(std::make_shared<const Data>(lens, model, radius)) {}

double Transmission::error() const noexcept { return data_ ? std::min(data_->error, 1.0) : 0; }

template <class T>
void Transmission::to_scene(const RayModel& model, std::size_t count, const TwoPlaneRays<const T>& lines,
                            const RayWavelengths& wavelengths, const RayArrays<T>& rays, RayFate* fates,
                            T* transmittances) const noexcept {
  std::fill_n(transmittances, count, T(1));
  model.to_scene(count, lines, wavelengths, rays, fates, &data_->light, transmittances);
}

RayFate Transmission::to_scene(const RayModel& model, const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray,
                               double& transmittance) const noexcept {
  transmittance = 1;
  return model.to_scene(line, wavelength, ray, &data_->light, &transmittance);
}

void Transmission::to_film(const RayModel& model, std::size_t count, const RayArrays<const double>& rays,
                           const RayWavelengths& wavelengths, const TwoPlaneRays<double>& lines, RayFate* fates,
                           double* transmittances) const noexcept {
  std::fill_n(transmittances, count, 1.0);
  model.to_film(count, rays, wavelengths, lines, fates, &data_->light, transmittances);
}

template <class T>
void Transmission::of_lines(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                            T* transmittances) const noexcept {
  if (data_->traced) return;
  const TransmissionJob<T>* job = nullptr;
  if constexpr (sizeof(T) == sizeof(float)) {
    job = &data_->in_float;
  } else {
    job = &data_->in_double;
  }
  std::array<T, block> found;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t n = std::min(block, count - begin);
    data_->evaluate(*job, n, lines.from(begin), wavelengths.from(begin), found.data());
    for (std::size_t i = 0; i < n; ++i) transmittances[begin + i] *= found[i];
  }
}

#define PETZVAL_TRANSMISSION(T)                                                                                  \
  template void Transmission::to_scene(const RayModel&, std::size_t, const TwoPlaneRays<const T>&,               \
                                       const RayWavelengths&, const RayArrays<T>&, RayFate*, T*) const noexcept; \
  template void Transmission::of_lines(std::size_t, const TwoPlaneRays<const T>&, const RayWavelengths&, T*)     \
      const noexcept;
PETZVAL_TRANSMISSION(float)
PETZVAL_TRANSMISSION(double)
#undef PETZVAL_TRANSMISSION

}  // namespace petzval::camera_detail
