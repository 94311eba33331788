// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

class GlassCatalogue;

struct ReadOptions {
  /// Every assumption is an error: the first entry of Prescription::imported->warnings is thrown.
  bool strict = false;
  /// Indices of glasses that a file only names. Null: glass_tables(), loaded if a name occurs.
  const GlassCatalogue* glasses = nullptr;
  /// The lens to read of a file that holds several (a lentil database): its key, or its name if no other lens has the
  /// name. Not used by other files. Prescription::imported->entry names the lens that was read.
  std::string entry{};
};

/// Reads a lens from a file of any of these formats, which it knows by their content:
///
///     petzval-lens 1        the library's own JSON (lens_json.hpp); it has no assumptions
///     zemax                 .zmx, sequential
///     codev                 .seq
///     oslo                  .len
///     opticalbench          the tables of Photons to Photos, .txt
///     flaresim              .lens
///     table                 rows of numbers, with heads or without: renderers', patents', CSV (data/README.md)
///     lentil, optiland      their JSON; of a database of lentil, ReadOptions::entry
///
/// Text may be UTF-8, UTF-16 or Latin-1, with any line ends; lengths become millimetres. A command of the file is
/// honoured, or is named in Prescription::imported->warnings with its line, or the file is refused: never does a lens
/// come out that differs from the file without a word. What changes nothing of the lens (merit functions, tolerances,
/// colours, windows) is left out. A declared aperture launches the beam and the rim of the stop clips it: the size of
/// the stop, in each configuration, is the smaller one. Solves of a .zmx have the values that the file states. Surfaces
/// without a clear aperture get the aperture of with_apertures().
///
/// A glass that a file names has n_d and V_d of its formula. If a glass of another catalogue or name is taken, a
/// warning names both. If a glass has no index at the d line (germanium), reference_wavelength_nm is the primary
/// wavelength.
///
/// Throws Error that names file, line, value and rule (of JSON also the column), or the kind of a file that is no lens
/// or that only another program reads. A file has at most largest_file_bytes. Time is proportional to the size of the
/// file; tests/README.md has the memory of the largest inputs.
PETZVAL_API Prescription read_lens(const std::filesystem::path& file, const ReadOptions& options = {});

/// The same from memory. `where` is the name of the source in messages.
PETZVAL_API Prescription parse_lens(std::string bytes, const std::string& where, const ReadOptions& options = {});

/// A lens in the format of another program, and what that format cannot say.
struct WrittenLens {
  std::string text;
  std::vector<ImportWarning> losses;  ///< line: 0; command: what is lost ("aspheric", "vd", ...)
};

/// A renderer's table of four columns: radius, thickness, n_d (0 at the stop), diameter, in mm. It has one index for
/// all wavelengths, spheres only, and one stop. A thickness of 0 of the first glass or of the last surface is written
/// as 1e-9 mm. Throws Error for mirrors, cylinders, aspheres, a closed stop and a medium in front of the lens: without
/// them it would be another lens. This and the other formats mark the surface that limits the beam where no stop is
/// marked, and write blanks for the control characters of texts. glasses, for the indices of media that state none: as
/// in ReadOptions.
PETZVAL_API WrittenLens format_table(const Prescription& prescription, const GlassCatalogue* glasses = nullptr);
/// A .zmx of sequential Zemax, in millimetres. Glasses of the tables (ReadOptions) keep their names, with an offset if
/// n_d differs from the formula and from the printed table. Other media become models of n_d and V_d. Indices at
/// another line than d are restated there, as in a .seq. Throws Error for cylinders curved along x and for a closed
/// stop.
PETZVAL_API WrittenLens format_zemax(const Prescription& prescription, const GlassCatalogue* glasses = nullptr);
/// A .seq of CODE V, in millimetres. Glasses of the tables keep their names (BK7_SCHOTT) if the n_d is theirs; other
/// media become private glasses with indices at C, d and F. Throws Error for aspheric terms that it lacks: of odd
/// order, of order 2 and above 20.
PETZVAL_API WrittenLens format_codev(const Prescription& prescription, const GlassCatalogue* glasses = nullptr);

}  // namespace petzval
