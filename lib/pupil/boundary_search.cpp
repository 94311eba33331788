// SPDX-License-Identifier: Apache-2.0
#include "boundary_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "pupil_estimate.hpp"
#include "pupil_region.hpp"

namespace petzval::pupil_detail {
namespace {

/// Tolerance of span ends, in half axes.
constexpr double tolerance = 2e-5;

class Search {
 public:
  Search(std::span<const PupilGuess> points, std::size_t directions, bool mirrored,
         const PositionClearances& clearances, const ConnectedPupils* connected)
      : points_(points),
        directions_(directions),
        traced_(mirrored ? directions / 2 : directions),
        mirrored_(mirrored),
        clearances_(&clearances),
        connected_(connected),
        estimates_(points.size()) {
    PupilRegion unit_circle{.half_axes = {1, 1}, .directions = directions};
    for (std::size_t k = 0; k < directions; ++k) units_.push_back(unit_circle.unit(k));
  }

  bool lit(std::size_t point) const noexcept { return !estimates_[point].empty(); }

  std::vector<PupilRegion> regions() const {
    std::vector<PupilRegion> result;
    result.reserve(estimates_.size());
    for (std::uint32_t p = 0; p < estimates_.size(); ++p) {
      result.push_back(region_of(estimates_[p], units_));
      const bool disconnected = result[p].spans.size() > directions_ || !estimates_[p].gaps.empty();
      if (connected_ && disconnected) keep_connected(result[p], connected_->chief(p).value_or(result[p].middle));
    }
    return result;
  }

  /// The pupils that were found, minus the obscurations, which `clearances` includes.
  std::vector<PupilRegion> obscured_regions(const PositionClearances& clearances) {
    const std::vector<PupilRegion> open = regions();
    clearances_ = &clearances;
    connected_ = nullptr;
    std::vector<std::uint32_t> lit;
    for (std::uint32_t p = 0; p < open.size(); ++p) {
      if (!open[p].empty()) lit.push_back(p);
    }
    outwards_near(lit, 320, true);
    outwards_far(lit, true);
    std::vector<PupilRegion> result = regions();
    for (std::size_t p = 0; p < open.size(); ++p) keep_within(result[p], open[p]);
    return result;
  }

  /// Finds pupils without a prediction from their neighbours.
  void in_full(std::span<const std::uint32_t> which) {
    std::vector<std::uint32_t> seen, rings;
    look_along_y(which, seen, rings);
    across(seen, Reach::near);
    std::vector<std::uint32_t> discs;
    for (const std::uint32_t p : seen) {
      if (std::find(rings.begin(), rings.end(), p) == rings.end()) discs.push_back(p);
    }
    outwards_near(discs, 24, false);
    outwards_near(rings, 320, true);
    outwards_far(discs, false);
    outwards_far(rings, true);
  }

  /// True for each point with at least one ray that passes.
  std::vector<bool> lit_points() {
    std::vector<std::uint32_t> all(points_.size()), seen, rings;
    std::iota(all.begin(), all.end(), 0u);
    std::vector<bool> lit(points_.size(), true);
    for (const std::uint32_t p : look_along_y(all, seen, rings)) lit[p] = false;
    return lit;
  }

