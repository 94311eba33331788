// SPDX-License-Identifier: Apache-2.0
#include "layers/lit_scene.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <unordered_map>
#include <variant>

#include <glm/glm.hpp>

#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "renderer/albedo.hpp"
#include "renderer/embree.hpp"
#include "renderer/sky_light.hpp"
#include "renderer/solids.hpp"

namespace lens_blur {
namespace {

using renderer::Rgb;

constexpr int packet = 16;
constexpr float infinity = std::numeric_limits<float>::infinity();

renderer::Mesh mesh_of(const renderer::Sphere& sphere) {
  const std::vector<renderer::ProfilePoint> outline{
      {0, -sphere.radius, 0.41421356f}, {sphere.radius, 0, 0.41421356f}, {0, sphere.radius}};
  return placed(renderer::lathe(outline, 24), sphere.centre);
}
renderer::Mesh mesh_of(const renderer::Quad& q) {
  return {{q.corner, q.corner + q.edge_u, q.corner + q.edge_u + q.edge_v, q.corner + q.edge_v},
          {{0, 1, 2}, {0, 2, 3}},
          {},
          {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
}
renderer::Mesh mesh_of(const renderer::Mesh& mesh) { return mesh; }

renderer::Albedo albedo_of(const renderer::Material& material) {
  return std::visit(
      renderer::Cases{[](const renderer::Diffuse& m) { return m.albedo; },
                      [](const renderer::Varnish& m) { return m.albedo; },
                      [](const renderer::Mirror& m) { return renderer::Albedo{.colour = 0.5f * m.reflectance}; },
                      [](const renderer::Rough& m) { return renderer::Albedo{.colour = 0.6f * m.reflectance}; },
                      [](const renderer::Glass&) {
                        return renderer::Albedo{.colour = {0.5f, 0.55f, 0.55f}};
                      }},
      material);
}

/// Noise from 0 to 1 that is smooth between the points of a repeating lattice.
class Noise {
 public:
  Noise() {
    std::mt19937 engine(1);
    for (float& value : values_) value = static_cast<float>(engine() >> 8) / 16777216.0f;
  }
  float at(const glm::vec3& p) const {
    const glm::vec3 floor = glm::floor(p), t = p - floor;
    const int x = static_cast<int>(floor.x), y = static_cast<int>(floor.y), z = static_cast<int>(floor.z);
    const auto line = [&](int dy, int dz) { return &values_[(((z + dz) & last) * side + ((y + dy) & last)) * side]; };
    const int x0 = x & last, x1 = (x + 1) & last;
    const auto along_x = [&](const float* v) { return v[x0] + t.x * (v[x1] - v[x0]); };
    const float a = along_x(line(0, 0)), b = along_x(line(1, 0)), c = along_x(line(0, 1)), d = along_x(line(1, 1));
    const float front = a + t.y * (b - a), back = c + t.y * (d - c);
    return front + t.z * (back - front);
  }

 private:
  static constexpr int side = 32, last = side - 1;
  std::array<float, side * side * side> values_;
};

/// An object prepared for tracing.
struct Body {
  renderer::Mesh mesh;     ///< in camera space: x to the right, y up, z along the axis
  std::vector<Rgb> light;  ///< incident light at the mesh vertices
  renderer::Albedo albedo;
  Rgb emission{0, 0, 0};
  std::optional<renderer::Sphere> lamp;  ///< in camera space
};

/// Area that a disc around (0, 0) and a quadrant, the points with smaller x and y, have in common.
float area_below(float x, float y, float radius) {
  x = std::clamp(x, -radius, radius), y = std::clamp(y, -radius, radius);
  const auto height = [&](float t) { return std::sqrt(std::max(0.0f, radius * radius - t * t)); };
  // Integral of half the height of the disc between two columns.
  const auto half = [&](float from, float to) {
    const auto up_to = [&](float t) { return t * height(t) + radius * radius * std::asin(t / radius); };
    return to > from ? (up_to(to) - up_to(from)) / 2 : 0.0f;
  };
  // Between -edge and edge the quadrant cuts columns at y; beyond, they lie entirely below or above y.
  const float edge = height(y), cut = std::clamp(x, -edge, edge), outer = y > 0 ? 2.0f : 0.0f;
  return outer * (half(-radius, std::min(x, -edge)) + half(edge, x)) + half(-edge, cut) + y * (cut + edge);
}

/// A small light as a disc in the picture of a layer camera.
struct Lamp {
  glm::vec2 raster{0, 0};
  float radius_px = 0, inverse_depth = 0;
  Rgb radiance{0, 0, 0};

  /// The fraction of a pixel, centred at a raster position, that the lamp covers.
  float covers(const glm::vec2& centre) const {
    const glm::vec2 to = centre - raster + 0.5f, from = to - 1.0f;
    return std::max(0.0f, area_below(to.x, to.y, radius_px) - area_below(from.x, to.y, radius_px) -
                              area_below(to.x, from.y, radius_px) + area_below(from.x, from.y, radius_px));
  }
};

/// The light of a lamp in one pixel of the layers.
struct LampLight {
  float area, inverse_depth;  ///< area: fraction of the pixel
  Rgb radiance;
};
using LampPixels = std::unordered_map<std::size_t, std::vector<LampLight>>;

/// Rays of a packet. Directions have z = 1 mm, so that ray distances are depths.
struct alignas(64) Packet {
  RTCRayHit16 rays;
  alignas(64) int valid[packet];
  Rgb colours[packet];

  /// Fills all lanes with empty segments, because Embree may read invalid lanes.
  Packet() {
    std::fill_n(valid, packet, 0);
    RTCRay16& r = rays.ray;
    for (float* const values : {r.org_x, r.org_y, r.org_z, r.dir_x, r.dir_y}) std::fill_n(values, packet, 0.0f);
    std::fill_n(r.dir_z, packet, 1.0f);
    std::fill_n(r.tnear, packet, infinity), std::fill_n(r.tfar, packet, -infinity);
  }
  void set(int lane, const glm::vec3& from, const glm::vec2& run, float near, float far = infinity) {
    RTCRay16& r = rays.ray;
    r.org_x[lane] = from.x, r.org_y[lane] = from.y, r.org_z[lane] = from.z;
    r.dir_x[lane] = run.x, r.dir_y[lane] = run.y, r.dir_z[lane] = 1;
    r.tnear[lane] = near, r.tfar[lane] = far, r.time[lane] = 0, r.mask[lane] = ~0u, r.flags[lane] = 0;
    rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID, rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    valid[lane] = -1;
  }
  bool hit(int lane) const { return rays.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID; }
};

}  // namespace

struct LitScene::Data {
  renderer::EmbreeDevice device;
  renderer::EmbreeScene scene, surfaces;  ///< surfaces: without lamps; null if there are no lamps
  std::vector<Body> bodies;
  glm::mat3 turn{1};  ///< camera to world
  glm::vec3 origin{0, 0, 0};
  renderer::SkyLight sky;
  std::optional<Rgb> plain_sky;
  Noise noise;

  explicit Data(const renderer::SceneDescription& description) : sky(description.sky) {
    if (!description.sky.image) plain_sky = description.sky.colour;
    const renderer::Pose& pose = description.pose;
    const glm::dvec3 forward = glm::normalize(pose.look_at - pose.position);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, pose.up));
    if (!(glm::dot(right, right) > 0.5)) throw petzval::Error("scene: pose: forward and up must not be parallel");
    turn = glm::mat3(right, glm::cross(right, forward), forward);
    origin = pose.position;

    device.reset(rtcNewDevice(nullptr));
    for (const renderer::Object& object : description.objects) {
      Body& body = bodies.emplace_back();
      body.mesh = std::visit([](const auto& shape) { return mesh_of(shape); }, object.shape);
      if (body.mesh.triangles.empty()) throw petzval::Error("scene: object " + object.name + " has no area");
      body.albedo = albedo_of(object.material), body.emission = object.emission;
      light(body);
      for (glm::vec3& p : body.mesh.positions) p = (p - origin) * turn;
      const auto* const sphere = std::get_if<renderer::Sphere>(&object.shape);
      if (sphere && object.emission != Rgb{0, 0, 0}) {
        body.lamp = renderer::Sphere{(sphere->centre - origin) * turn, sphere->radius};
      }
    }
    build(scene, [](const Body&) { return true; });
    if (std::ranges::any_of(bodies, [](const Body& body) { return body.lamp.has_value(); })) {
      build(surfaces, [](const Body& body) { return !body.lamp; });
    }
  }
  RTCScene without_lamps() const { return surfaces ? surfaces.get() : scene.get(); }

