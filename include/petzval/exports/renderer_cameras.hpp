// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"

namespace petzval {

class Camera;
class Lens;

/// Formats a lens as an Open Shading Language camera for Blender Cycles (4.5 and later) and Octane.
///
///     write_file(format_osl_camera(compile(prescription)), "lens.osl");
///
/// The result is one shader that needs no other file: the template osl/camera.osl of data_directory() with the surfaces
/// of the lens as arrays, precomputed tables, and a loop that traces a ray from the film through the surfaces.
///
/// Each sample has one of the compiled wavelengths, which the first random number chooses. The throughput is the linear
/// sRGB colour of this wavelength (rgb_weights() of D65) divided by its chance, so that the mean of white light is
/// white; its components may be negative. A lens with one wavelength has a grey throughput.
///
/// dPdx, dPdy, dDdx and dDdy are the derivatives of position and direction by the pixels of a row and of a column. The
/// point of the ray in the plane of the last vertex is constant.
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
/// Rays have uniform slopes in a box around the exit pupil as seen from the film point. The throughput is 0 if a rim
/// clips the ray; its mean over the random sample is the irradiance relative to the centre of the film, as with
/// Normalisation::unity_on_axis.
///
/// @param lens     the lens
/// @param film     the largest film that the shader supports; its width and height are the defaults of the shader's
///                 parameters. nullopt: default_film(), at most 36 x 24 mm
/// @throws Error   for mirrors; if the lens has no marked stop with a rim; if the film has no area; if with_focus() at
///                 infinity or rgb_weights() throws; if the template cannot be read or has an unknown name
///
/// Accuracy: at the widest f-number and at infinity, rays of every lens of data/lenses meet their film points within
/// 1e-5 focal lengths, and derivatives are within 2e-4 pixels. Between the tabulated f-numbers and distances they are
/// within 2e-3 focal lengths, except cylinder_3.9mm (4e-2), and 5e-3 pixels. Mean throughputs are within 2.2 % of
/// film_irradiance() (tests/formats).
PETZVAL_API std::string format_osl_camera(const Lens& lens, const std::optional<Film>& film = {});

/// Formats a camera as an include file of POV-Ray 3.7 with a mesh_camera that traces its rays: one mesh for each sample
/// of a pixel, one triangle for each pixel.
///
/// The centroid of a triangle is the origin of a ray, its normal the direction. A mesh_camera has no weights: rays are
/// dropped in proportion to their weights, and dropped or lost rays start inside a black ball.
///
/// @param camera   camera with Normalisation::unity_on_axis
/// @param samples  rays per pixel
/// @throws Error   if `samples` or the number of pixels is not positive, or no ray passes the lens
///
/// Accuracy: positions within 0.5 pixels, diameters of blur within 2 % of `petzval render`
/// (tests/examples/povray_test.cpp).
/// Limitations: POV-Ray 3.7 uses the triangles of the second row also for the first row of a picture.
PETZVAL_API std::string format_povray_camera(const Camera& camera, int samples);

}  // namespace petzval
