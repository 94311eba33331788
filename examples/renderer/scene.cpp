// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "petzval/core/error.hpp"
#include "renderer/embree.hpp"
#include "renderer/frame.hpp"
#include "renderer/luminance.hpp"
#include "renderer/sky_light.hpp"

namespace renderer {
namespace {

using std::numbers::pi;

constexpr float infinity = std::numeric_limits<float>::infinity();
/// Offset of ray origins from a surface, relative to the size of its coordinates: sixteen units in the last place.
constexpr float rounding = 1e-6f;

Mesh mesh_of(const Quad& q) {
  return {{q.corner, q.corner + q.edge_u, q.corner + q.edge_u + q.edge_v, q.corner + q.edge_v},
          {{0, 1, 2}, {0, 2, 3}},
          {},
          {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
}

float largest(const glm::vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// An object prepared for Embree and for light sampling.
struct Body {
  Mesh mesh;                 ///< also for a quad; empty for a sphere
  float reach = 0;           ///< SurfacePoint::reach of its points
  std::vector<double> ends;  ///< cumulative areas of the triangles
  double area = 0;           ///< area of the whole sphere or of all triangles, mm^2
  double lamp_fraction = 0;  ///< probability to be sampled as a lamp

  std::array<glm::vec3, 3> corners(std::size_t triangle) const {
    const auto& t = mesh.triangles[triangle];
    return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  }
};

SurfacePoint point_on(const Object& object, const Body& body, std::size_t triangle, float u, float v) {
  const auto [a, b, c] = body.corners(triangle);
  const float w = 1 - u - v;
  SurfacePoint result{w * a + u * b + v * c, glm::normalize(glm::cross(b - a, c - a)), {}, {u, v}, &object, body.reach};
  result.shading = result.normal;
  const auto& t = body.mesh.triangles[triangle];
  if (!body.mesh.normals.empty()) {
    const auto& n = body.mesh.normals;
    const glm::vec3 mean = w * n[t[0]] + u * n[t[1]] + v * n[t[2]];
    const float length = glm::length(mean);
    if (length > 0 && glm::dot(mean, result.normal) > 0) result.shading = mean / length;
  }
  if (!body.mesh.uvs.empty()) {
    result.uv = w * body.mesh.uvs[t[0]] + u * body.mesh.uvs[t[1]] + v * body.mesh.uvs[t[2]];
  }
  return result;
}

SurfacePoint point_on(const Object& object, const Body& body, const Sphere& sphere, const glm::vec3& normal) {
  const glm::vec2 uv{0.5f + std::atan2(normal.x, normal.z) / static_cast<float>(2 * pi),
                     1 - std::acos(std::clamp(normal.y, -1.0f, 1.0f)) / static_cast<float>(pi)};
  return {sphere.centre + sphere.radius * normal, normal, normal, uv, &object, body.reach};
}

}  // namespace

struct Scene::Data {
  SceneDescription description;
  SkyLight sky;
  EmbreeDevice device;
  EmbreeScene scene;
  std::vector<Body> bodies;
  std::vector<double> lamp_ends;  ///< cumulative lamp_share of the objects; the rest belongs to the sky
  double sky_fraction = 0;
  glm::vec3 centre{0, 0, 0};  ///< centre of the bounding sphere of all objects
  float radius = 1;

  explicit Data(SceneDescription d) : description(std::move(d)), sky(description.sky) {}

  const Body& body(const Object& object) const {
    return bodies[static_cast<std::size_t>(&object - description.objects.data())];
  }
  bool free(const glm::vec3& origin, const glm::vec3& direction, float distance) const noexcept {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray{};
    ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
    ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
    ray.tfar = distance;
    ray.mask = ~0u;
    rtcOccluded1(scene.get(), &context, &ray);
    return ray.tfar >= 0;
  }
  void build();
  void find_light();
};

void Scene::Data::build() {
  device.reset(rtcNewDevice(nullptr));
  if (!device) throw petzval::Error("Embree: no device");
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  glm::vec3 low(infinity), high(-infinity);
  for (const Object& object : description.objects) {
    Body body;
    RTCGeometry geometry = nullptr;
    float size = 0;
    const auto include = [&](const glm::vec3& a, const glm::vec3& b) {
      low = glm::min(low, a), high = glm::max(high, b);
      size = std::max({size, largest(a), largest(b)});
    };
    if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
      geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
      auto* const data = static_cast<float*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 1));
      data[0] = sphere->centre.x, data[1] = sphere->centre.y, data[2] = sphere->centre.z, data[3] = sphere->radius;
      include(sphere->centre - sphere->radius, sphere->centre + sphere->radius);
      body.area = 4 * pi * double{sphere->radius} * double{sphere->radius};
    } else {
      const auto* const mesh = std::get_if<Mesh>(&object.shape);
      body.mesh = mesh ? *mesh : mesh_of(std::get<Quad>(object.shape));
      geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* const vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                     sizeof(glm::vec3), body.mesh.positions.size());
      auto* const indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                    sizeof(body.mesh.triangles[0]), body.mesh.triangles.size());
      if (!vertices || !indices) throw petzval::Error(object.name + ": Embree cannot allocate the mesh");
      std::memcpy(vertices, body.mesh.positions.data(), body.mesh.positions.size() * sizeof(glm::vec3));
      std::memcpy(indices, body.mesh.triangles.data(), body.mesh.triangles.size() * sizeof(body.mesh.triangles[0]));
      for (std::size_t t = 0; t < body.mesh.triangles.size(); ++t) {
        const auto [a, b, c] = body.corners(t);
        include(glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)));
        body.area += glm::length(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a))) / 2;
        body.ends.push_back(body.area);
      }
    }
    if (!(body.area > 0 && std::isfinite(body.area))) {
      throw petzval::Error(object.name + ": has no area; must have a finite area above 0");
    }
    body.reach = rounding * size;
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene.get(), geometry, static_cast<unsigned>(bodies.size()));
    rtcReleaseGeometry(geometry);
    bodies.push_back(std::move(body));
  }
  rtcCommitScene(scene.get());
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) throw petzval::Error("Embree: could not build the scene");
  if (bodies.empty()) return;
  centre = (low + high) / 2.0f;
  radius = glm::length(high - low) / 2 * 1.0001f;
}

