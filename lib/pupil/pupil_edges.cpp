// SPDX-License-Identifier: Apache-2.0
// The edges of many pupils at once: every round of the search is one batch of rays.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "petzval/pupil/pupil_polygon.hpp"

namespace petzval::inline v0::pupil_detail {
namespace {

/// A walk along a line in the plane of one field, from `from` by multiples of `step`.
struct Line {
  std::uint32_t field = 0;
  double x = 0, y = 0;    // where it begins
  double dx = 0, dy = 0;  // per unit of the parameter
};

/// Points to be tested in one batch.
struct Batch {
  std::vector<std::uint32_t> fields;
  std::vector<double> x, y;
  std::vector<std::uint8_t> passes;

  void clear() {
    fields.clear();
    x.clear();
    y.clear();
  }
  void add(const Line& line, double s) {
    fields.push_back(line.field);
    x.push_back(line.x + s * line.dx);
    y.push_back(line.y + s * line.dy);
  }
  void test(const Passing& passing) {
    passes.resize(x.size());
    if (!x.empty()) passing(x.size(), fields.data(), x.data(), y.data(), passes.data());
  }
};

/// What passes along a line: from the first to the last, but for the widest gap between.
struct Extent {
  double from = 0, gap_from = 0, gap_to = 0, to = 0;
  bool any = false;
};

/// An end of an extent that is being closed in: a parameter that passes, one that does not.
struct Bracket {
  std::size_t line = 0;
  double with = 0, without = 0;
  double Extent::*end = &Extent::to;
};

void close_in(std::vector<Bracket>& brackets, const std::vector<Line>& lines, int rounds, const Passing& passing) {
  Batch batch;
  for (int round = 0; round < rounds; ++round) {
    batch.clear();
    for (const Bracket& b : brackets) batch.add(lines[b.line], (b.with + b.without) / 2);
    batch.test(passing);
    for (std::size_t i = 0; i < brackets.size(); ++i) {
      Bracket& b = brackets[i];
      (batch.passes[i] ? b.with : b.without) = (b.with + b.without) / 2;
    }
  }
}

/// The extents along some lines, looked for at `samples` + 1 parameters from `low` to `high` of each; the ends are
/// found within 2^-rounds of a step. Where the first sample passes, the extent begins there.
std::vector<Extent> extents(const std::vector<Line>& lines, double low, double high, int samples, int rounds,
                            const Passing& passing) {
  const double step = (high - low) / samples;
  Batch batch;
  for (const Line& line : lines) {
    for (int i = 0; i <= samples; ++i) batch.add(line, low + step * i);
  }
  batch.test(passing);
  std::vector<Extent> result(lines.size());
  std::vector<Bracket> brackets;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const std::uint8_t* passes = batch.passes.data() + l * (static_cast<std::size_t>(samples) + 1);
    int first = 0, last = samples, gap = 0, gap_end = 0;
    while (first <= samples && !passes[first]) ++first;
    if (first > samples) continue;
    while (!passes[last]) --last;
    for (int i = first, before = first; i <= last; ++i) {
      if (!passes[i]) continue;
      if (i - before > std::max(1, gap_end - gap)) gap = before, gap_end = i;
      before = i;
    }
    result[l].any = true;
    const auto close = [&](double Extent::*end, int with, int without) {
      result[l].*end = low + step * with;
      if (without >= 0 && without <= samples) {
        brackets.push_back({l, low + step * with, low + step * without, end});
      }
    };
    close(&Extent::from, first, first - 1);
    close(&Extent::to, last, last + 1);
    if (gap == gap_end) continue;
    close(&Extent::gap_from, gap, gap + 1);
    close(&Extent::gap_to, gap_end, gap_end - 1);
  }
  close_in(brackets, lines, rounds, passing);
  for (const Bracket& b : brackets) result[b.line].*b.end = b.with;
  return result;
}

constexpr int end_rounds = 10;

class Search {
 public:
  Search(std::span<const PupilGuess> fields, std::size_t directions, bool mirrored, const Passing& passing)
      : fields_(fields), directions_(directions), mirrored_(mirrored), passing_(passing), found_(fields.size()) {
    traced_ = mirrored ? directions / 2 + 1 : directions;
  }

  const PupilEdges& operator[](std::size_t field) const noexcept { return found_[field]; }
  std::vector<PupilEdges> take() { return std::move(found_); }

  /// Looks for pupils of which nothing is known.
  void in_full(std::span<const std::uint32_t> which) {
    // Where nothing is found the pupil may be far off its place, or a sliver: once more on all of the line, and finer.
    std::vector<std::uint32_t> seen, rings;
    auto dark = along_y(which, Reach::near, 128, seen, rings);
    dark = along_y(dark, Reach::far, 256, seen, rings);
    along_y(dark, Reach::far, 1024, seen, rings);
    across(seen);
    outwards(seen, 32, 1.6, 12);
    outwards(rings, 320, 1.6, 9);
    // Pupils of a strange shape want a farther look.
    std::vector<std::uint32_t> strange;
    for (const std::uint32_t f : seen) {
      const PupilEdges& edges = found_[f];
      const bool plain = std::all_of(edges.to.begin(), edges.to.end(), [](double s) { return s > 0 && s < 1.59; }) &&
                         (edges.gap_from == edges.gap_to || std::find(rings.begin(), rings.end(), f) != rings.end());
      if (!plain) strange.push_back(f);
    }
    outwards(strange, 96, 4.8, 12);
    for (const std::uint32_t f : strange) {
      if (std::none_of(found_[f].to.begin(), found_[f].to.end(), [](double s) { return s > 0; })) found_[f] = {};
    }
  }