  /// Lights the vertices: from the sky by their inclination, and from the sun, low behind the camera on the left.
  void light(Body& body) const {
    renderer::Mesh& mesh = body.mesh;
    if (mesh.normals.empty()) {  // flat triangles have their own vertices
      renderer::Mesh flat;
      for (const auto& t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(flat.positions.size());
        const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
        for (const std::uint32_t k : t) {
          flat.positions.push_back(mesh.positions[k]);
          flat.normals.push_back(glm::normalize(glm::cross(b - a, c - a)));
          if (!mesh.uvs.empty()) flat.uvs.push_back(mesh.uvs[k]);
        }
        flat.triangles.push_back({first, first + 1, first + 2});
      }
      mesh = std::move(flat);
    }
    const glm::vec3 sun = glm::normalize(glm::vec3{-0.5f, 0.6f, 0.65f});
    const Rgb above =
        sky.radiance({0, -1, 0}) + sky.radiance({0.6f, -0.5f, 0.6f}) + sky.radiance({-0.6f, -0.5f, -0.6f});
    const float brightness = std::max({above.x, above.y, above.z, 1e-3f}) / 3;
    for (const glm::vec3& n : mesh.normals) {
      const float up = 0.5f + 0.5f * n.y, direct = std::max(0.0f, glm::dot(n, sun));
      body.light.push_back((0.15f + 0.35f * up) * above / 3.0f + 0.9f * direct * brightness * Rgb{1, 0.93f, 0.82f});
    }
  }