  /// Finds pupils about halfway between two known pupils: the search starts from the mean of their ends. Pupils far
  /// from this prediction are searched in full.
  void between(std::span<const Halfway> which) {
    std::vector<std::uint32_t> points, disconnected;
    for (const Halfway& halfway_point : which) {
      const PupilEstimate &a = estimates_[halfway_point.before], &b = estimates_[halfway_point.after];
      if (!a.gaps.empty() || !b.gaps.empty()) {
        disconnected.push_back(halfway_point.point);
        continue;
      }
      const Interpolation at(estimates_[halfway_point.far_before], a, b, estimates_[halfway_point.far_after]);
      PupilEstimate& found = estimates_[halfway_point.point];
      for (int i : {0, 1}) {
        found.middle[i] = at([i](const PupilEstimate& f) { return f.middle[i]; });
        found.half_axes[i] = at.positive([i](const PupilEstimate& f) { return f.half_axes[i]; });
      }
      found.ends.assign(directions_, {});
      for (std::size_t k = 0; k < directions_; ++k) {
        const PupilEstimate::Ends &p = a.ends[k], &q = b.ends[k];
        const auto mean = [](double x, double y) { return (x + y) / 2; };
        found.ends[k] = {mean(p.obscured_from, q.obscured_from), mean(p.obscured_to, q.obscured_to),
                         at.positive([k](const PupilEstimate& f) { return f.ends[k].to; }),
                         p.slope < 0 && q.slope < 0 ? mean(p.slope, q.slope) : 0};
      }
      points.push_back(halfway_point.point);
    }
    // In batches of 8, to reuse buffers.
    constexpr std::size_t batch_size = 8;
    std::vector<std::uint32_t> lost;
    for (std::size_t begin = 0; begin < points.size(); begin += batch_size) {
      const auto group = std::span(points).subspan(begin, std::min(batch_size, points.size() - begin));
      std::vector<std::uint32_t> moved;
      for (const std::uint32_t point : settle(group)) lost.push_back(point);
      for (const std::uint32_t point : group) {
        if (recentre(estimates_[point], units_)) moved.push_back(point);
      }
      for (const std::uint32_t point : settle(moved)) lost.push_back(point);
    }
    for (const std::uint32_t point : lost) estimates_[point] = {};
    lost.insert(lost.end(), disconnected.begin(), disconnected.end());
    in_full(lost);
  }

 private:
  enum class Reach { near, far };

  /// Finds outer ends for which the slope of the clearance is predicted: from the slope directly if the end is close
  /// enough, else by one Newton step and one secant step. by_slope_ is true for the ends found in this way.
  void step_to_ends(std::span<const std::uint32_t> which, double relative_step) {
    struct Step {
      std::uint32_t point;
      std::size_t direction;
      double from, at_from = 0, to = 0;
    };
    std::vector<Step> steps;
    Batch batch;
    for (const std::uint32_t point : which) {
      for (std::size_t k = 0; k < traced_; ++k) {
        const PupilEstimate::Ends& ends = estimates_[point].ends[k];
        if (!(ends.slope < 0)) continue;
        steps.push_back({point, k, ends.to});
        batch.add(outward(point, k), ends.to);
      }
    }
    by_slope_.assign(steps.size(), false);
    batch.test(*clearances_);
    const auto put = [&](std::size_t i, double end, double slope) {
      const auto& [point, k, from, at_from, to] = steps[i];
      by_slope_[i] = true;
      PupilEstimate& found = estimates_[point];
      found.ends[k].to = end, found.ends[k].slope = slope;
      if (mirrored_) found.ends[directions_ - 1 - k].to = end;
    };
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      Step& step = steps[i];
      const double slope = estimates_[step.point].ends[step.direction].slope;
      step.at_from = batch.clearances[i];
      const double by = step.at_from / slope;
      step.to = step.from - std::clamp(by, -relative_step * step.from, relative_step * step.from);
      if (step.at_from > -1 && std::abs(by) < tolerance / 2) {
        put(i, step.to, slope);
      } else {
        open.push_back(i);
      }
    }
    batch.clear();
    for (const std::size_t i : open) batch.add(outward(steps[i].point, steps[i].direction), steps[i].to);
    batch.test(*clearances_);
    for (std::size_t j = 0; j < open.size(); ++j) {
      const auto& [point, k, from, at_from, to] = steps[open[j]];
      const double expected = estimates_[point].ends[k].slope, at_to = batch.clearances[j];
      const double slope = std::abs(to - from) > 1e-6 * from ? (at_to - at_from) / (to - from) : expected;
      const double end = to - at_to / slope;
      constexpr double max_slope_ratio = 2, max_distance = 5 * tolerance;
      const bool found = at_from > -1 && at_to > -1 && slope < expected / max_slope_ratio &&
                         slope > expected * max_slope_ratio && std::abs(end - to) < max_distance;
      if (found) put(open[j], end, slope);
    }
  }

