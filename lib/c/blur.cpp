// SPDX-License-Identifier: Apache-2.0
// Lens blur of the C interface.
#include <cstdlib>
#include <utility>

#include "handles.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"

using namespace petzval;
using namespace petzval::c_detail;

struct petzval_lens_rays : Holder<const std::pair<LensRays, double>, Kind::lens_rays> {};  // and z of the pinhole
struct petzval_layers : Holder<LayerSet, Kind::layers> {};
struct petzval_blur : Holder<BlurredImage, Kind::blur> {};

namespace {

std::size_t pixel_count(std::int32_t columns, std::int32_t rows) {
  if (columns < 1 || rows < 1) {
    bad_argument("columns x rows = " + std::to_string(columns) + " x " + std::to_string(rows) + "; must be at least 1");
  }
  return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
}

/// Makes layers by a function that fills a LayerSet.
template <class Fill>
petzval_status create_layers(petzval_layers** layers, const Fill& fill) {
  return guarded(results(layers), [&] {
    given(layers, "layers");
    auto set = std::make_shared<LayerSet>();
    fill(*set);
    give(std::move(set), layers);
  });
}

}  // namespace

petzval_status petzval_lens_rays_create(const petzval_camera* camera, const petzval_lens_rays_options* options,
                                        petzval_lens_rays** rays) {
  return guarded(results(rays), [&] {
    given(rays, "rays");
    const Camera& own = live(camera, "camera").contents->camera;
    const auto in = received(options, "petzval_lens_rays_options");
    const LensRaysOptions how{.nearest_mm = in.nearest_mm,
                              .set_count = in.set_count == 0 ? 1 : in.set_count,
                              .over_pixels = flag(in.over_pixels, "over_pixels"),
                              .threads = in.threads == 0 ? 1 : in.threads};
    std::vector<Wavelength> wavelengths;
    for (int c = 0; in.rgb_nm && c < 3; ++c) wavelengths.push_back(Wavelength::nm(in.rgb_nm[c]));
    const auto points = vogel_sets(in.count == 0 ? 100 : in.count, how.set_count);
    give(std::make_shared<const std::pair<LensRays, double>>(
             LensRays::of(own, layer_camera(own), points, wavelengths, how), layer_origin_z(own)),
         rays);
  });
}

void petzval_lens_rays_free(petzval_lens_rays* rays) { release(rays); }

petzval_status petzval_lens_rays_get_info(const petzval_lens_rays* rays, double nearest_mm, double farthest_mm,
                                          petzval_lens_rays_info* info) {
  return guarded(results(info), [&] {
    const auto& [lens, pinhole_z] = *live(rays, "rays").contents;
    const PeelPlan plan = plan_peel(lens, nearest_mm, farthest_mm);
    petzval_lens_rays_info found{};
    found.focal_px = plan.camera.focal_px;
    found.axis_px[0] = plan.camera.axis.x, found.axis_px[1] = plan.camera.axis.y;
    found.pinhole_z_mm = pinhole_z;
    found.reach_px = lens.reach_px(1 / farthest_mm, 1 / nearest_mm);
    found.offset_px = lens.offset_px(1 / farthest_mm, 1 / nearest_mm);
    found.bias = plan.bias;
    found.columns = plan.camera.columns, found.rows = plan.camera.rows;
    found.overscan = plan.camera.overscan, found.most_layers = plan.most_layers;
    send(found, info, "petzval_lens_rays_info");
  });
}

petzval_status petzval_layers_create(std::int32_t columns, std::int32_t rows, std::size_t count,
                                     const float* const* rgba, const float* const* depth_mm, petzval_layers** layers) {
  return create_layers(layers, [&](LayerSet& set) {
    const std::size_t pixels = pixel_count(columns, rows);
    if (count < 1 || count > 64) bad_argument("count = " + std::to_string(count) + "; must be 1 to 64");
    given(rgba, "rgba"), given(depth_mm, "depth_mm");
    std::vector<LayerImage> images;
    for (std::size_t i = 0; i < count; ++i) {
      images.push_back(
          {columns, rows, {&given(rgba[i], "rgba"), 4 * pixels}, {&given(depth_mm[i], "depth_mm"), pixels}});
    }
    set.set(images);
  });
}

petzval_status petzval_layers_create_deep(std::int32_t columns, std::int32_t rows, const std::size_t* offsets,
                                          const float* samples, std::size_t count, double bias,
                                          std::int32_t most_layers, petzval_layers** layers) {
  return create_layers(layers, [&](LayerSet& set) {
    const std::size_t pixels = pixel_count(columns, rows);
    given(offsets, "offsets");
    if (count > 0) given(samples, "samples");
    FragmentLists lists{.columns = columns, .rows = rows, .offsets = {offsets, offsets + pixels + 1}, .fragments = {}};
    for (std::size_t i = 0; i < count; ++i, samples += 5) {
      lists.fragments.push_back({samples[0], samples[1], samples[2], samples[3], samples[4]});
    }
    set.peel_fragments(lists, bias, most_layers);
  });
}

void petzval_layers_free(petzval_layers* layers) { release(layers); }

petzval_status petzval_blur_create(petzval_blur** blur) {
  return guarded(results(blur), [&] {
    given(blur, "blur");
    give(std::make_shared<BlurredImage>(), blur);
  });
}

void petzval_blur_free(petzval_blur* blur) { release(blur); }

petzval_status petzval_gather(const petzval_layers* layers, const petzval_lens_rays* rays,
                              const petzval_gather_options* options, petzval_blur* blur, float* rgba,
                              std::ptrdiff_t row_bytes, float* missed) {
  return guarded([&] {
    const LayerSet& scene = *live(layers, "layers").contents;
    const LensRays& lens = live(rays, "rays").contents->first;
    BlurredImage& picture = *live(blur, "blur").contents;
    const auto in = received(options, "petzval_gather_options");
    given(rgba, "rgba");
    const std::ptrdiff_t columns = in.columns == 0 ? lens.camera().columns : in.columns, row = row_bytes / 4;
    if (row_bytes % 4 != 0 || std::abs(row) < 4 * columns) {
      bad_argument("row_bytes = " + std::to_string(row_bytes) + "; must be a multiple of 4 and at least " +
                   std::to_string(16 * columns) + " in magnitude");
    }
    GatherOptions how{.threads = in.threads == 0 ? 1 : in.threads,
                      .highlights_above = in.highlights_above == 0 ? 1 : in.highlights_above,
                      .left = in.left,
                      .top = in.top,
                      .columns = in.columns,
                      .rows = in.rows};
    if (in.progress) how.progress = [&](double done) { return in.progress(done, in.user) == 0; };
    try {
      gather(scene, lens, how, picture);
    } catch (const Cancelled& cancelled) {
      throw Failure{PETZVAL_CANCELLED, cancelled.what()};
    }
    for (int y = 0; y < picture.rows; ++y) {
      std::copy_n(picture.rgba.data() + y * 4 * columns, 4 * columns, rgba + y * row);
    }
    if (missed) std::ranges::copy(picture.missed, missed);
  });
}