  struct Halfway {
    std::uint32_t field, before, after;
  };

  /// Looks for pupils about halfway between two that were found: next to where these have their edges. Those that are
  /// not there are looked for in full.
  void between(std::span<const Halfway> which) {
    constexpr double beside = 0.01;
    std::vector<Line> lines;
    std::vector<Bracket> brackets;
    for (const auto& [field, before, after] : which) {
      const PupilEdges &a = found_[before], &b = found_[after];
      const auto mean = [](double x, double y) { return (x + y) / 2; };
      PupilEdges& edges = found_[field];
      edges.middle = {mean(a.middle[0], b.middle[0]), mean(a.middle[1], b.middle[1])};
      edges.half_axes = {mean(a.half_axes[0], b.half_axes[0]), mean(a.half_axes[1], b.half_axes[1])};
      clear(edges);
      for (std::size_t k = 0; k < traced_; ++k) {
        const auto outer = [&](double Extent::*end, double s) {
          brackets.push_back({lines.size(), s * (1 - beside), s * (1 + beside), end});
        };
        outer(&Extent::to, mean(a.to[k], b.to[k]));
        if (const double gap_from = mean(a.gap_from[k], b.gap_from[k]); gap_from > 0) {
          outer(&Extent::gap_from, gap_from);
        }
        if (const double gap_to = mean(a.gap_to[k], b.gap_to[k]); gap_to > 0) {
          brackets.push_back({lines.size(), gap_to * (1 + beside), gap_to * (1 - beside), &Extent::gap_to});
        }
        lines.push_back(outward(field, k));
      }
    }
    Batch batch;
    for (const Bracket& b : brackets) {
      batch.add(lines[b.line], b.with);
      batch.add(lines[b.line], b.without);
    }
    batch.test(passing_);
    std::vector<bool> lost(which.size(), false);
    for (std::size_t j = 0; j < brackets.size(); ++j) {
      if (!batch.passes[2 * j] || batch.passes[2 * j + 1]) lost[brackets[j].line / traced_] = true;
    }
    close_in(brackets, lines, end_rounds, passing_);
    for (const Bracket& b : brackets) {
      PupilEdges& edges = found_[lines[b.line].field];
      const std::size_t k = b.line % traced_;
      auto& ends = b.end == &Extent::to ? edges.to : b.end == &Extent::gap_to ? edges.gap_to : edges.gap_from;
      ends[k] = b.with;
      if (mirrored_ && k > 0) ends[directions_ - k] = b.with;
    }
    std::vector<std::uint32_t> again;
    for (std::size_t i = 0; i < which.size(); ++i) {
      if (!lost[i]) continue;
      found_[which[i].field] = {};
      again.push_back(which[i].field);
    }
    in_full(again);
  }

 private:
  enum class Reach { near, far };

  /// Extents along y; fields of which something is seen are added to `seen`, of these those with a gap to `rings`; the
  /// others come back, and those that reach beyond what is near.
  std::vector<std::uint32_t> along_y(std::span<const std::uint32_t> which, Reach reach, int samples,
                                     std::vector<std::uint32_t>& seen, std::vector<std::uint32_t>& rings) {
    std::vector<Line> lines;
    for (const std::uint32_t f : which) {
      const PupilGuess& g = fields_[f];
      const bool near = reach == Reach::near && g.near > 0;
      lines.push_back({f, g.x, near ? g.y : (g.low + g.high) / 2, 0, near ? g.near : (g.high - g.low) / 2});
    }
    const auto extent = extents(lines, -1, 1, samples, end_rounds, passing_);
    std::vector<std::uint32_t> left;
    for (std::size_t i = 0; i < which.size(); ++i) {
      const Extent& e = extent[i];
      if (!e.any || (reach == Reach::near && (e.from == -1 || e.to == 1))) {
        left.push_back(which[i]);
        continue;
      }
      PupilEdges& edges = found_[which[i]];
      const PupilGuess& g = fields_[which[i]];
      const double half = lines[i].dy, low = lines[i].y + half * e.from, high = lines[i].y + half * e.to;
      edges.middle = {lines[i].x, (low + high) / 2};
      edges.half_axes[1] = (high - low) / 2;
      // What is left of a ring is a star about the ring's own middle, though that is dark.
      if (g.ring && g.y > low - g.radius && g.y < high + g.radius) {
        edges.middle[1] = g.y;
        edges.half_axes[1] = std::max(high - g.y, g.y - low);
      }
      seen.push_back(which[i]);
      if (g.ring || e.gap_from < e.gap_to) rings.push_back(which[i]);
    }
    return left;
  }

