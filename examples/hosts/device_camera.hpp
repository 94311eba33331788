// SPDX-License-Identifier: Apache-2.0
// A camera sampled from Camera::tables() alone, with nothing but floats and loops: to be copied into a kernel of a GPU.
// PETZVAL_DEVICE: what the functions of the kernel are marked with (__device__, for instance).
#pragma once

#include <cmath>

#include "petzval/camera/camera_tables.hpp"

#ifndef PETZVAL_DEVICE
#define PETZVAL_DEVICE
#endif

namespace hosts {

using Table = petzval::CameraTables;
constexpr int surface_size = static_cast<int>(Table::surface_size);

struct DeviceRay {
  float origin[3] = {0, 0, 0}, direction[3] = {0, 0, -1};  // lens frame, mm, from the front of the lens to the scene
  float weight = 0;                                        // 0: lost
};

struct DevicePlace {
  float x = 0, y = 0, area = 0;  // in the plane of the pupil; area 0: nothing to sample
};

PETZVAL_DEVICE inline int whole_number(const float* t, Table::Position at) { return static_cast<int>(t[at]); }
PETZVAL_DEVICE inline const float* list(const float* t, Table::Position at) { return t + whole_number(t, at); }

/// Turns count from +y towards +x.
PETZVAL_DEVICE inline DevicePlace sample_image(const float* t, float film_x, float film_y, float u, float v, int w) {
  const float* image = list(t, Table::pupil_list) + 5 * w;
  const float way = std::sqrt(v);
  const int blades = whole_number(t, Table::iris_blades);
  float x, y;
  if (blades == 0) {
    const float turn = 6.28318531f * u;
    x = way * std::sin(turn), y = way * std::cos(turn);
  } else {
    constexpr int terms = 8;
    const float at = u * static_cast<float>(blades);
    const int k = static_cast<int>(at) < blades ? static_cast<int>(at) : blades - 1;
    const float q = 2 * (at - static_cast<float>(k)) - 1, square = 2 * q * q - 1;
    const float *edge = list(t, Table::iris), *turn = edge + 2 * terms + 2 * k;
    float across = 0, along = 0;
    for (int i = terms - 1; i >= 0; --i) across = edge[i] + square * across, along = edge[terms + i] + square * along;
    across *= q;
    x = way * (along * turn[0] + across * turn[1]), y = way * (along * turn[1] - across * turn[0]);
  }
  return {image[0] * film_x + image[2] * x, image[1] * film_y + image[3] * y, image[4]};
}

/// Smaller squared distances from the axis, mm^2, have too few digits for a direction.
PETZVAL_DEVICE inline bool off_axis(float square) { return square > 1e-31f; }

PETZVAL_DEVICE inline DevicePlace sample_polygon(const float* t, float film_x, float film_y, float u, float v, int w) {
  const int strips = whole_number(t, Table::strips);
  const float square = film_x * film_x + film_y * film_y, height = std::sqrt(square);
  const float at = t[Table::pupil_radius] > 0 ? height * static_cast<float>(strips) / t[Table::pupil_radius] : 0;
  const int strip = static_cast<int>(at) < strips ? static_cast<int>(at) : strips - 1;
  const float part = at - static_cast<float>(strip);
  const float* row = list(t, Table::pupil_list) + (w * strips + strip) * 784;
  const auto before = [row, part](int k) {
    const float* a = row + (k == 64 ? 4 : 12 + 8 * k);
    return a[0] + part * (a[1] + part * (a[2] + part * a[3]));
  };
  // The polygon is that of a film point on +y; it turns with the point, and u does not.
  const bool turned = off_axis(square);
  const float sine = turned ? film_x / height : 0, cosine = turned ? film_y / height : 1;
  float share = u - std::atan2(sine, cosine) / 6.28318531f;
  share -= std::floor(share);
  const float wanted = share * before(64);
  int k = 0;
  for (int step = 32; step > 0; step /= 2) k += before(k + step) <= wanted ? step : 0;
  const float own = before(k + 1) - before(k), along = own > 0 ? (wanted - before(k)) / own : 0;
  const float *a = row + 8 + 8 * k, *b = a + 8, *o = row + 528 + 4 * k;
  const float ax = a[0] + part * a[2], ay = a[1] + part * a[3], bx = b[0] + part * b[2], by = b[1] + part * b[3];
  const float begin = o[0] + part * o[2], width = o[1] + part * o[3];
  const float squared = (1 - width) * v, way = std::sqrt(squared < begin ? squared : squared + width);
  const float x = way * (ax + along * (bx - ax)), y = row[0] + part * row[1] + way * (ay + along * (by - ay));
  return {cosine * x + sine * y, cosine * y - sine * x, before(64)};
}

/// The polygon at fractions of a cell.
struct DeviceCell {
  const float* numbers;
  float t, s;