  template <class Has>
  void build(renderer::EmbreeScene& of, const Has& has) {
    of.reset(rtcNewScene(device.get()));
    rtcSetSceneBuildQuality(of.get(), RTC_BUILD_QUALITY_HIGH);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (has(bodies[i])) attach(bodies[i].mesh, of.get(), static_cast<unsigned>(i));
    }
    rtcCommitScene(of.get());
  }

  void attach(const renderer::Mesh& mesh, RTCScene to, unsigned number) {
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    void* const corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                  sizeof(glm::vec3), mesh.positions.size());
    std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<glm::vec3*>(corners));
    void* const triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                    3 * sizeof(std::uint32_t), mesh.triangles.size());
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<std::array<std::uint32_t, 3>*>(triangles));
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(to, geometry, number);
    rtcReleaseGeometry(geometry);
  }

  /// Finds the first surfaces hit by the rays of a packet, and their colours.
  void trace(Packet& p, RTCScene in) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(p.valid, in, &context, &p.rays);
    for (int lane = 0; lane < packet; ++lane) {
      if (p.valid[lane]) p.colours[lane] = colour(p, lane);
    }
  }

  Rgb colour(const Packet& p, int lane) const {
    const RTCRay16& ray = p.rays.ray;
    const glm::vec3 run{ray.dir_x[lane], ray.dir_y[lane], 1};
    if (!p.hit(lane)) return plain_sky ? *plain_sky : sky.radiance(-glm::normalize(turn * run));
    const Body& body = bodies[p.rays.hit.geomID[lane]];
    const auto& t = body.mesh.triangles[p.rays.hit.primID[lane]];
    const float u = p.rays.hit.u[lane], v = p.rays.hit.v[lane], w = 1 - u - v;
    const glm::vec3 surface_point =
        turn * (glm::vec3{ray.org_x[lane], ray.org_y[lane], ray.org_z[lane]} + ray.tfar[lane] * run) + origin;
    glm::vec2 uv{u, v};
    if (!body.mesh.uvs.empty()) uv = w * body.mesh.uvs[t[0]] + u * body.mesh.uvs[t[1]] + v * body.mesh.uvs[t[2]];
    const Rgb light = w * body.light[t[0]] + u * body.light[t[1]] + v * body.light[t[2]];
    return body.emission +
           light * at(body.albedo, surface_point, uv) * (0.7f + 0.6f * noise.at(surface_point * (1 / 35.0f)));
  }

  /// The lamps in front of a camera, at raster positions of its picture.
  std::vector<Lamp> lamps(const petzval::LayerCamera& camera, const glm::vec3& eye) const {
    std::vector<Lamp> found;
    for (const Body& body : bodies) {
      if (!body.lamp || !(body.lamp->centre.z - eye.z > body.lamp->radius)) continue;
      const glm::vec3 run = (body.lamp->centre - eye) / (body.lamp->centre.z - eye.z);
      const auto focal = static_cast<float>(camera.focal_px);
      // The image of a sphere away from the axis is an ellipse; the disc has its area.
      found.push_back(
          {.raster = glm::vec2(camera.axis) + focal * glm::vec2{run.x, -run.y},
           .radius_px = focal * body.lamp->radius / (body.lamp->centre.z - eye.z) * std::sqrt(glm::length(run)),
           .inverse_depth = 1 / (body.lamp->centre.z - eye.z),
           .radiance = body.emission});
    }
    return found;
  }

  /// The pixels of the layers that lamps cover. Surfaces that are nearer by less than the bias hide parts of a lamp,
  /// because both are in the same layer.
  LampPixels lamp_pixels(const petzval::LayerCamera& camera, const glm::vec3& eye, double bias) const {
    LampPixels found;
    Packet p;
    for (const Lamp& lamp : lamps(camera, eye)) {
      const glm::ivec2 begin = glm::max(glm::ivec2(glm::floor(lamp.raster - lamp.radius_px)), -camera.overscan),
                       end = glm::min(glm::ivec2(glm::ceil(lamp.raster + lamp.radius_px)),
                                      glm::ivec2(camera.columns, camera.rows) + camera.overscan);
      for (int row = begin.y; row < end.y; ++row) {
        for (int column = begin.x; column < end.x; ++column) {
          const glm::vec2 from = glm::max(glm::vec2(column, row), lamp.raster - lamp.radius_px),
                          size = glm::min(glm::vec2(column, row) + 1.0f, lamp.raster + lamp.radius_px) - from;
          int inside = 0, hidden = 0;
          for (int lane = 0; lane < packet; ++lane) {
            const float part = (static_cast<float>(lane) + 0.5f) / packet;
            const glm::vec2 at = from + size * glm::vec2(part, glm::fract(part * packet * 0.618034f));
            const glm::vec2 run = (at - glm::vec2(camera.axis)) / static_cast<float>(camera.focal_px);
            p.set(lane, eye, {run.x, -run.y}, 1 / (lamp.inverse_depth + static_cast<float>(bias)),
                  1 / lamp.inverse_depth);
            p.valid[lane] = glm::length(at - lamp.raster) < lamp.radius_px ? -1 : 0;
          }
          trace(p, surfaces.get());
          for (int lane = 0; lane < packet; ++lane) {
            if (p.valid[lane]) ++inside, hidden += p.hit(lane);
          }
          const float area = lamp.covers(glm::vec2(column, row) + 0.5f) *
                             (1 - static_cast<float>(hidden) / static_cast<float>(std::max(inside, 1)));
          const auto pixel =
              static_cast<std::size_t>((row + camera.overscan) * camera.layer_columns() + column + camera.overscan);
          if (area > 0) found[pixel].push_back({area, lamp.inverse_depth, lamp.radiance});
        }
      }
    }
    return found;
  }
};

