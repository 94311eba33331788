// SPDX-License-Identifier: Apache-2.0
#include "footprint.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "area_raster.hpp"
#include "core/least_squares.hpp"
#include "core/text.hpp"
#include "paraxial_ghost.hpp"
#include "petzval/core/error.hpp"
#include "petzval/trace/trace.hpp"
#include "trace/clearances.hpp"

namespace petzval::ghosts_detail {
namespace {

/// Rays as a structure of arrays that owns its numbers.
struct Rays {
  explicit Rays(std::size_t count) : count_(count), values_(6 * count) {}

  template <class T = double>
  RayArrays<T> arrays() noexcept {
    const auto at = [&](std::size_t k) { return values_.data() + k * count_; };
    return {at(0), at(1), at(2), at(3), at(4), at(5)};
  }
  void set(std::size_t i, const Ray<double>& ray) noexcept {
    const auto& [o, d] = ray;
    const std::array values{o.x, o.y, o.z, d.x, d.y, d.z};
    for (std::size_t k = 0; k < 6; ++k) values_[k * count_ + i] = values[k];
  }
  Ray<double> operator[](std::size_t i) const noexcept {
    const auto at = [&](std::size_t k) { return values_[k * count_ + i]; };
    return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
  }

 private:
  std::size_t count_;
  std::vector<double> values_;
};

/// Corners of a polygon, at most 6.
struct Polygon {
  std::array<Vec2<double>, 6> at;
  int count = 0;

