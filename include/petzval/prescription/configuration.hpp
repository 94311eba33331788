// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "petzval/prescription/surface_row.hpp"

namespace petzval {

/// The changes of one surface in a configuration. Absent members keep the value of the row.
struct SurfaceChange {
  int surface = 0;  ///< from 0
  std::optional<double> thickness{};
  std::optional<double> radius{};
  std::optional<double> conic{};
  std::optional<double> semi_diameter{};
  std::optional<Medium> medium{};

  bool operator==(const SurfaceChange&) const = default;
};

/// One position of a lens with moving groups: a zoom position, or the focus of a zoom position at a near subject.
struct Configuration {
  std::string name{};
  /// Name of the zoom position that this configuration focuses; nullopt for a zoom position.
  std::optional<std::string> focus_of{};
  std::optional<double> subject_distance_mm{};  ///< from the first surface, positive; nullopt: infinity
  std::optional<int> stop{};                    ///< stop surface; nullopt: the stop of the rows
  std::optional<double> focal_length_mm{};      ///< nominal, as printed in the source
  std::optional<double> f_number{};
  std::optional<double> half_field_deg{};
  std::optional<double> image_diagonal_mm{};
  std::vector<SurfaceChange> changes{};

  bool operator==(const Configuration&) const = default;
};

/// A configuration, chosen by name or by number from 0.
///
/// Fractions interpolate: 0.5 is halfway from the first to the second configuration.
class ConfigurationChoice {
 public:
  ConfigurationChoice() = default;
  ConfigurationChoice(std::string name) : choice_(std::move(name)) {}
  ConfigurationChoice(std::string_view name) : choice_(std::string(name)) {}
  ConfigurationChoice(const char* name) : choice_(std::string(name)) {}
  template <class Number>
    requires((std::integral<Number> && !std::same_as<Number, bool>) || std::floating_point<Number>)
  ConfigurationChoice(Number number) : choice_(static_cast<double>(number)) {}

  const std::variant<double, std::string>& value() const noexcept { return choice_; }

 private:
  std::variant<double, std::string> choice_ = 0.0;
};

}  // namespace petzval
