// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

class Camera;

/// The pinhole camera with which layers are rendered, in the middle of the entrance pupil and along the lens axis.
///
/// Camera space: x to the right, y up, depth along the axis, in mm from the pinhole. A scene point appears at the
/// raster position axis + focal_px (x, -y) / depth; (0, 0) is the upper left corner of the image. A straight ray in the
/// scene, of any lens, is therefore a straight line in raster position and inverse depth.
struct PETZVAL_API LayerCamera {
  int columns = 0, rows = 0;  ///< size of the image, pixels
  double focal_px = 0;        ///< (rows / 2) / tan(half the vertical angle)
  Vec2<double> axis{0, 0};    ///< raster position of the axis, usually the middle of the image
  int overscan = 0;           ///< pixels by which layers extend beyond the image on each side

  int layer_columns() const noexcept { return columns + 2 * overscan; }
  int layer_rows() const noexcept { return rows + 2 * overscan; }
  /// Raster position in the image of a point (camera space, mm) in front of the pinhole.
  Vec2<double> raster(const Vec3<double>& point) const noexcept {
    return axis + Vec2<double>{point.x, -point.y} * (focal_px / point.z);
  }
};

/// A layer camera with its axis in the middle of the image.
///
/// @throws Error unless columns and rows are 1 to 32768 and the angle is in (0, 120 degrees]; a flat image cannot show
///               the field of a fisheye
PETZVAL_API LayerCamera layer_camera(int columns, int rows, double vertical_angle_rad);

/// The layer camera for the blur of a lens camera, with the pinhole at layer_origin_z(camera).
///
/// Raster positions equal raster positions on the film, except for the distortion of the lens.
///
/// @throws Error if columns or rows of the film are not 1 to 32768, the entrance pupil is at infinity, or a ray of the
///               film is more than 60 degrees from the axis
PETZVAL_API LayerCamera layer_camera(const Camera& camera);

/// z of the pinhole of layer_camera(camera): the middle of the entrance pupil (lens frame, mm).
///
/// @throws Error if the entrance pupil is at infinity
PETZVAL_API double layer_origin_z(const Camera& camera);

class LensRays;

/// The parameters for peeling a scene into layers without holes for any ray of a lens.
struct PeelPlan {
  LayerCamera camera{};    ///< with the overscan that the rays need
  double bias = 0;         ///< 1/mm: surfaces behind another by less, in inverse depth, are hidden from all rays
  int most_layers = 1;     ///< upper bound for any scene
  double nearest_mm = 0;   ///< depth of the nearest surface
  double farthest_mm = 0;  ///< depth of the farthest surface, or infinity
};

/// Plans extended-umbra peeling for the rays of a lens.
///
/// A pixel, extended to the centres of its neighbours, hides all surfaces behind it from the rays of the lens up to a
/// constant offset in inverse depth: the bias, 1 / LensRays::largest_slope(). The next layer holds the nearest surfaces
/// beyond the bias. In the fragment shader of a rasteriser with reverse depth buffers (near x inverse depth, cleared to
/// 0):
///
///     if (layer > 0 && (previous <= 0 ||
///         depth >= previous - near * bias)) discard;
///
/// and with depth = a - b x inverse depth, b = far near / (far - near):
///
///     if (layer > 0 && depth <= previous + b * bias)
///       discard;
///
/// @param rays         the rays of the lens
/// @param nearest_mm   depth of the nearest surface
/// @param farthest_mm  depth of the farthest surface; may be infinite
/// @throws Error       unless 0 < nearest < farthest, and if rays reach more than 16384 pixels beyond the image
///
/// Source: Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control", section 3.1. Their offset x = d
/// s / (E - s) equals the bias: s grows with d, and 1 / d - 1 / (d + x) = s / (d E) is the same for all d.
PETZVAL_API PeelPlan plan_peel(const LensRays& rays, double nearest_mm, double farthest_mm);

/// The output planes of one layer, columns x rows values each, row by row from the top.
struct LayerPlanes {
  std::span<float> inverse_depth;            ///< 1/mm; 0: infinity; negative or NaN: empty
  std::span<float> red, green, blue, alpha;  ///< linear, unlimited, premultiplied by alpha
};

/// A deep image: a list of surface fragments for each pixel.
///
/// Pixel p has fragments[offsets[p]] to fragments[offsets[p + 1] - 1], in any order.
struct FragmentLists {
  /// One surface or volume seen in a pixel.
  struct Fragment {
    float depth_mm = 0;                             ///< along the axis; infinity for the sky
    float red = 0, green = 0, blue = 0, alpha = 1;  ///< premultiplied by alpha
    /// Depth at which a uniform volume ends. Not beyond depth_mm, infinite, or an alpha of 1: a surface at depth_mm.
    float back_mm = 0;
  };
  int columns = 0, rows = 0;
  std::vector<std::size_t> offsets;  ///< columns x rows + 1
  std::vector<Fragment> fragments;
};

/// Refuses a deep image that LayerSet::peel_fragments() refuses.
///
/// @param where    name of the image, with which messages begin
/// @param colours  false: the image is a holdout, whose colours are not used
/// @throws Error   if the lists are inconsistent; with column and row, if an alpha is outside 0 to 1 or a colour is NaN
PETZVAL_API void check_fragments(const FragmentLists& lists, const std::string& where, bool colours = true);

