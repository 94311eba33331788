// SPDX-License-Identifier: Apache-2.0
#include "two_disc_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/NonLinearOptimization>
#include <utility>
#include <vector>

#include "core/householder.hpp"
#include "core/text.hpp"
#include "lens_facts.hpp"
#include "petzval/camera/bokeh.hpp"
#include "petzval/core/error.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval {
namespace camera_detail {
namespace {

using Discs = std::array<PupilDisc, 2>;

/// Distance of a point outside a disc; negative inside.
double outside(const EdgePoint& point, const PupilDisc& disc) noexcept {
  return std::hypot(point.x, point.y - disc.shift * point.field) - disc.radius;
}

/// Distance of a point outside the intersection of two discs; negative inside.
double outside(const EdgePoint& point, const Discs& discs) noexcept {
  return std::max(outside(point, discs[0]), outside(point, discs[1]));
}

/// Distances of edge points from the edge of the intersection of two discs, for a solver. They are reduced to five
/// residuals with the same sum of squares, gradient and Gauss-Newton matrix. Unknowns: the centre of each disc at the
/// largest field and its radius, in units of `unit`, so that the tolerances of the solver are meaningful.
struct EdgeDistances {
  using Scalar = double;

  std::span<const EdgePoint> edges;
  std::span<const double> weights;
  double unit = 1, field = 1;

  Discs discs(const double* p) const noexcept {
    return {{{p[0] * unit / field, p[1] * unit}, {p[2] * unit / field, p[3] * unit}}};
  }
  void parameters(const Discs& discs, double* p) const noexcept {
    for (std::size_t i = 0; i < 2; ++i) {
      p[2 * i] = discs[i].shift * field / unit;
      p[2 * i + 1] = discs[i].radius / unit;
    }
  }

  int values() const noexcept { return 5; }
  int operator()(const Eigen::VectorXd& p, Eigen::VectorXd& residuals) const {
    residuals = triangle(p).col(4).head<5>();
    return 0;
  }
  int df(const Eigen::VectorXd& p, Eigen::MatrixXd& jacobian) const {
    jacobian = triangle(p).topLeftCorner<5, 4>().triangularView<Eigen::Upper>();
    return 0;
  }

  /// Derivatives in four columns and distances in the fifth, reduced to five rows.
  Eigen::MatrixXd triangle(const Eigen::VectorXd& p) const {
    const Discs both = discs(p.data());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(edges.size()), 5);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const EdgePoint& e = edges[i];
      const double first = outside(e, both[0]), second = outside(e, both[1]);
      const std::size_t disc = first >= second ? 0 : 1;
      const double dy = e.y - both[disc].shift * e.field;
      const double length = std::max(std::hypot(e.x, dy), std::numeric_limits<double>::min());
      auto row = all.row(static_cast<Eigen::Index>(i));
      const auto column = static_cast<Eigen::Index>(2 * disc);
      row[column] = -weights[i] * dy / length * e.field / field;
      row[column + 1] = -weights[i];
      row[4] = weights[i] * std::max(first, second) / unit;
    }
    core_detail::to_triangle(all, 5);
    return all;
  }
};

/// Starting discs: each disc touches the pupil of the field on one side, above or below; one disc may be wider than the
/// axial pupil.
void add_starts(std::span<const EdgePoint> pupil, double radius, std::vector<Discs>& starts) {
  const auto [lowest, highest] =
      std::minmax_element(pupil.begin(), pupil.end(), [](const EdgePoint& a, const EdgePoint& b) { return a.y < b.y; });
  const double field = pupil.front().field;
  for (const auto& [below, above] : {std::array{1.0, 1.0}, std::array{1.0, 1.6}, std::array{1.6, 1.0}}) {
    starts.push_back({{{(lowest->y + below * radius) / field, below * radius},
                       {(highest->y - above * radius) / field, above * radius}}});
  }
}

}  // namespace

std::vector<EdgePoint> real_edges(const FilmPupilTable& real, std::size_t wavelength) {
  constexpr int fields = 16, directions = pupil_table_detail::polygon_corners / 2;
  // Polygons have the area of the pupils; they cross a round pupil at this fraction of the distance between corners.
  constexpr double crossing = 0.21, step = 2.0 / pupil_table_detail::polygon_corners;
  constexpr double darkest = 0.01;  // fraction of the axial pupil's area
  std::vector<EdgePoint> edges;
  for (int j = 0; j <= fields; ++j) {
    const FilmPoint film{0, real.lit_radius() * std::sqrt(static_cast<double>(j) / fields)};
    std::array<PupilSample, directions> points;
    for (int k = 0; k < directions; ++k) points[k] = real.sample(film, (k + crossing / 2) * step, 1, wavelength);
    if (!(points[0].area > darkest * real.area({}, wavelength))) continue;
    for (int k = 0; k < directions; ++k) {
      const PupilSample &before = points[(k + directions - 1) % directions], &after = points[(k + 1) % directions];
      const double length = std::hypot(after.x - before.x, after.y - before.y) / 2;
      edges.push_back({film.y, points[k].x, points[k].y, length / points[k].area});
    }
  }
  return edges;
}