void Scene::Data::find_light() {
  double total = 0;
  std::vector<double> powers;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    powers.push_back(double{luminance(description.objects[i].emission)} * bodies[i].area * pi);
    total += powers.back();
  }
  // Sky light that enters the bounding sphere, which is not 0 without objects. With lamps the sky gets at most half of
  // the samples, because most of its light falls outside the view of the lens.
  const double sky_power = sky.total() * pi * double{radius} * double{radius};
  if (!(total + sky_power > 0)) return;
  constexpr double max_sky_fraction = 0.5;
  sky_fraction = total > 0 ? std::min(sky_power / (total + sky_power), max_sky_fraction) : 1;
  // Half by power, half equally: small lamps are bright where the lens sees them.
  const auto lamps = static_cast<double>(std::count_if(powers.begin(), powers.end(), [](double p) { return p > 0; }));
  double end = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].lamp_fraction = powers[i] > 0 ? (powers[i] / total + 1 / lamps) / 2 * (1 - sky_fraction) : 0;
    lamp_ends.push_back(end += bodies[i].lamp_fraction);
  }
}

Scene::Scene(SceneDescription description) {
  auto data = std::make_unique<Data>(std::move(description));
  data->build();
  data->find_light();
  data_ = std::move(data);
}
Scene::~Scene() = default;

const SceneDescription& Scene::description() const noexcept { return data_->description; }

std::optional<SurfacePoint> Scene::meet(const glm::vec3& origin, const glm::vec3& direction) const noexcept {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  RTCRay& ray = query.ray;
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tfar = infinity;
  ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(data_->scene.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const Object& object = data_->description.objects[query.hit.geomID];
  const Body& body = data_->bodies[query.hit.geomID];
  if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    return point_on(object, body, *sphere, glm::normalize(origin + ray.tfar * direction - sphere->centre));
  }
  return point_on(object, body, query.hit.primID, query.hit.u, query.hit.v);
}

