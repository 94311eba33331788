// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "petzval/analysis/aberrations.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {

/// Number of Zernike polynomials in fringe order.
inline constexpr std::size_t zernike_terms = 37;

/// A Zernike polynomial in fringe order: 1, r cos a, r sin a, 2 r^2 - 1, r^2 cos 2a, ... with the angle a from +x to
/// +y. At r = 1, a = 0 the cosine terms are 1 and the sine terms 0.
///
/// @param term   0 to 36: one less than the number in other programs
/// @param pupil  position in the unit circle
/// @throws Error if `term` is above 36
PETZVAL_API double zernike_fringe(std::size_t term, const Vec2<double>& pupil);

/// Pupil coordinates of a wavefront.
enum class PupilCoordinates : std::uint8_t {
  stop,      ///< intersections with the stop, in its semi-diameters
  entrance,  ///< intersections with the plane of the paraxial entrance pupil, in its semi-diameters
};

/// Wavefront error of one field and wavelength over the exit pupil, in waves.
///
/// The centre of the reference sphere is the chief ray on the film. Its radius is the length of the chief ray from the
/// plane of the paraxial exit pupil.
/// Errors are positive if the wavefront is ahead of the sphere, as with undercorrected spherical aberration; the error
/// of the chief ray is 0.
struct Wavefront {
  struct Point {
    Vec2<double> pupil{0, 0};
    double waves = 0;
    double weight = 0;  ///< share of the light; the weights sum to 1
  };
  std::vector<Point> points{};  ///< rays that pass the lens
  Vec2<double> image{0, 0};     ///< chief ray on the film, mm
  double reference_radius = 0;  ///< radius of the reference sphere, mm; infinite for a telecentric image space
  double rms_waves = 0;         ///< standard deviation
  double rms_without_tilt = 0;  ///< standard deviation about the image point that makes it smallest, waves
  double peak_to_valley_waves = 0;
  /// Strehl ratio at the image point with the smallest standard deviation, for equal amplitude over the pupil. nullopt
  /// if rms_without_tilt exceeds half a wave, because such an image has no single peak.
  std::optional<double> strehl{};
  double strehl_error = 0;                      ///< as sampling_error_waves, for strehl; 0 without it
  std::array<double, zernike_terms> zernike{};  ///< coefficients in waves; zernike[k] belongs to zernike_fringe(k)
  double zernike_residual_waves = 0;            ///< standard deviation of the wavefront about the polynomials
  /// Larger change of rms_waves with a third of the directions and with half of the nodes along each direction.
  double sampling_error_waves = 0;
};

/// Wavefront error over the exit pupil, by optical paths of exact rays.
///
/// Rays lie on Gauss-Legendre nodes inside the vignetted pupil: 16 along each direction, 32 if strehl_error exceeds
/// 1e-4. Lenses with thousands of surfaces keep the first number of directions, with a larger strehl_error. Zernike
/// coefficients are a least-squares fit in the unit circle of the coordinates; if the pupil is vignetted, the
/// polynomials are not orthogonal over the rays.
///
/// @param lens   the focused lens
/// @param point  the scene point
/// @param wavelength   a compiled wavelength
/// @param coordinates  of Wavefront::points and the Zernike coefficients
/// @param directions   directions about the middle of the pupil, a multiple of 3, at least 12; up to nine times as many
///                     if the Strehl ratio needs them
/// @return       nullopt if the chief ray does not reach the film, or the pupil is empty
/// @throws Error if the number of directions is not a multiple of 3 or below 12, or under the conditions of aim()
///
/// Accuracy: paths within 1e-8 waves of sums in long double; rms_waves and Zernike coefficients within
/// sampling_error_waves, and strehl within strehl_error, of ten times the rays (tests/analysis/wavefront_test.cpp).
PETZVAL_API std::optional<Wavefront> wavefront(const Lens& lens, const FieldPoint& point, Wavelength wavelength = {},
                                               PupilCoordinates coordinates = PupilCoordinates::stop,
                                               std::size_t directions = 48);

/// Options of diffraction_psf().
struct DiffractionOptions {
  int pixels = 512;                      ///< width of the image, 16 to 4096
  double half_width_mm = 0;              ///< half of the image width; 0: 15 Airy radii, or the geometric blur and 5 %
  std::optional<Vec2<double>> centre{};  ///< film position of the image centre, mm; unset: the chief ray
  std::optional<std::size_t> wavelength{};  ///< wavelength index; unset: all compiled wavelengths
  /// false: fast Fourier transform over a uniform grid of directions behind the lens. true: Huygens' sum, one plane
  /// wave for each ray: time grows with pixels times rays, any window.
  bool huygens = false;
  int threads = 1;  ///< does not change the results
};

