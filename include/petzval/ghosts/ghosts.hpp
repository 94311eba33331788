// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// How ghosts are computed.
enum class GhostModel {
  exact,     ///< exact rays with their derivatives
  paraxial,  ///< to first order about the axis: one polygon of uniform irradiance for each pair
};

/// Options of ghosts.
struct GhostOptions {
  Wavelength wavelength = {};   ///< for ghost_pairs() and ghost_audit(); any wavelength that the lens covers
  double film_reflectance = 0;  ///< reflectance of the film, 0 to 1, equal for all angles: the film is a first mirror
  /// The pairs that are computed, as (GhostPair::first, GhostPair::second); empty: all
  std::vector<std::array<std::size_t, 2>> only{};
  /// Largest number of pairs; for lenses of more than 100 surfaces, at most 200000 divided by their number. The pairs
  /// of the surfaces with the highest reflectances at normal incidence are kept.
  std::size_t max_pairs = 2000;
  bool starburst = false;  ///< add_ghosts() also adds the light that the edges of the pupil diffract
  /// Target for the relative error of the energy of a pair; reached with at most 256^2 rays.
  double tolerance = 1e-3;
  GhostModel model = GhostModel::exact;  ///< of the pairs; the starburst and the audit are exact
  int threads = 1;                       ///< at least 1; the number does not change results
};

/// Light that is reflected at one surface, travels back, and is reflected again towards the film.
struct GhostPair {
  std::size_t first = 0;   ///< surface of the second reflection, the one nearer to the scene; surfaces count from 0
  std::size_t second = 0;  ///< surface of the first reflection; Lens::surface_count() is the film
  /// Energy on the film plane, as a fraction of the light that enters the first surface within its rim.
  double energy = 0;
  double error = 0;          ///< estimated relative error of `energy`; paraxial: its distance from exact rays
  FilmPoint centre{};        ///< centroid of the energy, mm
  double rms_radius_mm = 0;  ///< root of the mean squared distance from the centroid
  double peak_per_mm2 = 0;   ///< largest energy per area of a square of 1/64 of the ghost's width, at least 1 um
  bool caustic = false;      ///< true if rays cross in front of the film in one part of the ghost only
};

/// The ghosts of a light at one wavelength.
struct Ghosts {
  std::vector<GhostPair> pairs;  ///< all pairs that reach the film, by decreasing energy
  /// Area of the beam that enters the first surface within its rim, across the beam at the front vertex (mm^2): the
  /// power that enters (W) for an irradiance of 1e6 W/m^2.
  double entering_mm2 = 0;
  std::size_t left_out = 0;    ///< number of pairs beyond GhostOptions::max_pairs
  double left_out_energy = 0;  ///< sum of the products of their reflectances at normal incidence
};

/// The ghosts of every pair of surfaces of a lens, with exact rays.
///
/// A ray of a pair keeps its power times the transmittances of the surfaces and the two reflectances, as
/// surface_light(), and the internal transmittances of the media. Surfaces without a stated coating are uncoated.
/// Polarisation is kept along the path: s and p are relative to the plane of incidence of each surface. Rims,
/// obscurations and the iris clip at every passage. Mirrors of the lens reflect on every path, and form no pairs.
///
/// @param lens   the lens; rays end at the film plane of Lens::film_z(), without limits
/// @param light  a point, or the direction towards a point at infinity (scene_point())
/// @throws Error if the light is behind the front surface, inside the lens or too close (seen from the light, the first
///               surface must be within 87 degrees of its vertex), or no light enters the first surface; if this
///               surface has no rim; if an option is out of range; if a wavelength is outside a table of reflectances
///
/// Accuracy: GhostPair::error, with a target of GhostOptions::tolerance (tests/ghosts).
///
/// Limitations: phases of coatings and of total reflection are not modelled; s and p keep the phase difference of
/// normal incidence. Interference and diffraction are not modelled. A region of the entrance that is much smaller than
/// another region of the same pair may be missed.
PETZVAL_API Ghosts ghost_pairs(const Lens& lens, const ScenePoint& light, const GhostOptions& options = {});

/// Adds the ghosts of a light to pictures of a film.
///
/// Values are irradiances of the film for a light whose irradiance at the front vertex, across the beam, is 1. Times
/// the irradiance of a light (W/m^2), they have the unit of the mean of CameraRay::weight * radiance with
/// Normalisation::irradiance. Each ray deposits its energy over its cell by its exact derivatives, integrated over the
/// pixels; no two rays are joined.
///
/// A starburst is the mean of Fraunhofer's diffraction over its fringes, for uniform light in the pupil, about the
/// image of the light; a sixth of the light of the image of a round pupil. It begins at the first dark ring, where the
/// mean is right: the image itself is not added. Its fringes, of wavelength times f-number, are smaller than pixels.
///
/// @param lens         the lens
/// @param light        as in ghost_pairs()
/// @param film         the film; its margin is ignored. A reflecting film is taken as upright at Lens::film_z()
/// @param wavelengths  one picture for each
/// @param pictures     [wavelength][row][column], row 0 at the top of the upright picture
/// @param options      as in ghost_pairs(); `wavelength` is ignored
/// @throws Error       as ghost_pairs(); if the film has no area or the pictures have another size
///
/// Accuracy: edges within 0.2 pixels, energy within 1 % of each ghost that holds more than 1e-4 of the light of all
/// ghosts in the picture; a ghost of uniform irradiance is flat within
/// 1e-5 (tests/ghosts). Elsewhere the irradiance has steps of about 1 %. Starbursts: 3 % of Fraunhofer's light in
/// rings.
///
/// Limitations: ghosts have no starbursts.
PETZVAL_API void add_ghosts(const Lens& lens, const ScenePoint& light, const Film& film,
                            std::span<const Wavelength> wavelengths, std::span<float> pictures,
                            const GhostOptions& options = {});

/// The fate of the light that enters the first surface within its rim, as fractions. A reflecting film takes the
/// light that it does not reflect.
struct GhostAudit {
  double image = 0;         ///< taken by the film without a reflection at a refracting surface
  double ghosts = 0;        ///< taken after two reflections, from ghost_pairs()
  double higher_order = 0;  ///< taken after more reflections, or not followed
  double absorbed = 0;      ///< by media, coatings and mirrors
  double stopped = 0;       ///< by rims, the iris, edges and mounts
  double back_out = 0;      ///< leaves through the first surface
  double sum = 0;           ///< of all; 1 within the errors of rays and pairs
};

/// Splits rays at every surface and follows both branches.
///
/// Branches with more than two reflections are followed down to 1e-5 of the ray. The reflectance of the film counts as
/// a reflection. `ghosts` comes from ghost_pairs(), all other numbers from split rays.
///
/// @param rays  number of rays that are split, at least 1; fewer for lenses of more than 100 surfaces. Of more than 48
///              surfaces, some reflected branches are chosen at random
/// @throws Error as ghost_pairs()
///
/// Accuracy: sum within 0.002 of 1 for every shipped lens (tests/ghosts); smaller if pairs are left out.
PETZVAL_API GhostAudit ghost_audit(const Lens& lens, const ScenePoint& light, const GhostOptions& options = {},
                                   std::size_t rays = 512);

}  // namespace petzval
