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

/// A lens in the world: the complete interface of this renderer to petzval, made to be copied.
///
/// The lens frame is right-handed and looks along -z, like the world of a camera that looks along -z. A pose rotates
/// and shifts the frame. The camera must be compiled for a range that includes the wavelengths of calls.
class LensCamera {
 public:
  /// @throws petzval::Error if the directions of the pose are parallel or zero
  LensCamera(petzval::Camera camera, const Pose& pose);

  const petzval::Camera& camera() const noexcept { return camera_; }
  bool pinhole() const noexcept { return camera_.model() == petzval::ModelKind::pinhole; }
  const petzval::Film& film() const noexcept { return camera_.film(); }
  /// Film point of the sharp image of a point.
  petzval::Projection project(const glm::vec3& point) const noexcept { return camera_.project(to_lens(point)); }
  /// Distance of a point from the front vertex along the axis, mm; negative behind the vertex.
  double depth(const glm::vec3& point) const noexcept;
  /// Map points, mm, and unit directions between the world and the lens frame.
  petzval::Vec3<double> to_lens(const glm::vec3& point) const noexcept;
  petzval::Vec3<double> turn_to_lens(const glm::vec3& direction) const noexcept;
  glm::vec3 to_world(const petzval::Vec3<double>& point) const noexcept;
  /// The first vertex of the lens.
  glm::vec3 front() const noexcept { return to_world({0, 0, 0}); }

  /// Film samples that are drawn in one call, so that the exact lens traces them in SIMD lanes.
  struct Batch {
    std::vector<float> raster_x, raster_y;  ///< pixels from the upper left
    std::vector<float> u, v;                ///< pupil sample
    std::vector<float> nm;                  ///< empty: the primary wavelength
    std::vector<WorldRay> rays;             ///< results of sample()
    std::vector<float> weights;             ///< 0 for a lost ray

    void resize(std::size_t count, bool with_nm);
    std::size_t size() const noexcept { return u.size(); }

   private:
    friend class LensCamera;
    std::vector<float> x_, y_, lens_[6];
  };
  void sample(Batch& batch) const noexcept;
  /// The importance of the rays of a batch, reversed towards the lens, at wavelengths in nm (empty: the primary
  /// wavelength).
  void importance(const Batch& batch, std::span<const float> nm, std::span<petzval::Importance> found) const;

  /// Film point of a ray that runs towards the lens in the world, with its densities.
  petzval::Importance importance(const glm::vec3& point, const glm::vec3& direction,
                                 petzval::Wavelength wavelength) const noexcept;

  /// A connection of the lens with a point or with distant light; position and direction in the world.
  struct Connection {
    glm::vec3 direction{0, 0, 1}, on_front{0, 0, 0};
    double pdf = 0;  ///< 1/sr at the point; for distant light 1/mm^2 across its direction
    petzval::Importance importance{};

    explicit operator bool() const noexcept { return importance.we > 0; }
  };
  Connection connect(const glm::vec3& point, float u, float v, petzval::Wavelength wavelength) const noexcept;
  /// Makes many connections in one call, at wavelengths in nm (empty: the primary wavelength).
  struct Request {
    glm::vec3 point{0, 0, 0};
    float u = 0, v = 0;
  };
  std::vector<Connection> connect(std::span<const Request> requests, std::span<const float> nm) const;
  Connection connect_distant(const glm::vec3& travel, float u, float v, petzval::Wavelength wavelength) const noexcept;
  /// Densities with which connect() and connect_distant() give a ray that runs towards the lens; 0 for a pinhole.
  double pdf_connection(const glm::vec3& point, const glm::vec3& direction,
                        petzval::Wavelength wavelength) const noexcept;
  double pdf_distant_connection(const WorldRay& travel, petzval::Wavelength wavelength) const noexcept;

 private:
  glm::vec3 turn_to_world(const petzval::Vec3<double>& direction) const noexcept;
  Connection connection(const petzval::ImportanceSample& sample) const noexcept;

  petzval::Camera camera_;
  glm::dmat3 turn_{1};          ///< lens to world
  glm::dvec3 origin_{0, 0, 0};  ///< origin of the lens frame, mm
};

}  // namespace renderer
