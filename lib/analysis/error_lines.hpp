// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "camera/exact_model.hpp"
#include "camera/ray_model.hpp"
#include "petzval/core/film.hpp"
#include "pupil_table/two_plane_rays.hpp"

/// The lines along which models are compared with the lens.
namespace petzval::analysis_detail {

/// Number of lines through each film point. The first half are uniform samples of the pupil, used for means. The others
/// lie along the rims of the pupil, where errors are largest and uniform samples are rare.
inline constexpr std::size_t lines_per_point = 128, uniform_lines = 64;

/// Factors from the largest measured error to a bound of the error of every line: smooth_guard for smooth models,
/// noise_guard for rays traced in float, whose errors are noise, and blur_guard for errors relative to the blur, which
/// has sharp minima over the film.
inline constexpr double smooth_guard = 1.04, noise_guard = 1.5, blur_guard = 1.15;

/// Film points below this fraction of the largest irradiance are left out.
inline constexpr double darkest = 0.01;

/// Radius of the lit area of the film, mm: the irradiance falls to `darkest` of the largest value, or the film ends.
/// The radius of the film if the lens is not rotationally symmetric.
double lit_radius(const camera_detail::ExactModel<double>& exact, const Film& film, std::size_t wavelength);

/// The film point with an index. Points with even indices are uniform samples of the film. The others alternate between
/// a corner, a side and, for most of them, positions near the sides. Points without light move towards the axis, the
/// farthest of them to the edge of the lit area.
FilmPoint error_film_point(const Film& film, std::size_t index, std::uint32_t seed, double lit_radius) noexcept;
/// True if the film point is one of the uniform samples.
inline bool is_uniform(std::size_t film_point) noexcept { return film_point % 2 == 0; }

/// Film points for the comparison of pupils, which depend mostly on the distance from the axis. For a rotationally
/// symmetric lens the distances are random (by the seed) within equal steps, denser towards the edge of the lit area,
/// and include the smallest and the largest distance. For other lenses: error_film_point().
std::vector<FilmPoint> pupil_film_points(const Lens& lens, const Film& film, std::size_t count, std::uint32_t seed,
                                         double lit_radius);

/// Lines of one film point. All numbers are exact in float, so models in float and the lens in double trace equal
/// lines.
struct PointLines {
  FilmPoint film;
  alignas(64) std::array<double, lines_per_point> film_x, film_y, pupil_x, pupil_y;
  alignas(64) std::array<float, lines_per_point> film_x_float, film_y_float, pupil_x_float, pupil_y_float;

  /// The film point of all lines; its coordinates must be exact in float.
  explicit PointLines(const FilmPoint& point) noexcept;
  void put(std::size_t line, double x, double y) noexcept;

  TwoPlaneRays<const double> lines() const noexcept {
    return {film_x.data(), film_y.data(), pupil_x.data(), pupil_y.data()};
  }
  TwoPlaneRays<const float> float_lines() const noexcept {
    return {film_x_float.data(), film_y_float.data(), pupil_x_float.data(), pupil_y_float.data()};
  }
};

/// The lines of a film point through the pupil of the lens. The film point must have a pupil.
PointLines error_lines(const FilmPoint& film, const camera_detail::ExactModel<double>& exact, std::size_t wavelength,
                       std::uint64_t seed) noexcept;

/// The rays of a model for such lines.
struct PointRays {
  std::array<Ray<double>, lines_per_point> rays;
  std::array<bool, lines_per_point> reaches;  ///< the model has a ray for the line
  std::array<bool, lines_per_point> passes;   ///< the model has a ray, and the line lies in the model's pupil
};
using Tracing = std::function<void(const PointLines& lines, std::size_t wavelength, PointRays& rays)>;

/// Traces a model as a renderer does: in float, except exact_double. Models that do not clip at apertures pass the
/// lines within their pupils; the single ray of a pinhole represents every line. The model must outlive the result.
Tracing tracing(const RayModel& model);
/// tracing() for lines that lie within the model's own pupils.
Tracing tracing_within(const RayModel& model);

}  // namespace petzval::analysis_detail
