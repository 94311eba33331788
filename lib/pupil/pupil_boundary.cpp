// SPDX-License-Identifier: Apache-2.0
#include "pupil/pupil_boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "box.hpp"
#include "core/bisect.hpp"
#include "lens/without_obscurations.hpp"
#include "petzval/core/error.hpp"
#include "pupil_ray_tracer.hpp"
#include "pupil_region.hpp"

namespace petzval {
namespace {

using Point = Vec2<double>;
using pupil_detail::Box;
using pupil_detail::Coordinates;
using pupil_detail::PassingPoint;
using pupil_detail::PupilRayTracer;

/// The bounding box of the ends of all spans.
Box box_of(const PupilRegion& region) noexcept {
  Box box;
  for (const PupilSpan& s : region.spans) box.take({s.from.x, s.from.y}), box.take({s.to.x, s.to.y});
  return box;
}

/// A box inside the pupil and a box around it, computed from some passing rays on finer and finer grids.
std::pair<Box, Box> boxes_around(PupilRayTracer& ray_tracer, const std::vector<PassingPoint>& passing) {
  Box seen, box;
  for (const auto& [at, spacing] : passing) {
    seen.take(at);
    box.take(at - spacing), box.take(at + spacing);
  }
  std::vector<double> x, y;
  for (int pass = 0; pass < 32; ++pass) {
    const int steps = pass == 0 || seen.half().x > 0 ? 24 : 12;
    const Point low = box.low, step = box.half() * (2.0 / steps);
    x.clear(), y.clear();
    for (int j = 0; j <= steps; ++j) {
      for (int i = 0; i <= steps; ++i) x.push_back(low.x + i * step.x), y.push_back(low.y + j * step.y);
    }
    const auto clearance = ray_tracer.clearances(x, y);
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (clearance[i] >= 0) seen.take({x[i], y[i]});
    }
    // Components at the edge of the box may extend beyond the box.
    const Point before = std::exchange(box, {seen.low - step, seen.high + step}).half();
    if (box.half().x > before.x / 2 && box.half().y > before.y / 2 && seen.half().x > 2 * step.x &&
        seen.half().y > 2 * step.y) {
      break;
    }
  }
  return {seen, box};
}

/// Searches the boundary along all its directions together. Radii are in units of the half axes.
class Tracer {
 public:
  /// @param near a point of the component to keep; nullopt keeps all components
  Tracer(PupilRayTracer& ray_tracer, PupilBoundary& boundary, const std::optional<Point>& near)
      : ray_tracer_(ray_tracer), boundary_(boundary), near_(near) {}

  struct Seen {
    bool disc = true;   ///< one span in each direction, beginning at the middle
    bool whole = true;  ///< no span reaches the end of the scan
  };
  /// Finds all spans between the middle and `reach` from `steps` samples along each of `directions`, and also spans
  /// between two samples if the clearance indicates a passing ray.
  Seen scan(std::size_t directions, double reach, int steps, double tolerance) {
    begin(directions);
    sample(steps + 1, [&](std::size_t, int i) { return reach * i / steps; });
    const double step = reach / steps;
    const std::vector<Sliver> slivers = find_slivers(step, steps);
    auto sliver = slivers.begin();
    for (std::size_t k = 0; k < directions; ++k) {
      const double* value = values_.data() + k * (static_cast<std::size_t>(steps) + 1);
      for (int i = 0; i <= steps; ++i) {
        const bool passes = value[i] >= 0, before = i > 0 && value[i - 1] >= 0;
        if (passes && !before) {
          if (i == 0) {
            ends_.push_back({k, {0, 0, 0, 0, 1}});
          } else {
            ends_.push_back({k, {step * i, value[i], step * (i - 1), value[i - 1], tolerance}});
          }
        }
        if (!passes && before) {
          ends_.push_back({k, {step * (i - 1), value[i - 1], step * i, value[i], tolerance}});
        }
        if (sliver != slivers.end() && sliver->direction == k && sliver->sample == i) {
          const auto& [low, middle, high] = sliver->radii;
          const auto& [at_low, at_middle, at_high] = sliver->values;
          ends_.push_back({k, {middle, at_middle, low, at_low, tolerance}});
          ends_.push_back({k, {middle, at_middle, high, at_high, tolerance}});
          ++sliver;
        }
      }
      // Rays beyond `reach` miss the first surface: a ray that passes at `reach` touches its rim.
      if (value[steps] >= 0) ends_.push_back({k, {reach, 0, reach, 0, 1}});
    }
    finish();
    const auto& spans = boundary_.spans;
    Seen seen{.disc = spans.size() == directions};
    for (std::size_t i = 0; i < spans.size(); ++i) {
      seen.disc = seen.disc && spans[i].direction == i && spans[i].from_radius == 0;
      seen.whole = seen.whole && spans[i].to_radius < reach;
    }
    return seen;
  }

