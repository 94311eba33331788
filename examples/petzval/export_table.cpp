// SPDX-License-Identifier: Apache-2.0
#include "export_table.hpp"

#include <bit>
#include <cstdint>
#include <sstream>
#include <string_view>

#include "petzval/core/error.hpp"
#include "petzval/petzval_camera.h"
#include "support/files.hpp"
#include "support/text.hpp"

namespace commands {
namespace {

/// The names of the positions 0 to PZ_HEAD - 1, as in petzval_camera.h (tests/hosts/camera_table_test.py compares
/// them).
constexpr std::string_view positions =
    "format size rays wavelength_count primary wavelengths shortest longest t_scale t_offset numbers powers "
    "film_z pupil_z film_x film_y film_width film_height margin columns rows front_z front_curvature front_first "
    "surface_count surfaces mirrors edges blades iris_area iris reach rows_per_mm half_widths "
    "film_nodes film_node_size film_polygon_size film_cells_1 film_cells_2 film_cells_3 "
    "terms degree domain_film domain_shift_x domain_radius_x domain_shift_y domain_radius_y reference_z "
    "centre_z steepest front_half widest balls "
    "scene_nodes scene_node_size scene_polygon_size scene_cells_1 scene_cells_2 scene_cells_3";

/// A float with nine digits, which is read back as the same float.
std::string text_of(float value) {
  std::string text = examples::number(static_cast<double>(value), 9);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string as_c(const std::vector<float>& table, const std::string& title) {
  std::string text =
      "/* " + examples::comment_text(title) + ". For petzval_camera.h, format " + std::to_string(PZ_FORMAT) + ". */\n";
  text += "#ifndef PETZVAL_TABLE_NAME\n#define PETZVAL_TABLE_NAME petzval_table\n#endif\n";
  text += "static const float PETZVAL_TABLE_NAME[" + std::to_string(table.size()) + "] = {\n";
  std::string row;
  for (const float value : table) {
    const std::string number = text_of(value) + "f,";
    if (row.size() + number.size() > 118) text += row + '\n', row.clear();
    row += (row.empty() ? "  " : " ") + number;
  }
  return text + row + "\n};\n#undef PETZVAL_TABLE_NAME\n";
}

std::string as_bytes(const std::vector<float>& table) {
  std::string bytes;
  for (const float value : table) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xff);
  }
  return bytes;
}

std::string as_json(const std::vector<float>& table, const std::string& title) {
  examples::Json names = examples::Json::object();
  std::istringstream words{std::string(positions)};
  std::string name;
  for (std::size_t i = 0; words >> name; ++i) names[name] = i;
  std::string text =
      "{\"title\": " + examples::Json(title).dump() + ",\n\"positions\": " + names.dump() + ",\n\"table\": [";
  for (std::size_t i = 0; i < table.size(); ++i) text += (i == 0 ? "" : i % 16 == 0 ? ",\n" : ", ") + text_of(table[i]);
  return text + "]}\n";
}

}  // namespace

void check_table_name(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".h" || ending == ".bin" || ending == ".json") return;
  throw petzval::Error("--camera: " + file.string() + " ends in \"" + ending + "\"; must end in .h, .bin or .json");
}

void write_camera_table(const std::vector<float>& table, const std::string& title, const std::filesystem::path& file) {
  check_table_name(file);
  const std::string ending = file.extension().string();
  examples::write_text(file, ending == ".h"     ? as_c(table, title)
                             : ending == ".bin" ? as_bytes(table)
                                                : as_json(table, title));
}

}  // namespace commands
