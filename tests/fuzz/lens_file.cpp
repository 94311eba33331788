// SPDX-License-Identifier: Apache-2.0
// Lens files of every format: a lens that is read is valid, and the JSON of the library reproduces it to the byte.
#include "petzval/formats/lens_file.hpp"

#include "laws.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace petzval;
  static const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  Prescription lens;
  const bool read = fuzz::done([&] {
    lens = parse_lens({reinterpret_cast<const char*>(data), size}, "x", {.glasses = &glasses});
  });
  if (!read) return 0;

  validate(lens, "x");
  const std::string json = format_prescription(lens);
  const Prescription back = parse_prescription(json, "x");
  fuzz::require(back == lens, "JSON keeps a lens");
  fuzz::require(format_prescription(back) == json, "JSON round-trips to the same bytes");
  return 0;
}