double two_disc_error(std::span<const EdgePoint> edges, const Discs& discs) noexcept {
  double sum = 0;
  for (const EdgePoint& e : edges) sum += std::abs(outside(e, discs)) * e.edge_weight;
  return sum;
}

std::array<PupilDisc, 2> fit_two_discs(std::span<const EdgePoint> edges) {
  if (edges.empty()) return {};
  std::vector<std::span<const EdgePoint>> pupils;
  for (auto from = edges.begin(); from != edges.end();) {
    const auto to = std::find_if(from, edges.end(), [&](const EdgePoint& e) { return e.field != from->field; });
    pupils.emplace_back(from, to);
    from = to;
  }
  const auto wider = [](const EdgePoint& a, const EdgePoint& b) { return a.x < b.x; };
  const double radius = std::max_element(pupils[0].begin(), pupils[0].end(), wider)->x;
  std::vector<Discs> starts{{{{0, radius}, {0, radius}}}};
  if (pupils.back()[0].field > 0) add_starts(pupils.back(), radius, starts);
  if (pupils.size() > 2) add_starts(pupils[pupils.size() / 2], radius, starts);

  std::vector<double> weights(edges.size());
  const double last_field = pupils.back()[0].field;
  const EdgeDistances distances{edges, weights, radius, last_field > 0 ? last_field : 1};
  Discs best{};
  double least = std::numeric_limits<double>::infinity();
  const auto improve = [&](const Discs& start) {
    Eigen::VectorXd p(4);
    distances.parameters(start, p.data());
    Eigen::LevenbergMarquardt<const EdgeDistances>(distances).minimize(p);
    const Discs discs = distances.discs(p.data());
    const double error = two_disc_error(edges, discs);
    if (error < least) least = error, best = discs;
  };
  std::transform(edges.begin(), edges.end(), weights.begin(),
                 [&](const EdgePoint& e) { return std::sqrt(e.edge_weight * radius); });
  for (const Discs& start : starts) improve(start);
  // Minimise squares once more, with weights: their sum then approaches the sum of distances, which is the area between
  // the edges.
  for (int round = 0; round < 4; ++round) {
    std::transform(edges.begin(), edges.end(), weights.begin(), [&](const EdgePoint& e) {
      return std::sqrt(e.edge_weight * radius / (0.01 + std::abs(outside(e, best)) / radius));
    });
    improve(best);
  }
  return best;
}

}  // namespace camera_detail

TwoDiscs fit_two_discs(const Lens& lens, double film_radius, Wavelength wavelength) {
  const std::size_t w = lens.wavelength_index(wavelength);
  if (!(film_radius > 0 && std::isfinite(film_radius))) {
    throw Error(lens.name() + ": fit_two_discs: film_radius = " + to_text(film_radius) +
                " mm; must be finite and above 0");
  }
  if (camera_detail::has_cylinders(lens))
    throw Error(lens.name() + ": fit_two_discs: the lens has cylinders; must be a lens of revolution");
  using camera_detail::EdgePoint;
  const FilmPupilTable pupils = FilmPupilTable::equal_area(with_iris(lens, {}), film_radius);
  const std::vector<EdgePoint> edges = camera_detail::real_edges(pupils, w);
  if (edges.empty()) throw Error(lens.name() + ": fit_two_discs: the lens is dark; must transmit light");
  auto discs = camera_detail::fit_two_discs(edges);
  if (discs[1].radius < discs[0].radius) std::swap(discs[0], discs[1]);
  TwoDiscs result;
  result.lens_ratio = discs[1].radius / discs[0].radius;
  result.rate_of_change = (discs[0].shift - discs[1].shift) * film_radius / discs[0].radius;
  for (auto from = edges.begin(); from != edges.end();) {
    const auto to = std::find_if(from, edges.end(), [&](const EdgePoint& e) { return e.field != from->field; });
    result.film_mm.push_back(from->field);
    result.errors.push_back(camera_detail::two_disc_error({from, to}, discs));
    result.error += result.errors.back();
    from = to;
  }
  result.error /= static_cast<double>(result.errors.size());
  return result;
}

}  // namespace petzval
