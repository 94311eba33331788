// SPDX-License-Identifier: Apache-2.0
#include "renderer/chess_pieces.hpp"

#include <initializer_list>
#include <vector>

#include "renderer/solids.hpp"

namespace renderer {
namespace {

using Profile = std::vector<ProfilePoint>;

/// The foot of all pieces, up to a height of 8 mm and 0.7 of its radius.
Profile foot(float radius) {
  return {{0, 0},
          {0.96f * radius, 0, 0.6f},
          {0.96f * radius, 3.4f},
          {0.84f * radius, 4, 0.8f},
          {0.84f * radius, 6.6f},
          {0.74f * radius, 7}};
}

Mesh turned(float radius, std::initializer_list<ProfilePoint> above) {
  Profile profile = foot(radius);
  profile.insert(profile.end(), above);
  return lathe(profile);
}

Mesh knight() {
  Mesh mesh = turned(14.5f, {{10, 8, -0.3f}, {8.5f, 14, 0.7f}, {8.5f, 16.5f}, {7, 17}, {0, 17}});
  // From the neck over the crown to the muzzle: the mane on the left, the throat on the right.
  constexpr TubeStation head[] = {{{-8, 15}, {7, 15}, 7},
                                  {{-9.5f, 23}, {6, 22}, 6.4f},
                                  {{-9.5f, 32}, {4.5f, 28}, 5.6f},
                                  {{-7, 41}, {4.2f, 32.5f}, 5},
                                  {{-2, 46.5f}, {4.8f, 34.5f}, 4.8f},
                                  {{4.5f, 47.5f}, {6.5f, 35}, 4.6f},
                                  {{10.5f, 43.5f}, {9, 34.2f}, 4.2f},
                                  {{15, 38.5f}, {12, 32.6f}, 3.6f},
                                  {{17, 35.2f}, {14.6f, 31.8f}, 3}};
  append(mesh, tube(head));
  for (const float side : {-1.0f, 1.0f}) {
    constexpr ProfilePoint ear[] = {{0, 0}, {1.9f, 0, 0.15f}, {0, 8}};
    append(mesh, placed(lathe(ear, 24), {-1, 43, 2.6f * side}));
  }
  return mesh;
}

Mesh king() {
  Mesh mesh = turned(16, {{11, 8.5f, -0.22f},
                          {5.6f, 48, 0},
                          {8.5f, 48.5f, 0.8f},
                          {8.5f, 50.5f},
                          {10.8f, 51.5f, 0.8f},
                          {10.8f, 54.5f},
                          {6.6f, 55.5f, -0.1f},
                          {10.6f, 67, 0.3f},
                          {10.2f, 69, 0.2f},
                          {2.2f, 72.4f},
                          {0, 72.4f}});
  append(mesh, box({-1.4f, 71.5f, -1.4f}, {1.4f, 81, 1.4f}));
  append(mesh, box({-4, 75.2f, -1.3f}, {4, 77.8f, 1.3f}));
  return mesh;
}

}  // namespace

Mesh chess_piece(ChessPiece piece) {
  switch (piece) {
    case ChessPiece::pawn:
      return turned(
          13,
          {{9, 8, -0.25f}, {4.2f, 25}, {7.8f, 26, 0.8f}, {7.8f, 28.5f}, {4.5f, 29.6f}, {4.5f, 30.64f, 0.7f}, {0, 43}});
    case ChessPiece::rook:
      return turned(15, {{10.5f, 8.5f, -0.18f},
                         {7.6f, 31},
                         {10, 32, 0.8f},
                         {10, 34.4f},
                         {9, 35},
                         {11.2f, 39},
                         {11.2f, 48},
                         {8.4f, 48},
                         {8.4f, 43.5f},
                         {0, 43.5f}});
    case ChessPiece::knight: return knight();
    case ChessPiece::bishop:
      return turned(14, {{9.6f, 8.5f, -0.25f},
                         {4.6f, 34},
                         {8.4f, 35, 0.8f},
                         {8.4f, 37.8f},
                         {5, 39, 0.38f},
                         {1.5f, 57, 0.72f},
                         {0, 61.5f}});
    case ChessPiece::queen:
      return turned(15.5f, {{10.8f, 8.5f, -0.22f},
                            {5.2f, 44},
                            {8, 44.5f, 0.8f},
                            {8, 46.5f},
                            {9.8f, 47.4f, 0.8f},
                            {9.8f, 50},
                            {6, 51, -0.12f},
                            {10.2f, 64},
                            {8.6f, 64},
                            {7.8f, 62.4f, 0.25f},
                            {1.8f, 66, 0.71f},
                            {0, 70.8f}});
    case ChessPiece::king: return king();
  }
  return {};
}

}  // namespace renderer
