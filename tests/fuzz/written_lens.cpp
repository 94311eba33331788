// SPDX-License-Identifier: Apache-2.0
// Any lens: edited, checked, or written in a format.
#include <string>

#include "laws.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/io/lint.hpp"
#include "wild_lens.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace petzval;
  static const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  fuzz::Bytes bytes(data, size);
  const int work = bytes.count(0, 7);
  Prescription lens = fuzz::wild_prescription(bytes);
  for (SurfaceRow& row : lens.surfaces) {  // JSON has no infinity; unlimited rims are left out
    if (row.semi_diameter && std::isinf(*row.semi_diameter)) row.semi_diameter.reset();
  }
  if (!fuzz::done([&] { validate(lens, "x"); })) return 0;

  const auto returns = [&](const ExportedLens& written) { parse_lens(written.text, "x", {.glasses = &glasses}); };
  switch (work) {
    case 0: fuzz::done([&] { returns(format_zemax(lens, &glasses)); }); break;
    case 1: fuzz::done([&] { returns(format_codev(lens, &glasses)); }); break;
    case 2: fuzz::done([&] { returns(format_table(lens)); }); break;
    case 3: {
      for (const Finding& finding : lint(lens, glasses))
        fuzz::require(!finding.message.empty(), "a finding has a message");
      Prescription repaired = lens;
      repair(repaired);
      validate(repaired, "x");
      break;
    }
    case 4: fuzz::done([&] { validate(scale(lens, bytes.number(0.1, 10)), "x"); }); break;
    case 5: fuzz::done([&] { validate(reverse(lens), "x"); }); break;
    case 6: fuzz::done([&] { validate(configured(lens, bytes.number(0, 3)), "x"); }); break;
    default: {
      const std::string json = format_prescription(lens);
      const Prescription back = parse_prescription(json, "x");
      fuzz::require(back == lens, "JSON keeps a lens");
      fuzz::require(format_prescription(back) == json, "JSON round-trips to the same bytes");
    }
  }
  return 0;
}
