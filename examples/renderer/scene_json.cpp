// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene_json.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "petzval/core/error.hpp"
#include "renderer/obj_mesh.hpp"
#include "support/cli.hpp"
#include "support/json_input.hpp"

namespace renderer {
namespace {

using examples::Json;
using examples::Range;

// Embree misses larger objects, and float overflows at larger radiances.
constexpr Range finite{-1e9, 1e9, "a number from -1e9 to 1e9"}, positive{1e-9, 1e9, "a number from 1e-9 to 1e9"},
    not_negative{0, 1e12, "a number from 0 to 1e12"}, unit_range{0, 1, "a number from 0 to 1"},
    rough{0.01, 1, "a number from 0.01 to 1"}, index_of_glass{1.001, 4, "a number from 1.001 to 4"};

std::shared_ptr<const petzval::RgbImage> read_image(const std::string& where, const std::filesystem::path& file,
                                                    float most, const char* rule) {
  const std::string ending = file.extension().string();
  if (ending != ".exr" && ending != ".EXR") examples::refuse(where, file.string(), "an EXR file (.exr)");
  auto image = std::make_shared<petzval::RgbImage>();
  try {
    *image = petzval::read_exr(file);
  } catch (const petzval::Error& error) {
    throw petzval::Error(where + ": " + error.what());
  }
  const auto wrong =
      std::find_if_not(image->pixels.begin(), image->pixels.end(), [&](float v) { return v >= 0 && v <= most; });
  if (wrong != image->pixels.end()) {
    const auto pixel = (wrong - image->pixels.begin()) / 3;
    throw petzval::Error(where + ": " + file.string() + ": pixel (" + std::to_string(pixel % image->width) + ", " +
                         std::to_string(pixel / image->width) + ") = " + std::to_string(*wrong) + "; must be " + rule);
  }
  return image;
}

/// A JSON value, its path for messages, and the folder of its file.
struct Entry : examples::JsonEntry {
  const std::filesystem::path& folder;

  /// The value of an existing key.
  Entry at(const std::string& key) const { return {{where + "." + key, json.at(key)}, folder}; }
  Entry at(std::size_t i) const { return {{where + "[" + std::to_string(i) + "]", json.at(i)}, folder}; }

  void read(const char* key, float& to, const Range& range) const {
    if (has(key)) to = static_cast<float>(at(key).number(range));
  }
  template <class Vector>
  Vector three(const Range& range) const {
    const auto values = list(3, range, std::string("a list of three values, each ") + range.words);
    return {values[0], values[1], values[2]};
  }
  template <class Vector>
  void read(const char* key, Vector& to, const Range& range) const {
    if (has(key)) to = at(key).template three<Vector>(range);
  }