  double area() const noexcept {
    double twice = 0;
    for (int k = 2; k < count; ++k) twice += cross(at[k - 1] - at[0], at[k] - at[0]);
    return twice / 2;
  }
};

constexpr double lost = -1;  // the margin of rays that miss a surface or are totally reflected

/// The part of the unit square about the origin in which an interpolated margin is positive.
/// @param margins at (-,-), (+,-), (+,+), (-,+)
Polygon inside(const std::array<double, 4>& margins) noexcept {
  constexpr std::array<Vec2<double>, 4> corners{Vec2<double>{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  Polygon result;
  const auto add = [&](const Vec2<double>& at) { result.at[static_cast<std::size_t>(result.count++)] = at; };
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    const double a = margins[k], b = margins[next];
    if (a > 0) add(corners[k]);
    // A ray that is lost without a rim gives no distance: on average, light ends at half of the side.
    const double end = a == lost || b == lost ? 0.5 : a / (a - b);
    if ((a > 0) != (b > 0)) add(corners[k] + (corners[next] - corners[k]) * end);
  }
  return result;
}

/// The image of a cell: a point of the film and its derivatives by the position in units of the cell.
struct Image {
  Vec2<double> at{0, 0}, u{0, 0}, v{0, 0};
  bool reached = false;
};

/// A polynomial of the position in a box, from -1 to 1, in Chebyshev terms up to a total degree.
class Fit {
 public:
  Fit(int degree, std::span<const Vec2<double>> positions, std::span<const double> values) : degree_(degree) {
    Eigen::MatrixXd rows(positions.size(), (degree + 1) * (degree + 2) / 2);
    Eigen::VectorXd wanted(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      terms(positions[i], [&](Eigen::Index k, double value) { rows(row, k) = value; });
      wanted(row) = values[i];
    }
    factors_ = core_detail::least_squares(rows, wanted);
    error_ = (rows * factors_ - wanted).cwiseAbs().maxCoeff() / wanted.cwiseAbs().mean();
  }
  /// Largest residual, relative to the mean.
  double error() const noexcept { return error_; }
  double operator()(const Vec2<double>& at) const noexcept {
    double sum = 0;
    terms(at, [&](Eigen::Index k, double value) { sum += factors_(k) * value; });
    return std::max(sum, 0.0);
  }

 private:
  static constexpr int most = 8;

  void terms(const Vec2<double>& at, const auto& take) const noexcept {
    std::array<double, most + 1> x{1, at.x}, y{1, at.y};
    for (std::size_t k = 2; k <= static_cast<std::size_t>(degree_); ++k) {
      x[k] = 2 * at.x * x[k - 1] - x[k - 2], y[k] = 2 * at.y * y[k - 1] - y[k - 2];
    }
    Eigen::Index k = 0;
    for (int i = 0; i <= degree_; ++i) {
      for (int j = 0; i + j <= degree_; ++j) take(k++, x[static_cast<std::size_t>(i)] * y[static_cast<std::size_t>(j)]);
    }
  }

  int degree_;
  Eigen::VectorXd factors_;
  double error_ = 0;
};

/// Transmittances of the rays of a box. They vary slowly: a polynomial through some exact rays or, if it does not fit,
/// cubic interpolation between exact rays on a grid. Near edges of the transmittance each ray is traced.
class Transmittances {
 public:
  /// @param exact exact(at): the transmittance at a position from -1 to 1, or nullopt
  Transmittances(std::span<const Vec2<double>> positions, std::function<std::optional<double>(Vec2<double>)> exact)
      : exact_(std::move(exact)) {
    constexpr double tolerance = 1e-3;
    for (const int degree : {4, 8}) {
      const auto samples = static_cast<std::size_t>(3 * (degree + 1) * (degree + 2) / 2);
      if (positions.size() < 2 * samples) return;
      std::vector<Vec2<double>> at;
      std::vector<double> values;
      for (std::size_t k = 0; k < samples; ++k) {
        at.push_back(positions[k * (positions.size() - 1) / (samples - 1)]);
        values.push_back(exact_(at.back()).value_or(0));
      }
      fit_.emplace(degree, at, values);
      if (fit_->error() < tolerance) return;
      fit_.reset();
    }
    if (positions.size() < static_cast<std::size_t>(side * side)) return;
    nodes_.assign(static_cast<std::size_t>(side * side), unknown);
    // The error of the interpolation at some of the rays.
    double sum = 0;
    for (std::size_t k = 0; k < 16; ++k) {
      const Vec2<double>& at = positions[k * (positions.size() - 1) / 15];
      const double value = exact_(at).value_or(0);
      sum += value / 16, grid_error_ += std::abs((*this)(at)-value) / 16;
    }
    grid_error_ = sum > 0 ? grid_error_ / sum : 0;
  }

  /// Error relative to the mean: the largest of a polynomial, the mean of a grid.
  double error() const noexcept { return fit_ ? fit_->error() : grid_error_; }

  double operator()(const Vec2<double>& at) {
    if (fit_) return (*fit_)(at);
    if (nodes_.empty()) return exact_(at).value_or(0);
    const Vec2<double> q = (at + 1.0) * ((side - 1) / 2.0);
    const int x = std::clamp(static_cast<int>(q.x), 1, side - 3), y = std::clamp(static_cast<int>(q.y), 1, side - 3);
    const auto wx = weights(q.x - x), wy = weights(q.y - y);
    double sum = 0;
    std::array<double, 4> inner{};
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        const double value = node(x + i - 1, y + j - 1);
        if (value == lost) return exact_(at).value_or(0);
        if (i % 3 != 0 && j % 3 != 0) inner[static_cast<std::size_t>(2 * j + i - 3)] = value;
        sum += value * wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)];
      }
    }
    // Near total reflection, transmittances have edges.
    const auto [least, most] = std::ranges::minmax(inner);
    const double linear =
        std::lerp(std::lerp(inner[0], inner[1], q.x - x), std::lerp(inner[2], inner[3], q.x - x), q.y - y);
    const bool smooth = most - least < 0.3 * linear && std::abs(sum - linear) < 0.02 * linear;
    return smooth ? sum : exact_(at).value_or(0);
  }

 private:
  static constexpr int side = 24;
  static constexpr double unknown = -2, lost = -1;

  /// Lagrange's weights of the nodes -1, 0, 1 and 2.
  static std::array<double, 4> weights(double t) noexcept {
    return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
            (t + 1) * t * (t - 1) / 6};
  }
  double node(int x, int y) {
    double& value = nodes_[static_cast<std::size_t>(y * side + x)];
    if (value == unknown) value = exact_(Vec2<double>(x, y) * (2.0 / (side - 1)) - 1.0).value_or(lost);
    return value;
  }

  std::function<std::optional<double>(Vec2<double>)> exact_;
  std::optional<Fit> fit_;
  std::vector<double> nodes_;
  double grid_error_ = 0;
};

