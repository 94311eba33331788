// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace examples {

/// A pupil as the textbook method finds it: one disc on the axis, and the ray that gave it.
struct TextbookPupil {
  double z = 0;         ///< of the paraxial image of the stop (lens frame, mm); infinite: telecentric
  double diameter = 0;  ///< of the marginal ray in that plane, mm
  std::size_t limiting =
      0;  ///< the surface that ends the next ray outwards: the first rim to clip, not always the stop
  petzval::RayFate beyond = petzval::RayFate::vignetted;  ///< the fate of that next ray
  /// The outermost ray, traced and transmitted; as it meets the lens: in object space (entrance) or image space (exit).
  petzval::Ray<double> marginal{};
};

/// The entrance pupil by the textbook method: the outermost ray that the lens passes from a point of the axis, found by
/// bisection between the axis and the rim of the first surface, in the plane of the paraxial image of the stop.
/// The literature samples lenses by this pupil. Its errors (tests/examples/textbook_pupil_test.cpp, a
/// double Gauss f/2) are:
///   - its ray belongs to the first rim that clips, which need not be the stop: f/2.018 where the stop gives f/2.004;
///   - it is a disc on the axis: 10 degrees or more off, rims and the aberrations of the pupil cut and shift what
///     passes. In the corner of the film a fifth of the disc passes;
///   - stopped down, where no rim clips, the disc is still in the wrong place: it misses a fifth of the passing rays in
///     that corner. A lens with a central obscuration has no such pupil at all.
/// Use pupils() for the image of the stop, aim() for its rays and pupil_boundary() for what passes.
///
/// object_z: lens frame, mm; infinite, or anywhere but in the first vertex (a converging beam aims behind it).
/// Steps 1 to 8 of Wu et al. 2010, section 5.1.2, repaired: the result is the last ray that passed (theirs is a middle
/// of the bracket that nobody traced); rays count by their distance from the vertex, which an infinite conjugate has
/// too; steps 6 to 8 are their limit, the paraxial matrices. Throws Error where pupils() does, for a wavelength that
/// was not compiled, an object_z in the vertex or NaN, and where the ray along the axis is lost.
TextbookPupil textbook_entrance_pupil(const petzval::Lens& lens, double object_z, petzval::Wavelength wavelength = {});

/// The exit pupil by the same method from the other side: rays from the axial point of a film, traced to the scene.
TextbookPupil textbook_exit_pupil(const petzval::Lens& lens, double film_z, petzval::Wavelength wavelength = {});

}  // namespace examples
