// SPDX-License-Identifier: Apache-2.0
// A sensor of Mitsuba 3 with the lenses of petzval. README.md describes the build. Scalar variants; all wavelengths of
// a path use the primary wavelength of the lens.
#include <mitsuba/core/fresolver.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/transform.h>
#include <mitsuba/render/sensor.h>

#include <memory>
#include <petzval/petzval17.hpp>
#include <string>

NAMESPACE_BEGIN(mitsuba)

template <typename Float, typename Spectrum>
class PetzvalSensor final : public Sensor<Float, Spectrum> {
 public:
  MI_IMPORT_BASE(Sensor, m_to_world, m_film, m_needs_sample_3, m_shutter_open, m_shutter_open_time, sample_wavelengths)
  MI_IMPORT_TYPES()

  PetzvalSensor(const Properties& props) : Base(props) {
    if constexpr (dr::is_array_v<Float>) Throw("The petzval sensor has scalar variants only.");
    std::string file = Thread::thread()->file_resolver()->resolve(props.template get<std::string>("lens")).string();
    petzval17::Lens lens = petzval17::Lens::read(file);
    if (props.has_property("f_number")) lens.f_number(double(props.template get<ScalarFloat>("f_number")));
    // From the film, in metres.
    lens.focus(1000 * double(props.template get<ScalarFloat>("focus_distance", ScalarFloat(10))), PETZVAL_FROM_FILM);
    petzval_film film = petzval_film_init();
    film.columns = int32_t(m_film->size().x());
    film.rows = int32_t(m_film->size().y());
    film.width_mm = double(props.template get<ScalarFloat>("film_width_mm", ScalarFloat(36)));
    film.height_mm = film.width_mm * film.rows / film.columns;
    film.margin_mm = double(m_film->rfilter()->radius()) * film.width_mm / film.columns;
    std::string model = props.template get<std::string>("model", "exact_float");
    petzval_camera_options options = petzval_camera_options_init();
    options.model = model.c_str();
    options.frame = PETZVAL_FRAME_MITSUBA;
    options.origin = PETZVAL_FROM_FILM;
    m_camera = petzval17::Camera(lens, film, options);
    if (!m_camera) Throw("%s", m_camera.message());
    m_needs_sample_3 = true;
  }

  std::pair<Ray3f, Spectrum> sample_ray(Float time, Float wavelength_sample, const Point2f& position_sample,
                                        const Point2f& aperture_sample, Mask active) const override {
    auto [ray, weight] = sample_ray_differential(time, wavelength_sample, position_sample, aperture_sample, active);
    return {Ray3f(ray), weight};
  }

  std::pair<RayDifferential3f, Spectrum> sample_ray_differential(Float time, Float wavelength_sample,
                                                                 const Point2f& position_sample,
                                                                 const Point2f& aperture_sample,
                                                                 Mask active) const override {
    auto [wavelengths, wav_weight] = sample_wavelengths(dr::zeros<SurfaceInteraction3f>(), wavelength_sample, active);
    RayDifferential3f ray = dr::zeros<RayDifferential3f>();
    ray.time = time;
    ray.wavelengths = wavelengths;
    Float weight = 0.f;
    if constexpr (!dr::is_array_v<Float>) {
      petzval_sample at = {m_film->crop_offset().x() + double(position_sample.x()) * m_film->crop_size().x(),
                           m_film->crop_offset().y() + double(position_sample.y()) * m_film->crop_size().y(),
                           double(aperture_sample.x()),
                           double(aperture_sample.y()),
                           0,
                           fraction(time)};
      petzval_ray_differential found = m_camera.sample_differential(at);
      const Transform4f trafo = m_to_world.value();
      ray.o = trafo.transform_affine(Point3f(vector(found.ray.origin)));
      ray.d = trafo * vector(found.ray.direction);
      ray.o_x = ray.o + trafo * vector(found.origin_by_x);
      ray.o_y = ray.o + trafo * vector(found.origin_by_y);
      ray.d_x = ray.d + trafo * vector(found.direction_by_x);
      ray.d_y = ray.d + trafo * vector(found.direction_by_y);
      ray.has_differentials = true;
      ray.maxt = dr::Largest<Float>;
      weight = Float(found.ray.weight);
    }
    return {ray, wav_weight * weight};
  }

