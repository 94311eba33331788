// SPDX-License-Identifier: Apache-2.0
// The Fourier transform of an image is the autocorrelation of the amplitudes over the directions behind the lens: at
// the frequency v, pairs of directions that differ by wavelength v / n (J. W. Goodman, Introduction to Fourier Optics,
// optical transfer function). The phase of a pair is smooth even if the wavefront error has many waves.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/quadrature.hpp"
#include "core/text.hpp"
#include "direction_map.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "points.hpp"

namespace petzval {
namespace {

using analysis_detail::DirectionMap;
using Point = Vec2<double>;
using std::numbers::pi;

constexpr std::size_t fewest_lines = 16, most_lines = 256;
constexpr double goal = 5e-4;       // error by the number of lines
constexpr double rim_error = 5e-4;  // rim with 96 directions: largest deviation from 1024 directions
constexpr std::size_t rim_points = 96;

using Edge = std::array<Point, 2>;

/// The rim of a pupil: edges of closed polygons in directions behind the lens. A point is inside if a line from it
/// crosses an odd number of edges.
std::vector<Edge> rim_of(const DirectionMap& map) {
  const PupilBoundary& boundary = map.boundary();
  // Polygons that have the area of an ellipse.
  const double turn = 2 * pi / static_cast<double>(boundary.directions), grow = std::sqrt(turn / std::sin(turn));
  const auto outwards = [&](const Point& at) { return map.middle() + grow * (at - map.middle()); };
  std::vector<std::vector<Edge>> spans(boundary.directions);  // inner and outer end
  for (std::size_t i = 0; i < boundary.spans.size(); ++i) {
    const PupilSpan& span = boundary.spans[i];
    const auto from = map.paths()({span.from.x, span.from.y});
    if (!from || !std::isfinite(map.rim()[i].x)) continue;
    spans[span.direction].push_back({outwards(Point(from->direction)), outwards(map.rim()[i])});
  }
  std::vector<Edge> edges;
  for (std::size_t k = 0; k < spans.size(); ++k) {
    const std::vector<Edge>&here = spans[k], &next = spans[(k + 1) % spans.size()];
    for (std::size_t i = 0; i < std::max(here.size(), next.size()); ++i) {
      if (i >= here.size() || i >= next.size()) {  // spans without a neighbour end at their direction
        edges.push_back(i < here.size() ? here[i] : next[i]);
        continue;
      }
      for (const std::size_t end : {0, 1}) edges.push_back({here[i][end], next[i][end]});
    }
  }
  return edges;
}

/// Ends of the intervals inside a rim, in pairs, along the line with the coordinate `across` perpendicular to `axis`.
std::vector<double> crossings(std::span<const Edge> rim, int axis, double across) {
  std::vector<double> result;
  for (const auto& [a, b] : rim) {
    const double from = a[1 - axis] - across, to = b[1 - axis] - across;
    if ((from <= 0) != (to <= 0)) result.push_back(a[axis] + (b[axis] - a[axis]) * from / (from - to));
  }
  std::ranges::sort(result);
  return result;
}

/// Optical path (waves) and amplitude along an interval of a line, as Chebyshev series.
class Profile {
 public:
  using Lane = Eigen::Array<double, 16, 1>;

  double from, to;

  /// at(position): the direction. even: the values are equal on both sides of the middle.
  template <class At>
  Profile(const DirectionMap& map, double wavelength_mm, double low, double high, bool even, const At& at)
      : from(low), to(high) {
    static const std::array transforms{transform(12), transform(20), transform(32)};
    constexpr double tail = 3e-4, negligible = 1e-7;  // waves
    for (const Eigen::MatrixXd& series : transforms) {
      const Eigen::Index nodes = series.rows();
      terms_.resize(nodes, 2);
      for (Eigen::Index j = 0; j < nodes; ++j) {
        if (even && 2 * j >= nodes) {
          terms_.row(j) = terms_.row(nodes - 1 - j);
          continue;
        }
        const double t = series(1, j) * static_cast<double>(nodes) / 2;
        const Point direction = at(0.5 * (from + to + t * (to - from)));
        const auto path = map.path(direction);
        if (!path) throw Error("diffraction_mtf: a direction inside the pupil has no ray; must have one");
        terms_.row(j) << *path / wavelength_mm, std::sqrt(map.stretch(direction));
      }
      terms_ = series * terms_;
      if (terms_.col(0).tail(2).cwiseAbs().sum() < tail) break;
    }
    count_ = terms_.rows();
    const double amplitudes = negligible * terms_(0, 1);
    while (count_ > 2 && std::abs(terms_(count_ - 1, 0)) < negligible && std::abs(terms_(count_ - 1, 1)) < amplitudes) {
      --count_;
    }
  }

