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

/// Random work of one kind, in cases that depend on the seed and their number alone.
namespace petzval::flood {

/// Random bytes of a case, and random numbers.
class Case {
 public:
  Case(std::uint32_t seed, std::uint64_t number) : state_(core_detail::mixed(seed) ^ number) {
    for (auto& byte : bytes_) byte = static_cast<std::uint8_t>(draw());
  }

  /// What makes lenses and options, as the fuzz targets do.
  fuzz::Bytes bytes() const noexcept { return {bytes_.data(), bytes_.size()}; }
  double between(double least, double most) noexcept {
    return least + (most - least) * static_cast<double>(draw() >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t draw() noexcept { return core_detail::mixed(state_ += core_detail::splitmix_step); }

  std::uint64_t state_;
  std::array<std::uint8_t, 1024> bytes_;
};

/// What a case found.
struct Counts {
  std::uint64_t done = 0;                      ///< rays, samples or pixels
  std::map<std::string, std::uint64_t> kinds;  ///< how they ended
  std::map<std::string, double> worst;         ///< measured errors, the largest of each
  std::optional<std::string> fault;            ///< the first broken law

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

/// Rays through lenses that nobody has designed and through those of data/, damaged or whole, in both directions, float
/// and double, fast and reproducible: finite, of unit length where they pass.
Counts rays(Case& at);
/// Samples of cameras of all models of lenses of data/, with blades, weights and tilted films, at any aperture and
/// focus: finite, no negative light, no more than a film can get, and on the axis that of the exact lens.
Counts samples(Case& at);
/// Pixels of blurred pictures of random layers: finite, no brighter than the layers, and even where these are.
Counts gathers(Case& at);

}  // namespace petzval::flood