/// Corners of cells, [row * (cells + 1) + column].
std::vector<Vec2<double>> corners_of(const Box& box, std::size_t cells) {
  const std::size_t side = cells + 1;
  const Vec2<double> step = (box.high - box.low) / static_cast<double>(cells);
  std::vector<Vec2<double>> result;
  result.reserve(side * side);
  for (std::size_t i = 0; i < side * side; ++i) {
    result.push_back(box.low + step * Vec2<double>(static_cast<double>(i % side), static_cast<double>(i / side)));
  }
  return result;
}

}  // namespace

Box Deposit::bounds() const noexcept {
  Box result{corners[0], corners[0]};
  for (const Vec2<double>& p : polygon()) result = {glm::min(result.low, p), glm::max(result.high, p)};
  return result;
}

Entrance::Entrance(const Lens& lens, const ScenePoint& light) {
  const auto fail = [&](const std::string& what) { throw Error(lens.name() + ": light: " + what); };
  const Vec3<double>& at = light.position;
  const double length = glm::length(at);
  if (!std::isfinite(length) || !(length > 0))
    fail("position = (" + to_text(at.x) + ", " + to_text(at.y) + ", " + to_text(at.z) +
         "); must be finite and differ from 0");
  distance_ = light.at_infinity ? std::numeric_limits<double>::infinity() : length;
  towards_ = at / length;
  const double sine = std::hypot(towards_.x, towards_.y);
  const Vec2<double> azimuth = sine > 0 ? Vec2<double>(towards_.x, towards_.y) / sine : Vec2<double>(0, 1);
  x_axis_ = {azimuth.y, -azimuth.x, 0};
  y_axis_ = -glm::cross(x_axis_, towards_);

  const double rim = lens.surfaces()[0].semi_diameter;
  if (!std::isfinite(rim)) fail("surface 0: semi_diameter is unlimited; must be finite");
  if (!light.at_infinity && std::hypot(at.x, at.y) <= rim && !(at.z < sag(lens, 0, at.x, at.y))) {
    fail("z = " + to_text(at.z) + " mm; must be in front of surface 0");
  }
  box_ = {{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()},
          {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()}};
  constexpr int rings = 16, directions = 64;
  for (int k = 0; k <= rings * directions; ++k) {
    const double r = rim * (1 + k / directions) / rings, angle = 2 * std::numbers::pi * (k % directions) / directions;
    Vec3<double> p{r * std::sin(angle), r * std::cos(angle), 0};
    if (k == rings * directions) p.x = p.y = 0;
    p.z = sag(lens, 0, p.x, p.y);
    if (!std::isfinite(p.z)) continue;
    if (!light.at_infinity) {
      const Vec3<double> from = p - at;
      const double depth = -glm::dot(from, towards_);
      if (!(depth > 0.05 * glm::length(from))) {
        fail("distance = " + to_text(length) + " mm; must be larger: surface 0 is seen at more than 87 degrees");
      }
      p = at + from * (length / depth);
    }
    const Vec2<double> q{glm::dot(p, x_axis_), glm::dot(p, y_axis_)};
    box_ = {{std::min(box_.low.x, q.x), std::min(box_.low.y, q.y)},
            {std::max(box_.high.x, q.x), std::max(box_.high.y, q.y)}};
  }
  const Vec2<double> margin = 0.01 * (box_.high - box_.low);
  box_.low -= margin, box_.high += margin;
}

double Entrance::flux(const Vec2<double>& at) const noexcept {
  if (std::isinf(distance_)) return 1;
  const double secant2 = 1 + glm::dot(at, at) / (distance_ * distance_);
  return 1 / (secant2 * std::sqrt(secant2));
}