glm::vec3 Scene::leave(const SurfacePoint& from, const glm::vec3& direction) noexcept {
  return from.position + from.normal * std::copysign(from.reach, glm::dot(from.normal, direction));
}

bool Scene::sees(const SurfacePoint& from, const glm::vec3& to) const noexcept {
  const glm::vec3 origin = leave(from, to - from.position), to_target = to - origin;
  const float distance = glm::length(to_target);
  return distance > 0 && data_->free(origin, to_target / distance, distance);
}

bool Scene::sees(const SurfacePoint& from, const SurfacePoint& to) const noexcept {
  return sees(from, leave(to, from.position - to.position));
}

bool Scene::sees_sky(const glm::vec3& from, const glm::vec3& direction) const noexcept {
  return data_->free(from, direction, infinity);
}

bool Scene::has_light() const noexcept { return data_->sky_fraction > 0 || !data_->lamp_ends.empty(); }

LightPoint Scene::sample_light(float pick, float u, float v) const noexcept {
  LightPoint result;
  if (!has_light()) return result;
  const auto& ends = data_->lamp_ends;
  const auto lamp = std::upper_bound(ends.begin(), ends.end(), double{pick});
  if (lamp == ends.end()) {
    if (!(data_->sky_fraction > 0)) return result;
    result.travel = data_->sky.sample(u, v);
    result.radiance = sky(result.travel);
    result.pdf = pdf_sky(result.travel);
    return result;
  }
  const auto index = static_cast<std::size_t>(lamp - ends.begin());
  const Object& object = data_->description.objects[index];
  const Body& body = data_->bodies[index];
  if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    result.surface = point_on(object, body, *sphere, on_sphere(u, v));
  } else {
    const double drawn = double{u} * body.area;
    const auto t =
        static_cast<std::size_t>(std::upper_bound(body.ends.begin(), body.ends.end() - 1, drawn) - body.ends.begin());
    const double begin = t > 0 ? body.ends[t - 1] : 0;
    const auto within = static_cast<float>(std::clamp((drawn - begin) / (body.ends[t] - begin), 0.0, 1.0));
    const float root = std::sqrt(within);
    result.surface = point_on(object, body, t, root * (1 - v), root * v);
  }
  result.radiance = object.emission;
  result.pdf = pdf_light(*result.surface);
  return result;
}

double Scene::pdf_light(const SurfacePoint& lamp) const noexcept {
  const Body& body = data_->body(*lamp.object);
  return body.lamp_fraction / body.area;
}

double Scene::pdf_sky(const glm::vec3& travel) const noexcept { return data_->sky_fraction * data_->sky.pdf(travel); }

Rgb Scene::sky(const glm::vec3& travel) const noexcept { return data_->sky.radiance(travel); }

Rgb Scene::emission(const SurfacePoint& lamp, const glm::vec3& away) noexcept {
  return glm::dot(lamp.normal, away) > 0 ? lamp.object->emission : Rgb(0);
}

glm::vec3 Scene::sky_entry(const glm::vec3& travel, float u, float v) const noexcept {
  const glm::vec2 disc = on_disc(u, v) * data_->radius;
  return data_->centre + Frame(travel).to_world({disc, -data_->radius});
}

double Scene::sky_entry_area() const noexcept { return pi * double{data_->radius} * double{data_->radius}; }

const Object* Scene::around(const glm::vec3& point) const noexcept {
  const Object* solid = nullptr;
  for (int i = 0; i < 64; ++i) {
    const auto sphere_fraction = (static_cast<float>(i) + 0.5f) / 64;
    const float turn = static_cast<float>(i) * 0.618034f;
    const glm::vec3 direction = on_sphere(sphere_fraction, turn - std::floor(turn));
    const auto met = meet(point, direction);
    if (!met || glm::dot(met->normal, direction) < 0 || std::holds_alternative<Glass>(met->object->material)) return {};
    if (solid && solid != met->object) return {};
    solid = met->object;
  }
  return solid;
}

}  // namespace renderer
