// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

#include "petzval/camera/ray_model.hpp"

namespace petzval {
namespace {

constexpr std::array all{Model::pinhole,       Model::thin,         Model::thin_two_disc, Model::thick,
                         Model::polynomial_3,  Model::polynomial_5, Model::polynomial_7,  Model::polynomial_9,
                         Model::polynomial_11, Model::exact_float,  Model::exact_double};
constexpr std::array<std::string_view, all.size()> names{
    "pinhole",      "thin",         "thin_two_disc", "thick",       "polynomial_3", "polynomial_5",
    "polynomial_7", "polynomial_9", "polynomial_11", "exact_float", "exact_double"};

}  // namespace

std::string_view name(Model model) noexcept { return names[static_cast<std::size_t>(model)]; }

std::optional<Model> model_named(std::string_view name) noexcept {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return {};
  return all[static_cast<std::size_t>(std::distance(names.begin(), found))];
}

std::span<const Model> models() noexcept { return all; }

}  // namespace petzval