/// The samples of a deep image behind a holdout of the same size, as a pinhole sees the image. Composited, they give
/// the picture of `lists` without the light and the alpha that the holdout hides.
///
/// @throws Error as LayerSet::peel_fragments()
PETZVAL_API FragmentLists hold_out(const FragmentLists& lists, const FragmentLists& holdout);

/// Converts distances from the pinhole to depths along the axis, in place. Invalid depths and infinity are kept.
///
/// @throws Error if the number of pixels differs from the layers of the camera, overscan included
PETZVAL_API void axial_depths(const LayerCamera& camera, FragmentLists& lists);
PETZVAL_API void axial_depths(const LayerCamera& camera, std::span<float> depth_mm);

/// An image with depths: one layer of a scene, or a single RGB-D image.
struct LayerImage {
  int columns = 0, rows = 0;
  std::span<const float> rgba;      ///< columns x rows x 4, linear, premultiplied by alpha
  std::span<const float> depth_mm;  ///< columns x rows; infinity: the sky; 0, negative or NaN: empty
};

/// The surfaces seen by a layer camera: for each pixel, a list from near to far.
///
/// If a pixel is empty in one layer, it is empty in all layers behind. Colours are linear and unlimited. A set can be
/// refilled without allocation if its size and number of layers do not grow. If filling throws, the set has no layers.
/// A moved-from set can only be assigned to or destroyed.
class PETZVAL_API LayerSet {
 public:
  LayerSet();
  LayerSet(LayerSet&&) noexcept;
  LayerSet& operator=(LayerSet&&) noexcept;
  ~LayerSet();

  /// Renders one layer and returns the number of pixels written.
  ///
  /// Each pixel of `out` receives the nearest surface with an inverse depth less than `below` (1/mm): infinity in the
  /// first layer, negative if the pixel needs no surface. `out` is initially empty and black with alpha 1.
  using Peel = std::function<std::size_t(int layer, std::span<const float> below, const LayerPlanes& out)>;
  /// Fills the set by rendering layers until no pixel is written.
  ///
  /// @param plan    camera and bias
  /// @param layers  largest number of layers, 1 to 64
  /// @param peel    renders a layer
  /// @throws Error  if `layers` is out of range, `peel` is empty, a surface is not less than `below`, or an alpha is
  ///                outside 0 to 1
  void peel(const PeelPlan& plan, int layers, const Peel& peel);

  /// Fills the set with the layers that peel() would find in fragment lists.
  ///
  /// Fragments within the bias of the layer in front are dropped. If that layer has alpha below 1, they are composited
  /// with it instead. Volumes become slices that are at least as long as the bias, in inverse depth, and less than
  /// twice as long: the blur of a point changes by less than two pixels from the front to the back of a slice. If a
  /// pixel has more surfaces than layers, the distance over which translucent surfaces are composited is doubled until
  /// they fit, so that no light is lost. Fragments at equal depths are mixed.
  ///
  /// @param lists    fragments of each pixel, in any order; without a depth above 0 they are ignored
  /// @param bias     as in PeelPlan (1/mm)
  /// @param layers   largest number of layers, 1 to 64; fragments behind an opaque last layer are dropped
  /// @param holdout  an image of the same size that hides `lists` where it is in front, along each ray of the lens, but
  ///                 adds no colour or alpha; 0 x 0 pixels: none. Its colours are not used. Doubles the time of
  ///                 gather()
  /// @throws Error   if `layers` is out of range, the lists are inconsistent or differ in size, the bias is negative,
  ///                 an alpha is outside 0 to 1, or a colour is NaN
  ///
  /// Accuracy: without highlights, the picture of A held out by B and the picture of B held out by A add up to the
  /// picture of all their fragments, within 1e-4 of colours up to 1 and of alpha (tests/blur/holdout_test.cpp). With
  /// highlights, the same holds if the same surfaces are spread in all three pictures.
  void peel_fragments(const FragmentLists& lists, double bias, int layers, const FragmentLists& holdout = {});

  /// Fills the set with images from near to far, 1 to 64.
  ///
  /// @throws Error if there is no image, sizes differ, pixels are missing, a surface is nearer than the surface in
  ///               front of it or behind an empty pixel, or an alpha is outside 0 to 1
  void set(std::span<const LayerImage> images);

  int columns() const noexcept;
  int rows() const noexcept;
  /// Number of layers that have a surface.
  int count() const noexcept;
  /// Inverse depths of a layer, columns x rows values; negative if empty.
  std::span<const float> inverse_depth(int layer) const noexcept;
  /// Red, green, blue and alpha of a pixel of a layer. Colours are stored with 13 significant bits. A holdout is black.
  std::array<float, 4> rgba(int layer, std::size_t pixel) const noexcept;
  /// True if all surfaces have alpha 1.
  bool opaque() const noexcept;
  /// Memory of the layers and of the depth bounds of rays, bytes.
  std::size_t memory_bytes() const noexcept;
  /// Time that the last fill took to build the depth bounds of rays.
  double n_buffer_seconds() const noexcept;
  /// The layers as fragment lists, for files; a holdout is black.
  FragmentLists fragments() const;

 private:
  friend class LayerAccess;
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace petzval
