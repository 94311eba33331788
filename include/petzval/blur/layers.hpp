// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "petzval/blur/layer_camera.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/fragment_lists.hpp"

namespace petzval {

class LensRays;

/// What a peeled picture of the scene wants so that no ray of a lens finds a hole.
struct PeelPlan {
  LayerCamera camera{};    ///< with the overscan that the rays need
  double bias = 0;         ///< 1/mm: a surface farther than the last one by less, in inverse depth, no ray can reach
  int most_layers = 1;     ///< that any scene gives
  double nearest_mm = 0;   ///< depth of the nearest surface
  double farthest_mm = 0;  ///< of the farthest one, or infinity
};

/// Extended-umbra peeling: a pixel, taken as reaching to the centres of its neighbours, hides from all rays of the
/// lens what lies behind it by less than a constant offset in inverse depth, 1 px / max |B| (LensRays).
///
/// For reverse depth buffers (near x inverse depth, cleared to 0), in a rasteriser's fragment shader:
///
///     if (layer > 0 && (previous <= 0 ||
///         depth >= previous - near * bias)) discard;
///
/// and for depth = a - b x inverse depth, b = far near / (far - near):
///
///     if (layer > 0 && depth <= previous + b * bias)
///       discard;
///
/// Source: Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control", section 3.1. Their x = d s /
/// (E - s) is this offset: s grows with d, and 1 / d - 1 / (d + x) = s / (d E) is the same for all d.
///
/// Throws Error for depths that are not 0 < nearest < farthest <= infinity, and for rays that reach farther than 16384
/// pixels beyond the picture.
PETZVAL_API PeelPlan plan_peel(const LensRays& rays, double nearest_mm, double farthest_mm);

/// One layer to be written: planes of columns x rows values each, row by row from the top.
struct LayerPlanes {
  std::span<float> inverse_depth;            ///< 1/mm; 0: infinity; below 0 or not a number: empty
  std::span<float> red, green, blue, alpha;  ///< linear, of any brightness, multiplied with alpha
};

/// Turns distances from the pinhole into depths along the axis, in place; infinity and what is no depth stay. camera:
/// whose layers these are, overscan included. Throws Error for numbers of another size than its layers.
PETZVAL_API void axial_depths(const LayerCamera& camera, FragmentLists& lists);
PETZVAL_API void axial_depths(const LayerCamera& camera, std::span<float> depth_mm);

/// A picture with depths: the surfaces of one layer, or all that a single picture knows.
struct LayerImage {
  int columns = 0, rows = 0;
  std::span<const float> rgba;      ///< columns x rows x 4, linear, multiplied with alpha
  std::span<const float> depth_mm;  ///< columns x rows; infinity: the sky; 0, below, or not a number: empty
};

/// What the layer camera sees: for each pixel, surfaces from near to far.
///
/// A pixel without a surface in one layer has none in those behind it. Colours are linear and unlimited. Refilled
/// without allocation if its size and number of layers do not grow. A filling that throws on its way leaves no layer.
/// One that was moved from may be assigned to or destroyed, nothing else.
class PETZVAL_API LayerSet {
 public:
  LayerSet();
  LayerSet(LayerSet&&) noexcept;
  LayerSet& operator=(LayerSet&&) noexcept;
  ~LayerSet();

  /// Renders a layer: what is seen at each pixel of all surfaces whose inverse depth is below `below` there, infinity
  /// for the first layer; -1 or less: no surface is wanted. out: empty and black with alpha 1 before. Returns how many
  /// pixels were written.
  using Peel = std::function<std::size_t(int layer, std::span<const float> below, const LayerPlanes& out)>;
  /// Layers until nothing is written, at most `layers`. Throws Error for less than one layer or more than 64, for an
  /// empty `peel`, for a surface that is not below `below`, and for alphas outside 0 to 1.
  void peel(const PeelPlan& plan, int layers, const Peel& peel);

  /// The layers that peel() would find in lists. Fragments nearer to the last one than the bias are left out, but those
  /// behind one with alpha below 1 are composed with it, so that light is kept. layers: as in peel(); what lies behind
  /// is left out. Throws Error for lists whose numbers do not fit, and for alphas outside 0 to 1.
  void thin(const FragmentLists& lists, double bias, int layers);

  /// Pictures from near to far, one alone included. Throws Error for none, for pictures of different sizes or without
  /// all their numbers, for a surface nearer than one before it or behind an empty pixel, and for alphas outside 0
  /// to 1.
  void set(std::span<const LayerImage> images);

  int columns() const noexcept;
  int rows() const noexcept;
  /// Layers that have a surface.
  int count() const noexcept;
  /// A layer, columns x rows values each: inverse depth, below 0 where empty, and colours.
  std::span<const float> inverse_depth(int layer) const noexcept;
  /// 0 to 3: red, green, blue, alpha.
  std::span<const float> channel(int layer, int channel) const noexcept;
  /// Whether all surfaces have alpha 1.
  bool opaque() const noexcept;
  /// Of the last filling: what bounding the ways of rays took.
  double n_buffer_seconds() const noexcept;
  /// Back to lists, for files.
  FragmentLists fragments() const;

 private:
  friend class LayerAccess;
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace petzval
