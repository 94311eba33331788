// SPDX-License-Identifier: Apache-2.0
// Deep images as layers.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "layer_data.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

using namespace blur_detail;

/// Red, green, blue, alpha and coverage: the part of alpha that belongs to the picture and not to its holdout.
using Values = std::array<float, 5>;

/// A surface, or a volume between two depths (mm).
struct Sample {
  float front, back;
  Values values;

  bool volume() const noexcept { return back > front; }
};

/// Samples that share a space, by their light without absorption. The light of alpha is the optical thickness. All
/// lights add up, in proportion to the length of a volume.
/// Source: Hillman, "The Theory of OpenEXR Deep Samples" (OpenEXR documentation), splitting and merging of samples.
class Mixture {
 public:
  /// Adds a sample `times` times.
  void add(const Sample& sample, double times = 1) noexcept {
    constexpr double opaque = 1e9;  // stands for infinity: hides all other samples, and the mean of two remains finite
    const auto alpha = static_cast<double>(sample.values[3]);
    const double unabsorbed = alpha == 0 ? 1 : alpha < 1 ? -std::log1p(-alpha) / alpha : opaque;
    for (std::size_t c = 0; c < 5; ++c) light_[c] += times * unabsorbed * static_cast<double>(sample.values[c]);
  }
  void add(const Mixture& other) noexcept {
    for (std::size_t c = 0; c < 5; ++c) light_[c] += other.light_[c];
  }
  /// The values of a part with this length in units of the added samples.
  Values values(double length) const noexcept {
    const double thickness = length * light_[3];
    const double seen = length * (thickness > 0 ? -std::expm1(-thickness) / thickness : 1);
    Values result{};
    for (std::size_t c = 0; c < 5; ++c) result[c] = static_cast<float>(seen * light_[c]);
    result[3] = std::clamp(result[3], 0.0f, 1.0f), result[4] = std::clamp(result[4], 0.0f, result[3]);
    return result;
  }

 private:
  std::array<double, 5> light_{};
};

bool has_pixels(const FragmentLists& lists) { return lists.columns != 0 || lists.rows != 0; }

/// The samples of a pixel of an image and its holdout, from near to far and without overlaps. Samples at equal depths
/// are mixed, so that their order does not matter.
class DeepPixel {
 public:
  DeepPixel(const FragmentLists& lists, const FragmentLists& holdout) : lists_(lists), holdout_(holdout) {
    check_fragments(lists, "fragments");
    if (!has_pixels(holdout)) return;
    if (holdout.columns != lists.columns || holdout.rows != lists.rows) {
      throw Error("holdout: size = " + std::to_string(holdout.columns) + " x " + std::to_string(holdout.rows) +
                  "; must be the size of the fragments, " + std::to_string(lists.columns) + " x " +
                  std::to_string(lists.rows));
    }
    check_fragments(holdout, "holdout", false);
  }

  const std::vector<Sample>& samples(std::size_t pixel) {
    sorted_.clear(), samples_.clear(), active_.clear();
    add(lists_, pixel, false);
    if (has_pixels(holdout_)) add(holdout_, pixel, true);
    std::ranges::stable_sort(sorted_, {}, &Sample::front);

    // From one depth at which a sample begins or ends to the next, the same volumes are mixed.
    float from = 0;
    for (std::size_t next = 0; next < sorted_.size() || !active_.empty();) {
      float to = next < sorted_.size() ? sorted_[next].front : INFINITY;
      Mixture within, at_depth;
      for (const Volume& v : active_) to = std::min(to, v.back), within.add(v.per_mm);
      if (!active_.empty()) {
        samples_.push_back({from, to, within.values(static_cast<double>(to) - static_cast<double>(from))});
      }
      std::erase_if(active_, [&](const Volume& v) { return v.back <= to; });
      for (int surfaces = 0; next < sorted_.size() && sorted_[next].front <= to; ++next) {
        const Sample& s = sorted_[next];
        if (s.volume()) {
          active_.push_back({s.back, {}});
          active_.back().per_mm.add(s, 1 / (static_cast<double>(s.back) - static_cast<double>(s.front)));
          continue;
        }
        at_depth.add(s);
        if (surfaces++ == 0) {
          samples_.push_back(s);
        } else {
          samples_.back().values = at_depth.values(1);
        }
      }
      from = to;
    }
    return samples_;
  }

