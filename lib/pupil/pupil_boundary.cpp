// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/pupil_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "aim.hpp"
#include "clearance.hpp"
#include "core/bisect.hpp"
#include "face.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::inline v0 {
namespace {

using Point = Vec2<double>;

struct Box {
  Point low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void take(const Point& p) noexcept {
    for (int i : {0, 1}) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
  }
  Point middle() const noexcept { return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2}; }
  Point half() const noexcept { return {(high[0] - low[0]) / 2, (high[1] - low[1]) / 2}; }
};

/// An end of a span: the last radius that passes, with the clearance of its ray and of the next one outside.
struct Edge {
  double radius;
  pupil_detail::Clearance inside, outside;
};

/// Looks along the directions of an boundary. Radii are in units of its half axes.
class Tracer {
 public:
  Tracer(const Lens& lens, PupilBoundary& boundary)
      : lens_(lens), boundary_(boundary), middle_(clearance(boundary.middle)) {}

  bool middle_passes() const noexcept { return middle_.passes(); }

  /// One span from the middle, which passes; it is expected to end about `near`.
  void trace_disc(std::size_t direction, double near) {
    begin(direction, {0, middle_, {}});
    finish(outer_edge(direction, near, 0, middle_));
  }

  /// One span of a ring, expected to end about where that of the direction before does. False where it does not.
  bool trace_ring(std::size_t direction, double near_from, double near_to) {
    const double low = 0.95 * near_from, high = 1.05 * near_from;
    const auto dark = clearance(boundary_.at(direction, low)), inside = clearance(boundary_.at(direction, high));
    if (dark.passes() || !inside.passes() || !(high < near_to)) return false;
    begin(direction, close_in(direction, {high, inside, dark}, low));
    finish(outer_edge(direction, near_to, high, inside));
    return true;
  }

  /// All spans between the middle and `reach` that `steps` samples show.
  void scan_spans(std::size_t direction, double reach, int steps) {
    double before = 0;
    auto last = middle_;
    if (last.passes()) begin(direction, {0, middle_, {}});
    for (int i = 1; i <= steps; ++i) {
      const double radius = reach * i / steps;
      const auto now = clearance(boundary_.at(direction, radius));
      if (now.passes() && !last.passes()) begin(direction, close_in(direction, {radius, now, last}, before));
      if (!now.passes() && last.passes()) finish(close_in(direction, {before, last, now}, radius));
      before = radius, last = now;
    }
    // No ray beyond `reach` enters the first surface: one that passes there touches its rim.
    if (last.passes()) finish({reach, last, last});
  }

 private:
  pupil_detail::Clearance clearance(const Point& p) const noexcept {
    return pupil_detail::clearance(lens_, boundary_.plane, p[0], p[1], boundary_.wavelength);
  }

  /// The end about `near`, farther out than a ray that passes.
  Edge outer_edge(std::size_t direction, double near, double passing, const pupil_detail::Clearance& passes) const {
    double low = 0.95 * near, high = 1.05 * near;
    auto inside = clearance(boundary_.at(direction, low)), outside = clearance(boundary_.at(direction, high));
    while (inside.passes() && outside.passes()) {
      low = high, inside = outside;
      outside = clearance(boundary_.at(direction, high *= 1.25));
    }
    if (inside.passes()) return close_in(direction, {low, inside, outside}, high);
    return close_in(direction, {passing, passes, inside}, low);
  }

  /// The end between a ray that passes and the radius of one that does not.
  Edge close_in(std::size_t direction, Edge edge, double outside) const {
    constexpr double tolerance = 4e-14;
    edge.radius = core_detail::last_above(edge.radius, edge.inside.value, outside, edge.outside.value, tolerance,
                                          [&](double radius) {
                                            const auto now = clearance(boundary_.at(direction, radius));
                                            (now.passes() ? edge.inside : edge.outside) = now;
                                            return now.value;
                                          });
    return edge;
  }

