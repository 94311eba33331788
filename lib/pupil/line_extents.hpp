// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/version.hpp"

/// What passes along lines in the planes of pupils, for the search of their boundaries.
namespace petzval::pupil_detail {

/// How near the rays through N places come to the edge of what passes, at (x[i], y[i]) of the plane of points[i]: not
/// negative where they pass, as trace/clearances.hpp; 1 and -1 where no more is known.
using PlaceClearances = std::function<void(std::size_t count, const std::uint32_t* points, const double* x,
                                           const double* y, double* clearances)>;

/// The clearance where no more is known than whether rays pass.
inline double clearance_of(bool passes) noexcept { return passes ? 1 : -1; }

/// A line in the plane of one point.
struct Line {
  std::uint32_t point = 0;
  double x = 0, y = 0;    // where it begins
  double dx = 0, dy = 0;  // per unit of the parameter
};

/// Places to be tested in one batch.
struct Batch {
  std::vector<std::uint32_t> points;
  std::vector<double> x, y, clearances;

  void clear() {
    points.clear();
    x.clear();
    y.clear();
  }
  void add(const Line& line, double s) {
    points.push_back(line.point);
    x.push_back(line.x + s * line.dx);
    y.push_back(line.y + s * line.dy);
  }
  void test(const PlaceClearances& at_places) {
    clearances.resize(x.size());
    if (!x.empty()) at_places(x.size(), points.data(), x.data(), y.data(), clearances.data());
  }
  bool passes(std::size_t i) const noexcept { return clearances[i] >= 0; }
};

/// An interval of a line in which nothing passes.
struct Gap {
  double from = 0, to = 0;
};

/// What passes along a line: from the first parameter to the last, except for the widest obscuration between, and for
/// other gaps, which are as wide as the samples show.
struct LineExtent {
  double from = 0, obscured_from = 0, obscured_to = 0, to = 0;
  double slope = 0;  // of the clearance at `to`, where it is known
  bool any = false;
  std::vector<Gap> gaps;
};

/// An end of an extent while it is closed in: a parameter that passes, one that does not, and their clearances.
struct Bracket {
  std::size_t line = 0;
  double with = 0, without = 0, at_with = 1, at_without = -1;
  double LineExtent::*end = &LineExtent::to;
  double found = 0;

  double secant() const noexcept { return with + (without - with) * (at_with / (at_with - at_without)); }
  /// Of the clearance; 0 where only its sign is known.
  double slope() const noexcept {
    const bool known = at_with < 1 && at_without > -1;
    return known && with != without ? (at_without - at_with) / (without - with) : 0;
  }
};

/// Finds the ends within a tolerance: by secants where the clearance is smooth, by bisection where only its sign is
/// known.
void close_in(std::vector<Bracket>& brackets, const std::vector<Line>& lines, double tolerance,
              const PlaceClearances& clearances);

/// The parameter near which the part of a line lies that counts; nullopt: the widest part counts.
using PartOfLine = std::function<std::optional<double>(std::size_t line)>;

/// The extents along some lines, looked for at `samples` + 1 parameters from `low` to `high` of each; the ends are
/// found within a tolerance. Where the first sample passes, the extent begins there.
///
/// part: called for lines of which several parts pass, and chooses a part. Empty: the extent covers all parts.
PETZVAL_API std::vector<LineExtent> extents_along(const std::vector<Line>& lines, double low, double high, int samples,
                                                  double tolerance, const PlaceClearances& clearances,
                                                  const PartOfLine& part = {});

}  // namespace petzval::pupil_detail
