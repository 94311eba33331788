// SPDX-License-Identifier: Apache-2.0
#include "between_wavelengths.hpp"

#include <cmath>
#include <limits>

#include "spectrum.hpp"

namespace petzval::lens_detail {
namespace {

constexpr std::size_t most_nodes = 4;

}  // namespace

CompiledWavelengths::CompiledWavelengths(std::span<const double> wavelengths_nm)
    : coordinate_(spectral_coordinate(wavelengths_nm)) {
  for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
    ranked_.push_back({wavelengths_nm[w], coordinate(wavelengths_nm[w]), w});
  }
  std::sort(ranked_.begin(), ranked_.end(), [](const Ranked& a, const Ranked& b) { return a.nm < b.nm; });
  for (std::size_t r = 0; r + 1 < count(); ++r) {
    const auto [nm, coordinate, position] = ranked_[r];
    steps_.push_back({static_cast<float>((nm + ranked_[r + 1].nm) / 2),
                      static_cast<std::int32_t>(ranked_[r + 1].position) - static_cast<std::int32_t>(position)});
    const std::size_t nodes = std::min(most_nodes, count()), before = nodes / 2 - 1;
    const Interval cubic = interval(r, std::min(r - std::min(r, before), count() - nodes), nodes);
    // Largest allowed amplification of errors between the nodes. It is 2.6 at the ends of a row that is uniform in nm.
    constexpr double max_amplification = 4;
    double sum = 0;
    for (const double w : about(cubic, (ranked_[r].coordinate + ranked_[r + 1].coordinate) / 2).weights)
      sum += std::abs(w);
    const bool distinct = ranked_[r].coordinate != ranked_[r + 1].coordinate;
    intervals_.push_back(sum <= max_amplification ? cubic : interval(r, r, distinct ? 2 : 1));
  }
  if (count() == 1) intervals_.push_back(interval(0, 0, 1));
}

CompiledWavelengths::Interval CompiledWavelengths::interval(std::size_t rank, std::size_t first,
                                                            std::size_t nodes) const noexcept {
  Interval result{.first = first, .from = ranked_[rank].coordinate};
  for (std::size_t i = 0; i < nodes; ++i) {
    std::array<double, 4> product{1};
    for (std::size_t j = 0; j < nodes; ++j) {
      if (j == i) continue;
      // Multiply by (t - other) / (own - other).
      const double other = ranked_[first + j].coordinate - result.from;
      const double per_step = 1 / (ranked_[first + i].coordinate - ranked_[first + j].coordinate);
      for (std::size_t k = 3; k > 0; --k) product[k] = (product[k - 1] - other * product[k]) * per_step;
      product[0] *= -other * per_step;
    }
    for (std::size_t k = 0; k < 4; ++k) result.by_power[k][i] = product[k];
  }
  return result;
}

bool CompiledWavelengths::even() const noexcept {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t r = 1; r < ranked_.size(); ++r) {
    const double step = ranked_[r].nm - ranked_[r - 1].nm;
    least = std::min(least, step), most = std::max(most, step);
  }
  return most <= 2 * least && longest() <= 1.8 * shortest();
}

std::size_t CompiledWavelengths::nearest(double nm) const noexcept {
  const auto narrow = static_cast<float>(nm);
  if (!covers(nm)) return count();
  return ranked_[static_cast<std::size_t>(std::count_if(steps_.begin(), steps_.end(),
                                                        [&](const auto& step) { return narrow > step.middle; }))]
      .position;
}

}  // namespace petzval::lens_detail
