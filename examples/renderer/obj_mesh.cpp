// SPDX-License-Identifier: Apache-2.0
#include "renderer/obj_mesh.hpp"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <string>
#include <string_view>
#include <tuple>

#include "petzval/core/error.hpp"
#include "support/files.hpp"

namespace renderer {
namespace {

using petzval::Error;

/// Removes and returns the first word of a line.
std::string_view next_word(std::string_view& line) {
  constexpr std::string_view blanks = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

/// Checks of numbers and indices. tinyobjloader reads invalid numbers as 0 and drops faces with invalid indices.
class Lines {
 public:
  Lines(const std::string& text, std::string where) : where_(std::move(where)) {
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      ++line_;
      check(std::string_view(text).substr(begin, end - begin));
      begin = end + 1;
    }
    if (faces_ == 0) throw Error(where_ + ": has no face; must have at least one triangle");
    for (std::size_t kind = 0; kind < 3; ++kind) {
      if (largest_[kind] <= counts_[kind]) continue;
      line_ = largest_at_[kind];
      refuse_index(kind, largest_[kind]);
    }
  }

 private:
  static constexpr std::array<const char*, 3> kinds{"vertex", "texture coordinate", "normal"};

  [[noreturn]] void refuse(const std::string& found, const std::string& rule) const {
    throw Error(where_ + ": line " + std::to_string(line_) + ": " + found + "; must be " + rule);
  }
  [[noreturn]] void refuse_index(std::size_t kind, long index) const {
    refuse(std::string(kinds[kind]) + " " + std::to_string(index),
           counts_[kind] == 0 ? std::string("left out: the file has no such entry")
                              : "1 to " + std::to_string(counts_[kind]));
  }

  void check(std::string_view line) {
    const std::string_view keyword = next_word(line);
    if (keyword == "v") numbers(line, 3), ++counts_[0];
    if (keyword == "vt") numbers(line, 1), ++counts_[1];
    if (keyword == "vn") numbers(line, 3), ++counts_[2];
    if (keyword == "f") face(line), ++faces_;
  }

  void numbers(std::string_view line, int rule) const {
    int count = 0;
    for (std::string_view word; !(word = next_word(line)).empty() && word.front() != '#'; ++count) {
      const std::string_view digits = word.substr(word.front() == '+' ? 1 : 0);
      float value = 0;
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (error == std::errc::result_out_of_range && std::abs(std::strtod(std::string(word).c_str(), nullptr)) < 1) {
        continue;  // smaller than the smallest float: read as 0
      }
      if (error != std::errc() || end != digits.data() + digits.size() || !(std::abs(value) <= 1e9f)) {
        refuse('"' + std::string(word) + '"', "a finite number up to 1e9");
      }
    }
    if (count < rule) refuse(std::to_string(count) + " numbers", std::to_string(rule));
  }

  void face(std::string_view line) {
    int corners = 0;
    for (std::string_view word; !(word = next_word(line)).empty() && word.front() != '#'; ++corners) {
      std::string_view rest = word;
      for (std::size_t kind = 0; kind < 3; ++kind) {
        const std::string_view digits = rest.substr(0, rest.find('/'));
        if (!digits.empty() || kind == 0) index(kind, digits, word);
        if (digits.size() == rest.size()) break;
        rest.remove_prefix(digits.size() + 1);
      }
    }
    if (corners < 3) refuse("face with " + std::to_string(corners) + " corners", "3 or more");
  }

  void index(std::size_t kind, std::string_view digits, std::string_view word) {
    long value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size()) {
      refuse('"' + std::string(word) + '"', "indices such as 1, 1/2, 1//3 or 1/2/3");
    }
    if (value == 0 || value < -counts_[kind]) refuse_index(kind, value);
    if (value > largest_[kind]) largest_[kind] = value, largest_at_[kind] = line_;
  }

