// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/glm.hpp>

#include "renderer/albedo.hpp"

namespace renderer {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float coat_ior = 1.5f;
/// Diffuse reflectance of a coat of index 1.5 from inside: 1 - (1 - 0.0918) / 1.5^2, where 0.0918 is its diffuse
/// reflectance from outside.
constexpr float coat_inside = 0.5964f;

float largest(const Rgb& colour) { return std::max({colour.r, colour.g, colour.b}); }
float squared(float x) { return x * x; }

/// Fresnel reflectance of a smooth interface. cosine: of the incident direction, negative inside.
float fresnel(float cosine, float ior) {
  const float eta = cosine > 0 ? ior : 1 / ior, c = std::min(std::abs(cosine), 1.0f);
  const float sine2 = (1 - c * c) / (eta * eta);
  if (sine2 >= 1) return 1;
  const float t = std::sqrt(1 - sine2);
  return (squared((eta * c - t) / (eta * c + t)) + squared((c - eta * t) / (c + eta * t))) / 2;
}

Lanes schlick(const Lanes& head_on, float cosine) {
  const float x = std::clamp(1 - cosine, 0.0f, 1.0f);
  return head_on + (1.0f - head_on) * (x * x * x * x * x);
}

/// GGX distribution. m, w: in the frame of the normal, m on its side.
float facets(const glm::vec3& m, float alpha) {
  // cos^4 (1 + tan^2 / alpha^2)^2, written without cancellation near the normal.
  const float d = m.z * m.z + (m.x * m.x + m.y * m.y) / (alpha * alpha);
  return m.z > 0 ? 1 / (pi * alpha * alpha * d * d) : 0;
}
float lambda(const glm::vec3& w, float alpha) {
  return (std::sqrt(1 + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z)) - 1) / 2;
}
float shown(const glm::vec3& o, const glm::vec3& i, float alpha) {
  return 1 / (1 + lambda(o, alpha) + lambda(i, alpha));
}
/// Density of the facets visible from o.
float visible(const glm::vec3& o, const glm::vec3& m, float alpha) {
  return facets(m, alpha) * std::abs(glm::dot(o, m)) / ((1 + lambda(o, alpha)) * std::abs(o.z));
}
glm::vec3 sample_facet(const glm::vec3& o, float alpha, float u, float v) {
  const float side = o.z < 0 ? -1.0f : 1.0f;
  const glm::vec3 stretched = glm::normalize(side * glm::vec3(alpha * o.x, alpha * o.y, o.z));
  const float length = std::hypot(stretched.x, stretched.y);
  const glm::vec3 x = length > 0 ? glm::vec3(-stretched.y, stretched.x, 0) / length : glm::vec3(1, 0, 0);
  const glm::vec3 y = glm::cross(stretched, x);
  const float radius = std::sqrt(u), angle = 2 * pi * v, t1 = radius * std::cos(angle);
  const float s = (1 + stretched.z) / 2;
  const float t2 = (1 - s) * std::sqrt(std::max(0.0f, 1 - t1 * t1)) + s * radius * std::sin(angle);
  const glm::vec3 h = t1 * x + t2 * y + std::sqrt(std::max(0.0f, 1 - t1 * t1 - t2 * t2)) * stretched;
  return glm::normalize(glm::vec3(alpha * h.x, alpha * h.y, std::max(1e-6f, h.z)));
}

glm::vec3 reflected(const glm::vec3& w, const glm::vec3& m) { return 2 * glm::dot(w, m) * m - w; }

/// Refracts w through a facet m, whose side has positive cosines; nullopt for total internal reflection.
std::optional<glm::vec3> refracted(const glm::vec3& w, const glm::vec3& m, float ior) {
  const float c = glm::dot(w, m), eta = c > 0 ? ior : 1 / ior, sine2 = (1 - c * c) / (eta * eta);
  if (sine2 >= 1) return {};
  const glm::vec3 facing = c > 0 ? m : -m;
  return -w / eta + (std::abs(c) / eta - std::sqrt(1 - sine2)) * facing;
}

}  // namespace

