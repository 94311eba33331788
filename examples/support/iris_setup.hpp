// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cli.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/lens.hpp"

namespace examples {

/// Command line of the programs that shape and stop down the iris.
struct IrisSetup {
  double f_number = 0;  ///< 0: wide open
  std::uint32_t blades = 0;
  double roundness = 0, rotation_deg = 0;
  std::string area = "circumscribed";
  std::string f_number_flag = "--f-number";  ///< for messages

  petzval::Iris iris() const;
  /// The f-number for petzval::with_f_number. @throws petzval::Error if the iris is out of range
  double f_number_by_corners() const;
};

/// Adds --blades, --roundness, --iris-rotation and --iris-area.
void add_iris_shape(App& app, IrisSetup& setup);

/// Adds the options of add_iris_shape() and --f-number.
void add_iris(App& app, IrisSetup& setup);

/// Applies petzval::with_f_number for the f-number of a command line. Lens names are rounded: if the f-number is faster
/// than the lens by at most 4 %, the lens opens fully and a note on standard error gives the true f-number.
petzval::Lens stopped_to(const petzval::Lens& lens, double f_number, const std::string& flag = "--f-number");

/// The lens with the iris, stopped down. @throws petzval::Error if the lens cannot have the iris or the f-number
petzval::Lens stopped_down(const petzval::Lens& lens, const IrisSetup& setup);

}  // namespace examples