LitScene::LitScene(const renderer::SceneDescription& description) : data_(std::make_unique<Data>(description)) {}
LitScene::~LitScene() = default;

std::optional<LitScene::Hit> LitScene::first_hit(const petzval::Ray<double>& ray) const {
  const glm::vec3 from = (glm::vec3(ray.origin) - data_->origin) * data_->turn,
                  run = glm::vec3(ray.direction) * data_->turn;
  RTCRayHit hit{};
  hit.ray.org_x = from.x, hit.ray.org_y = from.y, hit.ray.org_z = from.z;
  hit.ray.dir_x = run.x, hit.ray.dir_y = run.y, hit.ray.dir_z = run.z;
  hit.ray.tfar = infinity, hit.ray.mask = ~0u;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID, hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(data_->scene.get(), &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  std::size_t first = 0;  // index of the first vertex of the body
  for (unsigned body = 0; body < hit.hit.geomID; ++body) first += data_->bodies[body].mesh.positions.size();
  const auto& corners = data_->bodies[hit.hit.geomID].mesh.triangles[hit.hit.primID];
  const double u = static_cast<double>(hit.hit.u), v = static_cast<double>(hit.hit.v);
  Hit result{.triangle = {{first + corners[0], first + corners[1], first + corners[2]}, {1 - u - v, u, v}}};
  for (std::size_t k = 0; k < 3; ++k) {
    result.position += vertex(result.triangle.vertices[k]) * result.triangle.barycentric[k];
  }
  return result;
}

petzval::Vec3<double> LitScene::vertex(std::size_t index) const {
  for (const Body& body : data_->bodies) {
    const auto& positions = body.mesh.positions;
    if (index < positions.size()) return petzval::Vec3<double>(data_->turn * positions[index] + data_->origin);
    index -= positions.size();
  }
  throw petzval::Error("scene: vertex " + std::to_string(index) + " does not exist");
}

namespace {

/// The pixels of a packet: a square of 4 x 4 pixels, whose rays are coherent.
struct Square {
  int column = 0, row = 0, columns = 0, rows = 0;

  int column_of(int lane) const { return column + lane % side; }
  int row_of(int lane) const { return row + lane / side; }
  /// False for lanes outside the picture: squares at the right and lower edges are smaller.
  bool has(int lane) const { return lane % side < columns && lane / side < rows; }

  static constexpr int side = 4;
};

/// Calls work(square) for all squares of a picture.
template <class Work>
void for_squares(int columns, int rows, int threads, const Work& work) {
  const std::size_t down = static_cast<std::size_t>((rows + Square::side - 1) / Square::side);
  petzval::parallel_for(down, 1, threads, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin) * Square::side; row < std::min(rows, static_cast<int>(end) * Square::side);
         row += Square::side) {
      for (int column = 0; column < columns; column += Square::side) {
        work({column, row, std::min(Square::side, columns - column), std::min(Square::side, rows - row)});
      }
    }
  });
}

}  // namespace

