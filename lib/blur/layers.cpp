// SPDX-License-Identifier: Apache-2.0
#include "petzval/blur/layers.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "core/text.hpp"
#include "layer_data.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

using blur_detail::check_number, blur_detail::check_size, blur_detail::inverse_of, blur_detail::most_layers;

constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace

void blur_detail::check_number(int layers) {
  if (layers < 1 || layers > most_layers) {
    throw Error("layers: " + std::to_string(layers) + " layers; must be 1 to " + std::to_string(most_layers));
  }
}

void blur_detail::check_size(const std::string& where, int columns, int rows) {
  constexpr std::int64_t most_pixels = std::int64_t{1} << 26;
  if (columns < 1 || rows < 1 || static_cast<std::int64_t>(columns) * rows > most_pixels) {
    throw Error(where + ": size = " + std::to_string(columns) + " x " + std::to_string(rows) + "; must be 1 to " +
                std::to_string(most_pixels) + " pixels");
  }
}

namespace {

/// Checks the size of a camera's layers, including overscan.
void check_size(const LayerCamera& camera) {
  constexpr int max_overscan = 1 << 15;  // far below the overflow of the sum
  if (camera.overscan < 0 || camera.overscan > max_overscan) {
    throw Error("layers: overscan = " + std::to_string(camera.overscan) + " px; must be 0 to " +
                std::to_string(max_overscan));
  }
  check_size("layers", camera.columns, camera.rows);
  check_size("layers", camera.layer_columns(), camera.layer_rows());
}

std::string pixel_name(std::size_t pixel, int columns) {
  const auto width = static_cast<std::size_t>(columns);
  return "column " + std::to_string(pixel % width) + ", row " + std::to_string(pixel / width);
}

}  // namespace

LayerSet::Data::Filling::Filling(Data& data, int columns, int rows, int layers) : data_(data) {
  static std::atomic<std::uint64_t> fillings = 0;
  data.filling = ++fillings;
  data.columns = data.rows = data.count = 0, data.planes = 3, data.opaque = true;  // also if memory runs out
  const std::size_t pixels = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  data.below.assign(pixels, infinity);
  data.capacity = layers;
  data.reserve(pixels + slack);
  data.columns = columns, data.rows = rows;
}

LayerSet::Data::Filling::~Filling() {
  if (!finished_) data_.columns = data_.rows = data_.count = 0;
}

void LayerSet::Data::Filling::finish() {
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::span<const float>> depths;
  for (int layer = 0; layer < data_.count; ++layer) depths.emplace_back(data_.plane(layer, 0), data_.pixels());
  data_.n_buffer.fill(data_.columns, data_.rows, depths);
  data_.n_buffer_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  data_.below = {};
  finished_ = true;
}

LayerPlanes LayerSet::Data::begin_layer() {
  const auto span = [&](int p, float value) {
    float* const begin = plane(count, p);
    std::fill_n(begin, pixels(), value);
    return std::span<float>(begin, pixels());
  };
  return {span(0, -1), span(1, 0), span(2, 0), span(3, 0), span(4, 1)};
}

void LayerSet::Data::end_layer(const std::string& where) {
  float* const w = plane(count, 0);
  const float* const alpha = plane(count, 4);
  bool any = false, solid = true, ordered = true, mixed = true;
  for (std::size_t i = 0; i < pixels(); ++i) {
    w[i] = w[i] >= 0 ? w[i] : -1.0f;  // NaN: empty
    any |= w[i] >= 0;
    ordered &= w[i] < 0 || w[i] < below[i];
    solid &= w[i] < 0 || alpha[i] == 1;
    mixed &= w[i] < 0 || (alpha[i] >= 0 && alpha[i] <= 1);
  }
  if (!ordered) {
    std::size_t i = 0;
    while (w[i] < 0 || w[i] < below[i]) ++i;
    throw Error(where + ": " + pixel_name(i, columns) + ": inverse depth = " + to_text(w[i], 6) +
                " / mm; must be below " + to_text(below[i], 6) + ", or negative (no surface)");
  }
  if (!mixed) {
    std::size_t i = 0;
    while (w[i] < 0 || (alpha[i] >= 0 && alpha[i] <= 1)) ++i;
    throw Error(where + ": " + pixel_name(i, columns) + ": alpha = " + to_text(alpha[i]) + "; must be 0 to 1");
  }
  if (!any) return;
  // In place, by blocks: the compiler vectorises the loop only if results cannot overlap colours.
  constexpr std::size_t block = 256;
  for (std::size_t from = 0; from < pixels(); from += block) {
    float packed[2][block];
    const float *const red = plane(count, 1) + from, *const green = plane(count, 2) + from,
                       *const blue = plane(count, 3) + from;
    const std::size_t size = std::min(block, pixels() - from);
    for (std::size_t i = 0; i < size; ++i) {
      const auto colour = blur_detail::PackedColour::of(red[i], green[i], blue[i]);
      packed[0][i] = colour.red_blue, packed[1][i] = colour.green_blue;
    }
    for (int p = 0; p < 2; ++p) std::copy_n(packed[p], size, plane(count, 1 + p) + from);
  }
  if (!solid && planes == 3) add_alpha();
  if (planes > 3) std::copy_n(plane(count, 4), pixels(), plane(count, 3));
  count_layer();
  opaque &= solid;
}

