// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Start here: petzval in one page.
///
/// A lens is read or written down as a Prescription, what a patent prints, and compiled for some wavelengths to a Lens:
/// an immutable value, always valid, cheap to copy, safe to share between threads. Everything else asks the Lens.
///
///     Prescription  --compile-->  Lens  -->  first_order, pupils, real_f_number     numbers about the lens
///                                       -->  chief_ray, aim, pupil_boundary          which rays of a point get through
///                                       -->  relative_illumination                  how much light the film gets
///                                       -->  solve_focus, depth_of_field            where the film belongs
///                                       -->  autofocus, fit_tilt                    a film for points to be sharp,
///                                                                                   upright or tilted
///                                       -->  trace, trace_differentials             rays, either way, float or double,
///                                                                                   one or in batches on SIMD lanes
///                                       -->  Camera                                 rays, importance, projection for a
///                                                                                   renderer, by one of eleven models
///                                       -->  choose_model                           the cheapest model inside a budget
///                                       -->  spot_diagram, point_image              what the film sees of a point
///
/// Lens frame: right-handed, millimetres, light travels towards +z, origin at the vertex of the first surface; the
/// scene lies at negative z and the film image is upside down. Surfaces count from 0. Angles are radians, wavelengths
/// nanometres, and names say so.
///
/// What cannot be built throws Error; a solver that finds nothing returns a status; a ray that is lost has a RayFate.
///
///     using namespace petzval;
///     Lens lens = compile(read_prescription("data/lenses/double_gauss_100mm_f1.35.json"));
///     double f = first_order(lens).effective_focal_length;        // 100.437
///     lens = with_focus(with_f_number(lens, 2.0), 1000.0);        // f/2, focused at 1 m
///     PointImage bokeh = point_image(lens, {.field_rad = 0, .z = -1500});
///
/// This header has the core, for which a program links petzval::core and nothing but GLM. Images and figures are in
/// petzval/io/image.hpp and petzval/figure/ (petzval::image), the tilted film in petzval/movement/tilt_fit.hpp
/// (petzval::fit).

#include "petzval/camera/camera.hpp"
#include "petzval/camera/choose_model.hpp"
#include "petzval/camera/host_frame.hpp"
#include "petzval/camera/sample_rays.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/core/units.hpp"
#include "petzval/focus/depth_of_field.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/prescription_json.hpp"
#include "petzval/io/ray_polynomial_json.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lint/lint.hpp"
#include "petzval/media/catalogue.hpp"
#include "petzval/movement/autofocus.hpp"
#include "petzval/movement/focus_point.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/pupils.hpp"
#include "petzval/paraxial/thin_lens.hpp"
#include "petzval/polynomial/ray_polynomial.hpp"
#include "petzval/prescription/prescription.hpp"
#include "petzval/psf/colour.hpp"
#include "petzval/psf/histogram.hpp"
#include "petzval/psf/psf.hpp"
#include "petzval/psf/spot.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "petzval/pupil/pupil_boundary.hpp"
#include "petzval/pupil/pupil_sampler.hpp"
#include "petzval/trace/batch.hpp"
#include "petzval/trace/differentials.hpp"
#include "petzval/trace/trace.hpp"
