// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "petzval/core/config.hpp"

/// Intervals that pass along lines in pupil planes, for the search of pupil boundaries.
namespace petzval::pupil_detail {

/// Computes the clearances of N rays, each through (x[i], y[i]) in the plane of points[i], as in trace/clearances.hpp:
/// not negative if the ray passes. A source that knows only the sign gives 1 and -1.
using PositionClearances = std::function<void(std::size_t count, const std::uint32_t* points, const double* x,
                                              const double* y, double* clearances)>;

/// The clearance of a ray if only its sign is known.
inline double clearance_of(bool passes) noexcept { return passes ? 1 : -1; }

/// A line in the pupil plane of one point.
struct Line {
  std::uint32_t point = 0;
  double x = 0, y = 0;    // at parameter 0
  double dx = 0, dy = 0;  // per unit of the parameter
};

/// Points to be tested in one batch.
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
  void test(const PositionClearances& clearances_at) {
    clearances.resize(x.size());
    if (!x.empty()) clearances_at(x.size(), points.data(), x.data(), y.data(), clearances.data());
  }
  bool passes(std::size_t i) const noexcept { return clearances[i] >= 0; }
};

/// An interval of a line in which no ray passes.
struct Gap {
  double from = 0, to = 0;
};

/// The extent of passing rays along a line, from the first to the last parameter, minus the widest obscuration and
/// other gaps. The other gaps are as coarse as the samples.
struct LineExtent {
  double from = 0, obscured_from = 0, obscured_to = 0, to = 0;
  double slope = 0;  // d clearance / d parameter at `to`; 0 if unknown
  bool any = false;
  std::vector<Gap> gaps;
};

/// A bracket around an end of an extent: a parameter that passes, a parameter that is blocked, and both clearances.
struct Bracket {
  std::size_t line = 0;
  double with = 0, without = 0, at_with = 1, at_without = -1;
  double LineExtent::*end = &LineExtent::to;
  double found = 0;

  double secant() const noexcept { return with + (without - with) * (at_with / (at_with - at_without)); }
  /// Slope of the clearance; 0 if only its sign is known.
  double slope() const noexcept {
    const bool known = at_with < 1 && at_without > -1;
    return known && with != without ? (at_without - at_with) / (without - with) : 0;
  }
};

/// Finds the ends within a tolerance: by secants if the clearance is smooth, by bisection if only its sign is known.
void close_in(std::vector<Bracket>& brackets, const std::vector<Line>& lines, double tolerance,
              const PositionClearances& clearances);

/// Parameter close to the component of a line that is to be kept; nullopt keeps the widest component.
using ComponentOfLine = std::function<std::optional<double>(std::size_t line)>;

/// Finds the extents along lines from `samples` + 1 parameters between `low` and `high`; an extent starts at `low` if
/// the first sample passes.
/// @param tolerance tolerance of the ends, in units of the parameter
/// @param component selects one component of lines with several components; if empty, the extent covers all components
PETZVAL_API std::vector<LineExtent> extents_along(const std::vector<Line>& lines, double low, double high, int samples,
                                                  double tolerance, const PositionClearances& clearances,
                                                  const ComponentOfLine& component = {});

}  // namespace petzval::pupil_detail