  /// Finds one span in each direction, beginning at the middle. The ends are predicted from `coarse`, which has fewer
  /// directions. Returns false if an end is not close to its prediction.
  bool disc(std::size_t directions, const PupilBoundary& coarse) {
    begin(directions);
    const auto near = [&](std::size_t k) {
      const auto n = static_cast<double>(coarse.directions);
      const double at = (static_cast<double>(k) + 0.5) / static_cast<double>(directions) * n - 0.5 + n;
      const auto i = static_cast<std::size_t>(at);
      const double t = at - static_cast<double>(i);
      const auto radius = [&](std::size_t j) { return coarse.spans[j % coarse.directions].to_radius; };
      return (1 - t) * radius(i) + t * radius(i + 1);
    };
    constexpr std::array<double, 4> trial_radii{0, 0.98, 1.02, 1.3};
    constexpr int count = trial_radii.size();
    sample(count, [&](std::size_t k, int i) { return trial_radii[i] * near(k); });
    for (std::size_t k = 0; k < directions; ++k) {
      const double* value = values_.data() + k * count;
      int last = 0;
      while (last < count && value[last] >= 0) ++last;
      if (last == 0 || last == count) return false;
      ends_.push_back({k, {0, 0, 0, 0, 1}});
      ends_.push_back({k,
                       {trial_radii[last - 1] * near(k), value[last - 1], trial_radii[last] * near(k), value[last],
                        radius_tolerance}});
    }
    finish();
    return true;
  }

  static constexpr double radius_tolerance = 4e-14;

 private:
  /// An end of a span during the search. Ends come in pairs: the inner end, then the outer end.
  struct End {
    std::size_t direction;
    core_detail::LastAbove radius;
  };

  /// An interval of a direction between two samples that do not pass, around a sample with a local maximum of
  /// clearance.
  struct Sliver {
    std::size_t direction;
    int sample;
    std::array<double, 3> radii, values;
  };

  /// The slivers that pass, sorted by direction and sample.
  std::vector<Sliver> find_slivers(double step, int steps) {
    std::vector<Sliver> result, open;
    const auto lost = [](double value) { return value <= -1; };  // not at a rim
    for (std::size_t k = 0; k < boundary_.directions; ++k) {
      const double* value = values_.data() + k * (static_cast<std::size_t>(steps) + 1);
      for (int i = 1; i < steps; ++i) {
        const double before = value[i - 1], here = value[i], next = value[i + 1];
        if (!(here < 0) || !(before < here) || !(next <= here) || lost(here) || (lost(before) && lost(next))) continue;
        open.push_back({k, i, {step * (i - 1), step * i, step * (i + 1)}, {before, here, next}});
      }
    }
    constexpr int rounds = 8;
    for (int round = 0; round < rounds && !open.empty(); ++round) {
      x_.clear(), y_.clear();
      for (const Sliver& s : open) {
        const Point unit = boundary_.unit(s.direction);
        add(unit, (s.radii[0] + s.radii[1]) / 2), add(unit, (s.radii[1] + s.radii[2]) / 2);
      }
      const auto values = ray_tracer_.clearances(x_, y_);
      std::size_t left = 0;
      for (std::size_t j = 0; j < open.size(); ++j) {
        const auto& [direction, sample, r, v] = open[j];
        const std::array<double, 5> radii{r[0], (r[0] + r[1]) / 2, r[1], (r[1] + r[2]) / 2, r[2]};
        const std::array<double, 5> all{v[0], values[2 * j], v[1], values[2 * j + 1], v[2]};
        const auto highest = std::clamp<std::ptrdiff_t>(std::max_element(all.begin(), all.end()) - all.begin(), 1, 3);
        const auto part = [&](const std::array<double, 5>& of) {
          return std::array<double, 3>{of[highest - 1], of[highest], of[highest + 1]};
        };
        const Sliver closer{direction, sample, part(radii), part(all)};
        if (all[highest] >= 0) {
          result.push_back({direction, sample, {r[0], radii[highest], r[2]}, {v[0], all[highest], v[2]}});
        } else {
          open[left++] = closer;
        }
      }
      open.resize(left);
    }
    std::sort(result.begin(), result.end(), [](const Sliver& a, const Sliver& b) {
      return std::pair(a.direction, a.sample) < std::pair(b.direction, b.sample);
    });
    return result;
  }

  void begin(std::size_t directions) {
    boundary_.directions = directions;
    boundary_.spans.clear();
    ends_.clear();
  }

