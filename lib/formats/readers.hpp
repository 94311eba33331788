// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "import.hpp"
#include "table_text.hpp"

namespace petzval::formats_detail {

/// A format of another program. Readers return data; complete() does the optics.
struct Format {
  std::string_view name;
  bool (*is)(std::string_view text);
  void (*read)(std::string_view text, Import& in);
};

/// A .seq has statements SO, S and SI.
bool is_codev(std::string_view text);
void read_codev(std::string_view text, Import& in);

/// A .fx of crayg begins with [Metadata].
bool is_crayg(std::string_view text);
void read_crayg(std::string_view text, Import& in);

/// JSON of DeepLens has surfaces with d_next.
bool is_deeplens(std::string_view text);
void read_deeplens(std::string_view text, Import& in);

/// A .lens of FlareSim has a line "surfaces:" between keys and rows.
bool is_flaresim(std::string_view text);
void read_flaresim(std::string_view text, Import& in);

/// A .lhlt has a FormatVersion and Surfaces.
bool is_lenshh(std::string_view text);
void read_lenshh(std::string_view text, Import& in);

/// JSON of lentil has "optical-elements-...".
bool is_lentil(std::string_view text);
void read_lentil(std::string_view text, Import& in);

/// A table of Photons to Photos has a section [lens data].
bool is_opticalbench(std::string_view text);
void read_opticalbench(std::string_view text, Import& in);

/// JSON of optiland has a surface_group.
bool is_optiland(std::string_view text);
void read_optiland(std::string_view text, Import& in);

/// A lens file of OSLO begins with LEN NEW, a name, a number and a count of surfaces.
bool is_oslo(std::string_view text);
void read_oslo(std::string_view text, Import& in);

/// A page of a patent has a table of surfaces, and sections, names of radii or short rows.
bool is_page(std::string_view text);
void read_page(std::string_view text, Import& in);

/// A table has a row of two numbers, or of a plane and a number, among its first lines, behind a label or a mark.
bool is_table(std::string_view text);
void read_table(std::string_view text, Import& in);
/// Reads lines that are divided into cells: a head, and rows.
void read_table(std::vector<TableLine> lines, Import& in);

/// A .zmx has surfaces "SURF n" and one of the words that begin such files.
bool is_zemax(std::string_view text);
void read_zemax(std::string_view text, Import& in);

}  // namespace petzval::formats_detail
