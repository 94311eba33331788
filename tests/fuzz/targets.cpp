// SPDX-License-Identifier: Apache-2.0
#include "targets.hpp"

#include <array>

#include "seeds.hpp"

// The functions LLVMFuzzerTestOneInput of the targets, under the names of their files.
extern "C" {
using Fuzzed = int(const std::uint8_t*, std::size_t);
Fuzzed fuzz_lens_file, fuzz_glass_file, fuzz_first_order, fuzz_trace, fuzz_pupil, fuzz_focus, fuzz_camera,
    fuzz_camera_calls, fuzz_c_calls, fuzz_camera_setup, fuzz_camera_table, fuzz_table_calls, fuzz_psf, fuzz_gather,
    fuzz_written_lens;
#ifdef PETZVAL_FUZZ_FITS
Fuzzed fuzz_focus_points;
#endif
#ifdef PETZVAL_FUZZ_PICTURES
Fuzzed fuzz_picture_file, fuzz_psf_set;
#endif
#ifdef PETZVAL_FUZZ_SCENES
Fuzzed fuzz_scene_file;
#endif
}

namespace petzval::fuzz {

std::span<const Target> targets() {
  static const std::array all{
      Target{"petzval_json", "lens_file", fuzz_lens_file, own_json, 8192, 1000},
      Target{"zemax", "lens_file", fuzz_lens_file, zemax_texts, 8192, 600},
      Target{"codev", "lens_file", fuzz_lens_file, codev_texts, 8192, 600},
      Target{"typed_table", "lens_file", fuzz_lens_file, typed_tables, 4096, 600},
      Target{"page", "lens_file", fuzz_lens_file, pages, 8192, 600},
      Target{"flaresim", "lens_file", fuzz_lens_file, flaresim_texts, 4096, 600},
      Target{"oslo", "lens_file", fuzz_lens_file, oslo_texts, 4096, 600},
      Target{"opticalbench", "lens_file", fuzz_lens_file, opticalbench_texts, 4096, 600},
      Target{"table", "lens_file", fuzz_lens_file, tables, 4096, 600},
      Target{"lentil", "lens_file", fuzz_lens_file, lentil_texts, 4096, 600},
      Target{"optiland", "lens_file", fuzz_lens_file, optiland_texts, 4096, 600},
      Target{"collections", "lens_file", fuzz_lens_file, collection_texts, 4096, 600},
      Target{"lens_format", "lens_file", fuzz_lens_file, all_lens_texts, 8192, 1000},
      Target{"agf", "glass_file", fuzz_glass_file, agf_texts, 8192, 600},
      Target{"rii", "glass_file", fuzz_glass_file, rii_texts, 4096, 600},
      Target{"glass_csv", "glass_file", fuzz_glass_file, glass_tables, 4096, 600},
#ifdef PETZVAL_FUZZ_PICTURES
      Target{"exr", "picture_file", fuzz_picture_file, exr_files, 2048, 600},
      Target{"deep_exr", "picture_file", fuzz_picture_file, deep_exr_files, 2048, 600},
      Target{"png", "picture_file", fuzz_picture_file, png_files, 4096, 600},
      Target{"pfm", "picture_file", fuzz_picture_file, pfm_files, 4096, 600},
      Target{"psf_set", "psf_set", fuzz_psf_set, random_bytes, 512, 1000},
#endif
#ifdef PETZVAL_FUZZ_SCENES
      Target{"scene", "scene_file", fuzz_scene_file, scene_texts, 4096, 600},
      Target{"obj", "scene_file", fuzz_scene_file, obj_texts, 4096, 600},
#endif
      Target{"written_lens", "written_lens", fuzz_written_lens, random_bytes, 512, 500},
      Target{"first_order", "first_order", fuzz_first_order, random_bytes, 512, 1000},
      Target{"trace", "trace", fuzz_trace, random_bytes, 512, 1000},
      Target{"pupil", "pupil", fuzz_pupil, random_bytes, 512, 300},
      Target{"focus", "focus", fuzz_focus, random_bytes, 512, 200},
      Target{"camera", "camera", fuzz_camera, random_bytes, 512, 60},
      Target{"camera_calls", "camera_calls", fuzz_camera_calls, random_bytes, 256, 2000},
      Target{"c_calls", "c_calls", fuzz_c_calls, random_bytes, 256, 300},
      Target{"camera_setup", "camera_setup", fuzz_camera_setup, camera_setups, 8192, 200},
      Target{"camera_table", "camera_table", fuzz_camera_table, random_bytes, 256, 2000},
      Target{"table_calls", "table_calls", fuzz_table_calls, random_bytes, 256, 2000},
      Target{"psf", "psf", fuzz_psf, random_bytes, 512, 200},
      Target{"gather", "gather", fuzz_gather, random_bytes, 2048, 300},
#ifdef PETZVAL_FUZZ_FITS
      Target{"focus_points", "focus_points", fuzz_focus_points, random_bytes, 512, 500},
#endif
  };
  return all;
}

}  // namespace petzval::fuzz