Bsdf::Bsdf(const SurfacePoint& point, const glm::vec3& wo, const PathColours& colours) noexcept
    : material_(point.object->material), normal_(point.normal), wo_(wo), frame_(point.shading) {
  const Rgb colour = reflectance(material_, point.position, point.uv);
  float probability = largest(colour);
  if (std::holds_alternative<Mirror>(material_)) {
    specular_ = true;
  } else if (const auto* rough = std::get_if<Rough>(&material_)) {
    alpha_ = rough->roughness;
  } else if (const auto* glass = std::get_if<Glass>(&material_)) {
    alpha_ = glass->roughness;
    specular_ = alpha_ == 0;
    through_ = true;
  } else if (const auto* varnish = std::get_if<Varnish>(&material_)) {
    probability = std::max(probability, 0.2f);
    alpha_ = varnish->roughness;
  }
  if (!through_) {
    colour_ = colours.from_rgb * colour;
    goes_on_ = std::clamp(double{probability}, 0.05, 1.0);
  }
  if (!through_ && glm::dot(normal_, wo) < 0) {
    normal_ = -normal_;
    frame_ = Frame(-point.shading);
  }
  o_ = frame_.to_local(wo);
}

bool Bsdf::same_side(const glm::vec3& wi) const noexcept {
  return (glm::dot(normal_, wo_) > 0) == (glm::dot(normal_, wi) > 0);
}

double Bsdf::coat_fraction(const glm::vec3& o) const noexcept {
  const float f = fresnel(o.z, coat_ior);
  return std::clamp(f / (f + (1 - f) * static_cast<float>(goes_on_)), 0.1f, 0.9f);
}

float Bsdf::correction(const glm::vec3& wi, Carries carries) const noexcept {
  if (carries == Carries::radiance) return 1;
  const glm::vec3& ns = frame_.z;
  return std::abs(glm::dot(wo_, ns) * glm::dot(wi, normal_) / (glm::dot(wo_, normal_) * glm::dot(wi, ns)));
}

/// A facet of rough glass that connects two directions; value and density follow from the facet.
struct Facet {
  glm::vec3 m{0, 0, 1};
  float jacobian = 0, f = 0, eta = 1;
};
static std::optional<Facet> through_facet(const glm::vec3& o, const glm::vec3& i, float ior) {
  const float eta = o.z > 0 ? ior : 1 / ior;  // index on the side of i, divided by the index on the side of o
  glm::vec3 m = o + eta * i;
  const float length = glm::length(m);
  if (!(length > 0)) return {};
  m /= m.z > 0 ? length : -length;
  const float om = glm::dot(o, m), im = glm::dot(i, m);
  if (om * o.z <= 0 || im * i.z <= 0) return {};
  return Facet{m, std::abs(im) / squared(im + om / eta), fresnel(om, ior), eta};
}

Lanes Bsdf::value(const glm::vec3& o, const glm::vec3& i, Carries carries) const noexcept {
  if (specular_ || o.z == 0 || i.z == 0) return Lanes(0);
  if (through_) {
    const float ior = std::get<Glass>(material_).ior;
    if (o.z * i.z > 0) {
      const glm::vec3 m = glm::normalize((o + i) * (o.z > 0 ? 1.0f : -1.0f));
      return Lanes(fresnel(glm::dot(o, m), ior) * facets(m, alpha_) * shown(o, i, alpha_) / std::abs(4 * o.z * i.z));
    }
    const auto facet = through_facet(o, i, ior);
    if (!facet) return Lanes(0);
    const float om = std::abs(glm::dot(o, facet->m));
    const float f =
        (1 - facet->f) * facets(facet->m, alpha_) * shown(o, i, alpha_) * facet->jacobian * om / std::abs(o.z * i.z);
    return Lanes(carries == Carries::radiance ? f / squared(facet->eta) : f);
  }
  if (o.z < 0 || i.z < 0) return Lanes(0);
  if (std::holds_alternative<Diffuse>(material_)) return colour_ / pi;
  const glm::vec3 m = glm::normalize(o + i);
  const float surface = facets(m, alpha_) * shown(o, i, alpha_) / (4 * o.z * i.z);
  if (std::holds_alternative<Rough>(material_)) return schlick(colour_, glm::dot(o, m)) * surface;
  const float passes = (1 - fresnel(o.z, coat_ior)) * (1 - fresnel(i.z, coat_ior)) / squared(coat_ior);
  return Lanes(fresnel(glm::dot(o, m), coat_ior) * surface) + colour_ * passes / (pi * (1.0f - coat_inside * colour_));
}

