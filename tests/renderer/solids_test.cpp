// SPDX-License-Identifier: Apache-2.0
#include "renderer/solids.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "petzval/core/error.hpp"
#include "renderer/angel.hpp"
#include "renderer/chess_pieces.hpp"

namespace {

using namespace renderer;

using Place = std::array<float, 3>;
Place place(const glm::vec3& p) { return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}; }  // + 0: -0 becomes 0

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += glm::dot(glm::dvec3(mesh.positions[a]),
                    glm::cross(glm::dvec3(mesh.positions[b]), glm::dvec3(mesh.positions[c]))) /
           6;
  return sum;
}

/// Checks that every edge is used once in each direction, so that the mesh is closed and consistently oriented, that no
/// triangle is degenerate, and that normals have unit length and lie on the front side of their triangles.
void expect_closed(const Mesh& mesh, const std::string& name) {
  std::map<std::pair<Place, Place>, int> passes;
  for (const auto& triangle : mesh.triangles) {
    std::array<glm::vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.positions.at(triangle[i]);
    for (std::size_t i = 0; i < 3; ++i) ++passes[{place(p[i]), place(p[(i + 1) % 3])}];
    const glm::vec3 area = glm::cross(p[1] - p[0], p[2] - p[0]);
    ASSERT_GT(glm::length(area), 0) << name;
    for (const auto i : triangle) {
      EXPECT_NEAR(glm::length(mesh.normals.at(i)), 1, 1e-5) << name;
      EXPECT_GT(glm::dot(mesh.normals[i], area), 0) << name;
    }
  }
  for (const auto& [edge, times] : passes) {
    const auto back = passes.find({edge.second, edge.first});
    ASSERT_NE(back, passes.end()) << name << ": an open edge at height " << edge.first[1];
    ASSERT_EQ(back->second, times) << name;
  }
  EXPECT_GT(volume(mesh), 0) << name;
}

constexpr double pi = std::numbers::pi;

TEST(Lathe, TurnsASemicircleIntoASphere) {
  const Mesh mesh = lathe(std::array{ProfilePoint{0, -10, std::tan(0.125f * 3.14159265f)},
                                     ProfilePoint{10, 0, 0.41421356f}, ProfilePoint{0, 10}});
  expect_closed(mesh, "sphere");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(glm::length(mesh.positions[i]), 10, 1e-4);
    EXPECT_NEAR(glm::dot(mesh.positions[i], mesh.normals[i]), 10, 1e-4);
  }
  // Chords of angle h reduce the area of a circle by about h^2 / 6 and of the sphere along its outline by h^2 / 4.
  const double exact = 4.0 / 3 * pi * 1000;
  EXPECT_LT(volume(mesh), exact);
  EXPECT_GT(volume(mesh), exact * (1 - std::pow(2 * pi / 64, 2) / 6 - std::pow(pi / 18, 2) / 4));
}

TEST(Lathe, TurnsLinesIntoACylinder) {
  const Mesh mesh =
      lathe(std::array{ProfilePoint{0, 0}, ProfilePoint{3, 0}, ProfilePoint{3, 7}, ProfilePoint{0, 7}}, 12);
  expect_closed(mesh, "cylinder");
  EXPECT_NEAR(volume(mesh), 7 * 12 * 4.5 * std::sin(2 * pi / 12), 1e-3);  // a prism of 12 sides
}

TEST(Lathe, BendsOutwardForPositiveBulges) {
  const auto with = [](float bulge) {
    return volume(
        lathe(std::array{ProfilePoint{0, 0}, ProfilePoint{5, 0, bulge}, ProfilePoint{5, 8}, ProfilePoint{0, 8}}));
  };
  EXPECT_GT(with(0.5f), with(0));
  EXPECT_LT(with(-0.5f), with(0));
}

TEST(Lathe, RefusesProfilesThatAreOpenOrCrossTheAxis) {
  EXPECT_THROW(lathe(std::array{ProfilePoint{0, 0}, ProfilePoint{0, 1}}), petzval::Error);
  EXPECT_THROW(lathe(std::array{ProfilePoint{1, 0}, ProfilePoint{2, 1}, ProfilePoint{0, 1}}), petzval::Error);
  EXPECT_THROW(lathe(std::array{ProfilePoint{0, 0}, ProfilePoint{2, 1}, ProfilePoint{1, 1}}), petzval::Error);
  EXPECT_THROW(lathe(std::array{ProfilePoint{0, 0}, ProfilePoint{-2, 1}, ProfilePoint{0, 1}}), petzval::Error);
}

TEST(Tube, AroundALineIsAnEllipticCylinder) {
  const Mesh mesh = tube(std::array{TubeStation{{-2, 0}, {4, 0}, 2}, TubeStation{{-2, 10}, {4, 10}, 2}}, 64);
  expect_closed(mesh, "tube");
  EXPECT_NEAR(volume(mesh) / (10 * pi * 6), 1, 0.002);
}

TEST(Box, HasItsVolume) {
  const Mesh mesh = box({-1, 2, 3}, {4, 5, 10});
  expect_closed(mesh, "box");
  EXPECT_NEAR(volume(mesh), 5 * 3 * 7, 1e-4);
}

TEST(Placed, TurnsCounterClockwiseSeenFromAboveThenMoves) {
  const Mesh mesh = placed(box({0, 0, 0}, {2, 1, 1}), {10, 20, 30}, 90);
  expect_closed(mesh, "placed box");
  glm::vec3 least(1e9f), most(-1e9f);
  for (const glm::vec3& p : mesh.positions)
    for (int i = 0; i < 3; ++i) least[i] = std::min(least[i], p[i]), most[i] = std::max(most[i], p[i]);
  EXPECT_LT(glm::distance(least, {10, 20, 28}), 1e-5);
  EXPECT_LT(glm::distance(most, {11, 21, 30}), 1e-5);
}

TEST(ChessPieces, AreClosedAndStandOnTheBoard) {
  for (const ChessPiece piece : {ChessPiece::pawn, ChessPiece::rook, ChessPiece::knight, ChessPiece::bishop,
                                 ChessPiece::queen, ChessPiece::king}) {
    const Mesh mesh = chess_piece(piece);
    const std::string name = "piece " + std::to_string(static_cast<int>(piece));
    expect_closed(mesh, name);
    for (const glm::vec3& p : mesh.positions) {
      EXPECT_GE(p.y, 0) << name;
      EXPECT_LT(std::hypot(p.x, p.z), 20) << name;  // inside its square
    }
  }
}

TEST(Angels, AreClosedWithTheRequestedHeight) {
  for (const AngelPose pose : {AngelPose::praying, AngelPose::calling}) {
    const Mesh mesh = angel(pose, 500);
    expect_closed(mesh, "angel");
    glm::vec3 least(1e9f), most(-1e9f), crown(0);
    for (const glm::vec3& p : mesh.positions) {
      least = glm::min(least, p), most = glm::max(most, p);
      if (std::abs(p.x) < 10 && p.y > crown.y) crown = p;
    }
    EXPECT_EQ(least.y, 0);
    EXPECT_NEAR(crown.y, 500, 1);
    EXPECT_NEAR(most.y, 500, 6);  // the raised hand may reach over the crown
    EXPECT_NEAR(most.x - least.x, 0.76 * 500, 3);
    EXPECT_NEAR(most.x, -least.x, 1);  // the wings
  }
}

}  // namespace
