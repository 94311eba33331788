// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "petzval/camera/camera.hpp"
#include "renderer/scene_description.hpp"

namespace renderer {

/// A ray of the world, mm.
struct WorldRay {
  glm::vec3 origin{0, 0, 0}, direction{0, 0, -1};
};

/// A lens in the world: all that this renderer asks of petzval. Copy it to your own.
///
/// The lens frame is right-handed and looks along -z, as the world of a camera that looks that way does: a pose turns
/// and shifts it. Where a call takes a wavelength, the camera must have been compiled for a range that holds it.
class LensCamera {
 public:
  /// Throws petzval::Error for a pose without directions.
  LensCamera(petzval::Camera camera, const Pose& pose);

  const petzval::Camera& camera() const noexcept { return camera_; }
  bool pinhole() const noexcept { return camera_.model() == petzval::ModelKind::pinhole; }
  const petzval::Film& film() const noexcept { return camera_.film(); }
  /// Where the lens sees a point sharp.
  petzval::Projection project(const glm::vec3& point) const noexcept { return camera_.project(to_lens(point)); }
  /// Distance of a point from the front vertex along the axis, mm; negative behind the vertex.
  double depth(const glm::vec3& point) const noexcept;
  /// A point of the world in the lens frame, mm.
  petzval::Vec3<double> to_lens(const glm::vec3& point) const noexcept;
  /// The first vertex of the lens.
  glm::vec3 front() const noexcept { return to_world({0, 0, 0}); }

  /// Samples of the film, drawn in one call: the exact lens traces them side by side.
  struct Batch {
    std::vector<float> raster_x, raster_y;  ///< in pixels, from the upper left
    std::vector<float> u, v;                ///< of the pupil
    std::vector<float> nm;                  ///< or empty: the primary wavelength
    std::vector<WorldRay> rays;             ///< what sample() finds
    std::vector<float> weights;             ///< 0 for a lost ray

    void resize(std::size_t count, bool with_nm);
    std::size_t size() const noexcept { return u.size(); }

   private:
    friend class LensCamera;
    std::vector<float> x_, y_, lens_[6];
  };
  void sample(Batch& batch) const noexcept;
  /// The importance of the rays of a batch, back towards the lens, at these wavelengths in nm, or with none at the
  /// primary one. found: one for each.
  void importance(const Batch& batch, std::span<const float> nm, std::span<petzval::Importance> found) const;

  /// Where a ray in the world that runs towards the lens meets the film, and its densities.
  petzval::Importance importance(const glm::vec3& point, const glm::vec3& direction,
                                 petzval::Wavelength wavelength) const noexcept;

  /// A connection from a point, or of light that travels in a direction, with a place and a direction in the world.
  struct Connection {
    glm::vec3 direction{0, 0, 1}, on_front{0, 0, 0};
    double pdf = 0;  ///< 1/sr at the point; of light from afar 1/mm^2 across it
    petzval::Importance importance{};

    explicit operator bool() const noexcept { return importance.we > 0; }
  };
  Connection connect(const glm::vec3& point, float u, float v, petzval::Wavelength wavelength) const noexcept;
  /// Many connections in one call, each at its wavelength in nm, or with none at the primary one.
  struct Request {
    glm::vec3 point{0, 0, 0};
    float u = 0, v = 0;
  };
  std::vector<Connection> connect(std::span<const Request> requests, std::span<const float> nm) const;
  Connection connect_distant(const glm::vec3& travel, float u, float v, petzval::Wavelength wavelength) const noexcept;
  /// The densities with which these two give a ray that runs towards the lens; 0 for a pinhole.
  double pdf_connection(const glm::vec3& point, const glm::vec3& direction,
                        petzval::Wavelength wavelength) const noexcept;
  double pdf_distant_connection(const WorldRay& travel, petzval::Wavelength wavelength) const noexcept;

 private:
  petzval::Vec3<double> turn_to_lens(const glm::vec3& direction) const noexcept;
  glm::vec3 to_world(const petzval::Vec3<double>& point) const noexcept;
  glm::vec3 turn_to_world(const petzval::Vec3<double>& direction) const noexcept;
  Connection connection(const petzval::ImportanceSample& sample) const noexcept;

  petzval::Camera camera_;
  glm::dmat3 turn_{1};          ///< lens to world
  glm::dvec3 origin_{0, 0, 0};  ///< of the lens frame
};

}  // namespace renderer
