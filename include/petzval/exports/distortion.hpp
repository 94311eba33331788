// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// The pinhole camera to which a lens is compared.
///
/// The pinhole stands in the entrance pupil, its film is upright, and its image has the same scale on the axis as the
/// lens image.
struct Pinhole {
  /// Distance of the pinhole from its film, horizontal and vertical. The two are equal except for tilted films and for
  /// anamorphic lenses, whose image stays squeezed.
  Vec2<double> focal_length_mm{0, 0};
  /// Centre of projection, where the axis meets the image: mm to the right of the middle, and down. 0 unless the film
  /// is shifted.
  Vec2<double> centre_mm{0, 0};
  double z_mm = 0;          ///< position of the pinhole: the paraxial entrance pupil, lens frame
  double subject_z_mm = 0;  ///< scene plane in which both images are compared, lens frame; -inf at infinity
};

/// Maps image points of a pinhole camera to image points of a lens camera, and back.
///
/// Positions in both images are raster positions on the film of the camera (Film::raster): (0, 0) is the upper left
/// corner, (columns, rows) the lower right corner. The images coincide on the axis. The pinhole image extends beyond
/// these edges, because a lens with barrel distortion shows a larger field than a pinhole on the same film.
///
///     const Camera camera(lens, film, {.model = ModelKind::exact_double});
///     const LensDistortion distortion(camera);
///     const auto shown = distortion.distorted({0.5, 0.5});  // lens image position of the first pinhole pixel
///
/// The lens image is defined by chief rays at the primary wavelength, as in Camera::project(). If the film travels, its
/// position at shutter opening is used. Cheap to copy; thread-safe.
class PETZVAL_API LensDistortion {
 public:
  /// Sets up the pinhole that stands for a camera.
  ///
  /// @param camera        the lens camera
  /// @param subject_z_mm  Pinhole::subject_z_mm; unset: the plane in focus. Distortion depends on the subject distance,
  ///                      because the pupil moves with the field.
  /// @throws Error if the lens has no entrance pupil or a pupil at infinity, the subject is not in front of the pupil
  ///               and the lens, no subject is in focus, or the image is upside down or not visible on the axis
  explicit LensDistortion(const Camera& camera, std::optional<double> subject_z_mm = {});

  const Camera& camera() const noexcept { return camera_; }
  const Pinhole& pinhole() const noexcept { return pinhole_; }
  /// Raster position of the axis in both images.
  const Vec2<double>& centre() const noexcept { return centre_; }
  /// Focal length of the pinhole in pixels.
  const Vec2<double>& focal_length_px() const noexcept { return focal_length_px_; }

  /// Maps a position in the pinhole image to the lens image. Apertures are ignored: the result may be a dark point.
  ///
  /// @return raster position; nullopt if no chief ray from there reaches the film or its surroundings
  std::optional<Vec2<double>> distorted(const Vec2<double>& undistorted) const noexcept;

  /// Maps a position in the lens image to the pinhole image: the inverse of distorted(), by Broyden's method.
  ///
  /// @return raster position; nullopt if the point is dark, no chief ray reaches it, it lies outside the film and its
  ///         margin, or its field angle exceeds 89 degrees, the limit of a pinhole image
  ///
  /// Accuracy: within 1e-6 pixels for ModelKind::exact_double and 0.005 pixels for float models.
  std::optional<Vec2<double>> undistorted(const Vec2<double>& distorted) const noexcept;

  /// The largest field angle over a grid of 17 x 17 film points from edge to edge; 0 if all points are dark.
  double widest_field_rad() const noexcept;

 private:
  /// Raster position of a scene point in the pinhole image.
  Vec2<double> pinhole_raster_of(const Vec3<double>& point) const noexcept;
  /// A sample of a film point whose ray passes the lens; nullopt if the point is dark.
  std::optional<CameraSample> lit_sample(const FilmPoint& film) const noexcept;

  Camera camera_;
  Pinhole pinhole_;
  double distance_ = 0;  ///< from the pinhole to the subject
  Vec2<double> centre_{0, 0}, focal_length_px_{1, 1};
};

/// Size of the pinhole film relative to the lens film, at which the pinhole shows everything that the lens film sees.
///
/// @return       scale about the centre of projection, at least 1
/// @throws Error if the film is dark, or so far shifted that the axis lies outside the image
PETZVAL_API double overscan(const LensDistortion& distortion);

/// The direction in which a distortion model maps image positions.
enum class BrownConradyDirection : std::uint8_t {
  to_undistorted,  ///< from the lens image to the pinhole image: the default of OpenTrackIO if no model is named
  to_distorted,    ///< from the pinhole image to the lens image: OpenCV
};

/// "Brown-Conrady D-U" or "Brown-Conrady U-D", the names in OpenTrackIO and Unreal.
PETZVAL_API std::string_view name(BrownConradyDirection direction) noexcept;

