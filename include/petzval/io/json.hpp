// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

/// Reads a lens from a JSON file of the format "petzval-lens 1" (keys: data/README.md).
///
/// Surfaces without a clear aperture get the aperture of with_apertures(). read_lens() of petzval::formats reads this
/// and other formats.
///
/// @throws Error if the file cannot be read, or if parse_prescription() throws
PETZVAL_API Prescription read_prescription(const std::filesystem::path& file);

/// Reads a lens from JSON in memory. Missing clear apertures stay absent.
///
/// Time is proportional to the size of the text, which is at most 16 MiB; memory is at most 32 times its size.
///
/// @param json   the text
/// @param where  name of the source, for messages
/// @throws Error with source, line, column, surface (from 0), key, value and rule: for unknown and duplicate keys,
///               comments, NaN, numbers outside the range of double, brackets nested too deeply, lists of more than
///               10,000 entries, and lenses that validate() refuses
PETZVAL_API Prescription parse_prescription(std::string_view json, const std::string& where);

/// Formats a lens as JSON, with one surface per line.
///
/// Numbers are the shortest decimals that read back exactly. Reading and formatting the text again gives the same
/// bytes.
PETZVAL_API std::string format_prescription(const Prescription& prescription);

/// Writes the result of format_prescription() to a file.
///
/// @throws Error if write_file() throws
PETZVAL_API void write_prescription(const Prescription& prescription, const std::filesystem::path& file);

/// A lens by its file, as data, or as a thin lens, and the glasses and wavelengths it is compiled for.
struct LensSource {
  std::string file = {};                          ///< a file of read_lens(), or the name of a shipped lens
  std::optional<Prescription> prescription = {};  ///< used instead of `file`
  double thin_mm = 0;  ///< focal length of thin_elements(), used instead of `file`; needs CameraSetup::f_number
  /// A configuration by its name or its number from 0; empty: the first. If the file holds several lenses, the first
  /// word names the lens: "2004", "2004/long".
  std::string configuration = {};
  std::vector<std::string> glass_files = {};  ///< read_glasses(), searched before the tables of petzval
  std::vector<Glass> glasses = {};            ///< used instead of all tables; empty: the tables
  bool match_glasses = false;                 ///< media without a name get the nearest glass
  bool require_glasses = false;               ///< MissingGlass::error instead of the n_d/V_d model
  bool clamp_wavelengths = false;             ///< as in CompileOptions
  std::vector<double> wavelengths_nm = {};    ///< empty: the reference wavelength of the lens
  std::optional<double> primary_nm = {};      ///< as in CompileOptions
};

/// A camera as a plain value. The same set-up makes the same camera.
///
///     const CameraSetup setup{.lens = {.file = "double_gauss_52mm_f1.8"}, .f_number = 2.8, .focus_mm = 3000};
///     const Camera again = camera(camera_setup(to_json(setup), "setup"));  // formats/lens_file.hpp
struct CameraSetup {
  LensSource lens = {};
  std::optional<double> f_number = {};  ///< for with_f_number(); nullopt: wide open
  Iris iris = {};
  std::optional<Coating> coating = {};  ///< coating of all surfaces to air; nullopt: the coatings of the lens
  std::optional<double> focus_mm = {};  ///< for with_focus(); nullopt: as the lens states
  FocusOptions focus = {};
  Film film = {};
  CameraOptions camera = {};  ///< without its focal surface, which focal_points state
  /// Picture of camera.bokeh.weight_map, which the program reads (read_iris_map()); empty: no map.
  std::string iris_map = {};
  std::vector<FocalPoint> focal_points = {};  ///< points of the focal surface; empty: no surface
  FocalSurfaceOptions focal_surface = {};
};

/// Formats a set-up as JSON, "petzval-camera 2", with the names of the members as keys, without threads. Infinity is
/// null. camera_setup() reads the same values back, to the bit.
///
/// @throws Error if camera.focal_surface is set, or camera.bokeh.weight_map has values without iris_map
PETZVAL_API std::string to_json(const CameraSetup& setup);

/// Reads a set-up from the JSON of to_json(), or from a report: an object with a set-up as its key "setup". Keys that
/// are missing have the default values of the members.
///
/// @param where  name of the source, for messages
/// @throws Error with source, line, column, key, value and rule: for unknown keys and values out of range, unless
///               "format" and one lens are given, if parse_prescription() throws
PETZVAL_API CameraSetup camera_setup(std::string_view json, const std::string& where);

/// The file of a lens: `name` itself, or the file of the shipped lens of this name; nullopt if neither exists.
PETZVAL_API std::optional<std::filesystem::path> find_lens(const std::string& name);
/// "irradiance", "unity_on_axis" or "unity_at_each_wavelength".
PETZVAL_API std::string_view name(Normalisation normalisation) noexcept;

/// A compiled lens with the coating, the iris, the f-number and the focus of a set-up, and the camera with this lens.
///
/// @throws Error as with_coating(), with_iris(), with_f_number(), with_focus(), FocalSurface and Camera; if an iris
///               map is not read
PETZVAL_API Lens prepared(const CameraSetup& setup, const Lens& compiled);
PETZVAL_API Camera camera(const CameraSetup& setup, const Lens& prepared_lens);

}  // namespace petzval
