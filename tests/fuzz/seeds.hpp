// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

/// Seeds of fuzzing: small lenses of data/ in every format with a writer, texts of tests/fuzz/seeds and
/// tests/formats/samples in other formats, images of a few pixels, and bytes for targets that derive lenses from bytes.
namespace petzval::fuzz {

std::vector<std::string> own_json();
std::vector<std::string> camera_setups();
std::vector<std::string> zemax_texts();
std::vector<std::string> codev_texts();
std::vector<std::string> typed_tables();
std::vector<std::string> pages();
std::vector<std::string> flaresim_texts();
std::vector<std::string> oslo_texts();
std::vector<std::string> opticalbench_texts();
std::vector<std::string> tables();
std::vector<std::string> lentil_texts();
std::vector<std::string> collection_texts();
std::vector<std::string> optiland_texts();
std::vector<std::string> all_lens_texts();
std::vector<std::string> agf_texts();
std::vector<std::string> rii_texts();
std::vector<std::string> glass_tables();
std::vector<std::string> exr_files();
std::vector<std::string> deep_exr_files();
std::vector<std::string> png_files();
std::vector<std::string> pfm_files();
std::vector<std::string> scene_texts();
std::vector<std::string> obj_texts();
std::vector<std::string> random_bytes();

}  // namespace petzval::fuzz
