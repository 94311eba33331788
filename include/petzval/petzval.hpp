// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Start here: petzval in one page.
///
/// A Prescription is a lens as its source prints it: plain data, read from a file or written in a program. `compile`
/// makes a Lens of it for some wavelengths: an immutable value, cheap to copy, shared by threads. Functions take a
/// Lens; `with_...` functions return a changed one.
///
///     Prescription --compile--> Lens --> first_order, pupils, real_f_number   cardinal points, pupils, f-numbers
///                                    --> chief_ray, aim, pupil_boundary       rays through the stop, vignetted pupils
///                                    --> film_irradiance, image_circle_mm     light on the film
///                                    --> solve_focus, depth_of_field          film positions for subjects
///                                    --> autofocus, fit_tilt                  upright and tilted films for points
///                                    --> trace, trace_differentials           rays to film or scene, float or double,
///                                                                             one or in batches on SIMD lanes
///                                    --> Camera                               rays, importance and projection for a
///                                                                             renderer, by any model of the lens
///                                        --> LensDistortion                where it differs from a pinhole's picture
///                                    --> choose_model                         the fastest model in an error budget
///                                    --> fit_two_discs                        its cat's eyes as two discs
///                                    --> spot_diagram, point_image            spots and images of points
///                                    --> psf_kernel, PsfSet                   images of points over field, distance,
///                                                                             wavelength and stop, interpolated
///                                    --> chromatic_aberration                 longitudinal and lateral colour
///
/// Lens frame: right-handed, millimetres. Light travels towards +z, the origin is the vertex of the first surface, the
/// scene lies at negative z, and the image on the film is upside down. Surfaces count from 0. Angles are in radians,
/// wavelengths in nanometres; names say so. The default wavelength is the primary one of the lens.
///
/// Invalid input throws Error. A solver without a solution returns a status. A lost ray has a RayFate.
///
///     using namespace petzval;
///     Lens lens = compile(read_prescription("data/lenses/double_gauss_100mm_f1.35.json"));
///     double f = first_order(lens).effective_focal_length;  // 100.437
///     lens = with_focus(with_f_number(lens, 2.0), 1000.0);  // f/2, focused at 1 m
///     PointImage bokeh = point_image(lens, {.field_rad = 0, .z = -1500});
///
/// This header declares the core, and dot, cross, length and normalize of Vec2 and Vec3: a program links petzval::core,
/// which brings GLM and nothing else. petzval/figure/ has
/// SVG figures (petzval::figure), petzval/io/image.hpp images (petzval::image), petzval/movement/tilt_fit.hpp the
/// tilted film (petzval::fit).

#include "petzval/accuracy/choose_model.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/camera_tables.hpp"
#include "petzval/camera/expressive_lens.hpp"
#include "petzval/camera/host_frame.hpp"
#include "petzval/camera/polynomial_model.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/camera/two_discs.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/core/read_file.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/core/units.hpp"
#include "petzval/core/version.hpp"
#include "petzval/distortion/brown_conrady.hpp"
#include "petzval/distortion/lens_distortion.hpp"
#include "petzval/distortion/st_map.hpp"
#include "petzval/files/glass_files.hpp"
#include "petzval/files/lens_file.hpp"
#include "petzval/files/lens_metadata.hpp"
#include "petzval/files/open_track_io.hpp"
#include "petzval/film/film.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/lens_json.hpp"
#include "petzval/io/write_file.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/medium.hpp"
#include "petzval/lint/lint.hpp"
#include "petzval/lint/match_glasses.hpp"
#include "petzval/media/glass.hpp"
#include "petzval/movement/autofocus.hpp"
#include "petzval/movement/focal_surface.hpp"
#include "petzval/movement/focus_point.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"
#include "petzval/prescription/prescription.hpp"
#include "petzval/psf/colour.hpp"
#include "petzval/psf/psf.hpp"
#include "petzval/psf/psf_set.hpp"
#include "petzval/psf/spot.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "petzval/pupil/pupil_boundary.hpp"
#include "petzval/pupil/textbook.hpp"
#include "petzval/trace/trace.hpp"

// The functions of its vectors, for hosts without a vector library of their own.
#include <glm/geometric.hpp>

namespace petzval::inline v0 {
using glm::cross;
using glm::dot;
using glm::length;
using glm::normalize;
}  // namespace petzval::inline v0