 private:
  void add(const FragmentLists& lists, std::size_t pixel, bool held_out) {
    for (std::size_t i = lists.offsets[pixel]; i < lists.offsets[pixel + 1]; ++i) {
      const FragmentLists::Fragment& f = lists.fragments[i];
      if (!(f.depth_mm > 0)) continue;
      const bool volume = f.back_mm > f.depth_mm && std::isfinite(f.back_mm) && f.alpha < 1;
      Sample s{f.depth_mm, volume ? f.back_mm : f.depth_mm, {0, 0, 0, f.alpha, 0}};
      if (!held_out) s.values = {f.red, f.green, f.blue, f.alpha, f.alpha};
      sorted_.push_back(s);
    }
  }

  const FragmentLists &lists_, &holdout_;
  struct Volume {
    float back;
    Mixture per_mm;
  };
  std::vector<Sample> sorted_, samples_;
  std::vector<Volume> active_;
};

/// The surfaces of one pixel of the layers, by LayerSet::peel_fragments().
class PixelSurfaces {
 public:
  using Surface = std::pair<float, Values>;  ///< inverse depth, 1/mm

  PixelSurfaces(double bias, int layers) : bias_(bias), layers_(static_cast<std::size_t>(layers)) {}

  const std::vector<Surface>& of(const std::vector<Sample>& samples) {
    all_.clear();
    for (const Sample& s : samples) slice(s);
    const auto bias = static_cast<float>(bias_);
    for (float reach = bias; !fill(bias, reach) && reach < all_[0].first;) {
      reach = std::max(2 * reach, all_[0].first / 1024);
    }
    return surfaces_;
  }

 private:
  void slice(const Sample& s) {
    if (!s.volume()) return all_.push_back({inverse_of(s.front), s.values});
    const double front = 1 / static_cast<double>(s.front), back = 1 / static_cast<double>(s.back);
    // A little longer than the bias, so that rounding does not composite two slices.
    const int slices = static_cast<int>(std::clamp<double>(0.999 * (front - back) / bias_, 1, most_layers));
    const auto at = [&](double slice) { return std::lerp(front, back, slice / slices); };
    Mixture whole;
    whole.add(s);
    for (int i = 0; i < slices; ++i) {
      all_.push_back(
          {static_cast<float>(at(i + 0.5)), whole.values((1 / at(i + 1) - 1 / at(i)) / (1 / back - 1 / front))});
    }
  }

  /// Composites surfaces behind a surface by at most the bias, or `reach` if the surface is translucent.
  /// @return false if there are more surfaces than layers
  bool fill(float bias, float reach) {
    surfaces_.clear();
    bool fits = true;
    for (const auto& [w, values] : all_) {
      const float through = surfaces_.empty() ? 0 : 1 - surfaces_.back().second[3];
      const bool behind = surfaces_.empty() || w < surfaces_.back().first - (through > 0 ? reach : bias);
      if (behind && surfaces_.size() < layers_) {
        surfaces_.push_back({w, values});
      } else if (through > 0) {
        fits &= !behind;
        for (std::size_t p = 0; p < values.size(); ++p) surfaces_.back().second[p] += through * values[p];
      }
    }
    return fits;
  }

  double bias_;
  std::size_t layers_;
  std::vector<Surface> all_, surfaces_;
};

}  // namespace

void check_fragments(const FragmentLists& lists, const std::string& where, bool colours) {
  check_size(where.c_str(), lists.columns, lists.rows);
  const auto columns = static_cast<std::size_t>(lists.columns), pixels = columns * static_cast<std::size_t>(lists.rows);
  if (lists.offsets.size() != pixels + 1 || lists.offsets.front() != 0 ||
      lists.offsets.back() != lists.fragments.size() || !std::ranges::is_sorted(lists.offsets)) {
    throw Error(where + ": offsets must rise from 0 to the number of fragments, with one for each pixel and one more");
  }
  for (std::size_t i = 0; i < lists.fragments.size(); ++i) {
    const FragmentLists::Fragment& f = lists.fragments[i];
    const auto refuse = [&](const char* name, float value, const char* rule) {
      const auto next = std::ranges::upper_bound(lists.offsets, i);
      const auto pixel = static_cast<std::size_t>(next - lists.offsets.begin()) - 1;
      throw Error(where + ": column " + std::to_string(pixel % columns) + ", row " + std::to_string(pixel / columns) +
                  ": " + name + " = " + to_text(value) + "; must be " + rule);
    };
    if (!(f.depth_mm > 0)) continue;
    if (!(f.alpha >= 0 && f.alpha <= 1)) refuse("alpha", f.alpha, "0 to 1");
    for (const float colour : {f.red, f.green, f.blue}) {
      if (colours && std::isnan(colour)) refuse("colour", colour, "a number");
    }
  }
}

