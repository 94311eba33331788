// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "cli.hpp"
#include "focus_pull.hpp"
#include "load_lens.hpp"
#include "petzval/camera/bokeh.hpp"
#include "petzval/core/film.hpp"
#include "petzval/io/json.hpp"
#include "petzval/lens/lens.hpp"

namespace examples {

/// The set-up of a camera by the flags of a command line.
struct CameraFlags : petzval::CameraSetup {
  FocusPull pull = {};                      ///< a focus that moves; focus_mm is then its first distance
  std::string iris_area = "circumscribed";  ///< meaning of f_number: "equal": of a round iris of the same area
  std::string points_file = {};             ///< points of the focal surface, used instead of focal_points
  double from_lens = 0;                     ///< factor of the aberrations of the lens, for expressive_of()
  bool film_given = false;                  ///< the film has the size of --film or --setup
  bool pixels_given = false;                ///< the film has the pixels of --setup
  std::string file = {};                    ///< of --setup

  CameraFlags() { focus_mm = 3000; }

  /// The film with the given numbers of pixels; 0: not given. Without both the pixels of --setup are used.
  ///
  /// Without --film the film is the largest with the shape of the picture within 36 x 24 mm, or within 24 x 36 mm
  /// for a picture in portrait format. A missing number of pixels follows from the film and square pixels.
  ///
  /// @param usual_columns  columns if neither number is given
  /// @throws petzval::Error if --film is so narrow that the picture would need more than 16384 pixels
  petzval::Film sized_film(std::uint32_t columns, std::uint32_t rows, std::uint32_t usual_columns) const;
  /// Number of frames: --frames, the frames of a file of distances, or 1. A focus that moves has no focal surface.
  /// @throws petzval::Error that names the flag
  std::uint32_t frame_count() const;
  /// The set-up for a report, with the f-number of stopped_down().
  petzval::CameraSetup used_with(const petzval::Lens& compiled) const;
};

/// Adds --setup: a set-up, or a report with one, that replaces LENS and the values of all flags that are not given.
/// Must be added before these flags, because options are applied in the order of their addition.
void add_setup(App& app, CameraFlags& flags);

/// Adds the options of add_iris, --focus, --from, --criterion and --film.
/// @param frames_help  if not empty, adds the options of add_focus_pull()
void add_camera(App& app, CameraFlags& flags, const std::string& frames_help = "");

/// Adds --film. @param help  meaning of the size
void add_film(App& app, CameraFlags& flags, const std::string& help = "width and height of the film (mm)");

/// Adds --tilt and --swing. @param degrees  range
void add_tilt(App& app, CameraFlags& flags, const Range& degrees);

/// Adds --f-number.
void add_f_number(App& app, CameraFlags& flags);
/// Adds --blades, --roundness, --iris-rotation and --iris-area.
void add_iris_shape(App& app, CameraFlags& flags);
/// Adds the options of add_iris_shape() and --f-number.
void add_iris(App& app, CameraFlags& flags);

/// Adds --power-spline, --curvature-points, --dispersion and --from-lens, for camera.expressive.
void add_expressive(App& app, CameraFlags& flags);
/// camera.expressive, completed by --from-lens. @throws petzval::Error if fit_expressive_lens() throws
petzval::ExpressiveLens expressive_of(const CameraFlags& flags, const petzval::Lens& lens, const petzval::Film& film);

/// Adds --size, 0 if not given, for CameraFlags::sized_film.
void add_picture_size(App& app, std::uint32_t& width, std::uint32_t& height, std::uint32_t usual_width);

/// Adds --model.
Option* add_model(App& app, petzval::ModelKind& model);

/// The lens with the iris, stopped down unless it is a thin lens of the flags. Lens names are rounded: if the f-number
/// is faster than the lens by at most 4 %, the lens opens fully and a note on standard error gives the true f-number.
/// @throws petzval::Error if the lens cannot have the iris or the f-number
petzval::Lens stopped_down(const petzval::Lens& lens, const CameraFlags& flags);
/// The loaded lens, stopped down and focused at its primary wavelength.
petzval::Lens focused(const LoadedLens& loaded, const CameraFlags& flags);

/// Prints the findings of petzval::lint() about a film as notes on standard error.
///
/// @param pixel_flags  the options that set the numbers of pixels; if empty, only the size of the film is checked
void say_what_does_not_fit(const petzval::Lens& lens, const petzval::Film& film,
                           const std::string& pixel_flags = "--size");

}  // namespace examples
