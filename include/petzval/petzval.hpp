// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Start here: petzval on one page.
///
/// A Prescription is a lens as printed in its source: plain data, from a file or a program. `compile` turns it into a
/// Lens for some wavelengths: an immutable value, cheap to copy and thread-safe. Functions take a Lens; `with_...`
/// functions return a modified copy.
///
///     Prescription --compile--> Lens --> first_order, pupils, real_f_number   cardinal points, pupils, f-numbers
///                                    --> chief_ray, aim                       rays through the stop
///                                    --> film_irradiance, image_circle_mm     irradiance of the film
///                                    --> solve_focus, depth_of_field          film positions for subjects
///                                    --> autofocus                            film position for several points
///                                    --> trace, trace_differentials           rays to film or scene, float or double,
///                                                                             single or in batches on SIMD lanes
///                                    --> Camera                               rays, importance and projection for a
///                                                                             renderer, with a choice of ray models
///                                    --> fit_two_discs                        cat's eyes as two discs
///
/// Lens frame: right-handed, millimetres. Light travels towards +z, the origin is the vertex of the first surface, the
/// scene lies at negative z, and the image on the film is inverted. Surfaces count from 0. Angles are in radians,
/// wavelengths in nanometres, as the names say. The default wavelength is the primary wavelength of the lens.
///
/// Invalid input throws Error. A solver without a solution returns a status. A lost ray has a RayFate.
///
///     using namespace petzval;
///     Lens lens = compile(read_prescription("data/lenses/double_gauss_100mm_f1.35.json"));
///     double f = first_order(lens).effective_focal_length;  // 100.437
///     lens = with_focus(with_f_number(lens, 2.0), 1000.0);  // f/2, focused at 1 m
///
/// This header declares petzval::core, and dot, cross, length and normalize for Vec2 and Vec3. petzval::core depends on
/// GLM only. The other components have separate headers:
///
///     petzval::analysis   petzval/analysis/   spots, PSFs, colour, errors of ray models
///                         petzval/ghosts/     ghosts and veiling glare
///     petzval::exports    petzval/exports/    cameras for other programs: calibrations, distortion, ray maps, shaders
///     petzval::formats    petzval/formats/    lenses and glasses in files of other programs
///     petzval::fit        petzval/fit/        tilted films that focus several points
///                         petzval/editor/     focus control by events, for interactive programs
///     petzval::blur       petzval/blur/       lens blur of images with depth
///     petzval::figure     petzval/figure/     SVG figures
///     petzval::image      petzval/image/      EXR and PNG files

#include "petzval/camera/bokeh.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/camera_ray.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/prescription/coating.hpp"
#include "petzval/prescription/prescription.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "petzval/trace/trace.hpp"

// Vector functions, for hosts without a vector library.
#include <glm/geometric.hpp>

namespace petzval {
using glm::cross;
using glm::dot;
using glm::length;
using glm::normalize;
}  // namespace petzval
