// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "focus/plane_fit.hpp"
#include "focus/targets.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::fit_detail {

using focus_detail::PicturePoint;

/// The film plane z = z + p x + q y, in the coordinates of a TiltFrame.
struct FilmSlopes {
  double z = 0, p = 0, q = 0;
};

/// The coordinates of a fit: in focal lengths, relative to the centroid of the points at which chief rays should meet
/// the film. With this origin, z and the slopes of a film are determined independently.
struct TiltFrame {
  Vec3<double> origin{0, 0, 0};
  double unit = 1;

  /// A copy of the film `like`, with the position, tilt and swing of `slopes`.
  Film film(const FilmSlopes& slopes, const Film& like) const;
};

/// The set of films that a fit searches. parameters: 1, 2 or 3, the number that the targets determine.
struct TiltSpace {
  int parameters = 1;                                  ///< z; slope along the main direction; slope across
  double along_x = 1, along_y = 0;                     ///< unit vector: main direction of the images of the targets
  double spread_along = 1, spread_across = 1;          ///< RMS; slope times spread has the magnitude of z
  double largest_slope = 0, largest_slope_across = 0;  ///< half axes of the ellipse of the allowed slopes

  FilmSlopes film(double z, double along, double across) const noexcept {
    return {z, along * along_x - across * along_y, along * along_y + across * along_x};
  }
  /// A film by parameters of similar magnitude: z, and the slopes times the spreads.
  FilmSlopes film(const Eigen::Vector3d& at) const noexcept {
    return film(at[0], at[1] / spread_along, at[2] / spread_across);
  }
  Eigen::Vector3d parameters_of(const FilmSlopes& film) const noexcept {
    return {film.z, spread_along * along(film), spread_across * across(film)};
  }
  /// Derivatives of z, p and q with respect to these parameters.
  Eigen::Matrix3d by_parameters() const noexcept {
    return Eigen::Matrix3d{{1, 0, 0},
                           {0, along_x / spread_along, -along_y / spread_across},
                           {0, along_y / spread_along, along_x / spread_across}};
  }
  double along(const FilmSlopes& film) const noexcept { return film.p * along_x + film.q * along_y; }
  double across(const FilmSlopes& film) const noexcept { return film.q * along_x - film.p * along_y; }
};

/// Largest number of error rows of a target.
inline constexpr int most_rows = 4;

/// The blur errors of one target as functions of the film.
class BlurErrors {
 public:
  virtual ~BlurErrors() = default;
  virtual int rows() const noexcept = 0;
  /// @param errors rows() values
  /// @param derivatives rows() x 3, with respect to z, p and q; may be null
  /// @return false if the rays do not reach the front of the film
  virtual bool operator()(const FilmSlopes& film, double* errors, double* derivatives) const = 0;
};

/// The blur of an ideal lens: `root` times the distance, along the chief ray, between the film and the point at which
/// the ray should meet the film.
class IdealBlur final : public BlurErrors {
 public:
  double x = 0, y = 0, z = 0, slope_x = 0, slope_y = 0;  ///< in coordinates of the frame
  double root = 1;                                       ///< square root of the weight times the squared cone
  int rows() const noexcept override { return 1; }
  bool operator()(const FilmSlopes& film, double* errors, double* derivatives) const noexcept override;
};

/// A focus target with its image and its use.
struct ImagedTarget {
  TargetStatus status = TargetStatus::used;
  double weight = 0;  ///< 0 unless `status` is TargetStatus::used
  std::optional<ImagePoint> image;
  Vec3<double> target_point{0, 0, 0};  ///< point at which the chief ray should meet the film
  PicturePoint picture;                ///< the scene point whose image is that point
};
std::vector<ImagedTarget> imaged_targets(const IdealLens& lens, std::span<const FocusTarget> targets);

/// The input of a fit, made from the targets with a weight.
struct TiltProblem {
  PlaneRank rank = PlaneRank::none;
  TiltFrame frame;
  TiltSpace space;
  FilmSlopes start;               ///< least squares film in inverse distance
  std::vector<std::size_t> used;  ///< indices of the targets
  std::vector<IdealBlur> blurs;   ///< one per index in `used`
};
TiltProblem tilt_problem(const IdealLens& lens, std::span<const ImagedTarget> targets, double max_tilt);

struct TiltSolution {
  bool converged = false, limited = false;
  FilmSlopes film;
};
/// The film with the least sum of squared errors within the slope limit.
TiltSolution least_blur(std::span<const BlurErrors* const> errors, const TiltSpace& space, const FilmSlopes& start);

}  // namespace petzval::fit_detail
