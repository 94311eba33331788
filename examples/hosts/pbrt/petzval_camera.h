// SPDX-License-Identifier: Apache-2.0
// A camera of pbrt-v4 with the lenses of petzval (README.md: the lines of pbrt to change). CPU only.
#ifndef PBRT_PETZVAL_CAMERA_H
#define PBRT_PETZVAL_CAMERA_H

#include <pbrt/cameras.h>
#include <petzval/petzval.h>

#include <memory>
#include <string>

namespace pbrt {

class PetzvalCamera : public CameraBase {
 public:
  /// @param camera      a handle with the frame of pbrt, which this object frees
  /// @param dispersion  true: rays are traced at the first wavelength of a path, and the others end
  PetzvalCamera(CameraBaseParameters base, petzval_camera* camera, bool dispersion)
      : CameraBase(base), camera(camera, petzval_camera_free), dispersion(dispersion) {
    FindMinimumDifferentials(this);
  }

  static PetzvalCamera* Create(const ParameterDictionary& parameters, const CameraTransform& transform, Film film,
                               Medium medium, const FileLoc* loc, Allocator alloc = {});

  PBRT_CPU_GPU
  pstd::optional<CameraRay> GenerateRay(CameraSample sample, SampledWavelengths& lambda) const {
    petzval_sample at = SampleOf(sample, lambda);
    petzval_ray ray;
    if (petzval_camera_sample(camera.get(), &at, &ray) != PETZVAL_OK || ray.weight == 0) ray = LostRay().ray;
    return CameraRay{RenderFromCamera(RayOf(ray, sample)), SampledSpectrum(Float(ray.weight))};
  }

  PBRT_CPU_GPU
  pstd::optional<CameraRayDifferential> GenerateRayDifferential(CameraSample sample, SampledWavelengths& lambda) const {
    petzval_sample at = SampleOf(sample, lambda);
    petzval_ray_differential found;
    if (petzval_camera_sample_differential(camera.get(), &at, &found) != PETZVAL_OK || found.ray.weight == 0)
      found = LostRay();
    RayDifferential ray(RayOf(found.ray, sample));
    ray.rxOrigin = ray.o + VectorOf(found.origin_by_x);
    ray.ryOrigin = ray.o + VectorOf(found.origin_by_y);
    ray.rxDirection = ray.d + VectorOf(found.direction_by_x);
    ray.ryDirection = ray.d + VectorOf(found.direction_by_y);
    ray.hasDifferentials = true;
    return CameraRayDifferential{RenderFromCamera(ray), SampledSpectrum(Float(found.ray.weight))};
  }

  PBRT_CPU_GPU
  SampledSpectrum We(const Ray& ray, SampledWavelengths& lambda, Point2f* pRaster = nullptr) const {
    petzval_importance found = Importance(ray, Wavelength(lambda));
    if (pRaster) *pRaster = Point2f(Float(found.raster_x), Float(found.raster_y));
    return SampledSpectrum(Float(found.we));
  }

  /// Densities at the primary wavelength, because this function has no parameter for the wavelength.
  PBRT_CPU_GPU
  void PDF_We(const Ray& ray, Float* pdfPos, Float* pdfDir) const {
    petzval_importance found = Importance(ray, 0);
    *pdfPos = Float(found.pdf_position);
    *pdfDir = Float(found.pdf_direction);
  }

  PBRT_CPU_GPU
  pstd::optional<CameraWiSample> SampleWi(const Interaction& ref, Point2f u, SampledWavelengths& lambda) const {
    Point3f p = CameraFromRender(ref.p(), ref.time);
    const double point[3] = {p.x, p.y, p.z}, pupil[2] = {u[0], u[1]}, time = Fraction(ref.time);
    const float nm = Wavelength(lambda);
    petzval_connection found;
    if (petzval_camera_connect(camera.get(), 1, point, &pupil[0], &pupil[1], nm > 0 ? &nm : nullptr, &time, &found) !=
            PETZVAL_OK ||
        found.importance.we == 0)
      return {};
    Point3f onFront(Float(found.on_front[0]), Float(found.on_front[1]), Float(found.on_front[2]));
    Normal3f n(RenderFromCamera(Vector3f(0, 0, 1), ref.time));
    Interaction lens(RenderFromCamera(onFront, ref.time), n, ref.time, medium);
    return CameraWiSample(SampledSpectrum(Float(found.importance.we)),
                          RenderFromCamera(VectorOf(found.direction), ref.time), Float(found.pdf),
                          Point2f(Float(found.importance.raster_x), Float(found.importance.raster_y)), ref, lens);
  }

  std::string ToString() const { return "[ PetzvalCamera " + CameraBase::ToString() + " ]"; }

 private:
  /// A lost sample is a ray of weight 0 along the axis: without a ray, pbrt would leave out the light subpath of the
  /// sample, whose splats bidirectional methods need. FindMinimumDifferentials() ignores its large differentials.
  static petzval_ray_differential LostRay() {
    petzval_ray_differential lost = {};
    lost.ray.direction[2] = 1;
    lost.origin_by_x[0] = lost.origin_by_y[1] = lost.direction_by_x[0] = lost.direction_by_y[1] = 1;
    return lost;
  }
  static Vector3f VectorOf(const double* v) { return Vector3f(Float(v[0]), Float(v[1]), Float(v[2])); }
  Ray RayOf(const petzval_ray& ray, const CameraSample& sample) const {
    return Ray(Point3f(Float(ray.origin[0]), Float(ray.origin[1]), Float(ray.origin[2])), VectorOf(ray.direction),
               SampleTime(sample.time), medium);
  }
  /// 0 without dispersion: the primary wavelength of the lens.
  float Wavelength(SampledWavelengths& lambda) const {
    if (!dispersion) return 0;
    lambda.TerminateSecondary();
    return float(lambda[0]);
  }
  petzval_sample SampleOf(const CameraSample& sample, SampledWavelengths& lambda) const {
    return {sample.pFilm.x, sample.pFilm.y, sample.pLens.x, sample.pLens.y, Wavelength(lambda), sample.time};
  }
  /// Time of the exposure from 0 to 1.
  double Fraction(Float time) const {
    return shutterClose > shutterOpen ? double(time - shutterOpen) / double(shutterClose - shutterOpen) : 0;
  }
  /// Importance of a ray that leaves the camera.
  petzval_importance Importance(const Ray& ray, float nm) const {
    Point3f o = CameraFromRender(ray.o, ray.time);
    Vector3f d = CameraFromRender(ray.d, ray.time);
    const double origin[3] = {o.x, o.y, o.z}, direction[3] = {-d.x, -d.y, -d.z}, time = Fraction(ray.time);
    petzval_importance found;
    if (petzval_camera_importance(camera.get(), 1, origin, direction, nm > 0 ? &nm : nullptr, &time, &found) !=
        PETZVAL_OK)
      found = petzval_importance();
    return found;
  }

  std::shared_ptr<petzval_camera> camera;
  bool dispersion;
};

}  // namespace pbrt

#endif  // PBRT_PETZVAL_CAMERA_H
