// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "cli.hpp"
#include "iris_setup.hpp"
#include "load_lens.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"

namespace examples {

/// Command line of the programs with a camera.
struct CameraSetup {
  IrisSetup iris;
  double focus_mm = 3000;       ///< of the subject
  std::string origin = "film";  ///< of that distance
  std::string criterion = "min_rms";
  std::string film_mm = "36x24";

  /// Width and height of the film. Throws petzval::Error.
  std::array<double, 2> film_size() const;
};

/// Options of add_iris, --focus-mm, --criterion and --film-mm.
void add_camera(App& app, CameraSetup& setup);

/// Option --distance-from, of --focus-mm.
Option* add_distance_origin(App& app, CameraSetup& setup);

/// Option --model.
Option* add_model(App& app, std::string& model);

/// "36x24". Throws petzval::Error beginning with `where`.
std::array<double, 2> parse_size(const std::string& where, std::string_view text, const Range& range);

/// The loaded lens, stopped down and focused at its primary wavelength.
petzval::Lens focused(const LoadedLens& loaded, const CameraSetup& setup);

/// Notes on standard error a film that does not fit its lens: what petzval::lint() finds. Without pixels it looks at
/// the size of the film alone.
void say_what_does_not_fit(const petzval::Lens& lens, const petzval::Film& film, bool has_pixels = true);

}  // namespace examples
