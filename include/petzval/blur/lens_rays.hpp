// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "petzval/blur/layer_camera.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris_weights.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

class Camera;

/// A place in the pupil by two numbers from 0 to 1, as CameraSample has them: u around the middle, v the share of the
/// area that lies nearer to it.
struct PupilPoint {
  double u = 0, v = 0;
};

/// Points of a spiral that cover a pupil evenly (Vogel 1979). turn: by which part of a full turn the spiral is rotated.
/// Throws Error for fewer than 1 point or more than 2^20, and for a turn that is not finite.
PETZVAL_API std::vector<PupilPoint> vogel_points(int count, double turn = 0);

/// Points of `sets` spirals of `count` points, one after the other, for LensRaysOptions::sets. Each covers a pupil
/// evenly, and all together cover it nearly as evenly as one spiral of as many points.
///
/// @throws Error if there is not 1 set or more, or the points are not 1 to 2^20
///
/// Accuracy: the share of points on one side of a line, for 4 x 64 and 16 x 100 points: RMS error 0.0057 and 0.0013 of
/// all sets, 0.0124 and 0.0088 of one, against 0.0044 and 0.0011 of one spiral of 256 and 1600
/// (tests/blur/lens_rays_test.cpp).
PETZVAL_API std::vector<PupilPoint> vogel_sets(int count, int sets);

/// A ray of a lens in the scene as a line over inverse depth w: it passes the raster position at + slope w of the
/// picture. Source: (x / z, y / z, 1 / z) is a collineation.
struct LayerRay {
  Vec2<double> at{0, 0};     ///< px: where it runs to at infinity
  Vec2<double> slope{0, 0};  ///< px mm: focal_px times where it crosses the plane of the pinhole (rows run down)
  double weight = 1;         ///< against the other rays of all places
};

/// What a thin lens has in focus at a place of the picture.
struct FocusAt {
  double inverse_depth = 0;  ///< 1/mm; 0: infinity
  double pupil_scale = 1;    ///< the radius of its pupil there, over that of the lens
};

struct ThinLens {
  double radius_mm = 9;      ///< of the pupil, by the corners of the iris
  double inverse_focus = 0;  ///< 1 / depth in focus, 1/mm
  Iris iris{};
  EdgeWeight edge{};
  IrisMap map{};  ///< empty: none
  /// In place of inverse_focus, as of tilted films and focal surfaces; raster positions of the picture.
  std::function<FocusAt(const Vec2<double>& raster)> focus{};
  /// Of red, green and blue: added to the inverse depth in focus, 1/mm; all 0: one set of rays for all.
  Vec3<double> colour_shift{0, 0, 0};
};

struct LensRaysOptions {
  /// Depth of the nearest surface; 0: the focal length of the layer camera, for a picture 24 mm high.
  double nearest_mm = 0;
  /// Number of sets of rays in the points, one after the other (vogel_sets); pixels take them in turn, 4 in squares of
  /// 2 x 2, 16 of 4 x 4. More than 1 trade repeated patterns for grain; the mean over a square has the rays of all
  /// sets.
  int sets = 1;
  int threads = 1;
};

/// The rays of a lens through the layers, for all pixels of a picture: a line for each point of the pupil, smooth over
/// the picture. All that the blur knows of a lens.
///
/// Rays are kept at nodes in steps of up to 256 px and interpolated between. The step is the largest at which, halfway
/// between nodes, the lines of a place are right within 0.1 px (RMS) at the depth where they are nearest to each other,
/// and their light within 0.6 %; or the least step, 16 px, and error_px() says what is left of the lines. In pictures
/// below 512 px it is a 16th to a 32nd of the longer side, 2 px or more; pictures of a few pixels come out darker. At
/// other depths a ray may be off by more, within the blur. Nodes whose places get no light lead on the lines of those
/// beside them.
///
///     const LensRays rays = LensRays::of(camera, layer_camera(camera), vogel_points(100));
///
/// Immutable, cheap to copy, shared freely between threads.
class PETZVAL_API LensRays {
 public:
  /// Copies. Moves copy too, so that no LensRays is ever empty.
  LensRays(const LensRays&) = default;
  LensRays& operator=(const LensRays&) = default;

  /// The rays of a raster position. channel: 0; of rays with colours 0 to 2. found: one for each point.
  using Source = std::function<void(int channel, const Vec2<double>& raster, std::span<const PupilPoint> points,
                                    std::span<LayerRay> found)>;

  /// Any rays: those of a lens of your own. channels: 1, or 3 where colours differ. Throws Error for an empty source,
  /// for no points, for points beyond the pupil or that are not sets of one size, for rays whose numbers exceed 1e15,
  /// and for negative weights.
  LensRays(const LayerCamera& camera, std::span<const PupilPoint> points, int channels, Source source,
           const LensRaysOptions& options = {});

  /// A thin lens: even light over the picture and over the disc of a point, without the cos^4 of ModelKind::thin.
  /// Throws Error also for a radius that is negative, a depth in focus that is negative or within the diameter of the
  /// lens, and for an iris and weights out of range.
  static LensRays thin(const LayerCamera& camera, const ThinLens& lens, std::span<const PupilPoint> points,
                       const LensRaysOptions& options = {});

  /// The rays of a Camera: any model, blades, weights, cat's eyes, tilted films, focal surfaces, expressive lenses.
  /// wavelengths: one, or those of red, green and blue. Pupils of all film points get all points, so that no ray is
  /// lost; the light is the camera's, of its Normalisation. Throws Error for a film that travels.
  static LensRays of(const Camera& camera, const LayerCamera& layers, std::span<const PupilPoint> points,
                     std::span<const Wavelength> wavelengths = {}, const LensRaysOptions& options = {});

  const LayerCamera& camera() const noexcept;
  int channels() const noexcept;
  int sets() const noexcept;
  /// Of each pixel and channel.
  std::size_t count() const noexcept;
  /// True if all pixels of a set have the same rays, shifted with the pixel: the fastest kind.
  bool shift_invariant() const noexcept;
  /// How far interpolated lines were from the source's, as above.
  double error_px() const noexcept;
  double nearest_mm() const noexcept;
  /// The largest |slope| along columns or rows, px mm.
  double largest_slope() const noexcept;
  /// How far rays reach beyond the picture between these inverse depths, px.
  double reach_px(double least_inverse_depth, double most_inverse_depth) const noexcept;
  /// The interpolated rays of a pixel's centre. rays: count().
  void at(int channel, int column, int row, std::span<LayerRay> rays) const;
  /// The source's.
  void exact_at(int channel, int column, int row, std::span<LayerRay> rays) const;

 private:
  friend class RayAccess;
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace petzval
