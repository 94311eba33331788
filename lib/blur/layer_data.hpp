// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "n_buffer.hpp"
#include "packed_colour.hpp"
#include "petzval/blur/layers.hpp"

namespace petzval {
/// Planes of columns x rows numbers: inverse depth and two planes of PackedColour of each layer, and alpha unless all
/// surfaces have alpha 1. If there is a holdout, also two planes of a PackedColour of coverage, the part of alpha that
/// belongs to the picture, and of the rounding errors of red and green up to 1: a picture and its holdout share
/// surfaces, and their sum must not be rounded twice.
struct LayerSet::Data {
  /// Numbers before, between and after planes: lanes may read this far beyond the ends of a row.
  static constexpr std::size_t slack = 128;

  int columns = 0, rows = 0, count = 0;
  int planes = 3;    ///< 4: with alpha; 6: with alpha and coverage
  int capacity = 0;  ///< number of layers that the memory has room for
  bool opaque = true;
  double n_buffer_seconds = 0;
  std::uint64_t filling = 0;  ///< number of the last filling; no two sets have equal numbers
  std::vector<float> memory, below;
  std::vector<float> brightest;  ///< [layer][row] largest colour of the surfaces, at least 0
  blur_detail::NBuffer n_buffer;

  std::size_t pixels() const noexcept { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t plane_stride() const noexcept { return pixels() + slack; }
  float* plane(int layer, int plane) noexcept {
    return memory.data() + slack + static_cast<std::size_t>(layer * planes + plane) * plane_stride();
  }
  const float* plane(int layer, int p) const noexcept { return const_cast<Data*>(this)->plane(layer, p); }
  std::array<float, 3> colour(int layer, std::size_t pixel) const noexcept {
    return blur_detail::PackedColour{plane(layer, 1)[pixel], plane(layer, 2)[pixel]}.unpacked();
  }
  float alpha(int layer, std::size_t pixel) const noexcept { return planes > 3 ? plane(layer, 3)[pixel] : 1.0f; }
  bool held_out() const noexcept { return planes > 4; }
  float coverage(int layer, std::size_t pixel) const noexcept {
    return held_out() ? blur_detail::PackedColour{plane(layer, 4)[pixel], plane(layer, 5)[pixel]}.unpacked()[0]
                      : alpha(layer, pixel);
  }

  /// Grows the memory. The last layer has a plane for each colour and alpha until it is packed.
  void reserve(std::size_t stride) {
    const std::size_t count_of_planes = static_cast<std::size_t>(planes * (capacity - 1) + std::max(planes, 5));
    memory.resize(std::max(memory.size(), 2 * slack + count_of_planes * stride));
  }
  /// The depths of all layers.
  blur_detail::DepthRange depths() const noexcept { return n_buffer.below({0, 0, columns - 1, rows - 1}); }

  /// Adds a layer that is empty and black with alpha 1, with a plane for each colour. end_layer() packs and counts it.
  LayerPlanes begin_layer();
  /// Counts the layer of begin_layer() if it contains a surface.
  /// @param where prefix of messages
  void end_layer(const std::string& where);
  /// Counts a packed layer.
  void count_layer();
  /// Adds planes of alpha 1 to the layers that are counted, and keeps the planes of the next layer.
  void add_alpha();

  /// Guard of a filling: if its scope ends without finish(), the set has no layers.
  class Filling {
   public:
    /// Allocates memory for `layers` layers and discards earlier contents.
    Filling(Data& data, int columns, int rows, int layers);
    Filling(const Filling&) = delete;
    Filling& operator=(const Filling&) = delete;
    ~Filling();
    /// To be called after the last layer.
    void finish();

   private:
    Data& data_;
    bool finished_ = false;
  };
};

class LayerAccess {
 public:
  using Data = LayerSet::Data;
  static const LayerSet::Data& data(const LayerSet& layers) noexcept { return *layers.data_; }
};

namespace blur_detail {
using LayerData = LayerAccess::Data;

constexpr int most_layers = 64;

/// @throws Error unless there are 1 to most_layers layers
void check_number(int layers);
/// @throws Error unless there are 1 to 2^26 pixels
void check_size(const std::string& where, int columns, int rows);
/// Inverse depth, 1/mm; -1 for a value that is no depth.
inline float inverse_of(float depth_mm) noexcept { return depth_mm > 0 ? 1 / depth_mm : -1.0f; }
}  // namespace blur_detail

}  // namespace petzval
