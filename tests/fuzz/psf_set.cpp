// SPDX-License-Identifier: Apache-2.0
// Parts of PSF sets with changed entries: a kernel keeps every bit, or the part is refused.
#include "petzval/image/psf.hpp"

#include <string>
#include <utility>

#include "bytes.hpp"
#include "laws.hpp"

namespace {

using namespace petzval;

PsfKernel kernel_of(fuzz::Bytes& bytes) {
  PsfKernel kernel{.pixels = 3, .pixel_mm = bytes.number(0, 1)};
  for (int i = 0; i < 9; ++i) {
    kernel.light.push_back(static_cast<float>(bytes.between(0, 4)));
    kernel.hits_x.push_back(static_cast<float>(bytes.number(-1, 1)));
    kernel.hits_y.push_back(static_cast<float>(bytes.number(-1, 1)));
  }
  kernel.total = bytes.number(0, 1), kernel.throughput = bytes.number(0, 1), kernel.error = bytes.number(0, 1);
  kernel.rays = bytes.count(0, 100);
  kernel.anchor_mm = {bytes.number(-20, 20), bytes.number(-20, 20)};
  return kernel;
}

/// Changes an entry and updates the checksum, which fuzzers cannot guess.
void damage(ExrPart& part, fuzz::Bytes& bytes) {
  const auto some = [&](auto& map) { return std::next(map.begin(), bytes.byte() % static_cast<long>(map.size())); };
  switch (bytes.count(0, 7)) {
    case 0: part.channels.erase(some(part.channels)); break;
    case 1: part.channels.begin()->second.resize(static_cast<std::size_t>(bytes.count(0, 20))); break;
    case 2: part.numbers.erase(some(part.numbers)); break;
    case 3: some(part.numbers)->second = bytes.wild(); break;
    case 4: part.texts.erase(some(part.texts)); break;
    case 5: some(part.texts)->second += static_cast<char>(bytes.byte()); break;
    case 6: part.width = bytes.count(0, 5); break;
    default: part.channels.begin()->second[0] = static_cast<float>(bytes.wild()); break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  fuzz::done([&] {
    const PsfSetPoint point{bytes.number(0, 90), bytes.number(100, 1e4), bytes.number(400, 700), bytes.number(1, 22)};
    ExrPart part = to_exr_part(kernel_of(bytes), point);
    for (int i = bytes.count(0, 2); i > 0 && !part.channels.empty() && !part.channels.begin()->second.empty(); --i) {
      damage(part, bytes);
    }
    const auto [place, read] = from_exr_part(part);
    const ExrPart again = to_exr_part(read, place);
    fuzz::require(again.texts == part.texts, "a part round-trips with the same checksum");

    const PsfSet set({{place.field_deg}, {place.distance_mm}, {place.wavelength_nm}, {place.f_number}}, {read});
    fuzz::require(set.at(place).pixels == read.pixels, "a set has the kernel of its node");
  });
  return 0;
}
