// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene_checksum.hpp"

#include <type_traits>

#include "petzval/core/files.hpp"

namespace renderer {
namespace {

/// All visible properties as bytes: numbers one by one, lists after their length.
class Bytes {
 public:
  template <class T>
    requires std::is_arithmetic_v<T>
  void add(T x) { text_.append(reinterpret_cast<const char*>(&x), sizeof x); }
  void add(const glm::vec2& v) { add(v.x), add(v.y); }
  void add(const glm::vec3& v) { add(v.x), add(v.y), add(v.z); }
  void add(const glm::dvec3& v) { add(v.x), add(v.y), add(v.z); }
  void add(const std::array<std::uint32_t, 3>& t) { add(t[0]), add(t[1]), add(t[2]); }
  template <class T>
  void add(const std::vector<T>& list) {
    add(list.size());
    for (const T& item : list) add(item);
  }
  void add(const std::shared_ptr<const petzval::RgbImage>& image) {
    add(image != nullptr);
    if (image) add(image->width), add(image->height), add(image->pixels);
  }
  void add(const Albedo& a) {
    add(a.colour), add(a.checker.has_value());
    if (a.checker) add(a.checker->other), add(a.checker->size_mm);
    add(a.image);
  }
  void add(const Diffuse& m) { add(m.albedo); }
  void add(const Mirror& m) { add(m.reflectance); }
  void add(const Rough& m) { add(m.reflectance), add(m.roughness); }
  void add(const Glass& m) { add(m.ior), add(m.roughness); }
  void add(const Varnish& m) { add(m.albedo), add(m.roughness); }
  void add(const Sphere& s) { add(s.centre), add(s.radius); }
  void add(const Quad& q) { add(q.corner), add(q.edge_u), add(q.edge_v); }
  void add(const Mesh& m) { add(m.positions), add(m.triangles), add(m.normals), add(m.uvs); }
  template <class... T>
  void add(const std::variant<T...>& one_of) {
    add(one_of.index());
    std::visit([this](const auto& held) { this->add(held); }, one_of);
  }
  void add(const Object& o) { add(o.shape), add(o.material), add(o.emission); }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

std::string checksum(const SceneDescription& scene) {
  Bytes bytes;
  bytes.add(scene.objects);
  bytes.add(scene.sky.colour), bytes.add(scene.sky.image);
  bytes.add(scene.pose.position), bytes.add(scene.pose.look_at), bytes.add(scene.pose.up);
  return petzval::checksum(bytes.text());
}

}  // namespace renderer
