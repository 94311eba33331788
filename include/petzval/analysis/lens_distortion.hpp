// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/camera/camera.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// The pinhole camera that a lens is compared with: its pinhole stands in the entrance pupil, its film is upright, and
/// its picture has the scale of the lens's picture on the axis.
struct Pinhole {
  /// Across and up the picture: distance of the pinhole from its film. Both are the same except for anamorphic lenses,
  /// whose picture stays squeezed, and tilted films.
  Vec2<double> focal_length_mm{0, 0};
  /// Of projection, where the axis meets the picture: mm to the right of its middle, and down. 0 unless the film is
  /// shifted.
  Vec2<double> centre_mm{0, 0};
  double z_mm = 0;          ///< of the pinhole: the paraxial entrance pupil, lens frame
  double subject_z_mm = 0;  ///< plane of the scene in which both pictures are compared, lens frame; -inf at infinity
};

struct DistortionOptions {
  /// Pinhole::subject_z_mm; unset: the plane in focus. Near subjects are distorted otherwise, because the pupil moves
  /// with the field.
  std::optional<double> subject_z_mm = {};
};

/// Where points of a pinhole's picture lie in the picture of a camera, and back.
///
/// Places of both pictures are raster positions of the camera's film (Film::raster): (0, 0) is the upper left corner,
/// (columns, rows) the lower right one, and both pictures agree on the axis. The pinhole's picture goes on beyond those
/// edges: that of a lens with barrel distortion shows more than the pinhole does between them.
///
///     const Camera camera(lens, film, {.model = ModelKind::exact_double});
///     const LensDistortion distortion(camera);
///     const auto shown = distortion.distorted({0.5, 0.5});  // where the pinhole's first pixel is in the picture
///
/// The lens's picture is that of chief rays at the primary wavelength as Camera::project() has them; of a film that
/// travels, as the shutter opens. Cheap to copy, shared freely between threads.
class PETZVAL_API LensDistortion {
 public:
  /// Throws Error for a lens without entrance pupil or with one at infinity, a subject that is not in front of it, and
  /// a camera whose axis shows nothing or whose picture is upside down.
  explicit LensDistortion(const Camera& camera, const DistortionOptions& options = {});

  const Camera& camera() const noexcept { return camera_; }
  const Pinhole& pinhole() const noexcept { return pinhole_; }
  /// Where the axis meets both pictures.
  const Vec2<double>& centre() const noexcept { return centre_; }
  /// Focal length of the pinhole in pixels.
  const Vec2<double>& focal_length_px() const noexcept { return focal_length_px_; }

  /// Where the camera shows what the pinhole shows at a place. Nothing where no chief ray comes from there to the film
  /// or near it. Apertures are ignored: the place may be dark.
  std::optional<Vec2<double>> distorted(const Vec2<double>& undistorted) const noexcept;

  /// The inverse, by Broyden's iteration on distorted(), within 1e-6 pixels by ModelKind::exact_double and 0.005 by
  /// models in float. Nothing where the film sees no light or no chief ray arrives, for places beside the film and its
  /// margin, and for fields of more than 89 degrees, which a pinhole does not see.
  std::optional<Vec2<double>> undistorted(const Vec2<double>& distorted) const noexcept;

  /// The widest field that any of 17 x 17 places of the film sees, from edge to edge; 0 where all are dark.
  double widest_field_rad() const noexcept;

 private:
  /// Where the pinhole shows a point of the scene.
  Vec2<double> shown_at(const Vec3<double>& point) const noexcept;
  /// A sample of a film point whose ray is not lost. Nothing for a dark point.
  std::optional<CameraSample> sample_with_light(const FilmPoint& film) const noexcept;

  Camera camera_;
  Pinhole pinhole_;
  double distance_ = 0;  ///< from the pinhole to the subject
  Vec2<double> centre_{0, 0}, focal_length_px_{1, 1};
};

/// The part of the pinhole's picture that shows what the film sees: raster positions, found at 65 x 65 places of the
/// film. Nothing for a dark film.
struct RasterBox {
  Vec2<double> least{0, 0}, largest{0, 0};
};
PETZVAL_API std::optional<RasterBox> undistorted_box(const LensDistortion& distortion);

/// How many times as large as the film that of the pinhole has to be, about the centre of projection, to show all that
/// the film sees, at least 1. Throws Error for a dark film, and for one that is shifted until its picture does not hold
/// the centre.
PETZVAL_API double overscan(const LensDistortion& distortion);

}  // namespace petzval