void LayerSet::Data::add_alpha() {
  const auto move = [this](int from, int to, int number) {
    float* const begin = memory.data() + slack;
    std::memmove(begin + static_cast<std::size_t>(to) * plane_stride(),
                 begin + static_cast<std::size_t>(from) * plane_stride(),
                 static_cast<std::size_t>(number) * plane_stride() * sizeof(float));
  };
  planes = 4;
  reserve(plane_stride());
  move(3 * count, 4 * count, 5);
  for (int layer = count; layer-- > 0;) {
    move(3 * layer, 4 * layer, 3);
    std::fill_n(plane(layer, 3), pixels(), 1.0f);
  }
}

void LayerSet::Data::count_layer() {
  const auto brighter = [](float a, float b) { return a > b ? a : b; };  // b if a is NaN
  brightest.resize(static_cast<std::size_t>((count + 1) * rows));
  for (int row = 0; row < rows; ++row) {
    const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(row) * columns;
    const float *const w = plane(count, 0) + from, *const first = plane(count, 1) + from,
                       *const second = plane(count, 2) + from;
    float most = 0;
    for (int i = 0; i < columns; ++i) {
      const auto [r, g, b] = blur_detail::PackedColour{first[i], second[i]}.unpacked();
      most = brighter(w[i] >= 0 ? brighter(r, brighter(g, b)) : 0.0f, most);
    }
    brightest[static_cast<std::size_t>(count * rows + row)] = most;
  }
  ++count;
}

namespace {

/// Depth along the axis divided by the distance along the ray, for a pixel of the layers.
float axial_fraction(const LayerCamera& camera, std::size_t pixel) {
  const auto width = static_cast<std::size_t>(camera.layer_columns());
  const double x = (static_cast<double>(pixel % width) + 0.5 - camera.overscan - camera.axis.x) / camera.focal_px,
               y = (static_cast<double>(pixel / width) + 0.5 - camera.overscan - camera.axis.y) / camera.focal_px;
  return static_cast<float>(1 / std::sqrt(1 + x * x + y * y));
}

void check_pixels(const LayerCamera& camera, std::size_t pixels) {
  check_size(camera);
  const auto expected =
      static_cast<std::size_t>(camera.layer_columns()) * static_cast<std::size_t>(camera.layer_rows());
  if (pixels == expected) return;
  throw Error("axial_depths: number of pixels = " + std::to_string(pixels) +
              "; must be columns x rows of the layers, " + std::to_string(camera.layer_columns()) + " x " +
              std::to_string(camera.layer_rows()));
}

}  // namespace

void axial_depths(const LayerCamera& camera, FragmentLists& lists) {
  check_pixels(camera, lists.offsets.empty() ? 0 : lists.offsets.size() - 1);
  for (std::size_t pixel = 0; pixel + 1 < lists.offsets.size(); ++pixel) {
    const float fraction = axial_fraction(camera, pixel);
    for (std::size_t i = lists.offsets[pixel]; i < lists.offsets[pixel + 1]; ++i)
      lists.fragments[i].depth_mm *= fraction, lists.fragments[i].back_mm *= fraction;
  }
}

void axial_depths(const LayerCamera& camera, std::span<float> depth_mm) {
  check_pixels(camera, depth_mm.size());
  for (std::size_t pixel = 0; pixel < depth_mm.size(); ++pixel) depth_mm[pixel] *= axial_fraction(camera, pixel);
}

LayerSet::LayerSet() : data_(std::make_unique<Data>()) {}
LayerSet::LayerSet(LayerSet&&) noexcept = default;
LayerSet& LayerSet::operator=(LayerSet&&) noexcept = default;
LayerSet::~LayerSet() = default;

