// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "focus/plane_fit.hpp"
#include "focus/targets.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus_point.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::fit_detail {

using focus_detail::PicturePoint;

/// The film z = z + p x + q y, in the coordinates of a TiltFrame.
struct FilmSlopes {
  double z = 0, p = 0, q = 0;
};

/// The coordinates of a fit: in focal lengths, from the centroid of the images that the film should pass. In these the
/// z and the slopes of a film are independent, and the unit of length cancels.
struct TiltFrame {
  Vec3<double> origin{0, 0, 0};
  double unit = 1;

  /// `like` with the place, tilt and swing of these slopes.
  Film film(const FilmSlopes& slopes, const Film& like) const;
};

/// The films that a fit chooses from. parameters: 1, 2 or 3, as far as the targets determine them.
struct TiltSpace {
  int parameters = 1;                                  ///< z; the slope along the main direction; the slope across
  double along_x = 1, along_y = 0;                     ///< unit main direction of the targets' images
  double spread_along = 1, spread_across = 1;          ///< RMS, which makes slopes parameters as large as z
  double largest_slope = 0, largest_slope_across = 0;  ///< half axes of the ellipse of slopes within the limit

  FilmSlopes film(double z, double along, double across) const noexcept {
    return {z, along * along_x - across * along_y, along * along_y + across * along_x};
  }
  double along(const FilmSlopes& film) const noexcept { return film.p * along_x + film.q * along_y; }
  double across(const FilmSlopes& film) const noexcept { return film.q * along_x - film.p * along_y; }
};

/// The most rows of errors of a target.
inline constexpr int most_rows = 4;

/// The errors of the blur of one target, as functions of the film.
class BlurErrors {
 public:
  virtual ~BlurErrors() = default;
  virtual int rows() const noexcept = 0;
  /// errors: rows; derivatives: rows x 3, by z, p and q, or null. False for a film that light does not cross from
  /// the front.
  virtual bool operator()(const FilmSlopes& film, double* errors, double* derivatives) const = 0;
};

/// The blur of an ideal lens: root k (z - V) along the chief ray, which the film should cross at V.
class IdealBlur final : public BlurErrors {
 public:
  double x = 0, y = 0, z = 0, slope_x = 0, slope_y = 0;  ///< in the frame
  double root = 1;                                       ///< the root of weight times squared cone
  int rows() const noexcept override { return 1; }
  bool operator()(const FilmSlopes& film, double* errors, double* derivatives) const noexcept override;
};

/// A target with its image, as a fit uses it.
struct SeenTarget {
  TargetUse use = TargetUse::used;
  double weight = 0;  ///< 0 unless used
  std::optional<ImagePoint> image;
  Vec3<double> wanted{0, 0, 0};  ///< where the chief ray should meet the film
  PicturePoint picture;          ///< of the scene point that is imaged there
};
std::vector<SeenTarget> seen_targets(const IdealLens& lens, std::span<const FocusTarget> targets);

/// Everything about the targets of weight that a fit needs.
struct TiltProblem {
  PlaneRank rank = PlaneRank::none;
  TiltFrame frame;
  TiltSpace space;
  FilmSlopes start;               ///< least squares in inverse distance
  std::vector<std::size_t> used;  ///< positions of the targets
  std::vector<IdealBlur> blurs;   ///< one for each of them
};
TiltProblem tilt_problem(const IdealLens& lens, std::span<const SeenTarget> targets, double max_tilt);

struct TiltSolution {
  bool converged = false, limited = false;
  FilmSlopes film;
  double restraint = 0;  ///< Lagrange multiplier of the limit: the cost of its squared slopes
};
/// The film of least squared errors within the limit. A solution that converged for nearly the same errors is a start
/// from which few steps are needed.
TiltSolution least_blur(std::span<const BlurErrors* const> errors, const TiltSpace& space, const TiltSolution& start);
/// The film of least Tukey loss (biweight; errors beyond `reach` have no weight), without a limit.
std::optional<FilmSlopes> least_tukey_loss(std::span<const BlurErrors* const> errors, std::span<const double> weights,
                                           const TiltSpace& space, const FilmSlopes& start, double reach);

/// The part of its weight that each target of problem.used keeps, 0 to 1.
std::vector<double> robust_weights(const TiltProblem& problem, std::span<const SeenTarget> targets);

}  // namespace petzval::fit_detail