  PETZVAL_DEVICE float bilinear(const float* a) const { return a[0] + t * a[1] + s * (a[2] + t * a[3]); }
  PETZVAL_DEVICE float middle(int axis) const { return bilinear(numbers + 4 * axis); }
  /// Area before a corner; 64: the whole.
  PETZVAL_DEVICE float before(int k) const {
    const float* a = numbers + (k == 64 ? 8 : 25 + 17 * k);
    const float by_s = a[3] + t * (a[4] + t * a[5]), by_s2 = a[6] + t * (a[7] + t * a[8]);
    return a[0] + t * (a[1] + t * a[2]) + s * (by_s + s * by_s2);
  }
  /// A place, from the middle, and the whole area. share: of the area before it.
  PETZVAL_DEVICE DevicePlace place(float share, float v) const {
    const float whole = before(64), wanted = share * whole;
    int k = 0;
    for (int step = 32; step > 0; step /= 2) k += before(k + step) <= wanted ? step : 0;
    const float own = before(k + 1) - before(k), along = own > 0 ? (wanted - before(k)) / own : 0, way = std::sqrt(v);
    const float *a = numbers + 17 + 17 * k, *b = a + 17;
    const float ax = bilinear(a), ay = bilinear(a + 4), bx = bilinear(b), by = bilinear(b + 4);
    return {way * (ax + along * (bx - ax)), way * (ay + along * (by - ay)), whole};
  }
};

/// Of a lens with cylinders: in the quadrant x, y >= 0 of the film; the pupils of the others are mirror images.
PETZVAL_DEVICE inline DevicePlace sample_cell(const float* t, float film_x, float film_y, float u, float v, int w) {
  const int rows = whole_number(t, Table::rows), columns = whole_number(t, Table::columns);
  const float row = t[Table::height] > 0 ? std::fabs(film_y) * static_cast<float>(rows) / t[Table::height] : 0;
  if (!(row <= 1.000001f * static_cast<float>(rows))) return {};
  const int i = static_cast<int>(row) < rows ? static_cast<int>(row) : rows - 1;
  const float part_y = row - static_cast<float>(i), *half = list(t, Table::half_widths) + i;
  const float width = half[0] + part_y * (half[1] - half[0]);
  if (!(std::fabs(film_x) <= 1.000001f * width)) return {};
  const float column = width > 0 ? std::fabs(film_x) / width * static_cast<float>(columns) : 0;
  const int j = static_cast<int>(column) < columns ? static_cast<int>(column) : columns - 1;
  const DeviceCell cell{list(t, Table::pupil_list) + ((w * rows + i) * columns + j) * 1122,
                        column - static_cast<float>(j), part_y};
  if (!(cell.before(64) > 0)) return {};
  // u runs on where quadrants meet.
  float share = film_x < 0 ? 1 - u : u;
  if (film_y < 0) share = cell.before(32) / cell.before(64) - share;
  share -= std::floor(share);
  const DevicePlace p = cell.place(share, v);
  const float x = cell.middle(0) + p.x, y = cell.middle(1) + p.y;
  return {film_x < 0 ? -x : x, film_y < 0 ? -y : y, p.area};
}

/// Of a bladed iris: in a film that is turned, and mirrored, until the nearest corner of the iris is on +y.
PETZVAL_DEVICE inline DevicePlace sample_bladed(const float* t, float film_x, float film_y, float u, float v, int w) {
  const int rows = whole_number(t, Table::rows), columns = whole_number(t, Table::columns);
  const int blades = whole_number(t, Table::blades);
  const float square = film_x * film_x + film_y * film_y, height = std::sqrt(square);
  const float count = static_cast<float>(blades);
  const bool turned = off_axis(square);
  const float sine = turned ? film_x / height : 0, cosine = turned ? film_y / height : 1;
  const float row = t[Table::pupil_radius] > 0 ? height * static_cast<float>(rows) / t[Table::pupil_radius] : 0;
  const int i = static_cast<int>(row) < rows ? static_cast<int>(row) : rows - 1;
  // In blades, from one turn before the first corner.
  constexpr float whole_turn = 6.28318531f;
  const float turn = count * (std::atan2(sine, cosine) / whole_turn + 1) + t[Table::first_blade];
  const int nearest = static_cast<int>(turn + 0.5f), blade = nearest % blades;
  const float beside = turn - static_cast<float>(nearest), sign = beside < 0 ? -1.0f : 1.0f;
  const float column = 2 * std::fabs(beside) * static_cast<float>(columns);
  const int j = static_cast<int>(column) < columns ? static_cast<int>(column) : columns - 1;
  const DeviceCell cell{list(t, Table::pupil_list) + ((w * rows + i) * columns + j) * 1139,
                        column - static_cast<float>(j), row - static_cast<float>(i)};
  if (!(cell.before(64) > 0)) return {};
  // u begins at the iris's first corner.
  const int first = sign > 0 ? (blades - blade) % blades : blade;
  float share = cell.before(first * (whole_number(t, Table::blade_corners) / blades)) / cell.before(64) + sign * u;
  share -= std::floor(share);
  const DevicePlace p = cell.place(share, v);
  const float angle = whole_turn * (static_cast<float>(blade) - t[Table::first_blade]) / count;
  const float across = sign * p.x, along = p.y, middle = cell.middle(1);
  return {sine * middle + std::cos(angle) * across + std::sin(angle) * along,
          cosine * middle - std::sin(angle) * across + std::cos(angle) * along, p.area};
}

PETZVAL_DEVICE inline bool by_first_order(const float* t, const float film[2], const float pupil[2], int w,
                                          DeviceRay& ray) {
  float slope[2];
  for (int k = 0; k < 2; ++k) {
    const float* m = list(t, Table::rays) + 8 * w + 4 * k;
    ray.origin[k] = m[0] * film[k] + m[1] * pupil[k];
    slope[k] = m[2] * film[k] + m[3] * pupil[k];
  }
  const float down = -1 / std::sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
  ray.origin[2] = t[Table::reference_z];
  ray.direction[0] = slope[0] * down, ray.direction[1] = slope[1] * down, ray.direction[2] = down;
  return true;
}

/// s and o of a lens of revolution, from film and pupil point of the domain.
PETZVAL_DEVICE inline void turning_sums(const float* t, const float f[2], const float p[2], int w, float s[2],
                                        float o[2]) {
  const float u = f[0] * f[0] + f[1] * f[1], v = f[0] * p[0] + f[1] * p[1], r = p[0] * p[0] + p[1] * p[1];
  const int n = (whole_number(t, Table::degree) - 1) / 2, terms = (n + 1) * (n + 2) * (n + 3) / 6;
  const float* c = list(t, Table::rays) + 4 * terms * w;
  float sums[4] = {0, 0, 0, 0}, by_r = 1;
  for (int k = 0; k <= n; ++k, by_r *= r) {
    float by_v = by_r;
    for (int j = 0; j <= n - k; ++j, by_v *= v) {
      float term = by_v;
      for (int i = 0; i <= n - k - j; ++i, term *= u, ++c) {
        for (int list = 0; list < 4; ++list) sums[list] += c[list * terms] * term;
      }
    }
  }
  for (int k = 0; k < 2; ++k) s[k] = sums[0] * f[k] + sums[1] * p[k], o[k] = sums[2] * f[k] + sums[3] * p[k];
}

/// The same of a lens with cylinders, along one axis.
PETZVAL_DEVICE inline void mirror_sums(const float* t, const float f[2], const float p[2], int w, int axis, float s[2],
                                       float o[2]) {
  const int n = (whole_number(t, Table::degree) - 1) / 2, other = 1 - axis;
  const int terms = (n + 1) * (n + 2) * (n + 3) * (n + 4) / 24 + n * (n + 1) * (n + 2) * (n + 3) / 24;
  const float* c = list(t, Table::rays) + terms * (8 * w + axis);
  float sums[4] = {0, 0, 0, 0};
  for (int odd = 0; odd < 2; ++odd) {
    const int most = n - odd;
    float by_other_pupil = odd ? f[other] * p[other] : 1;
    for (int l = 0; l <= most; ++l, by_other_pupil *= p[other] * p[other]) {
      float by_other_film = by_other_pupil;
      for (int k = 0; k <= most - l; ++k, by_other_film *= f[other] * f[other]) {
        float by_pupil = by_other_film;
        for (int j = 0; j <= most - l - k; ++j, by_pupil *= p[axis] * p[axis]) {
          float term = by_pupil;
          for (int i = 0; i <= most - l - k - j; ++i, term *= f[axis] * f[axis], ++c) {
            for (int list = 0; list < 4; ++list) sums[list] += c[2 * list * terms] * term;
          }
        }
      }
    }
  }
  s[axis] = sums[0] * f[axis] + sums[1] * p[axis], o[axis] = sums[2] * f[axis] + sums[3] * p[axis];
}

/// See RayPolynomial for the chart of rays.
PETZVAL_DEVICE inline bool by_polynomial(const float* t, const float film[2], const float pupil[2], int w,
                                         DeviceRay& ray) {
  const bool mirrors = t[Table::domain_pupil_radius_x] != 0;
  float f[2], p[2], s[2], o[2];
  for (int k = 0; k < 2; ++k) {
    const bool x = mirrors && k == 0;
    const float shift = t[x ? Table::domain_pupil_shift_x : Table::domain_pupil_shift];
    const float radius = t[x ? Table::domain_pupil_radius_x : Table::domain_pupil_radius];
    f[k] = film[k] / t[Table::domain_film_radius];
    p[k] = (pupil[k] - shift * film[k]) / radius;
  }
  if (!(f[0] * f[0] + f[1] * f[1] <= 1.00001f && p[0] * p[0] + p[1] * p[1] <= 1.00001f)) return false;
  if (mirrors) {
    mirror_sums(t, f, p, w, 0, s, o), mirror_sums(t, f, p, w, 1, s, o);
  } else {
    turning_sums(t, f, p, w, s, o);
  }
  const float square = s[0] * s[0] + s[1] * s[1], twice = 2 / (square + 1), along = twice * (s[0] * o[0] + s[1] * o[1]);
  for (int k = 0; k < 2; ++k) ray.origin[k] = o[k] - s[k] * along, ray.direction[k] = twice * s[k];
  ray.origin[2] = along + t[Table::reference_z], ray.direction[2] = twice * (square - 1) / 2;
  return true;
}

/// Sag of a surface and its slope over r: z = sag, dz/dx = slope x. r2: in the section in which a cylinder is curved.
PETZVAL_DEVICE inline bool sag_of(const float* surface, float r2, float& z, float& slope) {
  const float c = surface[1], inside = 1 - (1 + surface[2]) * c * c * r2;
  if (!(inside > 0)) return false;
  const float root = std::sqrt(inside), height = surface[8], rho = std::sqrt(r2) / height;
  float sum = 0, derivative = 0;  // of the aspheric terms by rho, over rho^2 and rho
  for (int order = 40; order >= 2; --order) {
    const float a = surface[9 + order - 2];
    sum = sum * rho + a;
    derivative = derivative * rho + static_cast<float>(order) * a;
  }
  z = c * r2 / (1 + root) + sum * rho * rho;
  slope = c / root + derivative / (height * height);
  return true;
}

/// From the plane of the pupil to the scene, surface by surface from the last.
PETZVAL_DEVICE inline bool by_surfaces(const float* t, int w, DeviceRay& ray) {
  const int count = whole_number(t, Table::surface_count), edges = whole_number(t, Table::edge_count);
  const float* index = list(t, Table::indices) + w * (count + 1);
  float *o = ray.origin, *d = ray.direction;
  for (int i = count - 1; i >= 0; --i) {
    const float* surface = list(t, Table::rays) + surface_size * i;
    const float c = surface[1], e = 1 + surface[2], sense = d[2] > 0 ? 1.0f : -1.0f;
    // In the plane of the vertex the quadratic loses no digits.
    const float start = (surface[0] - o[2]) / d[2];
    const float x = o[0] + start * d[0], y = o[1] + start * d[1];
    // 0 along the axis in which a cylinder is not curved.
    const float in_x = surface[7] == 2 ? 0.0f : 1.0f, in_y = surface[7] == 1 ? 0.0f : 1.0f;
    const float quadratic = c * (in_x * d[0] * d[0] + in_y * d[1] * d[1] + e * d[2] * d[2]);
    const float free = c * (in_x * x * x + in_y * y * y);
    const float linear = d[2] - c * (in_x * x * d[0] + in_y * y * d[1]), square = linear * linear - quadratic * free;
    if (!(square >= 0)) return false;
    float way = free / (linear + sense * std::sqrt(square)), slope = 0;
    for (int step = 0; step < 12; ++step) {  // Newton, for the aspheric terms
      const float px = x + way * d[0], py = y + way * d[1];
      float z = 0;
      if (!sag_of(surface, in_x * px * px + in_y * py * py, z, slope)) return false;
      const float above = way * d[2] - z, rate = d[2] - slope * (in_x * px * d[0] + in_y * py * d[1]);
      way -= above / rate;
      if (std::fabs(above) <= 1e-7f * surface[8]) break;
    }
    o[0] = x + way * d[0], o[1] = y + way * d[1], o[2] = surface[0] + way * d[2];
    const float r2 = o[0] * o[0] + o[1] * o[1];
    if (!(r2 <= surface[3] * surface[3] && r2 >= surface[4] * surface[4])) return false;
    for (int k = 0; k < edges && surface[6] != 0; ++k) {
      const float* edge = list(t, Table::edges) + 4 * k;
      if (o[0] * edge[0] + o[1] * edge[1] + edge[2] * r2 > edge[3]) return false;
    }
    // The normal, against the ray.
    float normal[3] = {in_x * slope * o[0] * sense, in_y * slope * o[1] * sense, -sense};
    const float per_length = 1 / std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + 1);
    float cosine = 0;
    for (int k = 0; k < 3; ++k) normal[k] *= per_length, cosine -= normal[k] * d[k];
    float along = 2 * cosine, ratio = 1;
    if (surface[5] == 0) {
      ratio = index[i + 1] / index[i];
      const float left = 1 - ratio * ratio * (1 - cosine * cosine);
      if (!(left >= 0)) return false;
      along = ratio * cosine - std::sqrt(left);
    }
    for (int k = 0; k < 3; ++k) d[k] = ratio * d[k] + along * normal[k];
  }
  return true;
}