  std::pair<DirectionSample3f, Spectrum> sample_direction(const Interaction3f& it, const Point2f& sample,
                                                          Mask /* active */) const override {
    DirectionSample3f ds = dr::zeros<DirectionSample3f>();
    Float weight = 0.f;
    if constexpr (!dr::is_array_v<Float>) {
      const Transform4f trafo = m_to_world.value();
      Point3f local = trafo.inverse().transform_affine(it.p);
      const double point[3] = {double(local.x()), double(local.y()), double(local.z())};
      petzval_connection found = m_camera.connect(point, double(sample.x()), double(sample.y()), 0, fraction(it.time));
      ds.p = trafo.transform_affine(Point3f(vector(found.on_front)));
      ds.n = trafo * Vector3f(0.f, 0.f, 1.f);
      ds.d = trafo * vector(found.direction);
      ds.dist = Float(found.distance);
      ds.uv = Point2f(Float(found.importance.raster_x - m_film->crop_offset().x()),
                      Float(found.importance.raster_y - m_film->crop_offset().y()));
      ds.time = it.time;
      ds.pdf = Float(found.pdf);
      weight = found.pdf > 0 ? Float(found.importance.we * crop_scale() / found.pdf) : Float(0.f);
    }
    return {ds, Spectrum(weight)};
  }

  /// Importance of the ray that arrives at si.p from the direction si.wi.
  Spectrum eval(const SurfaceInteraction3f& si, Mask /* active */) const override {
    Float weight = 0.f;
    if constexpr (!dr::is_array_v<Float>) {
      const Transform4f inverse = m_to_world.value().inverse();
      Point3f o = inverse.transform_affine(si.p);
      Vector3f d = inverse * si.wi;
      const double origin[3] = {double(o.x()), double(o.y()), double(o.z())},
                   direction[3] = {-double(d.x()), -double(d.y()), -double(d.z())};
      weight = Float(m_camera.importance(origin, direction, 0, fraction(si.time)).we * crop_scale());
    }
    return Spectrum(weight);
  }

  ScalarBoundingBox3f bbox() const override {
    ScalarPoint3f p = m_to_world.scalar() * ScalarPoint3f(0.f);
    return ScalarBoundingBox3f(p, p);
  }

#if MI_VERSION_MINOR < 7
  MI_DECLARE_CLASS()
#else
  MI_DECLARE_CLASS(PetzvalSensor)
#endif
 private:
  template <typename Number>
  static Vector3f vector(const Number* v) {
    return Vector3f(Float(v[0]), Float(v[1]), Float(v[2]));
  }
  /// Importance in Mitsuba is relative to the area of the crop window, whose samples and positions Mitsuba counts.
  double crop_scale() const {
    return double(m_film->size().x()) * m_film->size().y() / m_film->crop_size().x() / m_film->crop_size().y();
  }
  double fraction(Float time) const {
    if constexpr (dr::is_array_v<Float>)
      return 0;
    else
      return m_shutter_open_time > 0 ? double(time - m_shutter_open) / double(m_shutter_open_time) : 0;
  }

  petzval17::Camera m_camera;
};

#if MI_VERSION_MINOR < 7
MI_IMPLEMENT_CLASS_VARIANT(PetzvalSensor, Sensor)
MI_EXPORT_PLUGIN(PetzvalSensor, "Sensor with a lens of petzval")
#else
MI_EXPORT_PLUGIN(PetzvalSensor)
#endif
NAMESPACE_END(mitsuba)
