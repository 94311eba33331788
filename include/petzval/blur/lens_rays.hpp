// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

class Camera;

/// A point of the pupil in the coordinates of CameraSample.
struct PupilPoint {
  double u = 0, v = 0;  ///< angle around the middle in turns, and fraction of the area nearer to the middle; 0 to 1
};

/// Points of a spiral that cover a pupil uniformly (Vogel 1979).
///
/// @param count  number of points, 1 to 2^20
/// @param turn   rotation of the spiral as a fraction of a full turn
/// @throws Error if `count` is out of range or `turn` is not finite
PETZVAL_API std::vector<PupilPoint> vogel_points(int count, double turn = 0);

/// Points of several spirals, one after the other, for LensRaysOptions::set_count.
///
/// Each spiral covers a pupil uniformly. All spirals together are nearly as uniform as a single spiral with the same
/// total number of points.
///
/// @param count  points per spiral
/// @param sets   number of spirals
/// @throws Error if `count` or `sets` is less than 1 or there are more than 2^20 points in all
///
/// Accuracy: RMS error of the fraction of points on one side of a line, for 4 x 64 and 16 x 100 points: all sets
/// 0.0057 and 0.0013, one set 0.0124 and 0.0088, a single spiral of 256 and 1600 points 0.0044 and 0.0011
/// (tests/blur/lens_rays_test.cpp).
PETZVAL_API std::vector<PupilPoint> vogel_sets(int count, int sets);

/// A ray of a lens in the scene, as a line over inverse depth w: the raster position at w is position + slope w.
///
/// Source: (x / z, y / z, 1 / z) is a collineation.
struct LayerRay {
  Vec2<double> position{0, 0};  ///< raster position at infinity, px
  Vec2<double> slope{0, 0};     ///< px mm: focal_px times the position in the plane of the pinhole (rows run down)
  double weight = 1;            ///< relative to the rays of all pixels
};

/// Local focus of a thin lens at a raster position.
struct FocusAt {
  double inverse_depth = 0;  ///< 1/mm; 0: infinity
  double pupil_scale = 1;    ///< local pupil radius divided by the radius of the lens
};

/// A thin lens for LensRays::thin().
struct ThinLens {
  double radius_mm = 9;      ///< radius of the pupil, to the corners of the iris
  double inverse_focus = 0;  ///< 1 / depth in focus, 1/mm
  Iris iris{};
  EdgeWeight edge{};
  IrisMap map{};  ///< empty: uniform
  /// Replaces inverse_focus, for example for tilted films and focal surfaces.
  std::function<FocusAt(const Vec2<double>& raster)> focus{};
  /// Added to the inverse depth in focus of red, green and blue, 1/mm. If all are 0, the channels share their rays.
  Vec3<double> colour_shift{0, 0, 0};
};

/// Thrown by a calculation whose std::stop_token requests a stop.
class PETZVAL_API Cancelled : public Error {
 public:
  /// @param where the calculation
  explicit Cancelled(const std::string& where) : Error(where + ": cancelled") {}
  ~Cancelled() override;
};

/// Options of LensRays.
struct LensRaysOptions {
  /// Depth of the nearest surface, mm; 0: the focal length of the layer camera for an image 24 mm high.
  double nearest_mm = 0;
  /// Number of ray sets in the points (vogel_sets): 1, 4 or 16. Each pixel of a square of 1 x 1, 2 x 2 or 4 x 4 takes a
  /// different set; the mean over the square has the rays of all sets. More sets replace repeated patterns by grain.
  int set_count = 1;
  /// Spreads the rays of a pixel over its area; false: they start at its centre. For layers with one sample per pixel:
  /// blurs smaller than a pixel become means over the pixel, and surfaces in focus are unchanged. The offsets are part
  /// of the rays of at(), not of exact_rays_at().
  bool over_pixels = false;
  int threads = 1;
  /// Cancels the construction from another thread: the constructor throws Cancelled. It tests the token before each
  /// call of the source.
  std::stop_token stop{};
};