  std::string where_;
  long line_ = 0, faces_ = 0;
  std::array<long, 3> counts_{}, largest_{}, largest_at_{};
};

/// True if the triangle has no area: it is no wider than the rounding of its coordinates.
bool is_a_line(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  return !(glm::length(glm::cross(b - a, c - a)) > 1e-6 * longest * longest);
}

}  // namespace

Mesh read_obj(const std::filesystem::path& file) {
  const std::string text = examples::read_text(file);
  Lines(text, file.string());
  tinyobj::ObjReaderConfig config;
  config.vertex_color = false;
  tinyobj::ObjReader reader;
  if (!reader.ParseFromString(text, "", config)) {
    throw Error(file.string() + ": not a valid OBJ file: " + reader.Error());
  }
  const tinyobj::attrib_t& attributes = reader.GetAttrib();

  Mesh mesh;
  std::map<std::tuple<int, int, int, std::size_t>, std::uint32_t> known;
  bool any_normal = false, all_uvs = true;
  for (const tinyobj::shape_t& shape : reader.GetShapes()) {
    for (const tinyobj::index_t& corner : shape.mesh.indices) {
      any_normal = any_normal || corner.normal_index >= 0;
      all_uvs = all_uvs && corner.texcoord_index >= 0;
    }
  }
  std::size_t lines = 0, first_line = 0;
  for (const tinyobj::shape_t& shape : reader.GetShapes()) {
    for (std::size_t i = 0; i + 2 < shape.mesh.indices.size(); i += 3) {
      const auto at = [&](const std::vector<float>& values, int index, std::size_t size) {
        const std::size_t first = size * static_cast<std::size_t>(index);
        if (index < 0 || first + size > values.size()) {
          throw Error(file.string() + ": triangle " + std::to_string(mesh.triangles.size() + 1) + ": corner = " +
                      std::to_string(index + 1) + "; must be 1 to " + std::to_string(values.size() / size));
        }
        return &values[first];
      };
      std::array<glm::vec3, 3> triangle_corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const float* const p = at(attributes.vertices, shape.mesh.indices[i + k].vertex_index, 3);
        triangle_corners[k] = {p[0], p[1], p[2]};
      }
      const std::size_t number = mesh.triangles.size() + 1;
      if (is_a_line(triangle_corners[0], triangle_corners[1], triangle_corners[2]) && lines++ == 0) first_line = number;
      const glm::vec3 flat = glm::normalize(
          glm::cross(triangle_corners[1] - triangle_corners[0], triangle_corners[2] - triangle_corners[0]));

      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const tinyobj::index_t& corner = shape.mesh.indices[i + k];
        const bool has_normal = corner.normal_index >= 0, own_normal = any_normal && !has_normal;
        const auto [entry, is_new] = known.try_emplace(
            {corner.vertex_index, corner.normal_index, corner.texcoord_index, own_normal ? number : 0},
            static_cast<std::uint32_t>(mesh.positions.size()));
        triangle[k] = entry->second;
        if (!is_new) continue;
        mesh.positions.push_back(triangle_corners[k]);
        if (any_normal) {
          const float* const n = has_normal ? at(attributes.normals, corner.normal_index, 3) : &flat.x;
          mesh.normals.emplace_back(n[0], n[1], n[2]);
        }
        if (all_uvs) {
          const float* const t = at(attributes.texcoords, corner.texcoord_index, 2);
          mesh.uvs.emplace_back(t[0], t[1]);
        }
      }
      mesh.triangles.push_back(triangle);
    }
  }
  if (mesh.triangles.empty()) throw Error(file.string() + ": has no triangle; must have at least one");
  if (lines > 0) {
    throw Error(file.string() + ": " + std::to_string(lines) + " of " + std::to_string(mesh.triangles.size()) +
                " triangles have no area, first triangle " + std::to_string(first_line) + "; all must have an area");
  }
  for (glm::vec3& normal : mesh.normals) {
    if (!(glm::length(normal) > 0)) throw Error(file.string() + ": has a normal of length 0");
    normal = glm::normalize(normal);
  }
  return mesh;
}

}  // namespace renderer
