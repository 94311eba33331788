// SPDX-License-Identifier: Apache-2.0
// The part of pbrt-v4 (github.com/mmp/pbrt-v4, src/pbrt) that examples/hosts/pbrt uses: the same names and signatures,
// bodies of our own, and the lines that examples/hosts/pbrt/README.md adds. Camera space is render space.
#pragma once

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#define PBRT_CPU_GPU

namespace pstd {
template <typename T>
using optional = std::optional<T>;
}

namespace pbrt {

using Float = float;
template <typename Own>
struct Tuple2 {
  Own x{}, y{};
  Own operator[](int i) const { return i == 0 ? x : y; }
};
struct Point2f : Tuple2<Float> {
  Point2f() = default;
  Point2f(Float x_, Float y_) : Tuple2{x_, y_} {}
};
struct Vector2f : Tuple2<Float> {};
struct Point2i : Tuple2<int> {};
struct Vector3f {
  Vector3f() = default;
  Vector3f(Float x_, Float y_, Float z_) : x(x_), y(y_), z(z_) {}
  Vector3f operator+(const Vector3f& v) const { return {x + v.x, y + v.y, z + v.z}; }
  Float x = 0, y = 0, z = 0;
};
struct Point3f {
  Point3f() = default;
  Point3f(Float x_, Float y_, Float z_) : x(x_), y(y_), z(z_) {}
  Point3f operator+(const Vector3f& v) const { return {x + v.x, y + v.y, z + v.z}; }
  Float x = 0, y = 0, z = 0;
};
struct Normal3f {
  explicit Normal3f(Vector3f v) : x(v.x), y(v.y), z(v.z) {}
  Float x, y, z;
};
class Medium {};
class Ray {
 public:
  Ray() = default;
  Ray(Point3f o_, Vector3f d_, Float time_ = 0.f, Medium medium_ = {}) : o(o_), d(d_), time(time_), medium(medium_) {}
  Point3f o;
  Vector3f d;
  Float time = 0;
  Medium medium;
};
class RayDifferential : public Ray {
 public:
  explicit RayDifferential(const Ray& ray) : Ray(ray) {}
  bool hasDifferentials = false;
  Point3f rxOrigin, ryOrigin;
  Vector3f rxDirection, ryDirection;
};
class SampledSpectrum {
 public:
  explicit SampledSpectrum(Float c) : value(c) {}
  Float operator[](int) const { return value; }

 private:
  Float value;
};
class SampledWavelengths {
 public:
  Float operator[](int i) const { return lambda[i]; }
  void TerminateSecondary() { terminated = true; }
  Float lambda[4] = {500, 550, 600, 650};
  bool terminated = false;
};
class Interaction {
 public:
  Interaction() = default;
  Interaction(Point3f p, Normal3f n_, Float time_, Medium medium_) : time(time_), medium(medium_), at(p) { (void)n_; }
  Point3f p() const { return at; }
  Float time = 0;
  Medium medium;

 private:
  Point3f at;
};
struct CameraSample {
  Point2f pFilm;
  Point2f pLens;
  Float time = 0;
  Float filterWeight = 1;
};
struct CameraRay {
  Ray ray;
  SampledSpectrum weight = SampledSpectrum(1);
};
struct CameraRayDifferential {
  RayDifferential ray;
  SampledSpectrum weight = SampledSpectrum(1);
};
struct CameraWiSample {
  CameraWiSample(const SampledSpectrum& Wi_, const Vector3f& wi_, Float pdf_, Point2f pRaster_,
                 const Interaction& pRef_, const Interaction& pLens_)
      : Wi(Wi_), wi(wi_), pdf(pdf_), pRaster(pRaster_), pRef(pRef_), pLens(pLens_) {}
  SampledSpectrum Wi;
  Vector3f wi;
  Float pdf;
  Point2f pRaster;
  Interaction pRef, pLens;
};

class Filter {
 public:
  Vector2f Radius() const { return {{1.5f, 1.5f}}; }
};
class Film {
 public:
  Point2i FullResolution() const { return {{36, 24}}; }
  Float Diagonal() const { return diagonal; }
  Filter GetFilter() const { return {}; }
  Float diagonal = 0.0432666f;
};
struct FileLoc {};
class ParameterDictionary {
 public:
  std::string GetOneString(const std::string& name, const std::string& def) const {
    const auto found = strings.find(name);
    return found == strings.end() ? def : found->second;
  }
  Float GetOneFloat(const std::string& name, Float def) const {
    const auto found = numbers.find(name);
    return found == numbers.end() ? def : found->second;
  }
  int GetOneInt(const std::string& name, int def) const {
    return static_cast<int>(GetOneFloat(name, static_cast<Float>(def)));
  }
  bool GetOneBool(const std::string& name, bool def) const { return GetOneFloat(name, def ? 1 : 0) != 0; }
  std::map<std::string, std::string> strings;
  std::map<std::string, Float> numbers;
};
class CameraTransform {};
struct CameraBaseParameters {
  CameraBaseParameters(const CameraTransform&, Film film_, Medium medium_, const ParameterDictionary&, const FileLoc*)
      : film(film_), medium(medium_) {}
  Float shutterOpen = 0, shutterClose = 0.5f;
  Film film;
  Medium medium;
};

class Allocator {
 public:
  template <class T, class... Args>
  T* new_object(Args&&... args) {
    return new T(std::forward<Args>(args)...);
  }
};

class PetzvalCamera;
class Camera {
 public:
  Camera(PetzvalCamera* camera_) : camera(camera_) {}
  std::optional<CameraRay> GenerateRay(CameraSample sample, SampledWavelengths& lambda) const;

 private:
  PetzvalCamera* camera;
};
class CameraBase {
 public:
  Float SampleTime(Float u) const { return shutterOpen + u * (shutterClose - shutterOpen); }
  std::string ToString() const { return "camera"; }

 protected:
  CameraBase() = default;
  CameraBase(CameraBaseParameters p) : shutterOpen(p.shutterOpen), shutterClose(p.shutterClose), film(p.film) {}
  template <class T>
  T RenderFromCamera(const T& one) const {
    return one;
  }
  template <class T>
  T RenderFromCamera(const T& one, Float) const {
    return one;
  }
  template <class T>
  T CameraFromRender(const T& one, Float) const {
    return one;
  }
  void FindMinimumDifferentials(Camera) {}

  CameraTransform cameraTransform;
  Float shutterOpen = 0, shutterClose = 1;
  Film film;
  Medium medium;
};

}  // namespace pbrt
#include <pbrt/petzval_camera.h>
namespace pbrt {

// The class must be complete here.
inline std::optional<CameraRay> Camera::GenerateRay(CameraSample sample, SampledWavelengths& lambda) const {
  return camera->GenerateRay(sample, lambda);
}

inline std::string ResolveFilename(const std::string& name) { return name; }
template <typename... Args>
[[noreturn]] void ErrorExit(const FileLoc*, const char*, Args&&... args) {
  throw std::runtime_error((std::string() + ... + std::string(args)));
}

}  // namespace pbrt