  template <class Radius>
  void sample(int count, const Radius& radius) {
    x_.clear(), y_.clear();
    for (std::size_t k = 0; k < boundary_.directions; ++k) {
      const Point unit = boundary_.unit(k);
      for (int i = 0; i < count; ++i) add(unit, radius(k, i));
    }
    const auto values = ray_tracer_.clearances(x_, y_);
    values_.assign(values.begin(), values.end());
  }
  /// Uses the same arithmetic as PupilRegion::at(), so that results are equal to the bit.
  void add(const Point& unit, double radius) {
    x_.push_back(boundary_.middle.x + boundary_.half_axes.x * radius * unit.x);
    y_.push_back(boundary_.middle.y + boundary_.half_axes.y * radius * unit.y);
  }

  /// Refines all ends and turns each pair of ends into a span.
  void finish() {
    std::vector<Point> units;
    for (std::size_t k = 0; k < boundary_.directions; ++k) units.push_back(boundary_.unit(k));
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      if (!ends_[i].radius.done()) open.push_back(i);
    }
    while (!open.empty()) {
      x_.clear(), y_.clear();
      for (const std::size_t i : open) add(units[ends_[i].direction], ends_[i].radius.next());
      const auto values = ray_tracer_.clearances(x_, y_);
      std::size_t left = 0;
      for (std::size_t j = 0; j < open.size(); ++j) {
        core_detail::LastAbove& radius = ends_[open[j]].radius;
        radius.take(values[j]);
        if (!radius.done()) open[left++] = open[j];
      }
      open.resize(left);
    }
    // Rays just outside the pupil show which surface limits each end.
    x_.clear(), y_.clear();
    for (const End& end : ends_) add(units[end.direction], end.radius.below());
    const auto [fates, surfaces] = ray_tracer_.ends(x_, y_);
    const auto rim = [&, &lost_by = fates, &lost_at = surfaces](std::size_t i) -> RimPoint {
      const double radius = ends_[i].radius.above();
      const Point p = boundary_.at(ends_[i].direction, radius);
      const bool is_rim = radius > 0;
      return {p.x, p.y, is_rim ? lost_at[i] : -1, is_rim ? lost_by[i] : RayFate::vignetted};
    };
    for (std::size_t i = 0; i < ends_.size(); i += 2) {
      boundary_.spans.push_back(
          {ends_[i].direction, ends_[i].radius.above(), ends_[i + 1].radius.above(), rim(i), rim(i + 1)});
    }
    if (near_) pupil_detail::keep_connected(boundary_, *near_);
  }

  PupilRayTracer& ray_tracer_;
  PupilBoundary& boundary_;
  std::optional<Point> near_;
  std::vector<double> x_, y_, values_;
  std::vector<End> ends_;
};

/// Reach of a scan in half axes; the corners of the bounding box are at sqrt(2).
constexpr double farthest = 1.6;

/// Traces the boundary, starting from some passing rays. The boundary stays empty if the pupil is too small to trace.
///
/// The pupil is connected: the component nearest to the chief ray is kept, or nearest to the mean of the given rays if
/// there is no chief ray.
void trace_boundary(PupilRayTracer& ray_tracer, PupilBoundary& boundary, const std::vector<PassingPoint>& passing,
                    std::size_t directions) {
  const auto [inner, box] = boxes_around(ray_tracer, passing);
  const Point near = ray_tracer.chief().value_or(inner.middle());
  boundary.middle = box.middle(), boundary.half_axes = box.half();
  Tracer tracer(ray_tracer, boundary, near);
  if (directions == 1) {  // rotationally symmetric
    const double reach =
        std::max({std::abs(box.low.x), std::abs(box.high.x), std::abs(box.low.y), std::abs(box.high.y)});
    boundary.middle = {0, 0}, boundary.half_axes = {reach, reach};
    tracer.scan(1, farthest, 512, Tracer::radius_tolerance);
    return;
  }
  // Compute the middle and the half axes from the ends along a few directions, repeatedly until they settle.
  Tracer::Seen shape;
  for (int pass = 0; pass < 6; ++pass) {
    if (!(boundary.half_axes.x > 0 && boundary.half_axes.y > 0)) break;
    // The tips of horseshoes and crescents are hidden behind other parts of the pupil and need more directions and
    // steps.
    const int samples = shape.disc ? 32 : 96;
    const bool simple = shape.disc;
    shape = tracer.scan(samples, farthest, samples, 1e-10);
    if (boundary.spans.empty()) break;
    const Box seen = box_of(boundary);
    const Point before = std::exchange(boundary.half_axes, seen.half());
    boundary.middle = seen.middle();
    const Point now = boundary.half_axes;
    const bool settled = std::abs(now.x / before.x - 1) < 0.1 && std::abs(now.y / before.y - 1) < 0.1;
    if (settled && shape.whole && simple == shape.disc) break;
  }
  if (!(boundary.half_axes.x > 0 && boundary.half_axes.y > 0) || boundary.spans.empty()) {
    boundary = PupilBoundary(boundary.plane, boundary.wavelength);
    return;
  }
  // A scan with more directions may reveal a larger pupil.
  for (int pass = 0; pass < 4; ++pass) {
    bool found = false;
    if (shape.disc && directions > 32 && tracer.scan(32, farthest, 32, 1e-6).disc) {
      const PupilBoundary coarse = boundary;
      found = tracer.disc(directions, coarse);
    }
    shape.whole = found || tracer.scan(directions, farthest, 96, Tracer::radius_tolerance).whole;
    const Box seen = box_of(boundary);
    const Point now = seen.half(), before = boundary.half_axes;
    if (shape.whole && now.x < 1.1 * before.x && now.y < 1.1 * before.y) break;
    if (pass + 1 < 4) boundary.middle = seen.middle(), boundary.half_axes = now;
  }
}

