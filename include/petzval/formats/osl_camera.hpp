// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"

namespace petzval {

class Lens;

struct OslCameraOptions {
  /// The largest film that the shader is for: its width and height, which are also the defaults of its parameters.
  /// Absent: 36 x 24 mm, or the largest of 3:2 in the image circle in which the film has a tenth of the axis's light.
  std::optional<Film> film{};
};

/// A camera for Blender's Cycles (4.5 and later) and for Octane, as the text of one Open Shading Language shader that
/// needs no other file: the surfaces of the lens as arrays, a loop that traces a ray from the film through them, and
/// numbers made beforehand.
///
///     write_file(format_osl_camera(compile(prescription)), "lens.osl");
///
/// Parameters of the shader: sensor width and height (mm), focus distance (in units of the host, from the camera's
/// origin along its axis), f-number (as with_f_number(), no faster than the lens given), blades, roundness and rotation
/// of the iris (Iris), and the units of the host per mm (0.001: metres). The film moves to focus, or groups do where
/// the lens has focus positions; the film is where solve_focus() puts it for this f-number, within 1e-4 of the
/// focal length.
///
/// Camera space is that of Cycles: +x right, +y up, +z forward, the origin in the entrance pupil of the lens as focused
/// at infinity (in its front vertex if that pupil is at infinity). Octane wants its own names for the film place and
/// the random sample; the comment at the top of the shader says where they stand. Light is that of the primary
/// wavelength.
///
/// Rays start at a uniform place in a box about what the film place sees of the rear of the lens, for its distance from
/// the axis and the f-number. Throughput is 0 where a rim clips; its mean over the random sample is the irradiance of
/// the film for a scene of radiance 1 over that of the middle of the film, as Normalisation::unity_on_axis: within 2 %
/// of film_irradiance(), and rays within 1e-4 of those of trace() in float (tests/formats).
///
/// Throws Error for mirrors, cylinders and a lens that nothing limits, and where with_focus() does at infinity.
PETZVAL_API std::string format_osl_camera(const Lens& lens, const OslCameraOptions& options = {});

}  // namespace petzval