std::array<Ray<double>, 3> Entrance::differential(const Vec2<double>& at) const noexcept {
  const Vec3<double> origin = x_axis_ * at.x + y_axis_ * at.y;
  if (std::isinf(distance_)) return {Ray<double>{origin, -towards_}, {x_axis_, {0, 0, 0}}, {y_axis_, {0, 0, 0}}};
  const Vec3<double> from = origin - towards_ * distance_;
  const double length = glm::length(from);
  const Vec3<double> d = from / length;
  const auto by = [&](const Vec3<double>& axis) { return (axis - d * glm::dot(axis, d)) / length; };
  return {Ray<double>{origin, d}, {x_axis_, by(x_axis_)}, {y_axis_, by(y_axis_)}};
}

LightPath::LightPath(const Lens& lens, std::vector<lens_detail::Passage> path)
    : path_(std::move(path)),
      lens_(lens_detail::along(lens, path_)),
      film_sense_(lens.light_direction(lens.surface_count())) {}

std::vector<double> LightPath::margins(const Entrance& entrance, std::span<const Vec2<double>> positions,
                                       Wavelength wavelength) const {
  const std::size_t count = positions.size();
  Rays rays(count);
  for (std::size_t i = 0; i < count; ++i) rays.set(i, entrance.ray(positions[i]));
  std::vector<double> result(count);
  trace_detail::clearances<double>(lens_, count, rays.arrays(), result.data(),
                                   {.wavelengths = {.all = wavelength}, .apertures = false});
  // From 1 - r^2 / R^2, or v / (1 - v) below 0, to 1 - r / R, which is nearly linear across a rim.
  for (double& value : result) {
    const double square = value >= 0 ? 1 - value : 1 - value / (1 + value);
    value = value > -1 ? 1 - std::min(std::sqrt(std::max(square, 0.0)), 10.0) : lost;
  }
  return result;
}

Box LightPath::region(const Entrance& entrance, Wavelength wavelength) const {
  // Two dense lines through the middle meet rings that lie between the corners.
  constexpr std::size_t cells = 24, line = 256;
  constexpr int rounds = 12;
  Box box = entrance.box(), found;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vec2<double>> positions = corners_of(box, cells);
    for (std::size_t k = 0; k <= line; ++k) {
      const Vec2<double> at = box.low + (box.high - box.low) * (static_cast<double>(k) / line),
                         middle = (box.low + box.high) / 2.0;
      positions.emplace_back(at.x, middle.y), positions.emplace_back(middle.x, at.y);
    }
    const std::vector<double> margin = margins(entrance, positions, wavelength);
    const auto best = static_cast<std::size_t>(std::ranges::max_element(margin) - margin.begin());
    Box lit{positions[best], positions[best]};
    for (std::size_t i = 0; i < margin.size(); ++i) {
      if (margin[i] > 0) lit = {glm::min(lit.low, positions[i]), glm::max(lit.high, positions[i])};
    }
    const Vec2<double> half = (box.high - box.low) / 2.0, step = half * (2.0 / cells);
    const bool bright = margin[best] > 0,
               large = bright && lit.high.x - lit.low.x > half.x && lit.high.y - lit.low.y > half.y;
    box = {lit.low - step, lit.high + step};
    if (!bright && (round >= 5 || found.high.x > found.low.x)) return found;
    if (round + 1 == rounds) return box;
    if (!large) continue;
    // A box that was found on a coarse grid may end within an arc or a ring: it grows while it gains light.
    const Vec2<double> size = box.high - box.low, before = 1.2 * (found.high - found.low);
    if (round == 0 || (size.x < before.x && size.y < before.y)) return box;
    found = box;
    box = {glm::max(box.low - size, entrance.box().low), glm::min(box.high + size, entrance.box().high)};
  }
  return {};
}

Footprint LightPath::paraxial(const Entrance& entrance, const Surfaces& surfaces, Wavelength wavelength,
                              const Film& film) const {
  return paraxial_footprint(path_, lens_, entrance, surfaces, wavelength, film);
}