  RimPoint public_edge(std::size_t direction, const Edge& edge) const noexcept {
    const Vec2<double> p = boundary_.at(direction, edge.radius);
    return {p.x, p.y, edge.outside.surface, edge.outside.fate};
  }
  void begin(std::size_t direction, const Edge& edge) {
    boundary_.spans.push_back({direction, edge.radius, 0, public_edge(direction, edge), {}});
  }
  void finish(const Edge& edge) {
    PupilSpan& span = boundary_.spans.back();
    span.to_radius = edge.radius;
    span.to = public_edge(span.direction, edge);
  }

  const Lens& lens_;
  PupilBoundary& boundary_;
  pupil_detail::Clearance middle_;
};

/// The part of the plane that rays cross on their way to the surface through which they enter: the shadow of a box
/// around that surface.
Box shadow(const Lens& lens, const PupilPlane& plane) {
  const std::size_t entered = plane.travel() == Travel::to_film ? 0 : lens.surface_count() - 1;
  const pupil_detail::Face face =
      pupil_detail::face_of(lens, entered, pupils(lens, lens.primary_wavelength()).entrance);
  Box box;
  for (const double z : {face.z_min, face.z_max}) {
    for (const double y : {-face.half, face.half}) {
      for (const double x : {-face.half, face.half}) {
        const Vec3<double> corner{x, y, z};
        box.take(plane.meet({corner, plane.direction_at(corner)}));
      }
    }
  }
  return box;
}

/// Searches for a ray that passes about a middle. As a function over the plane, the least clearance of all rims has one
/// maximum where rays pass the lens at all: the grid closes in on it.
std::optional<Point> summit_near(const Lens& lens, const PupilPlane& plane, std::size_t wavelength, Point middle,
                                 Point half) {
  int steps = 16;  // a side, from the middle
  for (int pass = 0; pass < 24; ++pass) {
    double highest = -std::numeric_limits<double>::infinity();
    Point summit = middle;
    for (int j = -steps; j <= steps; ++j) {
      for (int i = -steps; i <= steps; ++i) {
        const Point p{middle[0] + half[0] * i / steps, middle[1] + half[1] * j / steps};
        const auto here = pupil_detail::clearance(lens, plane, p[0], p[1], wavelength);
        if (here.passes()) return p;
        if (here.value > highest) highest = here.value, summit = p;
      }
    }
    middle = summit;
    half = {2 * half[0] / steps, 2 * half[1] / steps};
    steps = 4;
  }
  return {};
}

/// A ray that passes, if there is one: the chief ray, or one that is found about it or anywhere.
std::optional<Point> passing_point(const Lens& lens, const PupilPlane& plane, std::size_t wavelength, const Box& box) {
  const AimedRay chief = pupil_detail::aim(lens, plane, {}, wavelength);
  if (chief.status == AimStatus::converged) return plane.meet(chief.ray);
  const Point half = box.half();
  if (chief) {
    const auto near = summit_near(lens, plane, wavelength, plane.meet(chief.ray), {half[0] / 2, half[1] / 2});
    if (near) return near;
  }
  return summit_near(lens, plane, wavelength, box.middle(), half);
}

/// The largest radius, in units of half axes, at which the box has a point.
double reach(const Box& box, const Point& middle, const Point& half_axes) noexcept {
  double farthest = 0;
  for (const double x : {box.low[0], box.high[0]}) {
    for (const double y : {box.low[1], box.high[1]}) {
      farthest = std::max(farthest, std::hypot((x - middle[0]) / half_axes[0], (y - middle[1]) / half_axes[1]));
    }
  }
  return farthest;
}

/// The shape of a region: from its middle one span in each direction, a ring around the middle, or anything else.
enum class Shape { disc, ring, other };