void LayerSet::peel_fragments(const FragmentLists& lists, double bias, int layers, const FragmentLists& holdout) {
  check_number(layers);
  DeepPixel deep(lists, holdout);
  if (!(bias >= 0)) throw Error("fragments: bias = " + to_text(bias) + "; must be at least 0");

  // Filling layer by layer would sort each list again. One pass over the pixels writes to all layers.
  Data& d = *data_;
  Data::Filling filling(d, lists.columns, lists.rows, layers);
  const auto translucent = [](const auto& f) { return f.depth_mm > 0 && f.alpha != 1; };
  d.planes = has_pixels(holdout) ? 6 : std::ranges::any_of(lists.fragments, translucent) ? 4 : 3;
  d.reserve(d.plane_stride());
  for (int layer = 0; layer < layers; ++layer) {
    for (int p = 0; p < d.planes; ++p) {
      std::fill_n(d.plane(layer, p), d.pixels(), p == 0 ? -1.0f : p == 3 ? 1.0f : 0.0f);
    }
  }
  PixelSurfaces flat(bias, layers);
  std::size_t deepest = 0;
  for (std::size_t pixel = 0; pixel < d.pixels(); ++pixel) {
    const auto& surfaces = flat.of(deep.samples(pixel));
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const auto& [red, green, blue, alpha, coverage] = surfaces[i].second;
      const auto layer = static_cast<int>(i);
      const auto put = [&](int plane, const PackedColour& colour) {
        d.plane(layer, plane)[pixel] = colour.red_blue, d.plane(layer, plane + 1)[pixel] = colour.green_blue;
      };
      const auto colour = PackedColour::of(red, green, blue);
      d.plane(layer, 0)[pixel] = surfaces[i].first;
      put(1, colour);
      if (d.planes > 3) d.plane(layer, 3)[pixel] = alpha;
      if (d.held_out()) {
        const auto error = [](float c, float rounded) { return std::abs(c) <= 1 ? c - rounded : 0.0f; };
        const auto rounded = colour.unpacked();
        put(4, PackedColour::of(coverage, error(red, rounded[0]), error(green, rounded[1])));
      }
      d.opaque &= alpha == 1;
    }
    deepest = std::max(deepest, surfaces.size());
  }
  while (static_cast<std::size_t>(d.count) < deepest) d.count_layer();
  filling.finish();
}

FragmentLists hold_out(const FragmentLists& lists, const FragmentLists& holdout) {
  DeepPixel deep(lists, holdout);
  FragmentLists result{.columns = lists.columns, .rows = lists.rows, .offsets = {0}, .fragments = {}};
  result.fragments.reserve(lists.fragments.size());
  for (std::size_t pixel = 0; pixel + 1 < lists.offsets.size(); ++pixel) {
    // `through` behind the samples of both images, `open` behind the samples of the result.
    double through = 1, open = 1;
    for (const auto& [front, back, values] : deep.samples(pixel)) {
      if (!(through > 0 && open > 0)) break;
      const auto [red, green, blue, alpha, coverage] = values;
      const auto part = static_cast<float>(through / open);
      if (coverage > 0 || red != 0 || green != 0 || blue != 0) {
        result.fragments.push_back(
            {front, part * red, part * green, part * blue, std::min(part * coverage, 1.0f), back});
      }
      open -= through * static_cast<double>(coverage), through *= 1 - static_cast<double>(alpha);
    }
    result.offsets.push_back(result.fragments.size());
  }
  return result;
}

}  // namespace petzval
