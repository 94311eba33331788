// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "cli.hpp"
#include "focus_pull.hpp"
#include "iris_setup.hpp"
#include "load_lens.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace examples {

/// Width or height of a film, mm.
inline constexpr Range film_side{std::numeric_limits<double>::min(), 1e6, "a length above 0, at most 1e6 mm"};

/// Command line of the programs with a camera.
struct CameraSetup {
  IrisSetup iris;
  double focus_mm = 3000;  ///< distance of the subject in focus, mm
  FocusPull pull;          ///< a focus that moves; focus_mm is then its first distance
  FocusFlags focus;        ///< origin and criterion of focus_mm
  std::string film_mm = "36x24";
  bool film_given = false;

  /// Width and height of the film. Throws petzval::Error.
  std::array<double, 2> film_size() const;

  /// A film with the given numbers of pixels; 0: not given.
  ///
  /// Without --film the film is the largest with the shape of the picture within 36 x 24 mm, or within 24 x 36 mm
  /// for a picture in portrait format. A missing number of pixels follows from the film and square pixels.
  ///
  /// @param usual_columns  columns if neither number is given
  /// @throws petzval::Error if --film is invalid, or so narrow that the picture would need more than 16384 pixels
  petzval::Film film(std::uint32_t columns, std::uint32_t rows, std::uint32_t usual_columns) const;
};

/// Adds the options of add_iris, --focus, --from, --criterion and --film.
/// @param frames_help  if not empty, adds the options of add_focus_pull()
void add_camera(App& app, CameraSetup& setup, const std::string& frames_help = "");

/// Adds --size, 0 if not given, for CameraSetup::film.
void add_picture_size(App& app, std::uint32_t& width, std::uint32_t& height, std::uint32_t usual_width);

/// Adds --model.
Option* add_model(App& app, std::string& model);

/// Parses a size like "36x24"; parts of --film may have units. @throws petzval::Error that begins with `where`, if the
/// text is not a size
std::array<double, 2> parse_size(const std::string& where, std::string_view text, const Range& range);

/// The loaded lens, stopped down and focused at its primary wavelength.
petzval::Lens focused(const LoadedLens& loaded, const CameraSetup& setup);

/// Prints the findings of petzval::lint() about a film as notes on standard error.
///
/// @param pixel_flags  the options that set the numbers of pixels; if empty, only the size of the film is checked
void say_what_does_not_fit(const petzval::Lens& lens, const petzval::Film& film,
                           const std::string& pixel_flags = "--size");

}  // namespace examples