  /// Waves and amplitudes at positions.
  std::array<Lane, 2> operator()(const Lane& positions) const noexcept {
    const Lane t = 2 / (to - from) * (positions - from) - 1;
    std::array<Lane, 2> result;
    for (const Eigen::Index which : {0, 1}) {
      Lane sum = Lane::Zero(), before = Lane::Zero();
      for (Eigen::Index k = count_ - 1; k > 0; --k) {
        const Lane next = 2 * t * sum - before + terms_(k, which);
        before = sum, sum = next;
      }
      result[static_cast<std::size_t>(which)] = t * sum - before + terms_(0, which);
    }
    return result;
  }

 private:
  /// From values at the nodes to the terms of the series.
  static Eigen::MatrixXd transform(Eigen::Index nodes) {
    const double n = static_cast<double>(nodes);
    return Eigen::MatrixXd::NullaryExpr(nodes, nodes, [n](Eigen::Index k, Eigen::Index j) {
      return std::cos(pi * static_cast<double>(k) * (static_cast<double>(j) + 0.5) / n) * (k == 0 ? 1 : 2) / n;
    });
  }

  Eigen::Matrix<double, Eigen::Dynamic, 2> terms_;
  Eigen::Index count_ = 0;
};

/// A sum over pairs of directions that are `shift` apart, on a film that is moved by `defocus` wavelengths in the
/// medium.
struct Pairs {
  double shift = 0, defocus = 0;
  std::complex<double> value = 0;
  double limit = 0;  // without wavefront error

  /// Adds the pairs on one line with the coordinate `across`.
  void add(double weight, double across, std::span<const Profile> profiles) {
    static const auto nodes = core_detail::gauss_legendre<16>();
    static const auto positions =
        Profile::Lane::NullaryExpr([](Eigen::Index i) { return nodes[static_cast<std::size_t>(i)].x; }).eval();
    constexpr double cycles = 5;  // steepest phase of a panel: 16 nodes integrate them to 1e-6
    for (const Profile& upper : profiles) {
      for (const Profile& lower : profiles) {
        const double low = std::max(upper.from - shift / 2, lower.from + shift / 2),
                     high = std::min(upper.to - shift / 2, lower.to + shift / 2);
        if (!(high > low)) continue;
        Profile::Lane waves, amplitudes;
        const auto evaluate = [&](double from, double length) {
          const Profile::Lane at = from + length * positions, above = at + shift / 2, below = at - shift / 2;
          const auto a = upper(above), b = lower(below);
          waves = a[0] - b[0], amplitudes = a[1] * b[1];
          if (defocus == 0) return;
          const double rest = 1 - across * across;
          waves += defocus * ((rest - above.square()).sqrt() - (rest - below.square()).sqrt());
        };
        evaluate(low, high - low);
        const double steepest =
            ((waves.tail<15>() - waves.head<15>()) / (positions.tail<15>() - positions.head<15>())).abs().maxCoeff();
        const int panels = std::clamp(static_cast<int>(std::ceil(steepest / cycles)), 1, 64);
        const double length = (high - low) / panels;
        for (int panel = 0; panel < panels; ++panel) {
          if (panels > 1) evaluate(low + panel * length, length);
          for (std::size_t i = 0; i < nodes.size(); ++i) {
            const Eigen::Index k = static_cast<Eigen::Index>(i);
            const double amplitude = weight * length * nodes[i].weight * amplitudes[k];
            value += std::polar(amplitude, 2 * pi * (waves[k] - std::round(waves[k])));
            limit += amplitude;
          }
        }
      }
    }
  }
};

/// Transfer of one field and wavelength.
struct Transfer {
  std::array<std::vector<Pairs>, 2> sums;  // along x (sagittal) and y (tangential): the light, then the points
  double error = 0;                        // of a contrast