/// Along the ray to the front of the lens, where rays of every model start.
PETZVAL_DEVICE inline void move_to_front(const float* t, DeviceRay& ray) {
  float *o = ray.origin, *d = ray.direction;
  const float c = t[Table::front_curvature], z = o[2] - t[Table::front_z];
  const float e = c * (o[0] * o[0] + o[1] * o[1] + z * z) - 2 * z, along = o[0] * d[0] + o[1] * d[1] + z * d[2];
  const float b = d[2] - c * along, square = b * b - c * e;
  float way = d[2] < 0 ? -z / d[2] : -along;
  if (square > 0 && (b < 0 || c != 0)) {
    const float root = std::sqrt(square);
    way = b < 0 ? e / (b - root) : (b + root) / c;
  }
  for (int k = 0; k < 3; ++k) o[k] += way * d[k];
}

/// A film point and a sample of its pupil, as CameraSample; w: position of a compiled wavelength.
PETZVAL_DEVICE inline DeviceRay sample(const float* t, float film_x, float film_y, float u, float v, int w) {
  DeviceRay ray;
  const bool on_film = std::fabs(film_x - t[Table::film_x]) <= t[Table::half_width] &&
                       std::fabs(film_y - t[Table::film_y]) <= t[Table::half_height];
  const float r2 = film_x * film_x + film_y * film_y, reach = t[Table::pupil_radius] * 1.000001f;
  if (!on_film || !(r2 <= reach * reach)) return ray;
  u = std::fmin(std::fmax(u, 0.0f), 1.0f), v = std::fmin(std::fmax(v, 0.0f), 1.0f);
  DevicePlace place;
  switch (whole_number(t, Table::pupils_kind)) {
    case 0: place = sample_polygon(t, film_x, film_y, u, v, w); break;
    case 1: place = sample_image(t, film_x, film_y, u, v, w); break;
    case 2: place = sample_cell(t, film_x, film_y, u, v, w); break;
    default: place = sample_bladed(t, film_x, film_y, u, v, w);
  }
  if (!(place.area > 0)) return ray;
  const float film[2] = {film_x, film_y}, pupil[2] = {place.x, place.y};
  const float depth = t[Table::pupil_z] - t[Table::film_z], x = place.x - film_x, y = place.y - film_y;
  const float length2 = x * x + y * y + depth * depth;
  bool passes = false;
  switch (whole_number(t, Table::rays_kind)) {
    case 0: passes = by_first_order(t, film, pupil, w, ray); break;
    case 1: passes = by_polynomial(t, film, pupil, w, ray); break;
    default: {
      // Light runs towards +z into the lens, and back after an odd number of mirrors.
      float towards = -1;
      const int count = whole_number(t, Table::surface_count);
      for (int i = 0; i < count; ++i) towards = list(t, Table::rays)[surface_size * i + 5] != 0 ? -towards : towards;
      const float scale = (depth * towards > 0 ? 1 : -1) / std::sqrt(length2);
      ray.origin[0] = place.x, ray.origin[1] = place.y, ray.origin[2] = t[Table::pupil_z];
      ray.direction[0] = x * scale, ray.direction[1] = y * scale, ray.direction[2] = depth * scale;
      passes = by_surfaces(t, w, ray);
    }
  }
  if (!passes) return ray;
  move_to_front(t, ray);
  ray.weight = list(t, Table::scales)[w] * place.area * depth * depth / (length2 * length2);
  return ray;
}

}  // namespace hosts
