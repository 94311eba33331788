// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "../data_lenses.hpp"
#include "bytes.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval::fuzz {

/// A random surface of any kind, mostly with plausible numbers.
inline SurfaceRow wild_row(Bytes& bytes, bool in_glass) {
  SurfaceRow row;
  const int kind = bytes.byte();
  row.radius = kind % 8 == 0 ? 0 : bytes.number(-120, 120);
  row.thickness = bytes.number(0, in_glass ? 12 : 30);
  if (!in_glass) row.medium.nd = bytes.number(1.3, 2.1);
  if (kind % 16 != 1) row.semi_diameter = bytes.number(0.5, 25);
  row.stop = kind % 32 == 2;
  if (kind < 192) return row;

  const int rare = bytes.byte();
  if (rare & 1) row.conic = bytes.number(-4, 2);
  if (rare & 2) {
    for (int i = bytes.count(1, 4); i > 0; --i) {
      const int order = bytes.count(2, 20);
      row.aspheric.push_back({order, bytes.number(-2, 2) * std::pow(20.0, -order)});
    }
  }
  if (rare & 4) row.obscuration_semi_diameter = bytes.number(0, 8);
  if (rare & 8) row.curved_in = rare & 16 ? Section::x : Section::y;
  if (rare & 32) row.mirror = true;
  if (rare & 64) row.medium.vd = bytes.number(20, 95);
  if (rare & 128) row.thickness = -row.thickness;
  return row;
}

/// A random lens of 1 to 40 surfaces.
inline Prescription invented_lens(Bytes& bytes) {
  Prescription p;
  p.name = "invented";
  const int most = bytes.count(1, 8) == 8 ? 40 : 6, surfaces = bytes.count(1, most);
  bool in_glass = false;
  for (int i = 0; i < surfaces; ++i) {
    SurfaceRow row = wild_row(bytes, in_glass);
    if (row.mirror && !p.surfaces.empty()) row.medium = p.surfaces.back().medium;
    if (row.mirror && p.surfaces.empty()) row.medium = {};
    if (!row.mirror) in_glass = !row.medium.is_air();
    p.surfaces.push_back(row);
  }
  p.surfaces.back().thickness = bytes.number(1, 200);
  return p;
}

/// A lens of data/lenses with up to four changed numbers.
inline Prescription damaged_lens(Bytes& bytes) {
  static const std::vector<Prescription> lenses = testing::data_prescriptions();
  Prescription p = lenses[bytes.byte() % lenses.size()];
  for (int i = bytes.count(0, 4); i > 0; --i) {
    SurfaceRow& row = p.surfaces[bytes.byte() % p.surfaces.size()];
    switch (bytes.count(0, 9)) {
      case 0: row.radius = bytes.number(-200, 200); break;
      case 1: row.thickness = bytes.number(-5, 50); break;
      case 2: row.semi_diameter = bytes.number(0, 50); break;
      case 3: row.medium.nd = bytes.number(1, 2.5); break;
      case 4: row.conic = bytes.number(-4, 4); break;
      case 5: row.aspheric = {{bytes.count(2, 12), bytes.number(-1e-4, 1e-4)}}; break;
      case 6: row.stop = !row.stop; break;
      case 7: row.obscuration_semi_diameter = bytes.number(0, 20); break;
      case 8: row.semi_diameter.reset(); break;
      default: row.curved_in = Section::x; break;
    }
  }
  return p;
}

inline Prescription wild_prescription(Bytes& bytes) {
  return bytes.one_in(2) ? damaged_lens(bytes) : invented_lens(bytes);
}

/// The lens at one or three wavelengths, sometimes with blades. Throws Error if the lens cannot be compiled.
inline Lens wild_lens(Bytes& bytes) {
  const Prescription p = wild_prescription(bytes);
  constexpr std::array several{d_line_nm, 486.1327, 656.2725};
  const bool coloured = bytes.one_in(4), bladed = bytes.one_in(8);
  const Lens lens = compile(p, std::span(several).first(coloured ? 3 : 1), {.missing_glass = MissingGlass::abbe});
  if (!bladed) return lens;
  return with_iris(
      lens, {.blades = bytes.count(0, 21), .roundness = bytes.number(-1, 1), .rotation_rad = bytes.number(-4, 4)});
}

}  // namespace petzval::fuzz