/// Form of the radial distortion of BrownConrady.
enum class RadialForm : std::uint8_t {
  polynomial,  ///< k1 to k3; the others are 0
  rational,    ///< k1 to k6; unused denominator terms are 0
};

/// Radial distortion of a lens in the Brown-Conrady form, with the coefficient order of OpenCV and Unreal.
///
///     r' = r (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
///
/// r is the distance from the centre of projection divided by the focal length of the pinhole. The tangential terms p1
/// and p2 are 0, because only rotationally symmetric lenses on an upright film can be fitted.
struct PETZVAL_API BrownConrady {
  BrownConradyDirection direction = BrownConradyDirection::to_undistorted;
  std::array<double, 6> k{};  ///< k1 to k6
  Pinhole pinhole;
  double rms_px = 0;      ///< RMS error over a grid of 33 x 33 film points, dark film points left out
  double largest_px = 0;  ///< largest error on the same grid
  /// Largest pinhole field angle on that grid: the limit of the fitted range.
  double field_rad = 0;
  /// Pinhole field angle up to which r' increases with r. Beyond it the coefficients fold the image or have a pole.
  /// Searched up to 4 times the largest radius on the film.
  double rises_to_rad = 0;

  /// Maps a radius r to r'.
  double radius(double r) const noexcept;
};

/// Fits Brown-Conrady coefficients to a lens by least squares over the film.
///
/// The errors are measured in pixels of the target image; the scale on the axis is kept. Forms with 1 to 3 terms in the
/// numerator and 0 to 3 in the denominator are tried. The form with the least error whose r' increases up to 1.25 times
/// the largest radius on the film is preferred. If its RMS error is above 0.001 pixels and more than twice the error of
/// another form without a pole up to 1.1 times that radius, the other form is taken; rises_to_rad gives its range.
/// No term exceeds 100 at the largest radius.
///
/// @param distortion  the lens, camera and pinhole
/// @param direction   direction of the map
/// @param form        polynomial or rational
/// @return            the coefficients and their errors
/// @throws Error      if the lens has cylindrical surfaces or the film is tilted (distortion is not radial), if the
///                    film sees fields above 88 degrees (fisheyes exceed a pinhole image), or if the film is dark
///
/// st_maps() supports cylindrical surfaces, tilted films and fisheyes.
PETZVAL_API BrownConrady fit_brown_conrady(const LensDistortion& distortion,
                                           BrownConradyDirection direction = BrownConradyDirection::to_undistorted,
                                           RadialForm form = RadialForm::rational);

/// An ST map: for each pixel of an image, the position in another image from which it takes its value.
///
/// s runs from 0 at the left edge to 1 at the right edge, t from 0 at the bottom to 1 at the top, as in Nuke's STMap.
/// The centre of the first of n pixels is at 0.5 / n. In both maps 0 and 1 are the edges of the film image without its
/// margin; positions outside are below 0 or above 1. Pixels without a source position have s = t = -1.
struct PETZVAL_API StMap {
  int width = 0, height = 0;       ///< pixels, with the margin
  int margin_x = 0, margin_y = 0;  ///< pixels on either side of the film image
  std::vector<float> s{}, t{};     ///< width x height, rows from the top

  /// True if the pixel has a source position; false outside the map.
  bool has_source(int column, int row) const noexcept;
};

/// The two maps between a lens image and the image of its pinhole.
struct StMaps {
  StMap undistort;  ///< for pixels of the pinhole image and its margin: positions in the lens image
  StMap redistort;  ///< for pixels of the lens image: positions in the pinhole image
};

/// Computes ST maps for the pixels of a film: `undistort` warps a lens image to the pinhole image, `redistort` back.
///
/// The maps are computed at nodes at most 16 pixels apart and interpolated. Cells in which interpolation is not
/// accurate enough, mostly at the edge of the lit region, are computed pixel by pixel.
///
/// @param distortion  the lens, camera and pinhole
/// @param overscan    size of the pinhole image relative to the film image, 1 to 10; unset: the smallest size that
///                    contains everything the film sees, at most 2. The outer part of a fisheye image is cut off by
///                    this limit.
/// @param threads     at least 1; does not change the maps
/// @throws Error if the overscan is not 1 to 10, there is less than 1 thread, or the film is dark
///
/// Accuracy: within 0.001 pixels of LensDistortion, 0.02 near the edge of the lit region and 0.1 at fields beyond 70
/// degrees. With linear interpolation of the maps and exact or first-order models, one map after the other returns to
/// the start within 0.005 pixels (tests/exports/st_map_test.cpp).
PETZVAL_API StMaps st_maps(const LensDistortion& distortion, std::optional<double> overscan = {}, int threads = 1);

}  // namespace petzval
