// SPDX-License-Identifier: Apache-2.0
#include "keyframes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::focus_detail {

Keyframes::Keyframes(std::vector<double> times, std::vector<double> values)
    : times_(std::move(times)), values_(std::move(values)), slopes_(times_.size()) {
  const std::size_t count = times_.size();
  if (count == 0 || values_.size() != count) {
    throw Error("keyframes: " + std::to_string(count) + " times and " + std::to_string(values_.size()) +
                " values; must be equal in number, at least 1");
  }
  std::vector<double> between(count - 1);  // slope of the chord that starts at each key
  for (std::size_t k = 0; k < count; ++k) {
    const std::string where = "keyframes: key " + std::to_string(k) + ": ";
    if (!std::isfinite(times_[k]) || !std::isfinite(values_[k])) {
      throw Error(where + "value " + to_text(values_[k]) + " at " + to_text(times_[k]) + " s; both must be finite");
    }
    if (k == 0) continue;
    if (!(times_[k] > times_[k - 1])) {
      throw Error(where + "time = " + to_text(times_[k]) + " s; must be after " + to_text(times_[k - 1]) + " s");
    }
    between[k - 1] = (values_[k] - values_[k - 1]) / (times_[k] - times_[k - 1]);
    if (!std::isfinite(between[k - 1]) || !std::isfinite(times_[k] - times_[k - 1]) ||
        !std::isfinite(4 * (values_[k] - values_[k - 1]))) {
      throw Error(where + "value " + to_text(values_[k]) + " at " + to_text(times_[k]) + " s, after " +
                  to_text(values_[k - 1]) + " at " + to_text(times_[k - 1]) + " s; differences must be finite");
    }
  }
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const double before = times_[k] - times_[k - 1], after = times_[k + 1] - times_[k];
    const double s = between[k - 1], t = between[k];
    if (!(s > 0 && t > 0) && !(s < 0 && t < 0)) continue;
    const double fraction = (before + 2 * after) / (3 * (before + after));
    slopes_[k] = 1 / (fraction / s + (1 - fraction) / t);
  }
}

double Keyframes::at(double time) const noexcept {
  if (std::isnan(time)) return time;
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  if (after == times_.begin()) return values_.front();
  if (after == times_.end()) return values_.back();
  const auto k = static_cast<std::size_t>(after - times_.begin()) - 1;
  const double step = times_[k + 1] - times_[k], s = (time - times_[k]) / step;
  const double first = values_[k], rise = values_[k + 1] - first;
  // Cubic Hermite polynomial.
  const double leave = step * slopes_[k], arrive = step * slopes_[k + 1];
  const double value = first + s * (leave + s * (3 * rise - 2 * leave - arrive + s * (leave + arrive - 2 * rise)));
  const auto [low, high] = std::minmax(first, values_[k + 1]);
  return std::clamp(value, low, high);  // removes rounding errors
}

}  // namespace petzval::focus_detail
