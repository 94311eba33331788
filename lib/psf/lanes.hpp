// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>

namespace petzval::inline v0::psf_detail {

/// A sum, or a maximum, for each of some lanes on which a loop over many points can run; what comes out does not depend
/// on whether it does.
using Lanes = std::array<double, 8>;

inline double sum(const Lanes& lanes) noexcept { return std::accumulate(lanes.begin(), lanes.end(), 0.0); }

inline double largest(const Lanes& lanes) noexcept { return *std::max_element(lanes.begin(), lanes.end()); }

/// Calls see(lane, x, y) for all points of sets with coordinates x and y, each set's on the lanes by turns.
template <class Sets, class See>
void for_each(const Sets& sets, See&& see) noexcept {
  constexpr std::size_t lanes = std::tuple_size_v<Lanes>;
  for (const auto& points : sets) {
    const std::span<const double> xs = points.x, ys = points.y;
    const std::size_t whole = xs.size() - xs.size() % lanes;
    for (std::size_t i = 0; i < whole; i += lanes) {
      for (std::size_t lane = 0; lane < lanes; ++lane) see(lane, xs[i + lane], ys[i + lane]);
    }
    for (std::size_t i = whole; i < xs.size(); ++i) see(i - whole, xs[i], ys[i]);
  }
}

}  // namespace petzval::inline v0::psf_detail