/// The rays of a lens through the layers: one line per pupil point, for all pixels of an image.
///
/// Rays are stored at nodes up to 256 px apart and interpolated between the nodes. The node distance is reduced until
/// the tolerances below are met, at most to 16 px (images below 512 px: a 16th to a 32nd of the longer side, at least 2
/// px). Nodes without light continue the lines of adjacent nodes.
///
///     const LensRays rays = LensRays::of(camera, layer_camera(camera), vogel_points(100));
///
/// Accuracy: halfway between nodes 0.1 px RMS at the depth of sharpest focus, estimated with up to 16 rays, and 0.6 %
/// of the light. interpolation_error_px() returns the error that remains at the smallest node distance. At other depths
/// larger errors may occur within the blur.
///
/// Limitations: images of a few pixels are too dark.
///
/// Immutable, cheap to copy, thread-safe.
class PETZVAL_API LensRays {
 public:
  /// Moves are copies too, so that no LensRays is ever empty.
  LensRays(const LensRays&) = default;
  LensRays& operator=(const LensRays&) = default;

  /// Computes the rays of a raster position in a channel (0 to channels - 1): one ray in `found` per pupil point.
  using Source = std::function<void(int channel, const Vec2<double>& raster, std::span<const PupilPoint> points,
                                    std::span<LayerRay> found)>;

  /// Tabulates the rays of a custom lens.
  ///
  /// @param camera    the layer camera
  /// @param points    pupil points, `options.set_count` sets of equal size
  /// @param channels  1, or 3 if red, green and blue have different rays
  /// @param source    computes the rays
  /// @param options   nearest depth, sets and threads
  /// @throws Error    if the source or the points are empty, points are not 0 to 1, the sets differ in size, a
  ///                  parameter is out of range, a ray coordinate exceeds 1e15, or a weight is negative
  /// @throws Cancelled if `options.stop` requests a stop before the table is complete
  LensRays(const LayerCamera& camera, std::span<const PupilPoint> points, int channels, Source source,
           const LensRaysOptions& options = {});

  /// The rays of a thin lens with uniform irradiance over the image: without the cos^4 law of ModelKind::thin.
  ///
  /// @throws Error as the constructor; also if the radius or inverse_focus is negative, if the depth in focus does not
  ///               exceed the diameter of the pupil, or if the iris or its weights are out of range
  static LensRays thin(const LayerCamera& camera, const ThinLens& lens, std::span<const PupilPoint> points,
                       const LensRaysOptions& options = {});

  /// The rays of a Camera of any model, with blades, weights, vignetting, tilted films and focal surfaces.
  ///
  /// The pupil of each film point receives all pupil points, so that no ray is lost. The weights follow the
  /// Normalisation of the camera.
  ///
  /// @param camera       the lens camera; its film must not travel
  /// @param layers       the layer camera, with as many pixels as the film, or a whole multiple in both directions
  /// @param points       pupil points, `options.set_count` sets of equal size
  /// @param wavelengths  one wavelength, or the wavelengths of red, green and blue; empty: the primary wavelength
  /// @param options      nearest depth, sets and threads
  /// @throws Error       as the constructor; also if the film travels, the numbers of pixels do not fit or the camera
  ///                     does not cover a wavelength
  ///
  /// Accuracy: for exact models the light is measured at 49 positions along the longer side and interpolated. At 800 x
  /// 600 it is within 0.5 % of the brightest pixel of 8192 samples per pixel for 55 lenses of data/, and 2 % for the
  /// phone and anamorphic lenses, whose light ends steeply (ball lens: 20 %).
  static LensRays of(const Camera& camera, const LayerCamera& layers, std::span<const PupilPoint> points,
                     std::span<const Wavelength> wavelengths = {}, const LensRaysOptions& options = {});

  const LayerCamera& camera() const noexcept;
  int channels() const noexcept;
  int set_count() const noexcept;
  /// Number of rays per pixel and channel.
  std::size_t count() const noexcept;
  /// True if all pixels of a set have the same rays, shifted with the pixel: the fastest case for gather().
  bool shift_invariant() const noexcept;
  /// RMS interpolation error at the worst position, px, at the depth of sharpest focus.
  double interpolation_error_px() const noexcept;
  double nearest_mm() const noexcept;
  /// The largest |slope| along columns or rows, px mm.
  double largest_slope() const noexcept;
  /// Largest distance of rays beyond the image between these inverse depths (1/mm), px.
  double reach_px(double least_inverse_depth, double most_inverse_depth) const noexcept;
  /// Largest distance of a ray from its pixel, along columns or rows, between these inverse depths (1/mm), px.
  double offset_px(double least_inverse_depth, double most_inverse_depth) const noexcept;

