// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/camera/camera.hpp"
#include "petzval/core/export.hpp"
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

struct DistortionOptions {
  /// Pinhole::subject_z_mm; unset: the plane in focus. Distortion depends on the subject distance, because the pupil
  /// moves with the field.
  std::optional<double> subject_z_mm = {};
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
  /// @throws Error if the lens has no entrance pupil or a pupil at infinity, the subject is not in front of the pupil
  ///               and the lens, no subject is in focus, or the image is upside down or not visible on the axis
  explicit LensDistortion(const Camera& camera, const DistortionOptions& options = {});

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
  Vec2<double> shown_at(const Vec3<double>& point) const noexcept;
  /// A sample of a film point whose ray passes the lens; nullopt if the point is dark.
  std::optional<CameraSample> sample_with_light(const FilmPoint& film) const noexcept;

  Camera camera_;
  Pinhole pinhole_;
  double distance_ = 0;  ///< from the pinhole to the subject
  Vec2<double> centre_{0, 0}, focal_length_px_{1, 1};
};

/// A rectangle of raster positions.
struct RasterBox {
  Vec2<double> least{0, 0}, largest{0, 0};
};
/// Bounding box, in the pinhole image, of the scene region that the film sees; nullopt if the film is dark.
///
/// Sampled at 65 x 65 film points.
PETZVAL_API std::optional<RasterBox> undistorted_box(const LensDistortion& distortion);

/// Size of the pinhole film relative to the lens film, at which the pinhole shows everything that the lens film sees.
///
/// @return       scale about the centre of projection, at least 1
/// @throws Error if the film is dark, or so far shifted that the axis lies outside the image
PETZVAL_API double overscan(const LensDistortion& distortion);

}  // namespace petzval
