// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/camera.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

namespace petzval {
namespace {

constexpr std::array all{ModelKind::pinhole,       ModelKind::thin,          ModelKind::thin_two_disc,
                         ModelKind::thick,         ModelKind::polynomial(3), ModelKind::polynomial(5),
                         ModelKind::polynomial(7), ModelKind::polynomial(9), ModelKind::polynomial(11),
                         ModelKind::exact_float,   ModelKind::exact_double};
constexpr std::array<std::string_view, all.size()> names{
    "pinhole",      "thin",         "thin_two_disc", "thick",       "polynomial_3", "polynomial_5",
    "polynomial_7", "polynomial_9", "polynomial_11", "exact_float", "exact_double"};

}  // namespace

std::string_view name(ModelKind model) noexcept {
  const auto found = std::find(all.begin(), all.end(), model);
  if (found != all.end()) return names[static_cast<std::size_t>(std::distance(all.begin(), found))];
  return "unknown";
}

std::optional<ModelKind> model_named(std::string_view name) noexcept {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return {};
  return all[static_cast<std::size_t>(std::distance(names.begin(), found))];
}

std::span<const ModelKind> models() noexcept { return all; }

}  // namespace petzval