  /// The interpolated rays at the centre of a pixel. Fills count() rays.
  void at(int channel, int column, int row, std::span<LayerRay> rays) const;
  /// The rays at the centre of a pixel, computed by the source.
  void exact_rays_at(int channel, int column, int row, std::span<LayerRay> rays) const;

 private:
  friend class RayAccess;
  struct Data;
  std::shared_ptr<const Data> data_;
};

/// Options of gather().
struct GatherOptions {
  int threads = 1;
  /// Surfaces brighter than this in any channel are spread over the image as discs of the lens's own shape, if the rays
  /// of a pixel would meet too few of them for a smooth blur. Up to 1.25 times this value, surfaces are spread in part.
  /// 0: no surfaces are spread.
  double highlights_above = 1;
  /// Cancels gather() from another thread, within the time of about two tiles of 64 x 16 pixels: gather() throws
  /// Cancelled, and the picture is empty.
  std::stop_token stop{};
  /// The region to compute, px; all 0: the whole image. The picture holds the pixels of the region, with the bits of
  /// the whole image. Tiles of 64 x 16 pixels, in the grid of the image, are computed completely.
  int left = 0, top = 0, columns = 0, rows = 0;
  /// Called after each tile with the fraction done, by the thread that called gather(). Returns false to cancel.
  std::function<bool(double)> progress{};
};

/// The result of gather(). It can be refilled if its size does not grow, without allocation on one thread unless the
/// layers have highlights. It also keeps the highlights of the last layers, so that the regions of an image are faster.
///
/// Colours include the vignetting of the lens. `missed` and alpha are relative to the light that the lens passes at the
/// pixel: a surface that fills a dark corner has alpha 1.
struct BlurredImage {
  int columns = 0, rows = 0;  ///< size of the region
  std::vector<float> rgba;    ///< columns x rows x 4, linear, premultiplied by alpha
  std::vector<float> missed;  ///< columns x rows: fraction of rays, by weight, that met regions unknown to the layers
  std::uint64_t ray_count = 0;
  std::uint64_t missed_count = 0;  ///< rays that met a region unknown to the layers
  std::uint64_t step_count = 0;    ///< summed over SIMD lanes
  std::uint64_t highlight_count = 0;
  double gather_seconds = 0, highlight_seconds = 0;

  /// Working memory of gather().
  struct Memory;
  std::shared_ptr<Memory> memory;
};

/// Renders the image of layers through a lens.
///
/// Each ray is followed from near to far, pixel by pixel along its main direction, until it meets a surface at the
/// depth of the ray in that pixel. Surfaces with alpha below 1 transmit the remainder. A ray that meets no surface is
/// transparent if the first layer is empty where it ends, at the depth of the farthest surface. Otherwise it has
/// slipped behind a surface: it counts as missed and takes the colour of the last surface that it passed or, failing
/// that, the mean of the other rays of its pixel. The result is bit-identical for any number of threads.
///
/// @param layers   the scene; they extend beyond the image equally on all sides (PeelPlan::camera). Their border pixels
///                 are repeated outwards
/// @param rays     the lens
/// @param options  threads, highlights, region, progress and cancelling
/// @param picture  the result; left empty if an error occurs while it is filled
/// @throws Error   if the layers do not fit the image, options are out of range, rays reach more than 16384 pixels
///                 beyond the image, or the rays of a tile need more than 256 MiB of layers beyond their edges
/// @throws Cancelled  if `options.stop` requests a stop, or `options.progress` returns false, before the picture is
///                    complete
///
/// Source: Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control", section 3.1.
PETZVAL_API void gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                        BlurredImage& picture);
PETZVAL_API BlurredImage gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options = {});

}  // namespace petzval