  /// Extents along x, from the middle of that.
  void across(std::span<const std::uint32_t> which) {
    std::vector<Line> lines;
    for (const std::uint32_t f : which) {
      const PupilGuess& g = fields_[f];
      const double reach = std::max({(g.high - g.low) / 2, 2 * g.radius, 2 * found_[f].half_axes[1]});
      lines.push_back({f, found_[f].middle[0], found_[f].middle[1], reach, 0});
    }
    const auto extent = extents(lines, mirrored_ ? 0 : -1, 1, mirrored_ ? 96 : 192, end_rounds, passing_);
    for (std::size_t i = 0; i < which.size(); ++i) {
      PupilEdges& edges = found_[which[i]];
      const PupilGuess& g = fields_[which[i]];
      edges.half_axes[0] = edges.half_axes[1];
      if (!extent[i].any) continue;
      if (g.ring) {  // the line may miss the ring's widest place
        edges.half_axes[0] = std::max(edges.half_axes[1], lines[i].dx * extent[i].to);
        continue;
      }
      const double from = mirrored_ ? -extent[i].to : extent[i].from;
      edges.middle[0] += lines[i].dx * (extent[i].to + from) / 2;
      edges.half_axes[0] = lines[i].dx * (extent[i].to - from) / 2;
    }
  }

  void clear(PupilEdges& edges) const {
    for (auto* ends : {&edges.gap_from, &edges.gap_to, &edges.to}) ends->assign(directions_, 0);
  }

  /// From the middle in a direction, in coordinates in which the pupil is about a unit disc.
  Line outward(std::uint32_t field, std::size_t direction) const {
    const PupilEdges& edges = found_[field];
    const auto end = edges.at(static_cast<double>(direction), 1);
    return {field, edges.middle[0], edges.middle[1], end[0] - edges.middle[0], end[1] - edges.middle[1]};
  }

  void outwards(std::span<const std::uint32_t> which, int samples, double reach, int rounds) {
    std::vector<Line> lines;
    for (const std::uint32_t f : which) {
      clear(found_[f]);
      for (std::size_t k = 0; k < traced_; ++k) lines.push_back(outward(f, k));
    }
    const auto extent = extents(lines, 0, reach, samples, rounds, passing_);
    for (std::size_t i = 0; i < which.size(); ++i) {
      PupilEdges& edges = found_[which[i]];
      for (std::size_t k = 0; k < directions_; ++k) {
        const Extent& e = extent[i * traced_ + (k < traced_ ? k : directions_ - k)];
        if (!e.any) continue;
        // A dark middle is the gap that counts.
        edges.gap_from[k] = e.from > 0 ? 0 : e.gap_from;
        edges.gap_to[k] = e.from > 0 ? e.from : e.gap_to;
        edges.to[k] = e.to;
      }
    }
  }

  std::span<const PupilGuess> fields_;
  std::size_t directions_, traced_ = 0;
  bool mirrored_;
  const Passing& passing_;
  std::vector<PupilEdges> found_;
};

}  // namespace

std::array<double, 2> PupilEdges::at(double direction, double distance) const noexcept {
  const double angle = 2 * std::numbers::pi * direction / static_cast<double>(to.size());
  return {middle[0] + half_axes[0] * distance * std::sin(angle), middle[1] + half_axes[1] * distance * std::cos(angle)};
}

std::vector<PupilEdges> find_edges(std::span<const PupilGuess> fields, std::size_t row, std::size_t directions,
                                   bool mirrored, const Passing& passing) {
  Search search(fields, directions, mirrored, passing);
  // Some fields of each row in full, then those halfway between, and so on.
  constexpr std::size_t first_step = 16;
  std::vector<std::uint32_t> full;
  for (std::size_t begin = 0; begin < fields.size(); begin += row) {
    for (std::size_t i = 0; i < row; ++i) {
      if (i % first_step == 0 || i + 1 == row) full.push_back(static_cast<std::uint32_t>(begin + i));
    }
  }
  search.in_full(full);
  for (std::size_t step = first_step; step > 1; step /= 2) {
    std::vector<Search::Halfway> halfway;
    full.clear();
    for (std::size_t begin = 0; begin < fields.size(); begin += row) {
      const auto at = [&](std::size_t place) { return static_cast<std::uint32_t>(begin + place); };
      for (std::size_t i = step / 2; i + 1 < row; i += step) {
        const Search::Halfway place{at(i), at(i - step / 2), at(std::min(i + step / 2, row - 1))};
        // Between two dark fields it is dark.
        const bool light = !search[place.before].empty(), light_after = !search[place.after].empty();
        if (light && light_after) {
          halfway.push_back(place);
        } else if (light || light_after) {
          full.push_back(place.field);
        }
      }
    }
    search.between(halfway);
    search.in_full(full);
  }
  return search.take();
}

}  // namespace petzval::inline v0::pupil_detail