/// Finds middle and half axes of the region: first as seen from a ray that passes, then from the middle found last,
/// until they settle.
Shape measure(const Lens& lens, PupilBoundary& boundary, const Point& start, const Box& box) {
  boundary.middle = start;
  boundary.half_axes = box.half();
  Shape shape = Shape::disc;
  for (int pass = 0; pass < 6; ++pass) {
    // Horseshoes and crescents, whose tips lie behind their own edges, need more directions and steps.
    const bool simple = shape != Shape::other;
    boundary.directions = simple ? 24 : 96;
    const int steps = simple ? 32 : 128;
    const double farthest = reach(box, boundary.middle, boundary.half_axes);
    boundary.spans.clear();
    Tracer tracer(lens, boundary);
    // A region with one span in each direction from one of its points has one from its middle.
    const bool disc = pass > 0 && shape == Shape::disc && tracer.middle_passes();
    for (std::size_t k = 0; k < boundary.directions; ++k) {
      if (disc) {
        tracer.trace_disc(k, 1);
      } else {
        tracer.scan_spans(k, farthest, steps);
      }
    }
    if (boundary.spans.empty()) break;
    const bool one_each = boundary.spans.size() == boundary.directions;
    shape = !one_each ? Shape::other : tracer.middle_passes() ? Shape::disc : Shape::ring;
    Box seen;
    for (const PupilSpan& s : boundary.spans) seen.take({s.from.x, s.from.y}), seen.take({s.to.x, s.to.y});
    const Point before = std::exchange(boundary.half_axes, seen.half());
    boundary.middle = seen.middle();
    const bool settled =
        std::abs(boundary.half_axes[0] / before[0] - 1) < 0.1 && std::abs(boundary.half_axes[1] / before[1] - 1) < 0.1;
    if (settled && simple == (shape != Shape::other)) break;
  }
  return shape;
}

/// The boundary, from a ray that passes, within a box. It stays empty where the pupil is smaller than what rays
/// resolve.
void trace_boundary(const Lens& lens, PupilBoundary& boundary, const Point& start, const Box& box,
                    std::size_t directions) {
  constexpr int steps = 96;
  if (directions == 1) {  // alike all round
    boundary.directions = 1;
    boundary.half_axes = {std::max(box.half()[0], box.half()[1]), std::max(box.half()[0], box.half()[1])};
    Tracer(lens, boundary).scan_spans(0, 1, steps);
    return;
  }
  Shape shape = measure(lens, boundary, start, box);
  if (!(boundary.half_axes[0] > 0 && boundary.half_axes[1] > 0)) {
    boundary = PupilBoundary(boundary.plane, boundary.wavelength);
    return;
  }
  const double farthest = std::min(reach(box, boundary.middle, boundary.half_axes), 1.5);
  boundary.directions = directions;
  boundary.spans.clear();
  Tracer tracer(lens, boundary);
  if (shape == Shape::disc && !tracer.middle_passes()) shape = Shape::other;
  for (std::size_t k = 0; k < directions; ++k) {
    // Spans change little from one direction to the next.
    const bool first = boundary.spans.empty();
    const double near_from = first ? 0 : boundary.spans.back().from_radius;
    const double near_to = first ? 1 : boundary.spans.back().to_radius;
    if (shape == Shape::disc) {
      tracer.trace_disc(k, near_to);
    } else if (shape == Shape::other || first || !tracer.trace_ring(k, near_from, near_to)) {
      tracer.scan_spans(k, farthest, steps);
    }
  }
}

PupilBoundary boundary_of(const Lens& lens, const PupilPlane& plane, Wavelength at, std::size_t directions) {
  const std::size_t wavelength = lens.compiled_position(at);
  if (directions < 3 && !(directions == 1 && plane.on_axis() && lens.rotationally_symmetric())) {
    throw Error(lens.name() + ": pupil boundary: directions is " + std::to_string(directions) +
                ", wanted 3 or more, or 1 on the axis of a lens of revolution");
  }
  PupilBoundary boundary(plane, wavelength);
  const auto closed = [](const LensSurface& s) { return s.semi_diameter == 0; };
  if (std::any_of(lens.surfaces().begin(), lens.surfaces().end(), closed)) return boundary;
  const Box box = shadow(lens, plane);
  const auto start = passing_point(lens, plane, wavelength, box);
  if (start) trace_boundary(lens, boundary, *start, box, directions);
  return boundary;
}

}  // namespace

PupilBoundary pupil_boundary(const Lens& lens, const FieldPoint& point, Wavelength wavelength, std::size_t directions) {
  return boundary_of(lens, PupilPlane(lens, point), wavelength, directions);
}

PupilBoundary exit_pupil_boundary(const Lens& lens, const FilmPoint& point, Wavelength wavelength,
                                  std::size_t directions) {
  return boundary_of(lens, PupilPlane::of_film(lens, point), wavelength, directions);
}

}  // namespace petzval::inline v0
