// SPDX-License-Identifier: Apache-2.0
#include "seeds.hpp"

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>

#include "../data_lenses.hpp"
#include "laws.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/petzval.h"

namespace petzval::fuzz {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(file.string() + ": cannot be read; must be a seed");
  return {std::istreambuf_iterator<char>(stream), {}};
}
std::string seed(const char* name) { return bytes_of(fs::path(PETZVAL_FUZZ_SEEDS) / name); }
std::string sample(const char* name) { return bytes_of(fs::path(PETZVAL_TEST_SAMPLES) / name); }

/// Lenses that together cover spheres, cylinders, mirrors, obscurations, aspheres, configurations and media other than
/// air, and coatings.
std::vector<Prescription> small_lenses() {
  std::vector<Prescription> result;
  for (const char* id : {"singlet_50mm_biconvex", "achromat_100mm", "cylinder_3.9mm", "mirror_newton_200mm_f8",
                         "phone_5.6mm_f3.5", "eye_gullstrand_le_grand", "zoom_14-30mm_f4"}) {
    result.push_back(testing::data_prescription(id));
  }
  result[0].surfaces[0].coating = Coating::quarter_wave();
  result[0].surfaces[1].coating = Coating{};
  result[1].surfaces[0].coating = Coating{.table = {{1, 0.01}, {1e6, 0.01}}};
  return result;
}

Texts written(const std::function<ExportedLens(const Prescription&)>& write) {
  Texts result;
  for (const Prescription& lens : small_lenses()) {
    done([&] { result.push_back(write(lens).text); });
  }
  return result;
}

const GlassCatalogue& glasses() {
  static const auto tables = GlassCatalogue::load(fs::path(PETZVAL_TEST_DATA) / "glass");
  return tables;
}

}  // namespace

Texts own_json() {
  Texts result;
  for (const Prescription& lens : small_lenses()) result.push_back(format_prescription(lens));
  return result;
}
Texts camera_setups() {
  Texts result;
  for (const char* id : {"singlet_50mm_biconvex", "achromat_100mm", "phone_5.6mm_f3.5"}) {
    const std::string text = format_prescription(testing::data_prescription(id));
    petzval_lens* lens = nullptr;
    petzval_camera* camera = nullptr;
    std::size_t length = 0;
    if (petzval_lens_parse(text.data(), text.size(), id, nullptr, &lens) != PETZVAL_OK ||
        petzval_camera_create(lens, nullptr, nullptr, &camera) != PETZVAL_OK ||
        petzval_camera_write(camera, nullptr, 0, &length) != PETZVAL_OK) {
      throw Error(petzval_message());
    }
    std::string setup(length, 0);
    petzval_camera_write(camera, setup.data(), length, nullptr);
    petzval_camera_free(camera), petzval_lens_free(lens);
    result.push_back(std::move(setup));
  }
  return result;
}
Texts zemax_texts() {
  return written([](const Prescription& lens) { return format_zemax(lens, &glasses()); });
}
Texts codev_texts() {
  return written([](const Prescription& lens) { return format_codev(lens, &glasses()); });
}
Texts tables() {
  return written([](const Prescription& lens) { return format_table(lens); });
}
Texts typed_tables() { return {seed("patent.txt"), seed("sheet.csv")}; }
Texts pages() {
  return {sample("pages/olympus.txt"),    sample("pages/zeiss_tessar.txt"), sample("pages/sony_prime.txt"),
          sample("pages/canon_zoom.txt"), sample("pages/fuji_new.txt"),     sample("pages/nikon_zoom.txt")};
}
Texts flaresim_texts() { return {seed("flaresim.lens")}; }
Texts oslo_texts() { return {sample("oslo_words.len")}; }
Texts opticalbench_texts() { return {sample("opticalbench_macro.txt"), sample("opticalbench_zoom.txt")}; }
Texts lentil_texts() { return {seed("lentil.json")}; }
Texts collection_texts() { return {seed("lenshh.lhlt"), seed("deeplens.json"), seed("crayg.fx")}; }
Texts optiland_texts() { return {seed("optiland.json")}; }
Texts all_lens_texts() {
  Texts result;
  for (const auto& texts : {own_json, zemax_texts, codev_texts, tables, typed_tables, pages, flaresim_texts, oslo_texts,
                            opticalbench_texts, lentil_texts, optiland_texts, collection_texts}) {
    const Texts some = texts();
    result.insert(result.end(), some.begin(), some.begin() + 1);
  }
  std::string wide = "\xff\xfe";  // UTF-16, as written by Zemax
  for (const char c : result[1]) wide += {c, '\0'};
  result.push_back(wide);
  return result;
}
Texts agf_texts() { return {sample("every_formula.agf")}; }
Texts rii_texts() { return {seed("rii_formula.yml"), seed("rii_table.yml")}; }
Texts glass_tables() { return {bytes_of(fs::path(PETZVAL_TEST_DATA) / "glass" / "glass_misc.csv")}; }

Texts scene_texts() { return {seed("scene.json")}; }
Texts obj_texts() { return {seed("mesh.obj")}; }

Texts random_bytes() {
  Texts result;
  std::mt19937 engine(1);  // equal numbers with every compiler
  for (int i = 0; i < 24; ++i) {
    std::string bytes;
    for (int k = 0; k < 64 + 16 * i; ++k) bytes += static_cast<char>(engine() & 255);
    result.push_back(bytes);
  }
  return result;
}

}  // namespace petzval::fuzz