  /// Finds the ends of some pupils close to their predicted positions. Returns the pupils whose ends were not found.
  std::vector<std::uint32_t> settle(std::span<const std::uint32_t> which) {
    constexpr double relative_step = 0.01;
    step_to_ends(which, relative_step);
    std::vector<Line> lines;
    std::vector<Bracket> brackets;
    std::size_t at = 0;
    for (const std::uint32_t point : which) {
      for (std::size_t k = 0; k < traced_; ++k) {
        const auto outer = [&](double LineExtent::*end, double s) {
          brackets.push_back({lines.size(), s * (1 - relative_step), s * (1 + relative_step), 1, -1, end});
        };
        const auto& [from, to, end, slope] = estimates_[point].ends[k];
        const bool settled = slope < 0 && by_slope_[at++];
        if (!settled) outer(&LineExtent::to, end);
        if (from > 0) outer(&LineExtent::obscured_from, from);
        if (to > 0)
          brackets.push_back(
              {lines.size(), to * (1 + relative_step), to * (1 - relative_step), 1, -1, &LineExtent::obscured_to});
        lines.push_back(outward(point, k));
      }
    }
    std::vector<bool> nowhere(which.size(), false);
    for (const Bracket& b : widened(brackets, lines)) nowhere[b.line / traced_] = true;
    std::erase_if(brackets, [&](const Bracket& b) { return nowhere[b.line / traced_]; });
    close_in(brackets, lines, tolerance, *clearances_);
    for (const Bracket& b : brackets) {
      PupilEstimate& found = estimates_[lines[b.line].point];
      const std::size_t k = b.line % traced_;
      const auto set = [&](PupilEstimate::Ends& ends) {
        if (b.end == &LineExtent::to) ends.slope = b.slope();
        (b.end == &LineExtent::to            ? ends.to
         : b.end == &LineExtent::obscured_to ? ends.obscured_to
                                             : ends.obscured_from) = b.found;
      };
      set(found.ends[k]);
      if (mirrored_) set(found.ends[directions_ - 1 - k]);
    }
    std::vector<std::uint32_t> lost;
    for (std::size_t i = 0; i < which.size(); ++i) {
      if (!nowhere[i]) continue;
      estimates_[which[i]].ends.clear();
      lost.push_back(which[i]);
    }
    return lost;
  }

  /// Moves both sides of each bracket that does not enclose its end, with a step that doubles in every round. Returns
  /// the brackets that still enclose no end.
  std::vector<Bracket> widened(std::vector<Bracket>& brackets, const std::vector<Line>& lines) {
    std::vector<std::size_t> open(brackets.size());
    std::iota(open.begin(), open.end(), std::size_t{0});
    Batch batch;
    constexpr int widenings = 4;
    for (int round = 0; round <= widenings && !open.empty(); ++round) {
      batch.clear();
      for (const std::size_t j : open) {
        batch.add(lines[brackets[j].line], brackets[j].with);
        batch.add(lines[brackets[j].line], brackets[j].without);
      }
      batch.test(*clearances_);
      std::size_t left = 0;
      for (std::size_t i = 0; i < open.size(); ++i) {
        Bracket& b = brackets[open[i]];
        const bool with = batch.passes(2 * i), without = batch.passes(2 * i + 1);
        b.at_with = batch.clearances[2 * i], b.at_without = batch.clearances[2 * i + 1];
        if (with && !without) continue;
        const double bracket_width = (b.with - b.without) * 2;
        if (!with) b.without = std::exchange(b.with, std::max(b.with + bracket_width, 0.0));
        if (with) b.with = std::exchange(b.without, std::max(b.without - bracket_width, 0.0));
        open[left++] = open[i];
      }
      open.resize(left);
    }
    std::vector<Bracket> lost;
    for (const std::size_t j : open) lost.push_back(brackets[j]);
    return lost;
  }

