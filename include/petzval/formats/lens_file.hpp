// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

class GlassCatalogue;

/// Options of read_lens().
struct ReadOptions {
  /// True: every assumption is an error; the first of Prescription::imported->warnings is thrown.
  bool strict = false;
  /// Indices of glasses that a file only names; nullptr: glass_tables(), loaded if a name occurs.
  const GlassCatalogue* glasses = nullptr;
  /// The lens to read: its key or unique name in a lentil database, the number of its table (from 1) on a page with
  /// several tables. Other formats ignore it.
  /// Prescription::imported->entry is the key of the lens that was read.
  std::string entry{};
};

/// Reads a lens from a file. The content of the file determines its format:
///
///     petzval-lens 1        the library's own JSON (io/json.hpp), read without assumptions
///     zemax                 .zmx, sequential
///     codev                 .seq
///     oslo                  .len
///     opticalbench          the tables of Photons to Photos, .txt
///     flaresim, crayg       .lens, .fx
///     patent page           a printed page with a table of surfaces, aspheric data and positions (data/README.md)
///     table                 rows of numbers, with or without headings: from renderers, patents, CSV (data/README.md)
///     lentil, optiland, deeplens, lenshh  JSON (lenshh: .lhlt); from a lentil database, the lens of ReadOptions::entry
///
/// Text may be UTF-8, UTF-16 or Latin-1, with any line ends. Lengths become millimetres. Each command of the file is
/// applied, or listed with its line in Prescription::imported->warnings, or the file is refused: a lens never differs
/// from its file without a warning. Commands that do not change the lens (merit functions, tolerances, colours,
/// windows) are skipped. A declared aperture limits the beam, and so does the rim of the stop: the smaller size is
/// used, in each configuration. Solves of a .zmx have the values stated in the file. Surfaces without a clear aperture
/// get the aperture of with_apertures().
///
/// A named glass has the n_d and V_d of its formula. If a glass of another catalogue or name is substituted, a warning
/// names both. If a glass has no index at the d line (germanium), reference_wavelength_nm is the primary wavelength.
///
/// Time is proportional to the size of the file; tests/README.md lists the memory for the largest inputs.
///
/// @param file     the file, at most largest_file_bytes
/// @param options  strictness, glasses and entry
/// @throws Error   with file, line (in JSON also column), value and rule; for files of other programs, with their kind
PETZVAL_API Prescription read_lens(const std::filesystem::path& file, const ReadOptions& options = {});

/// Reads a lens from memory, like read_lens(). `where` is the name of the source in messages.
PETZVAL_API Prescription parse_lens(std::string bytes, const std::string& where, const ReadOptions& options = {});

/// Reads the lens of a source with all its configurations, or copies its prescription. `glasses` is as in ReadOptions.
PETZVAL_API Prescription read_lens(const LensSource& source, const GlassCatalogue* glasses = nullptr);
/// The configuration that a source names; nullopt: no name, the first. lens: of read_lens().
PETZVAL_API std::optional<ConfigurationChoice> configuration_of(const LensSource& source, const Prescription& lens);
/// Reads and compiles the lens of a set-up. glasses: used instead of its own; nullptr: its own.
PETZVAL_API Lens compile(const CameraSetup& setup, const GlassCatalogue* glasses = nullptr);
/// Reads and compiles the lens of a set-up, and makes its camera.
PETZVAL_API Camera camera(const CameraSetup& setup);

/// A lens in the format of another program, with the data that the format cannot express.
struct ExportedLens {
  std::string text;
  std::vector<ImportWarning> losses;  ///< command: the lost data ("aspheric", "vd", ...); line: 0
};

/// Formats a lens as the table of a renderer: radius, thickness, n_d (0 at the stop) and diameter, in mm.
///
/// The table has one index for all wavelengths, spheres only, and one stop. A thickness of 0 behind the first glass or
/// the last surface is written as 1e-9 mm. This and the other formats mark the surface that limits the beam if no stop
/// is marked, and write blanks for control characters in texts.
///
/// @param prescription  the lens
/// @param glasses       indices of media without a stated index, as in ReadOptions
/// @throws Error        if the table would describe another lens: for mirrors, cylinders, conics, aspheres, a closed
///                      stop, a stop inside glass, and a medium other than air in front of the lens
PETZVAL_API ExportedLens format_table(const Prescription& prescription, const GlassCatalogue* glasses = nullptr);
/// Formats a lens as a .zmx file of sequential Zemax, in millimetres.
///
/// Glasses of the tables keep their names, with an offset if n_d differs from the formula and from the printed table.
/// Other media become models with n_d and V_d. Indices stated at another line are converted to the d line, as in
/// format_codev().
///
/// @throws Error for cylinders curved along x, aspheric cylinders and a closed stop
PETZVAL_API ExportedLens format_zemax(const Prescription& prescription, const GlassCatalogue* glasses = nullptr);
/// Formats a lens as a .seq file of CODE V, in millimetres.
///
/// Glasses of the tables keep their names (BK7_SCHOTT) if n_d agrees; other media become private glasses with indices
/// at C, d and F.
///
/// @throws Error for cylinders curved along x, and for aspheric terms of odd order, of order 2 and above order 20
PETZVAL_API ExportedLens format_codev(const Prescription& prescription, const GlassCatalogue* glasses = nullptr);

/// The glasses of a file, with warnings about assumptions and omissions.
struct GlassFile {
  std::vector<Glass> glasses;
  std::vector<ImportWarning> warnings;
};

/// Reads glasses from a file. The content of the file determines its format:
///
/// - a Zemax catalogue (.agf), in UTF-16, UTF-8 or Latin-1, with or without text before the first glass. The name of
///   the catalogue is the file name in lower case, without its extension. All thirteen dispersion formulas are
///   supported. Formula 4 exists in two forms; the form that gives the printed n_d is used. Internal transmittances
///   become Glass::absorption; 0 is read as 0.0005, so that the absorption is a lower bound. Data on temperature and
///   mechanics are skipped with a warning.
/// - a page of refractiveindex.info (YAML): formulas 1, 2, 3, 4, 5 and 7, tables of n, and tables of n and k at
///   wavelengths with k up to 0.01. Tables of k become Glass::absorption. The name of the glass is the file name, its
///   catalogue "rii".
/// - a table of this library (CSV, data/README.md).
///
/// Each glass keeps the printed n_d and V_d. A warning names each glass with a formula that differs from these by more
/// than 1e-4 in n_d or 0.2 in V_d. A glass is left out with a warning if its formula is unknown or gives no real index.
/// At most 1,000 warnings are recorded.
///
///     const auto file = petzval::read_glasses("glasses/schott.agf");
///     const auto glasses = petzval::with_glasses(petzval::glass_tables(), file.glasses);
///
/// @throws Error with file and line if the file cannot be read, has another format or is incomplete; for a number that
///               is invalid or not finite; if no glass is left
PETZVAL_API GlassFile read_glasses(const std::filesystem::path& file);

/// The glasses of a source: its own, or the tables after its files, which are searched first. files: gets the files.
PETZVAL_API GlassCatalogue glasses_of(const LensSource& source, std::vector<GlassFile>* files = nullptr);

}  // namespace petzval