petzval::LayerSet::Peel LitScene::peel(const petzval::LayerCamera& camera, int threads, double bias) const {
  return [this, camera, threads, bias = static_cast<float>(bias), lamps = data_->lamp_pixels(camera, eye_, bias)](
             int, std::span<const float> below, const petzval::LayerPlanes& out) {
    std::atomic<std::size_t> written = 0;
    const auto focal = static_cast<float>(camera.focal_px);
    const glm::vec2 axis = glm::vec2(camera.axis) + static_cast<float>(camera.overscan);
    for_squares(camera.layer_columns(), camera.layer_rows(), threads, [&](const Square& square) {
      const auto pixel_of = [&](int lane) {
        return static_cast<std::size_t>(square.row_of(lane)) * static_cast<std::size_t>(camera.layer_columns()) +
               static_cast<std::size_t>(square.column_of(lane));
      };
      Packet p;
      bool any = false;
      for (int lane = 0; lane < packet; ++lane) {
        if (!square.has(lane)) continue;
        const float limit = below[pixel_of(lane)];
        if (!(limit > 0)) continue;
        const glm::vec2 at{static_cast<float>(square.column_of(lane)) + 0.5f,
                           static_cast<float>(square.row_of(lane)) + 0.5f},
            run = (at - axis) / focal;
        p.set(lane, eye_, {run.x, -run.y}, limit < infinity ? 1 / limit : 0.0f);
        any = true;
      }
      if (!any) return;
      data_->trace(p, data_->without_lamps());
      std::size_t count = 0;
      for (int lane = 0; lane < packet; ++lane) {
        if (!p.valid[lane]) continue;
        const std::size_t pixel = pixel_of(lane);
        float w = p.hit(lane) ? 1 / p.rays.ray.tfar[lane] : 0.0f;
        if (const auto lit = lamps.find(pixel); lit != lamps.end()) {
          // Lamps that are no farther behind the nearest surface or lamp than the bias belong to the same layer.
          const auto left = [&](const LampLight& l) { return l.inverse_depth < below[pixel]; };
          for (const LampLight& l : lit->second) w = left(l) ? std::max(w, l.inverse_depth) : w;
          Rgb light{0, 0, 0};
          float area = 0;
          for (const LampLight& l : lit->second) {
            if (left(l) && l.inverse_depth >= w - bias) light += l.area * l.radiance, area += l.area;
          }
          p.colours[lane] = light + std::max(0.0f, 1 - area) * p.colours[lane];
        }
        out.inverse_depth[pixel] = std::min(w, std::nextafter(below[pixel], 0.0f));
        out.red[pixel] = p.colours[lane].x, out.green[pixel] = p.colours[lane].y, out.blue[pixel] = p.colours[lane].z;
        ++count;
      }
      written += count;
    });
    return written.load();
  };
}

