// SPDX-License-Identifier: Apache-2.0
// Glass files of every format: an index is finite or refused.
#include "petzval/formats/lens_file.hpp"

#include "laws.hpp"
#include "scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace petzval;
  static const fuzz::ScratchFile file(".glass");
  fuzz::done([&] {
    const GlassFile read = read_glasses(file.holding({reinterpret_cast<const char*>(data), size}));
    fuzz::require(!read.glasses.empty(), "a glass file without a glass is refused");
    for (const Glass& glass : read.glasses) {
      for (const double nm : {365.0, 486.1, 587.6, 700.0, 2000.0}) {
        fuzz::done([&] { fuzz::require(refractive_index(glass, nm) > 0, "an index is positive"); });
      }
    }
    const GlassCatalogue catalogue = with_glasses({}, read.glasses);
    const Glass& first = read.glasses.front();
    fuzz::require(catalogue.find(first.name, first.catalogue) != nullptr, "a catalogue has the glasses it was given");
  });
  return 0;
}