/// The boundary of a lens without obscurations.
PupilBoundary open_boundary(const Lens& lens, const PupilPlane& plane, std::size_t wavelength, std::size_t directions,
                            Coordinates coordinates) {
  PupilBoundary boundary(plane, wavelength);
  const auto closed = [](const LensSurface& s) { return s.semi_diameter == 0; };
  if (std::any_of(lens.surfaces().begin(), lens.surfaces().end(), closed)) return boundary;
  PupilRayTracer ray_tracer(lens, plane, wavelength, coordinates);
  if (directions == 1) {  // one line suffices, unless the pupil is narrower than a step
    const double reach = ray_tracer.reach();
    boundary.half_axes = {reach, reach};
    if (reach > 0) Tracer(ray_tracer, boundary, Point{0, 0}).scan(1, 1, 512, Tracer::radius_tolerance);
    if (!boundary.empty()) {
      const double radius = boundary.spans.back().to_radius;
      if (!(radius > 0)) return boundary;
      for (PupilSpan& span : boundary.spans) span.from_radius /= radius, span.to_radius /= radius;
      boundary.half_axes *= radius;
      return boundary;
    }
    boundary = PupilBoundary(plane, wavelength);
  }
  const std::vector<PassingPoint> passing = ray_tracer.passing_points();
  if (!passing.empty()) trace_boundary(ray_tracer, boundary, passing, directions);
  return boundary;
}

/// The boundary minus the obscurations.
PupilBoundary obscured_boundary(const Lens& lens, const PupilBoundary& open, Coordinates coordinates) {
  PupilBoundary result = open;
  if (open.empty()) return result;
  PupilRayTracer ray_tracer(lens, open.plane, open.wavelength, coordinates);
  const bool one = open.directions == 1;
  Tracer(ray_tracer, result, {}).scan(open.directions, farthest, one ? 512 : 192, Tracer::radius_tolerance);
  pupil_detail::keep_within(result, open);
  return result;
}

PupilBoundary boundary_of(const Lens& lens, const PupilPlane& plane, Wavelength at, std::size_t directions,
                          Coordinates coordinates = Coordinates::plane) {
  const std::size_t wavelength = lens.wavelength_index(at);
  constexpr std::size_t max_directions = 1 << 20;
  const bool one_is_enough = plane.on_axis() && lens.rotationally_symmetric();
  if ((directions < 3 || directions > max_directions) && !(directions == 1 && one_is_enough)) {
    throw Error(lens.name() + ": pupil boundary: directions = " + std::to_string(directions) + "; must be 3 to " +
                std::to_string(max_directions) + ", or 1 on the axis of a lens of revolution");
  }
  if (!has_obscurations(lens)) {
    return open_boundary(lens, plane, wavelength, directions, coordinates);
  }
  const Lens open = without_obscurations(lens);
  return obscured_boundary(lens, open_boundary(open, plane, wavelength, directions, coordinates), coordinates);
}

}  // namespace

PupilBoundary pupil_boundary(const Lens& lens, const FieldPoint& point, Wavelength wavelength, std::size_t directions) {
  return boundary_of(lens, PupilPlane(lens, point), wavelength, directions);
}

PupilBoundary exit_pupil_boundary(const Lens& lens, const FilmPoint& point, Wavelength wavelength,
                                  std::size_t directions) {
  return boundary_of(lens, PupilPlane::of_film(lens, point), wavelength, directions);
}

PupilRegion pupil_detail::pupil_in_angles(const Lens& lens, const FilmPoint& point, Wavelength wavelength,
                                          std::size_t directions) {
  return boundary_of(lens, PupilPlane::of_film(lens, point), wavelength, directions, Coordinates::angles);
}

}  // namespace petzval