double LitScene::nearest_mm(const petzval::LayerCamera& camera, int threads) const {
  petzval::LayerSet layers;
  layers.peel({.camera = camera, .bias = 0}, 1, peel(camera, threads));
  float most = 0;
  for (int layer = 0; layer < layers.count(); ++layer) {
    for (const float w : layers.inverse_depth(layer)) most = std::max(most, w);
  }
  return most > 0 ? 1 / static_cast<double>(most) : std::numeric_limits<double>::infinity();
}

petzval::RgbImage LitScene::reference(const petzval::LensRays& rays, int threads) const {
  const petzval::LayerCamera& camera = rays.camera();
  petzval::RgbImage picture(camera.columns, camera.rows);
  const std::size_t count = rays.count();
  const auto focal = static_cast<float>(camera.focal_px);
  const auto axis = glm::vec2(camera.axis);

  // Rays shared by all pixels of a set are computed once, like in a renderer with an accumulation buffer.
  const bool same = rays.shift_invariant() && rays.channels() == 1;
  const int side = rays.set_count() == 16 ? 4 : rays.set_count() == 4 ? 2 : 1;
  std::vector<petzval::LayerRay> shared(same ? count * static_cast<std::size_t>(rays.set_count()) : 0);
  const auto of_set = [&](int column, int row) {
    return std::span(shared).subspan(static_cast<std::size_t>(row % side * side + column % side) * count, count);
  };
  for (int row = 0; same && row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      rays.exact_rays_at(0, column, row, of_set(column, row));
      for (petzval::LayerRay& ray : of_set(column, row)) ray.position -= petzval::Vec2<double>{column, row};
    }
  }

  const std::vector<Lamp> lamps = data_->lamps(camera, eye_);
  for_squares(camera.columns, camera.rows, threads, [&](const Square& square) {
    thread_local std::vector<petzval::LayerRay> own;
    own.resize(count * packet);
    glm::vec3 sums[packet] = {};
    Packet p;
    float weights[packet] = {}, at_x[packet] = {}, at_y[packet] = {}, slope_x[packet] = {}, slope_y[packet] = {};
    for (int channel = 0; channel < rays.channels(); ++channel) {
      for (int lane = 0; !same && lane < packet; ++lane) {
        if (!square.has(lane)) continue;
        rays.exact_rays_at(channel, square.column_of(lane), square.row_of(lane),
                           std::span(own).subspan(static_cast<std::size_t>(lane) * count, count));
      }
      for (std::size_t i = 0; i < count; ++i) {
        for (int lane = 0; lane < packet; ++lane) {
          if (!square.has(lane)) continue;
          const petzval::LayerRay& ray = same ? of_set(square.column_of(lane), square.row_of(lane))[i]
                                              : own[static_cast<std::size_t>(lane) * count + i];
          glm::vec2 at(ray.position);
          if (same)
            at += glm::vec2{static_cast<float>(square.column_of(lane)), static_cast<float>(square.row_of(lane))};
          const glm::vec2 run = (at - axis) / focal, from = glm::vec2(ray.slope) / focal;
          p.set(lane, eye_ + glm::vec3{from.x, -from.y, 0}, {run.x, -run.y}, 0);
          weights[lane] = static_cast<float>(ray.weight);
          at_x[lane] = at.x, at_y[lane] = at.y;
          slope_x[lane] = static_cast<float>(ray.slope.x), slope_y[lane] = static_cast<float>(ray.slope.y);
        }
        data_->trace(p, data_->without_lamps());
        // Lamps are integrated over a pixel around each ray: rays through the centres of pixels miss lamps.
        float free[packet];
        Rgb light[packet] = {};
        std::fill_n(free, packet, 1.0f);
        for (const Lamp& lamp : lamps) {
          const float reach = lamp.radius_px + 0.5f;
          int near[packet], any = 0;
          for (int lane = 0; lane < packet; ++lane) {
            const float x = at_x[lane] + slope_x[lane] * lamp.inverse_depth - lamp.raster.x,
                        y = at_y[lane] + slope_y[lane] * lamp.inverse_depth - lamp.raster.y;
            near[lane] = std::max(std::abs(x), std::abs(y)) < reach;
            any |= near[lane];
          }
          for (int lane = 0; any && lane < packet; ++lane) {
            if (!near[lane] || !p.valid[lane] || p.rays.ray.tfar[lane] * lamp.inverse_depth < 1) continue;
            const float area = lamp.covers(
                {at_x[lane] + slope_x[lane] * lamp.inverse_depth, at_y[lane] + slope_y[lane] * lamp.inverse_depth});
            light[lane] += area * lamp.radiance, free[lane] -= area;
          }
        }
        for (int lane = 0; lane < packet; ++lane) {
          p.colours[lane] = light[lane] + std::max(free[lane], 0.0f) * p.colours[lane];
        }
        for (int lane = 0; lane < packet; ++lane) {
          if (!p.valid[lane]) continue;
          if (rays.channels() == 1) {
            sums[lane] += weights[lane] * p.colours[lane];
          } else {
            sums[lane][channel] += weights[lane] * p.colours[lane][channel];
          }
        }
      }
    }
    for (int lane = 0; lane < packet; ++lane) {
      if (!square.has(lane)) continue;
      float* const pixel = picture.pixel(square.column_of(lane), square.row_of(lane));
      for (int c = 0; c < 3; ++c) pixel[c] = sums[lane][c] / static_cast<float>(count);
    }
  });
  return picture;
}

}  // namespace lens_blur