/// Image of a point light with diffraction.
///
/// Each wavelength has one plane of `pixels` x `pixels` values, rows from the top (largest y first), as in Psf. Values
/// are irradiance per mm^2 of the film as a fraction of the light on the paraxial entrance pupil.
struct DiffractionPsf {
  FieldPoint point;
  int pixels = 0;
  double pixel_mm = 0;
  Vec2<double> centre{0, 0};  ///< film position of the image centre, mm
  std::vector<double> wavelengths_nm{};
  std::vector<double> irradiance{};  ///< [wavelength][row][column]
  std::vector<double> throughput{};  ///< light that passes the lens, per wavelength, as in Psf::throughput()
  /// Largest irradiance of the image relative to the same amplitudes without wavefront error, per wavelength. The size
  /// of pixels does not matter.
  std::vector<double> strehl{};
  int samples_per_pixel = 1;  ///< a pixel is the mean of this number of samples squared
  /// Light of each column of samples from left to right and of each row from the bottom, [wavelength][sample], with
  /// `pixels` times `samples_per_pixel` samples: the images of lines, for diffraction_mtf().
  std::vector<double> line_x{}, line_y{};
};

/// Image of a point light with diffraction: a sum of the plane waves behind the lens at the film (Debye's integral).
///
/// Amplitudes conserve the energy of uniform light in the plane of the entrance pupil. A cell of the FFT that the edge
/// of the pupil crosses is sampled with 64 rays. The FFT repeats itself outside of its window, which is twice as wide
/// as the image if 4096 samples permit: spikes of an iris beyond the window return faintly.
///
/// @param lens     the focused lens
/// @param point    the scene point
/// @param options  image and arithmetic
/// @throws Error   if an option is invalid; if the image or the geometric blur needs more than 4096 samples: the
///                 geometric point_image() serves defocused lenses; if the rays behind the lens are parallel in a
///                 section; under the conditions of aim()
///
/// Accuracy: the FFT equals Huygens' sum within 1e-3 of the largest irradiance (tests/analysis/diffraction_test.cpp).
PETZVAL_API DiffractionPsf diffraction_psf(const Lens& lens, const FieldPoint& point,
                                           const DiffractionOptions& options = {});

/// MTF with diffraction, from an image: the contrast of lines perpendicular to y (tangential) and to x (sagittal).
///
/// Pixels do not matter: their samples are used. The light outside of the image counts as a background without
/// contrast, so that the MTF begins at the fraction of the light that the image holds.
///
/// @param psf                 the image
/// @param frequencies_per_mm  spatial frequencies (line pairs per mm)
/// @param wavelength_weights  weights of the wavelengths of the image; empty: equal weights
/// @throws Error              if the number of weights differs from the number of wavelengths
///
/// Accuracy: 5e-3 for a perfect lens with the default width, above frequency 0 (tests/analysis/diffraction_test.cpp).
PETZVAL_API std::vector<MtfPoint> diffraction_mtf(const DiffractionPsf& psf, std::span<const double> frequencies_per_mm,
                                                  std::span<const double> wavelength_weights = {});

/// MTF with diffraction of several fields, through focus: [field][shift, then frequency], by autocorrelation of the
/// pupil.
///
/// The pupil is a function of the directions behind the lens, with the amplitudes of diffraction_psf(). Lines across
/// the vignetted pupil are doubled from 16 up to 256 until their error is below 5e-4. No blur is too large, but fields
/// whose blur is far wider than a line pair may keep a larger error.
///
/// @param lens                the focused lens
/// @param subject_z           subject plane (lens frame, mm); -inf at infinity
/// @param fields_rad          field angles (rad)
/// @param frequencies_per_mm  spatial frequencies (line pairs per mm)
/// @param wavelength_weights  weights of the compiled wavelengths; empty: equal weights
/// @param threads             at least 1; the result is the same for every number
/// @param film_shifts_mm      shifts of the film towards +z (mm)
/// @return  `sampling_error` is a bound of the error
/// @throws Error  if the lens is afocal, or the rays behind it are parallel in a section; if a frequency or a shift is
///                not finite or the number of weights differs; under the conditions of aim()
///
/// Accuracy: `sampling_error` (5e-4 to 1e-3 for most lenses), against closed forms of round and annular pupils and
/// against sums over a grid of rays of a Cooke triplet, a double Gauss and a Tessar
/// (tests/analysis/diffraction_mtf_test.cpp).
PETZVAL_API Grid<MtfPoint> diffraction_mtf(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                           std::span<const double> frequencies_per_mm,
                                           std::span<const double> wavelength_weights = {}, int threads = 1,
                                           std::span<const double> film_shifts_mm = std::array{0.0});

}  // namespace petzval
