// SPDX-License-Identifier: Apache-2.0
#include "line_extents.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace petzval::pupil_detail {

void close_in(std::vector<Bracket>& brackets, const std::vector<Line>& lines, double tolerance,
              const PositionClearances& clearances) {
  constexpr int secants = 6, rounds = 40;
  std::vector<std::uint32_t> open(brackets.size());
  for (std::uint32_t i = 0; i < open.size(); ++i) open[i] = i;
  std::vector<double> tried;
  Batch batch;
  for (int round = 0; round < rounds && !open.empty(); ++round) {
    batch.clear();
    tried.clear();
    for (const std::uint32_t i : open) {
      Bracket& b = brackets[i];
      const double secant = b.secant(), middle = (b.with + b.without) / 2;
      tried.push_back(std::isfinite(secant) && (round < secants || round % 2 == 0) ? secant : middle);
      batch.add(lines[b.line], tried.back());
    }
    batch.test(clearances);
    std::size_t left = 0;
    for (std::size_t j = 0; j < open.size(); ++j) {
      Bracket& b = brackets[open[j]];
      const double x = tried[j];
      (batch.passes(j) ? b.with : b.without) = x;
      (batch.passes(j) ? b.at_with : b.at_without) = batch.clearances[j];
      b.found = b.secant();
      if (!std::isfinite(b.found)) b.found = b.with;
      const bool close = std::abs(b.found - x) < tolerance / 4 || std::abs(b.without - b.with) < tolerance;
      if (!close) open[left++] = open[j];
    }
    open.resize(left);
  }
}

namespace {

/// Narrows the range from `first` to `last` to one component.
/// @param near called if there are several components
template <class Passes, class Near>
void narrow(int& first, int& last, const Passes& passes, const Near& near, double low, double step) {
  std::vector<std::array<int, 2>> runs;
  for (int i = first; i <= last; ++i) {
    if (!passes(i)) continue;
    if (i > first && passes(i - 1)) {
      runs.back()[1] = i;
    } else {
      runs.push_back({i, i});
    }
  }
  if (runs.size() == 1) return;
  const std::optional<double> parameter = near();
  const auto badness = [&](const std::array<int, 2>& p) -> double {
    if (!parameter) return p[0] - p[1];
    const double sample = (*parameter - low) / step;
    return std::max({p[0] - sample, sample - p[1], 0.0});
  };
  const auto best = *std::min_element(runs.begin(), runs.end(),
                                      [&](const auto& a, const auto& b) { return badness(a) < badness(b); });
  first = best[0], last = best[1];
}

}  // namespace

std::vector<LineExtent> extents_along(const std::vector<Line>& lines, double low, double high, int samples,
                                      double tolerance, const PositionClearances& clearances,
                                      const ComponentOfLine& component) {
  const double step = (high - low) / samples;
  Batch batch;
  std::vector<LineExtent> result(lines.size());
  std::vector<Bracket> brackets;
  // In batches of about 2048 samples, to reuse buffers.
  const std::size_t a_line = static_cast<std::size_t>(samples) + 1, batch_lines = 1 + 2048 / a_line;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    if (l % batch_lines == 0) {
      batch.clear();
      for (std::size_t j = l; j < std::min(l + batch_lines, lines.size()); ++j) {
        for (int i = 0; i <= samples; ++i) batch.add(lines[j], low + step * i);
      }
      batch.test(clearances);
    }
    const double* values = batch.clearances.data() + l % batch_lines * a_line;
    const auto passes = [&](int i) { return values[i] >= 0; };
    int first = 0, last = samples, dark = 0, light = 0;  // dark, light: samples around the widest obscuration
    while (first <= samples && !passes(first)) ++first;
    if (first > samples) continue;
    while (!passes(last)) --last;
    if (component)
      narrow(
          first, last, passes, [&] { return component(l); }, low, step);
    const auto parameter = [&](int i) { return low + step * i; };
    for (int i = first, before = first; i <= last; ++i) {
      if (!passes(i)) continue;
      if (i - before > 1) {
        const bool widest = i - before > std::max(1, light - dark);
        const Gap other = widest ? Gap{parameter(dark) + step / 2, parameter(light) - step / 2}
                                 : Gap{parameter(before) + step / 2, parameter(i) - step / 2};
        if (other.from < other.to && (!widest || light > dark)) result[l].gaps.push_back(other);
        if (widest) dark = before, light = i;
      }
      before = i;
    }
    result[l].any = true;
    const auto close = [&](double LineExtent::*end, int with, int without) {
      result[l].*end = parameter(with);
      if (without >= 0 && without <= samples) {
        brackets.push_back({l, parameter(with), parameter(without), values[with], values[without], end});
      }
    };
    close(&LineExtent::from, first, first - 1);
    close(&LineExtent::to, last, last + 1);
    if (dark == light) continue;
    close(&LineExtent::obscured_from, dark, dark + 1);
    close(&LineExtent::obscured_to, light, light - 1);
  }
  close_in(brackets, lines, tolerance, clearances);
  for (const Bracket& b : brackets) {
    result[b.line].*b.end = b.found;
    if (b.end == &LineExtent::to) result[b.line].slope = b.slope();
  }
  return result;
}

}  // namespace petzval::pupil_detail