  /// Extents along y, as in along_y(), with smaller and smaller steps. Returns the points without any ray that passes.
  std::vector<std::uint32_t> look_along_y(std::span<const std::uint32_t> which, std::vector<std::uint32_t>& seen,
                                          std::vector<std::uint32_t>& rings) {
    // The pupil may be far from its predicted position, or narrower than a step: repeat on the whole line with smaller
    // steps.
    auto dark = along_y(which, Reach::near, 128, seen, rings);
    dark = along_y(dark, Reach::far, 256, seen, rings);
    return along_y(dark, Reach::far, 1024, seen, rings);
  }

  /// Extents along y. Appends points with rays that pass to `seen`, and also to `rings` if they have an obscuration.
  /// Returns the other points, including points whose extent leaves the range near the prediction.
  std::vector<std::uint32_t> along_y(std::span<const std::uint32_t> which, Reach reach, int samples,
                                     std::vector<std::uint32_t>& seen, std::vector<std::uint32_t>& rings) {
    std::vector<Line> lines;
    for (const std::uint32_t p : which) {
      const PupilGuess& g = points_[p];
      const bool near = reach == Reach::near && g.near > 0;
      lines.push_back({p, g.x, near ? g.y : (g.low + g.high) / 2, 0, near ? g.near : (g.high - g.low) / 2});
    }
    const auto extent = extents_along(lines, -1, 1, samples, tolerance, *clearances_, component_along_y(which, lines));
    std::vector<std::uint32_t> left;
    for (std::size_t i = 0; i < which.size(); ++i) {
      const LineExtent& e = extent[i];
      if (!e.any || (reach == Reach::near && (e.from == -1 || e.to == 1))) {
        left.push_back(which[i]);
        continue;
      }
      PupilEstimate& found = estimates_[which[i]];
      const PupilGuess& g = points_[which[i]];
      const double half = lines[i].dy, low = lines[i].y + half * e.from, high = lines[i].y + half * e.to;
      found.middle = {lines[i].x, (low + high) / 2};
      found.half_axes[1] = (high - low) / 2;
      // A clipped ring keeps the centre of the complete ring as its origin, although no ray passes there.
      if (g.ring && g.y > low - g.radius && g.y < high + g.radius) {
        found.middle[1] = g.y;
        found.half_axes[1] = std::max(high - g.y, g.y - low);
      }
      seen.push_back(which[i]);
      if (g.ring || e.obscured_from < e.obscured_to) rings.push_back(which[i]);
    }
    return left;
  }

  /// Selects the component of each line along y that contains the chief ray.
  ComponentOfLine component_along_y(std::span<const std::uint32_t> which, const std::vector<Line>& lines) const {
    if (!connected_) return {};
    return [this, which, &lines](std::size_t l) -> std::optional<double> {
      const auto chief = connected_->chief(which[l]);
      return chief ? std::optional((chief->y - lines[l].y) / lines[l].dy) : std::nullopt;
    };
  }

