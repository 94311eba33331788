// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "../fuzz/bytes.hpp"
#include "../fuzz/wild_lens.hpp"
#include "core/low_discrepancy.hpp"

/// Random tests in cases. A case depends only on the seed and its number.
namespace petzval::flood {

/// Random bytes and numbers of one case.
class Case {
 public:
  Case(std::uint32_t seed, std::uint64_t number) : state_(core_detail::mixed(seed) ^ number) {
    for (auto& byte : bytes_) byte = static_cast<std::uint8_t>(draw());
  }

  /// Input for the generators of lenses and options of the fuzz targets.
  fuzz::Bytes bytes() const noexcept { return {bytes_.data(), bytes_.size()}; }
  double between(double least, double most) noexcept {
    return least + (most - least) * static_cast<double>(draw() >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t draw() noexcept { return core_detail::mixed(state_ += core_detail::splitmix_step); }

  std::uint64_t state_;
  std::array<std::uint8_t, 1024> bytes_;
};

/// Results of a case.
struct Counts {
  std::uint64_t done = 0;                      ///< rays, samples or pixels
  std::map<std::string, std::uint64_t> kinds;  ///< numbers of items by result
  std::map<std::string, double> worst;         ///< largest errors by name
  std::optional<std::string> fault;            ///< first violated rule

  void fail_unless(bool holds, const char* law) {
    if (!holds && !fault) fault = law;
  }
  void measure(const std::string& name, double error) {
    auto& known = worst.try_emplace(name, 0).first->second;
    known = std::max(known, error);
  }
  void add(const Counts& other) {
    done += other.done;
    for (const auto& [kind, count] : other.kinds) kinds[kind] += count;
    for (const auto& [name, error] : other.worst) measure(name, error);
  }
};

/// Traces rays through random lenses and through lenses of data/, intact or damaged, in both directions, in float and
/// double, fast and reproducible: results are finite, directions of rays that pass have unit length.
Counts rays(Case& at);
/// Samples cameras of all models with lenses of data/, with blades, weights and tilted films, at any aperture and
/// focus: weights are finite, not negative, at most the irradiance of a half sphere, and on the axis equal to the exact
/// lens.
Counts samples(Case& at);
/// Blurs images of random layers: pixels are finite, not brighter than the layers, and uniform for uniform layers.
Counts gathers(Case& at);

}  // namespace petzval::flood
