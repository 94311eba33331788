// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "flood.hpp"
#include "petzval/core/error.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::flood {
namespace {

constexpr std::size_t count = 16384;

template <class T>
struct Arrays {
  std::vector<T> values[6];

  explicit Arrays(std::size_t n) {
    for (auto& v : values) v.resize(n);
  }
  RayArrays<T> rays() {
    return {values[0].data(), values[1].data(), values[2].data(), values[3].data(), values[4].data(), values[5].data()};
  }
  RayArrays<const T> constant() const {
    return {values[0].data(), values[1].data(), values[2].data(), values[3].data(), values[4].data(), values[5].data()};
  }
};

/// Rays that start just in front of the lens, over a half sphere of directions and 1.2 times the semi-diameter.
template <class T>
void fill(Arrays<T>& rays, const Lens& lens, Travel travel, Case& at) {
  const LensSurface& face = travel == Travel::to_film ? lens.surfaces().front() : lens.surfaces().back();
  const double width = std::isfinite(face.semi_diameter) ? 1.2 * face.semi_diameter : 25, steepest = at.between(0, 1);
  double along = travel == Travel::to_film ? 1 : -lens.light_direction(lens.surface_count());
  const double start = face.vertex_z - along * at.between(0, 20);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = at.between(0, 6.283185307179586), sine = steepest * at.between(0, 1),
                 z = along * std::sqrt(1 - sine * sine);
    const double numbers[] = {at.between(-width, width), at.between(-width, width), start,
                              sine * std::cos(angle),    sine * std::sin(angle),    z};
    for (int k = 0; k < 6; ++k) rays.values[k][i] = static_cast<T>(numbers[k]);
  }
}

template <class T>
void traced(const Lens& lens, const BatchOptions& options, Case& at, Counts& counts) {
  Arrays<T> in(count), out(count);
  fill(in, lens, options.travel, at);
  std::vector<RayFate> fates(count);
  trace<T>(lens, count, in.constant(), out.rays(), fates.data(), nullptr, options);
  std::array<std::uint64_t, 8> ended{};
  double longest = 0;
  std::uint64_t beyond = 0;
  const double eps = std::numeric_limits<T>::epsilon();
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& v : out.values) counts.fail_unless(std::isfinite(v[i]), "a ray is finite");
    ++ended[static_cast<std::size_t>(fates[i])];
    if (fates[i] != RayFate::transmitted) continue;
    const double x = out.values[3][i], y = out.values[4][i], z = out.values[5][i];
    const double error = std::abs(x * x + y * y + z * z - 1);
    longest = std::max(longest, error);
    beyond += error > 8 * eps;
  }
  // Bound of the documentation of trace(); rays that graze a surface have the largest errors.
  counts.fail_unless(longest <= 1000 * eps, "a ray that passes has unit length");
  counts.measure(sizeof(T) == 4 ? "|d|^2 - 1 in eps of float" : "|d|^2 - 1 in eps of double", longest / eps);
  counts.kinds["(beyond 8 eps of unit length)"] += beyond;
  for (std::size_t fate = 0; fate < ended.size(); ++fate) {
    if (ended[fate] > 0) counts.kinds[std::string(name(static_cast<RayFate>(fate)))] += ended[fate];
  }
  counts.done += count;
}

}  // namespace

Counts rays(Case& at) {
  Counts counts;
  fuzz::Bytes bytes = at.bytes();
  const int kind = bytes.byte();
  try {
    const Lens lens = fuzz::wild_lens(bytes);
    const BatchOptions options{.travel = kind & 1 ? Travel::to_scene : Travel::to_film,
                               .apertures = kind % 8 != 7,
                               .arithmetic = kind & 2 ? Arithmetic::reproducible : Arithmetic::fast};
    if (kind & 4)
      traced<float>(lens, options, at, counts);
    else
      traced<double>(lens, options, at, counts);
  } catch (const Error&) {
    ++counts.kinds["(lenses refused)"];
  }
  return counts;
}

}  // namespace petzval::flood