  Transfer(const Lens& lens, const FieldPoint& point, const Point& chief, std::size_t wavelength,
           std::span<const MtfPoint> points) {
    const DirectionMap map("diffraction_mtf", lens, point, wavelength, {chief.x, chief.y, lens.film_z()}, rim_points);
    const double mm = lens.wavelengths_nm()[wavelength] * 1e-6, medium_mm = mm / map.paths().film_index();
    const bool symmetric = lens.rotationally_symmetric();
    const std::vector<Edge> rim = rim_of(map);
    for (const int axis : {1, 0}) {
      std::vector<Pairs>& own = sums[static_cast<std::size_t>(axis)];
      own.resize(1);
      for (const MtfPoint& p : points) {
        own.push_back({.shift = medium_mm * p.frequency_per_mm,
                       .defocus = lens.light_direction(lens.surface_count()) * p.film_shift_mm / medium_mm});
      }
      if (rim.empty()) continue;
      if (axis == 0 && symmetric && point.field_rad == 0) {
        own = sums[1];
        continue;
      }
      const auto add_line = [&](double across, double weight) {
        const double least = 1e-9 * map.half();
        const bool mirrored = symmetric && axis == 1;
        if (mirrored && across > least) return;
        const std::vector<double> ends = crossings(rim, axis, across);
        std::vector<Profile> profiles;
        for (std::size_t k = 0; k + 1 < ends.size(); k += 2) {
          if (!(ends[k + 1] - ends[k] > least)) continue;
          const bool even = symmetric && axis == 0 && std::abs(ends[k] + ends[k + 1]) < least;
          profiles.emplace_back(map, mm, ends[k], ends[k + 1], even, [&](double along) {
            return axis == 1 ? Point{across, along} : Point{along, across};
          });
        }
        for (Pairs& sum : own) sum.add(mirrored && across < -least ? 2 * weight : weight, across, profiles);
      };
      const auto [low, high] = std::ranges::minmax(rim, {}, [&](const Edge& edge) { return edge[0][1 - axis]; });
      const double from = low[0][1 - axis], half = (high[0][1 - axis] - from) / 2;
      double uncertain = 1;
      for (std::size_t lines = fewest_lines / 2; lines <= most_lines && !(uncertain < goal); lines *= 2) {
        const std::vector<Pairs> before = own;
        for (Pairs& sum : own) sum.value /= 2, sum.limit /= 2;
        // With positions cos(a) the trapezoidal rule over a converges fast for round pupils.
        const double turn = pi / static_cast<double>(lines);
        for (std::size_t i = 1; i<lines; i += lines> fewest_lines / 2 ? 2 : 1) {
          const double angle = turn * static_cast<double>(i);
          add_line(from + half * (1 - std::cos(angle)), turn * half * std::sin(angle));
        }
        if (!(before[0].limit > 0)) continue;
        const double light = own[0].limit, light_before = before[0].limit;
        double change = 0;
        for (std::size_t i = 0; i < own.size(); ++i) {
          change = std::max({change, std::abs(own[i].value / light - before[i].value / light_before),
                             std::abs(own[i].limit / light - before[i].limit / light_before)});
        }
        uncertain = change / 2;  // falls by 2.8 or more with twice the lines
      }
      error = std::max(error, rim_error + uncertain);
    }
  }
};

}  // namespace

Grid<MtfPoint> diffraction_mtf(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                               std::span<const double> frequencies_per_mm, std::span<const double> wavelength_weights,
                               int threads, std::span<const double> film_shifts_mm) {
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  const auto weights = analysis_detail::mtf_weights(wavelengths, wavelength_weights);
  std::vector<MtfPoint> points;
  for (const double shift : film_shifts_mm) {
    for (const double frequency : frequencies_per_mm) {
      points.push_back({.frequency_per_mm = frequency, .film_shift_mm = shift});
      if (std::isfinite(frequency + shift)) continue;
      throw Error("diffraction_mtf: frequency = " + to_text(frequency) + " per mm, film shift = " + to_text(shift) +
                  " mm; must be finite");
    }
  }
  if (first_order(lens, {}, main_meridian(lens)).afocal) {
    throw Error("diffraction_mtf: " + lens.name() + " is afocal; contrast of lines per mm needs an image");
  }
  std::vector<std::optional<Transfer>> transfers(fields_rad.size() * wavelengths);
  std::vector<std::optional<Point>> chiefs;
  for (const double field : fields_rad) {
    chiefs.push_back(
        analysis_detail::chief_point(lens, {.field_rad = field, .z = subject_z}, lens.primary_wavelength()));
  }
  parallel_for(transfers.size(), 1, threads, [&](std::size_t i, std::size_t) {
    const std::size_t field = i / wavelengths;
    transfers[i].emplace(lens, FieldPoint{.field_rad = fields_rad[field], .z = subject_z},
                         chiefs[field].value_or(Point{0, 0}), i % wavelengths, points);
  });
  Grid<MtfPoint> result{{}, points.size()};
  for (std::size_t field = 0; field < fields_rad.size(); ++field) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      MtfPoint& point = result.values.emplace_back(points[k]);
      point.field_rad = fields_rad[field];
      if (chiefs[field]) point.image_height_mm = glm::length(*chiefs[field]);
      for (const std::size_t axis : {0, 1}) {
        std::complex<double> value = 0;
        double light = 0, limit = 0;
        for (std::size_t w = 0; w < wavelengths; ++w) {
          const Transfer& transfer = *transfers[field * wavelengths + w];
          const Pairs& sum = transfer.sums[axis][k + 1];
          light += weights[w] * transfer.sums[axis][0].limit, value += weights[w] * sum.value;
          limit += weights[w] * sum.limit, point.sampling_error = std::max(point.sampling_error, transfer.error);
        }
        const double unit = light > 0 ? 1 / light : 0;
        (axis == 1 ? point.tangential : point.sagittal) = unit * std::abs(value);
        (axis == 1 ? point.tangential_limit : point.sagittal_limit) = unit * limit;
      }
    }
  }
  return result;
}

}  // namespace petzval