  /// Extents along x through the middle of the extents along y. The tolerance of the ends is relative to the length of
  /// the line, so tiny pupils are searched on a short line around the middle first.
  void across(std::span<const std::uint32_t> which, Reach reach) {
    constexpr double tiny_pupil_ratio = 1e-4, near_reach_ratio = 32;
    std::vector<Line> lines;
    std::vector<bool> close;
    std::vector<std::uint32_t> far;
    for (const std::uint32_t p : which) {
      const PupilGuess& g = points_[p];
      const double half = estimates_[p].half_axes[1], all = std::max({(g.high - g.low) / 2, 2 * g.radius, 2 * half});
      close.push_back(reach == Reach::near && half < tiny_pupil_ratio * all);
      lines.push_back(
          {p, estimates_[p].middle[0], estimates_[p].middle[1], close.back() ? near_reach_ratio * half : all, 0});
    }
    const auto extent = extents_along(lines, mirrored_ ? 0 : -1, 1, mirrored_ ? 96 : 192, tolerance, *clearances_);
    for (std::size_t i = 0; i < which.size(); ++i) {
      const LineExtent& e = extent[i];
      if (close[i] && (!e.any || e.from == -1 || e.to == 1)) {
        far.push_back(which[i]);
        continue;
      }
      PupilEstimate& found = estimates_[which[i]];
      const PupilGuess& g = points_[which[i]];
      found.half_axes[0] = found.half_axes[1];
      if (!e.any) continue;
      if (g.ring) {  // the line may miss the widest part of the ring
        found.half_axes[0] = std::max(found.half_axes[1], lines[i].dx * e.to);
        continue;
      }
      const double from = mirrored_ ? -e.to : e.from;
      found.middle[0] += lines[i].dx * (e.to + from) / 2;
      found.half_axes[0] = lines[i].dx * (e.to - from) / 2;
    }
    if (!far.empty()) across(far, Reach::far);
  }

  /// Line outwards from the middle in a direction, in coordinates in which the pupil is roughly a unit disc.
  Line outward(std::uint32_t point, std::size_t direction) const noexcept {
    const PupilEstimate& found = estimates_[point];
    const Vec2<double> half = found.half_axes * units_[direction];
    return {point, found.middle.x, found.middle.y, half.x, half.y};
  }

  /// Finds the ends along every `direction_step`-th traced direction and along the last direction.
  void outwards(std::span<const std::uint32_t> which, int samples, double reach, std::size_t direction_step = 1) {
    std::vector<std::size_t> looked;
    for (std::size_t k = 0; k < traced_; ++k) {
      if (k % direction_step == 0 || k + 1 == traced_) looked.push_back(k);
    }
    std::vector<Line> lines;
    for (const std::uint32_t p : which) {
      estimates_[p].ends.assign(directions_, {});
      estimates_[p].gaps.clear();
      for (const std::size_t k : looked) lines.push_back(outward(p, k));
    }
    const auto extent = extents_along(lines, 0, reach, samples, tolerance, *clearances_);
    for (std::size_t i = 0; i < extent.size(); ++i) {
      const LineExtent& e = extent[i];
      if (!e.any) continue;
      PupilEstimate& found = estimates_[lines[i].point];
      const std::size_t direction = looked[i % looked.size()];
      // If no ray passes at the middle, the interval without rays around the middle is the obscuration.
      const bool dark = e.from > 0, both = dark && e.obscured_from < e.obscured_to;
      for (const std::size_t k : {direction, directions_ - 1 - direction}) {
        if (k != direction && !mirrored_) break;
        found.ends[k] = {dark ? 0 : e.obscured_from, dark ? e.from : e.obscured_to, e.to, e.slope};
        if (e.gaps.empty() && !both) continue;
        found.gaps.resize(directions_);
        found.gaps[k] = e.gaps;
        if (both) found.gaps[k].push_back({e.obscured_from, e.obscured_to});
      }
    }
  }

  static constexpr double near_reach = 1.6;  // length of outward lines, in half axes

  /// True if a direction has the ends of a disc, or of a ring if `ring`.
  static bool is_usual(const PupilEstimate::Ends& e, bool ring) noexcept {
    return e.to > 0 && e.to < near_reach - 0.01 && (ring || e.obscured_from == e.obscured_to);
  }

  /// Finds the ends in every direction, up to near_reach. A few directions are searched first; if these show a disc or
  /// a ring, the ends in the other directions are searched close to interpolated positions.
  void outwards_near(std::span<const std::uint32_t> which, int samples, bool rings) {
    constexpr std::size_t direction_step = 4, min_directions = 16;
    if (traced_ < min_directions) {
      outwards(which, samples, near_reach);
      return;
    }
    outwards(which, samples, near_reach, direction_step);
    std::vector<std::uint32_t> simple, others;
    for (const std::uint32_t p : which)
      (fill_between(estimates_[p], direction_step, rings) ? simple : others).push_back(p);
    for (const std::uint32_t p : settle(simple)) others.push_back(p);
    outwards(others, samples, near_reach);
  }

