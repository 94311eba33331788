// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli.hpp"
#include "petzval/camera/expressive_lens.hpp"

namespace examples {

/// Command line of the programs with an expressive lens.
struct ExpressiveFlags {
  std::vector<std::string> power_spline;      ///< radius:power
  std::vector<std::string> curvature_points;  ///< x,y:offset
  double dispersion = 1, from_lens = 0;

  bool change_nothing() const noexcept;
};

/// Adds --power-spline, --curvature-points, --dispersion and --from-lens.
void add_expressive(App& app, ExpressiveFlags& flags);

/// The lens by the flags. @throws petzval::Error that names the option; also if fit_expressive_lens() throws
petzval::ExpressiveLens expressive_of(const ExpressiveFlags& flags, const petzval::Lens& lens,
                                      const petzval::Film& film);

}  // namespace examples
