// SPDX-License-Identifier: Apache-2.0
// The part of Mitsuba 3 (github.com/mitsuba-renderer/mitsuba3, include/mitsuba) that examples/hosts/mitsuba uses, for
// its scalar_rgb variant: the same names and signatures as in version 3.9, bodies of our own.
#pragma once

#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#define MI_VERSION_MINOR 9
#define NAMESPACE_BEGIN(name) namespace name {
#define NAMESPACE_END(name) }
#define MI_IMPORT_BASE(Name, ...)     \
  using Base = Name<Float, Spectrum>; \
  using Base::m_to_world;             \
  using Base::m_film;                 \
  using Base::m_needs_sample_3;       \
  using Base::m_shutter_open;         \
  using Base::m_shutter_open_time;    \
  using Base::sample_wavelengths;
#define MI_IMPORT_TYPES()                                   \
  using ScalarFloat = Float;                                \
  using Mask = bool;                                        \
  using Point2f = mitsuba::Point2;                          \
  using Point3f = mitsuba::Point3;                          \
  using Vector3f = mitsuba::Vector3;                        \
  using ScalarPoint3f = mitsuba::Point3;                    \
  using Ray3f = mitsuba::Ray;                               \
  using RayDifferential3f = mitsuba::RayDifferential;       \
  using Interaction3f = mitsuba::Interaction;               \
  using SurfaceInteraction3f = mitsuba::SurfaceInteraction; \
  using DirectionSample3f = mitsuba::DirectionSample;       \
  using Transform4f = mitsuba::Transform;                   \
  using ScalarBoundingBox3f = mitsuba::BoundingBox;
#define MI_DECLARE_CLASS(Name)
#define MI_EXPORT_PLUGIN(Name) template class Name<float, mitsuba::Color>;

namespace drjit {
template <class T>
constexpr bool is_array_v = false;
template <class T>
T zeros() {
  return T();
}
template <class T>
constexpr T Largest = std::numeric_limits<T>::max();
}  // namespace drjit

namespace mitsuba {
namespace dr = drjit;

struct Point2 {
  Point2() = default;
  Point2(float x, float y) : at{x, y} {}
  float x() const { return at[0]; }
  float y() const { return at[1]; }
  float at[2] = {0, 0};
};
struct Vector3 {
  Vector3() = default;
  Vector3(float x, float y, float z) : at{x, y, z} {}
  float x() const { return at[0]; }
  float y() const { return at[1]; }
  float z() const { return at[2]; }
  Vector3 operator+(const Vector3& v) const { return {at[0] + v.at[0], at[1] + v.at[1], at[2] + v.at[2]}; }
  float at[3] = {0, 0, 0};
};
struct Point3 : Vector3 {
  Point3() = default;
  using Vector3::Vector3;
  explicit Point3(float x) : Vector3(x, x, x) {}
  explicit Point3(const Vector3& v) : Vector3(v) {}
  Point3 operator+(const Vector3& v) const { return Point3(Vector3::operator+(v)); }
};
struct Color {
  explicit Color(float v = 0) : value(v) {}
  Color operator*(float scale) const { return Color(value * scale); }
  float value;
};
struct Ray {
  Point3 o;
  Vector3 d;
  float maxt = 0, time = 0;
  int wavelengths = 0;
};
struct RayDifferential : Ray {
  Point3 o_x, o_y;
  Vector3 d_x, d_y;
  bool has_differentials = false;
};
struct Interaction {
  Point3 p;
  float time = 0;
};
struct SurfaceInteraction : Interaction {
  Vector3 wi;
};
struct DirectionSample {
  Point3 p;
  Vector3 n, d;
  Point2 uv;
  float time = 0, pdf = 0, dist = 0;
};
struct BoundingBox {
  BoundingBox(const Point3&, const Point3&) {}
};
struct Transform {
  Vector3 operator*(const Vector3& v) const { return v; }
  Point3 operator*(const Point3& p) const { return p; }
  Point3 transform_affine(const Point3& p) const { return p; }
  Transform inverse() const { return *this; }
};
template <class T>
struct Field {
  T value() const { return {}; }
  T scalar() const { return {}; }
};
class ReconstructionFilter {
 public:
  float radius() const { return 1.5f; }
};
struct Pixels {
  unsigned x() const { return at[0]; }
  unsigned y() const { return at[1]; }
  unsigned at[2];
};
class Film {
 public:
  Pixels size() const { return {{36, 24}}; }
  Pixels crop_offset() const { return offset; }
  Pixels crop_size() const { return crop; }
  const ReconstructionFilter* rfilter() const { return &filter; }
  Pixels offset{{0, 0}}, crop{{36, 24}};

 private:
  ReconstructionFilter filter;
};
class Properties {
 public:
  bool has_property(const std::string& name) const { return numbers.count(name) + strings.count(name) > 0; }
  template <class T>
  T get(const std::string& name) const {
    if constexpr (std::is_same_v<T, std::string>)
      return strings.at(name);
    else
      return T(numbers.at(name));
  }
  template <class T>
  T get(const std::string& name, const T& def) const {
    return has_property(name) ? get<T>(name) : def;
  }
  std::map<std::string, std::string> strings;
  std::map<std::string, float> numbers;
  Film film;
};
struct Path {
  std::string string() const { return name; }
  std::string name;
};
struct FileResolver {
  Path resolve(const std::string& name) const { return {name}; }
};
struct Thread {
  static Thread* thread() {
    static Thread one;
    return &one;
  }
  FileResolver* file_resolver() { return &resolver; }
  FileResolver resolver;
};
template <class... Args>
[[noreturn]] void Throw(const char* format, Args&&... args) {
  throw std::runtime_error((std::string(format) + ... + std::string(args)));
}

template <class Float, class Spectrum>
class Sensor {
 public:
  explicit Sensor(const Properties& properties) : film(properties.film), m_film(&film) {}
  virtual ~Sensor() = default;
  virtual std::pair<Ray, Spectrum> sample_ray(Float time, Float sample1, const Point2& sample2, const Point2& sample3,
                                              bool active = true) const = 0;
  virtual std::pair<RayDifferential, Spectrum> sample_ray_differential(Float time, Float sample1, const Point2& sample2,
                                                                       const Point2& sample3,
                                                                       bool active = true) const = 0;
  virtual std::pair<DirectionSample, Spectrum> sample_direction(const Interaction& it, const Point2& sample,
                                                                bool active = true) const = 0;
  virtual Spectrum eval(const SurfaceInteraction& si, bool active = true) const = 0;
  virtual BoundingBox bbox() const = 0;

 protected:
  std::pair<int, Spectrum> sample_wavelengths(const SurfaceInteraction&, Float, bool) const { return {0, Spectrum(1)}; }
  Field<Transform> m_to_world;
  Film film;
  const Film* m_film;
  bool m_needs_sample_3 = false;
  Float m_shutter_open = 0, m_shutter_open_time = 0;
};

}  // namespace mitsuba