  /// Predicts the ends between every `direction_step`-th direction by interpolation. Returns false if the searched
  /// directions do not all have the ends of a disc or ring.
  bool fill_between(PupilEstimate& found, std::size_t direction_step, bool ring) const {
    if (!found.gaps.empty()) return false;
    for (std::size_t k = 0; k + 1 < traced_; k += direction_step) {
      const std::size_t next = std::min(k + direction_step, traced_ - 1);
      const PupilEstimate::Ends a = found.ends[k], b = found.ends[next];
      if (!is_usual(a, ring) || !is_usual(b, ring)) return false;
      if ((a.obscured_from > 0) != (b.obscured_from > 0) || (a.obscured_to > 0) != (b.obscured_to > 0)) return false;
      for (std::size_t i = k + 1; i < next; ++i) {
        const double t = static_cast<double>(i - k) / static_cast<double>(next - k);
        const auto at = [t](double x, double y) { return x + t * (y - x); };
        found.ends[i] = {at(a.obscured_from, b.obscured_from), at(a.obscured_to, b.obscured_to), at(a.to, b.to),
                         a.slope < 0 && b.slope < 0 ? at(a.slope, b.slope) : 0};
        if (mirrored_) found.ends[directions_ - 1 - i] = found.ends[i];
      }
    }
    return true;
  }

  /// Searches pupils of an unusual shape farther out, with the same step length as for discs.
  void outwards_far(std::span<const std::uint32_t> which, bool rings) {
    std::vector<std::uint32_t> unusual;
    for (const std::uint32_t p : which) {
      const auto usual = [&](const PupilEstimate::Ends& e) { return is_usual(e, rings); };
      if (!std::all_of(estimates_[p].ends.begin(), estimates_[p].ends.end(), usual)) unusual.push_back(p);
    }
    outwards(unusual, 72, 4.8);
    for (const std::uint32_t p : unusual) {
      const auto any = [](const PupilEstimate::Ends& e) { return e.to > 0; };
      if (std::none_of(estimates_[p].ends.begin(), estimates_[p].ends.end(), any)) estimates_[p] = {};
    }
  }

  std::span<const PupilGuess> points_;
  std::size_t directions_, traced_;
  bool mirrored_;
  const PositionClearances* clearances_;
  const ConnectedPupils* connected_;
  std::vector<PupilEstimate> estimates_;
  std::vector<Vec2<double>> units_;  // unit vectors of the directions
  std::vector<bool> by_slope_;
};

}  // namespace

std::vector<PupilRegion> find_regions(std::span<const PupilGuess> points, const SearchOrder& order,
                                      std::size_t directions, bool mirrored, const PositionClearances& clearances,
                                      const ConnectedPupils* connected) {
  Search search(points, directions, mirrored, clearances, connected);
  search.in_full(order.full);
  for (const auto& round : order.rounds) {
    std::vector<Halfway> halfway;
    std::vector<std::uint32_t> full;
    for (const Halfway& halfway_point : round) {
      // A point between two points without passing rays is assumed to have none.
      const bool before = search.lit(halfway_point.before), after = search.lit(halfway_point.after);
      if (before && after) {
        halfway.push_back(halfway_point);
      } else if (before || after) {
        full.push_back(halfway_point.point);
      }
    }
    search.between(halfway);
    search.in_full(full);
  }
  return connected && connected->obscured ? search.obscured_regions(connected->obscured) : search.regions();
}

std::vector<bool> lit_points(std::span<const PupilGuess> points, const PositionClearances& clearances) {
  constexpr std::size_t test_directions = 2;
  return Search(points, test_directions, false, clearances, nullptr).lit_points();
}

}  // namespace petzval::pupil_detail
