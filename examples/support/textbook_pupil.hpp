// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace examples {

/// A pupil by the textbook method: one disc on the axis, with the ray that defines it.
struct TextbookPupil {
  double z = 0;              ///< paraxial image of the stop (lens frame, mm); infinite if telecentric
  double diameter = 0;       ///< twice the height of the marginal ray in that plane, mm
  std::size_t limiting = 0;  ///< surface that ends the next ray outwards; not always the stop
  petzval::RayFate next_fate = petzval::RayFate::vignetted;  ///< the fate of that next ray
  /// The outermost transmitted ray before it meets the lens: in object space (entrance) or image space (exit).
  petzval::Ray<double> marginal{};
};

/// The entrance pupil by the textbook method: the outermost ray from an axial point that passes the lens, found by
/// bisection between the axis and the rim of the first surface, in the plane of the paraxial image of the stop. The
/// literature samples lenses by this pupil. Use pupils() for the image of the stop, aim() for rays to the stop and
/// pupil_boundary() for the vignetted pupil.
///
/// @param object_z  axial point (lens frame, mm); infinite, or any value except the first vertex (a converging beam
///                  aims behind it)
/// @throws Error if pupils() does, if the wavelength was not compiled, if object_z is NaN or the vertex, or if the
///         axial ray is lost
///
/// Limitations, by tests/examples/textbook_pupil_test.cpp for a double Gauss f/2:
///   - the ray belongs to the first rim that clips, which need not be the stop: f/2.018 instead of f/2.004;
///   - the pupil is a disc on the axis. From 10 degrees on, rims and pupil aberrations clip and shift the real pupil:
///     in the corner of the film a fifth of the disc passes;
///   - stopped down, without clipping rims, the disc is misplaced: it misses a fifth of the passing rays in that
///   corner;
///   - a lens with a central obscuration has no such pupil.
///
/// Wu et al. 2010, section 5.1.2, steps 1 to 8, with three repairs: the result is the last ray that passed, not the
/// untraced middle of the bracket; rays are indexed by their distance from the vertex, which also works for infinite
/// conjugates; steps 6 to 8 are replaced by their limit, the paraxial matrices.
TextbookPupil textbook_entrance_pupil(const petzval::Lens& lens, double object_z, petzval::Wavelength wavelength = {});

/// The exit pupil by the same method from the other side: rays from the axial point of a film, traced to the scene.
TextbookPupil textbook_exit_pupil(const petzval::Lens& lens, double film_z, petzval::Wavelength wavelength = {});

}  // namespace examples