double Bsdf::density(const glm::vec3& o, const glm::vec3& i) const noexcept {
  if (specular_ || o.z == 0 || i.z == 0) return 0;
  if (through_) {
    const float ior = std::get<Glass>(material_).ior;
    if (o.z * i.z > 0) {
      const glm::vec3 m = glm::normalize((o + i) * (o.z > 0 ? 1.0f : -1.0f));
      const float om = glm::dot(o, m);
      return fresnel(om, ior) * visible(o, m, alpha_) / (4 * std::abs(om));
    }
    const auto facet = through_facet(o, i, ior);
    return facet ? (1 - facet->f) * visible(o, facet->m, alpha_) * facet->jacobian : 0;
  }
  if (o.z < 0 || i.z < 0) return 0;
  const double diffuse = double{i.z} / std::numbers::pi;
  if (std::holds_alternative<Diffuse>(material_)) return diffuse;
  const glm::vec3 m = glm::normalize(o + i);
  const double surface = visible(o, m, alpha_) / (4 * std::abs(glm::dot(o, m)));
  if (std::holds_alternative<Rough>(material_)) return surface;
  const double coat = coat_fraction(o);
  return coat * surface + (1 - coat) * diffuse;
}

Lanes Bsdf::times_cosine(const glm::vec3& wi, Carries carries) const noexcept {
  const glm::vec3 i = frame_.to_local(wi);
  if (same_side(wi) != (o_.z * i.z > 0)) return Lanes(0);
  const Lanes f = value(o_, i, carries);
  return f == Lanes(0) ? f : f * std::abs(i.z) * correction(wi, carries);
}

double Bsdf::pdf(const glm::vec3& wi) const noexcept { return density(o_, frame_.to_local(wi)); }
double Bsdf::pdf_reverse(const glm::vec3& wi) const noexcept { return density(frame_.to_local(wi), o_); }

std::optional<Bsdf::Sample> Bsdf::sample_specular(float choice, Carries carries) const noexcept {
  Sample result{.specular = true};
  glm::vec3 i(-o_.x, -o_.y, o_.z);
  result.weight = colour_;
  result.pdf = result.pdf_reverse = 1;
  if (through_) {
    const float ior = std::get<Glass>(material_).ior, f = fresnel(o_.z, ior);
    result.weight = Lanes(1);
    result.pdf = f;
    if (choice >= f) {
      const auto t = refracted(o_, {0, 0, 1}, ior);
      if (!t) return {};
      i = *t;
      result.pdf = 1 - f;
      if (carries == Carries::radiance) result.weight /= squared(o_.z > 0 ? ior : 1 / ior);
    }
    result.pdf_reverse = result.pdf;
  }
  result.wi = glm::normalize(frame_.to_world(i));
  if (same_side(result.wi) != (o_.z * i.z > 0)) return {};
  result.weight *= correction(result.wi, carries);
  return result;
}

std::optional<Bsdf::Sample> Bsdf::sample(float choice, float u, float v, Carries carries) const noexcept {
  if (o_.z == 0 || (!through_ && o_.z < 0)) return {};
  if (specular_) return sample_specular(choice, carries);
  glm::vec3 i;
  const bool diffuse = std::holds_alternative<Diffuse>(material_);
  if (diffuse || (std::holds_alternative<Varnish>(material_) && choice >= static_cast<float>(coat_fraction(o_)))) {
    i = by_cosine(u, v);
  } else {
    const glm::vec3 m = sample_facet(o_, alpha_, u, v);
    if (through_ && choice >= fresnel(glm::dot(o_, m), std::get<Glass>(material_).ior)) {
      const auto t = refracted(o_, m, std::get<Glass>(material_).ior);
      if (!t || t->z * o_.z >= 0) return {};
      i = *t;
    } else {
      i = reflected(o_, m);
      if (i.z * o_.z <= 0) return {};
    }
  }
  Sample result{.wi = glm::normalize(frame_.to_world(i))};
  result.pdf = pdf(result.wi);
  if (!(result.pdf > 0)) return {};
  result.weight = times_cosine(result.wi, carries) / static_cast<float>(result.pdf);
  if (result.weight == Lanes(0)) return {};
  result.pdf_reverse = pdf_reverse(result.wi);
  return result;
}

}  // namespace renderer