  std::filesystem::path path() const {
    if (!json.is_string()) refuse("a file name");
    return folder / json.get<std::string>();
  }
};

/// The key of this list that an entry has; empty if the entry has no such key. Throws if the entry has several of the
/// keys.
std::string_view one_of(const Entry& entry, std::initializer_list<const char*> keys, const std::string& words) {
  std::string_view found;
  for (const char* const key : keys) {
    if (!entry.has(key)) continue;
    if (!found.empty()) {
      throw petzval::Error(entry.where + ": has both " + std::string(found) + " and " + key +
                           "; must have only one of " + words);
    }
    found = key;
  }
  return found;
}

Albedo albedo(const Entry& entry) {
  Albedo result;
  if (!entry.json.is_object()) {
    result.colour = entry.three<Rgb>(unit_range);
    return result;
  }
  entry.keys({"checker", "size_mm", "image"}, "checker and size_mm, or image");
  const std::string_view kind = one_of(entry, {"checker", "image"}, "them");
  if (kind.empty()) entry.refuse("a list of three numbers, or an object with checker or image");
  if (kind == "image") {
    if (entry.has("size_mm"))
      throw petzval::Error(entry.where + ": size_mm must not be used with image, only with checker");
    result.image = read_image(entry.at("image").where, entry.at("image").path(), 1, "an albedo from 0 to 1");
    return result;
  }
  const Entry checker = entry.at("checker");
  if (!checker.json.is_array() || checker.json.size() != 2) checker.refuse("a list of two colours");
  result.colour = checker.at(std::size_t{0}).three<Rgb>(unit_range);
  result.checker = Albedo::Checker{.other = checker.at(std::size_t{1}).three<Rgb>(unit_range)};
  entry.read("size_mm", result.checker->size_mm, positive);
  return result;
}

Material material(const Entry& entry) {
  const std::string words = "diffuse, mirror, rough, glass or varnish";
  entry.keys({"diffuse", "mirror", "rough", "glass", "varnish"}, words);
  const std::string_view kind = one_of(entry, {"diffuse", "mirror", "rough", "glass", "varnish"}, words);
  if (kind.empty()) entry.refuse(words);
  const Entry of = entry.at(std::string(kind));
  if (kind == "diffuse") return Diffuse{albedo(of)};
  if (kind == "mirror") return Mirror{of.three<Rgb>(unit_range)};
  if (kind == "rough") {
    Rough result;
    of.keys({"reflectance", "roughness"});
    of.read("reflectance", result.reflectance, unit_range);
    of.read("roughness", result.roughness, rough);
    return result;
  }
  if (kind == "glass") {
    Glass result;
    of.keys({"ior", "roughness"});
    of.read("ior", result.ior, index_of_glass);
    of.read("roughness", result.roughness, unit_range);
    if (result.roughness > 0)
      of.read("roughness", result.roughness, {rough.least, rough.most, "a number from 0.01 to 1, or 0"});
    return result;
  }
  Varnish result;
  of.keys({"diffuse", "roughness"});
  if (of.has("diffuse")) result.albedo = albedo(of.at("diffuse"));
  of.read("roughness", result.roughness, rough);
  return result;
}

Shape shape(const Entry& entry) {
  const std::string words = "sphere, quad and obj";
  const std::string_view kind = one_of(entry, {"sphere", "quad", "obj"}, words);
  if (kind.empty()) throw petzval::Error(entry.where + ": has no shape; must have one of " + words);
  const Entry of = entry.at(std::string(kind));
  if (kind == "sphere") {
    Sphere result;
    of.keys({"centre_mm", "radius_mm"});
    of.read("centre_mm", result.centre, finite);
    of.read("radius_mm", result.radius, positive);
    return result;
  }
  if (kind == "quad") {
    Quad result;
    of.keys({"corner_mm", "edge_u_mm", "edge_v_mm"});
    of.read("corner_mm", result.corner, finite);
    of.read("edge_u_mm", result.edge_u, finite);
    of.read("edge_v_mm", result.edge_v, finite);
    const glm::dvec3 u = result.edge_u, v = result.edge_v;
    if (!(glm::length(glm::cross(u, v)) > 1e-6 * glm::length(u) * glm::length(v))) {
      of.refuse("a quad whose edges span an area");
    }
    return result;
  }
  try {
    return read_obj(of.path());
  } catch (const petzval::Error& error) {
    if (!of.json.is_string()) throw;
    throw petzval::Error(of.where + ": " + error.what());
  }
}

const Albedo* albedo_of(const Material& material) {
  if (const auto* const diffuse = std::get_if<Diffuse>(&material)) return &diffuse->albedo;
  if (const auto* const varnish = std::get_if<Varnish>(&material)) return &varnish->albedo;
  return nullptr;
}

Object object(const Entry& entry) {
  entry.keys({"sphere", "quad", "obj", "material", "emission"}, "sphere, quad or obj, and material and emission");
  Object result{entry.where, shape(entry)};
  if (entry.has("material")) result.material = material(entry.at("material"));
  entry.read("emission", result.emission, not_negative);
  const auto* const mesh = std::get_if<Mesh>(&result.shape);
  const Albedo* const painted = albedo_of(result.material);
  if (mesh && mesh->uvs.empty() && painted && painted->image) {
    throw petzval::Error(entry.where +
                         ".obj: corners have no texture coordinates; must have them, because the material has an " +
                         "image");
  }
  return result;
}

Pose pose(const Entry& entry) {
  Pose result;
  entry.keys({"position_mm", "look_at_mm", "up"});
  entry.read("position_mm", result.position, finite);
  result.look_at = result.position + glm::dvec3{0, 0, -1};
  entry.read("look_at_mm", result.look_at, finite);
  entry.read("up", result.up, finite);
  const glm::dvec3 view_direction = result.look_at - result.position;
  const double apart = glm::length(view_direction), up = glm::length(result.up);
  if (!(apart > 1e-9 * glm::length(result.position))) {
    entry.refuse("a pose whose look_at_mm differs from position_mm");
  }
  if (!(glm::length(glm::cross(view_direction / apart, result.up)) > 1e-6 * up)) {
    entry.refuse("a pose whose up is not parallel to look_at_mm - position_mm");
  }
  return result;
}

}  // namespace

SceneDescription read_scene(const std::filesystem::path& file) {
  const Json document = examples::read_json(file);
  const std::filesystem::path folder = file.parent_path();
  const auto entry = [&](const char* key) { return Entry{{file.string() + ": " + key, document.at(key)}, folder}; };
  examples::JsonEntry{file.string(), document}.keys({"sky", "camera", "objects"});

  SceneDescription scene{.name = file.string()};
  if (document.contains("sky")) {
    const Entry sky = entry("sky");
    if (sky.json.is_string()) {
      scene.sky = {
          {1, 1, 1},
          read_image(sky.where, sky.path(), std::numeric_limits<float>::max(), "a finite radiance, 0 or more")};
    } else {
      scene.sky.colour = sky.three<Rgb>(not_negative);
    }
  }
  if (document.contains("camera")) scene.pose = pose(entry("camera"));
  if (document.contains("objects")) {
    const Entry objects = entry("objects");
    if (!objects.json.is_array()) objects.refuse("a list");
    for (std::size_t i = 0; i < objects.json.size(); ++i) scene.objects.push_back(object(objects.at(i)));
  }
  return scene;
}

}  // namespace renderer
