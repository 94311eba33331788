// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"

namespace petzval {

class Lens;

/// Formats a lens as an Open Shading Language camera for Blender Cycles (4.5 and later) and Octane.
///
///     write_file(format_osl_camera(compile(prescription)), "lens.osl");
///
/// The result is one shader that needs no other file: the surfaces of the lens as arrays, precomputed tables, and a
/// loop that traces a ray from the film through the surfaces, at the primary wavelength.
///
/// Experimental: the parameters may change in any version.
///
/// Parameters of the shader: sensor width and height (mm); focus distance (host units, from the origin of the camera
/// along its axis); f-number (as with_f_number(), no faster than the lens); blades, roundness and rotation of the iris
/// (Iris); host units per mm (0.001 for metres). The film moves to focus, or the groups move if the lens has focus
/// positions.
///
/// Camera space is the space of Cycles: +x right, +y up, +z forward. Its origin is the entrance pupil of the lens
/// focused at infinity, or the front vertex if this pupil is at infinity. Octane has other names for the film point and
/// the random sample; the comment at the top of the shader names the variables to replace.
///
/// Rays start uniformly in a box around the exit pupil as seen from the film point. The throughput is 0 if a rim clips
/// the ray; its mean over the random sample is the irradiance relative to the centre of the film, as with
/// Normalisation::unity_on_axis.
///
/// @param lens     the lens
/// @param film     the largest film that the shader supports; its width and height are the defaults of the shader's
///                 parameters. nullopt: 36 x 24 mm, or the largest 3:2 film inside the circle with at least a tenth of
///                 the axial irradiance.
/// @throws Error   for mirrors and cylinders; if the lens has no marked stop with a rim; if the film has no area; if
///                 with_focus() at infinity throws
///
/// Accuracy: film position within 1e-4 focal lengths of solve_focus() for the f-number; mean throughput within 2 % of
/// film_irradiance(); rays within 1e-4 of trace() in float (tests/formats).
PETZVAL_API std::string format_osl_camera(const Lens& lens, const std::optional<Film>& film = {});

}  // namespace petzval