void LayerSet::peel(const PeelPlan& plan, int layers, const Peel& peel) {
  check_number(layers);
  if (!peel) throw Error("layers: peel is empty; must be a function");
  const LayerCamera& camera = plan.camera;
  check_size(camera);
  Data& d = *data_;
  Data::Filling filling(d, camera.layer_columns(), camera.layer_rows(), layers);
  const auto bias = static_cast<float>(plan.bias);
  for (int layer = 0; layer < layers; ++layer) {
    const std::size_t written = peel(layer, d.below, d.begin_layer());
    const int before = d.count;
    if (written > 0) d.end_layer("layer " + std::to_string(layer));
    if (d.count == before) break;
    const float* const w = d.plane(layer, 0);
    for (std::size_t i = 0; i < d.pixels(); ++i) d.below[i] = w[i] >= 0 ? w[i] - bias : -1.0f;
  }
  filling.finish();
}

void LayerSet::set(std::span<const LayerImage> images) {
  check_number(static_cast<int>(std::min<std::size_t>(images.size(), most_layers + 1)));
  const LayerImage& first = images.front();
  check_size("layer 0", first.columns, first.rows);
  const auto pixels = static_cast<std::size_t>(first.columns) * static_cast<std::size_t>(first.rows);
  for (std::size_t layer = 0; layer < images.size(); ++layer) {
    const LayerImage& image = images[layer];
    const std::string where = "layer " + std::to_string(layer);
    if (image.columns != first.columns || image.rows != first.rows) {
      throw Error(where + ": size = " + std::to_string(image.columns) + " x " + std::to_string(image.rows) +
                  "; must equal the first layer's, " + std::to_string(first.columns) + " x " +
                  std::to_string(first.rows));
    }
    if (image.rgba.size() != 4 * pixels || image.depth_mm.size() != pixels) {
      throw Error(where + ": number of colours = " + std::to_string(image.rgba.size()) +
                  ", of depths = " + std::to_string(image.depth_mm.size()) + "; must be 4 and 1 for each pixel");
    }
  }
  Data& d = *data_;
  Data::Filling filling(d, first.columns, first.rows, static_cast<int>(images.size()));
  for (std::size_t layer = 0; layer < images.size(); ++layer) {
    const LayerPlanes out = d.begin_layer();
    for (std::size_t i = 0; i < pixels; ++i) {
      const float* const rgba = &images[layer].rgba[4 * i];
      out.inverse_depth[i] = inverse_of(images[layer].depth_mm[i]);
      if (out.inverse_depth[i] < 0) continue;
      out.red[i] = rgba[0], out.green[i] = rgba[1], out.blue[i] = rgba[2], out.alpha[i] = rgba[3];
    }
    const int number = d.count;
    d.end_layer("layer " + std::to_string(layer));
    if (d.count == number) break;
    std::copy_n(d.plane(number, 0), pixels, d.below.begin());
    // A surface may have the same depth as the surface in front of it; behind an empty pixel there is no surface.
    for (float& w : d.below) w = w >= 0 ? std::nextafter(w, infinity) : -1.0f;
  }
  filling.finish();
}

int LayerSet::columns() const noexcept { return data_->columns; }
int LayerSet::rows() const noexcept { return data_->rows; }
int LayerSet::count() const noexcept { return data_->count; }
double LayerSet::n_buffer_seconds() const noexcept { return data_->n_buffer_seconds; }
bool LayerSet::opaque() const noexcept { return data_->opaque; }
std::span<const float> LayerSet::inverse_depth(int layer) const noexcept {
  return {data_->plane(layer, 0), data_->pixels()};
}
std::size_t LayerSet::memory_bytes() const noexcept {
  const Data& d = *data_;
  return sizeof(float) * (d.memory.size() + d.below.size() + d.brightest.size() + d.n_buffer.size());
}
std::array<float, 4> LayerSet::rgba(int layer, std::size_t pixel) const noexcept {
  const auto [red, green, blue] = data_->colour(layer, pixel);
  return {red, green, blue, data_->alpha(layer, pixel)};
}

FragmentLists LayerSet::fragments() const {
  const Data& d = *data_;
  FragmentLists lists{.columns = d.columns, .rows = d.rows, .offsets = {0}, .fragments = {}};
  lists.offsets.reserve(d.pixels() + 1);
  for (std::size_t i = 0; i < d.pixels(); ++i) {
    for (int layer = 0; layer < d.count && d.plane(layer, 0)[i] >= 0; ++layer) {
      const auto [red, green, blue] = d.colour(layer, i);
      lists.fragments.push_back({1 / d.plane(layer, 0)[i], red, green, blue, d.alpha(layer, i)});
    }
    lists.offsets.push_back(lists.fragments.size());
  }
  return lists;
}

}  // namespace petzval