double LightPath::entering(const Entrance& entrance, const Box& box, std::size_t cells, Wavelength wavelength) const {
  const std::vector<double> margin = margins(entrance, corners_of(box, cells), wavelength);
  const Vec2<double> step = (box.high - box.low) / static_cast<double>(cells);
  double sum = 0;
  for (std::size_t i = 0; i < cells * cells; ++i) {
    const std::size_t x = i % cells, y = i / cells, at = y * (cells + 1) + x;
    const double area = inside({margin[at], margin[at + 1], margin[at + cells + 2], margin[at + cells + 1]}).area();
    sum +=
        area * entrance.flux(box.low + step * Vec2<double>(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
  }
  return sum * step.x * step.y;
}

Footprint LightPath::footprint(const Entrance& entrance, const Box& box, std::size_t cells, const Surfaces& surfaces,
                               Wavelength wavelength, const Film& film, const Box& frame) const {
  Footprint result;
  const Vec2<double> step = (box.high - box.low) / static_cast<double>(cells);
  if (!(step.x > 0 && step.y > 0)) return result;
  const std::vector<double> margin = margins(entrance, corners_of(box, cells), wavelength);
  std::vector<Polygon> shapes(cells * cells);
  std::vector<std::size_t> lit;
  std::vector<std::uint8_t> traced(cells * cells);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::size_t at = i / cells * (cells + 1) + i % cells;
    shapes[i] = inside({margin[at], margin[at + 1], margin[at + cells + 2], margin[at + cells + 1]});
    if (shapes[i].count >= 3) lit.push_back(i);
  }

  // Rays through the middles, with their derivatives by the position in the cell.
  const std::size_t count = result.cells = lit.size();
  if (count == 0) return result;
  Rays rays(count), by_u(count), by_v(count);
  const auto position = [&](std::size_t i) {
    return Vec2<double>(static_cast<double>(i % cells) + 0.5, static_cast<double>(i / cells) + 0.5);
  };
  for (std::size_t k = 0; k < count; ++k) {
    const auto [ray, u, v] = entrance.differential(box.low + step * position(lit[k]));
    rays.set(k, ray);
    by_u.set(k, {u.origin * step.x, u.direction * step.x});
    by_v.set(k, {v.origin * step.y, v.direction * step.y});
  }
  std::vector<RayFate> fates(count);
  const RayTangents<double> tangents{by_u.arrays(), by_v.arrays()};
  trace_differentials<double>(lens_, count, rays.arrays<const double>(),
                              {by_u.arrays<const double>(), by_v.arrays<const double>()}, rays.arrays(), tangents,
                              fates.data(), nullptr, {.wavelengths = {.all = wavelength}, .apertures = false});

  std::vector<Image> images(cells * cells);
  const Vec3<double> normal = film.normal(), right = film.right(), up = film.up(), middle = film.position({});
  for (std::size_t k = 0; k < count; ++k) {
    const Ray<double> ray = rays[k];
    const Vec3<double>& o = ray.origin;
    const Vec3<double>& d = ray.direction;
    const double along = glm::dot(d, normal);
    if (fates[k] != RayFate::transmitted || !(along * film_sense_ > 0)) continue;
    const double t = glm::dot(middle - o, normal) / along;
    const Vec3<double> at = o + d * t - middle;
    const auto by = [&](const Ray<double>& dot) {
      const Vec3<double> moved = dot.origin + dot.direction * t;
      const Vec3<double> on_film = moved - d * (glm::dot(moved, normal) / along);
      return Vec2<double>(glm::dot(on_film, right), glm::dot(on_film, up));
    };
    const Image image{{glm::dot(at, right), glm::dot(at, up)}, by(by_u[k]), by(by_v[k]), true};
    const double sum = image.at.x + image.at.y + image.u.x + image.u.y + image.v.x + image.v.y;
    if (std::isfinite(sum)) images[lit[k]] = image;
  }
  std::erase_if(lit, [&](std::size_t i) {
    const Image& image = images[i];
    const Vec2<double> reach = glm::abs(image.u) + glm::abs(image.v), low = image.at - reach, high = image.at + reach;
    return !image.reached || low.x > frame.high.x || low.y > frame.high.y || high.x < frame.low.x ||
           high.y < frame.low.y;
  });
  if (lit.empty()) return result;
  result.lit = {box.high, box.low};
  std::vector<Vec2<double>> in_box(lit.size());
  for (std::size_t k = 0; k < lit.size(); ++k) {
    const Vec2<double> at = position(lit[k]);
    in_box[k] = at * (2.0 / static_cast<double>(cells)) - 1.0;
    result.lit.low = glm::min(result.lit.low, box.low + step * (at - 1.5));
    result.lit.high = glm::max(result.lit.high, box.low + step * (at + 1.5));
  }
  Transmittances transmittances(in_box, [&](const Vec2<double>& at) {
    const Ray<double> ray = entrance.ray(box.low + (box.high - box.low) * ((at + 1.0) / 2.0));
    return surfaces.power(path_, kernel::to_kernel(ray.origin), kernel::to_kernel(ray.direction));
  });
  result.weight_error = transmittances.error();

  const auto neighbour = [&](std::size_t i, std::size_t axis, int by) -> const Image* {
    const std::size_t at = axis == 0 ? i % cells : i / cells, stride = axis == 0 ? 1 : cells;
    if (by < 0 ? at == 0 : at + 1 == cells) return nullptr;
    const Image& image = images[by < 0 ? i - stride : i + stride];
    return image.reached ? &image : nullptr;
  };
  for (std::size_t k = 0; k < lit.size(); ++k) {
    const std::size_t i = lit[k];
    const Image& image = images[i];
    // Second derivatives, from the derivatives of adjacent rays.
    std::array<Vec2<double>, 2> bend_u{}, bend_v{};
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      const Image *before = neighbour(i, axis, -1), *behind = neighbour(i, axis, 1);
      if (!before && !behind) continue;
      const double scale = before && behind ? 0.5 : 1;
      const Image &from = before ? *before : image, &to = behind ? *behind : image;
      bend_u[axis] = (to.u - from.u) * scale, bend_v[axis] = (to.v - from.v) * scale;
    }
    const Vec2<double> mixed = (bend_u[1] + bend_v[0]) * 0.5;
    const auto at = [&](const Vec2<double>& q, double bend) {
      return image.at + image.u * q.x + image.v * q.y +
             (bend_u[0] * (q.x * q.x / 2) + mixed * (q.x * q.y) + bend_v[1] * (q.y * q.y / 2)) * bend;
    };
    const Polygon& shape = shapes[i];
    const double sense = cross(image.u, image.v);
    Deposit deposit{.count = shape.count, .mirrored = sense < 0};
    const auto corners = static_cast<std::size_t>(shape.count);
    bool convex = true;
    for (std::size_t m = 0; m < corners; ++m) deposit.corners[m] = at(shape.at[m], 1);
    for (std::size_t m = 0; m < corners; ++m) {
      const auto corner = [&](std::size_t next) { return deposit.corners[(m + next) % corners]; };
      convex = convex && cross(corner(1) - corner(0), corner(2) - corner(1)) * sense > 0;
    }
    // Near a caustic the parallelogram of the tangents stays simple.
    for (std::size_t m = 0; m < corners && !convex; ++m) deposit.corners[m] = at(shape.at[m], 0);
    if (const Image* next = neighbour(i, 0, 1); next && convex) {
      const Vec2<double> gap = at({0.5, 0.5}, 1) - next->at + next->u * 0.5 - next->v * 0.5 - (mixed * -0.25) -
                               (bend_u[0] + bend_v[1]) * 0.125;
      result.mismatch_mm = std::max(result.mismatch_mm, glm::length(gap));
    }
    result.cell_mm = std::max({result.cell_mm, glm::length(image.u), glm::length(image.v)});
    deposit.energy =
        transmittances(in_box[k]) * shape.area() * step.x * step.y * entrance.flux(box.low + step * position(i));
    result.energy += deposit.energy;
    result.deposits.push_back(deposit);
  }
  return result;
}

}  // namespace petzval::ghosts_detail
