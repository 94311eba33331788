// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/scene_description.hpp"

namespace renderer {

enum class ChessPiece { pawn, rook, knight, bishop, queen, king };

/// A piece for squares of 40 mm, its foot in the middle of the plane y = 0; a knight looks along +x. The king is 81 mm
/// high. Turned bodies after the pattern of Staunton's, with outlines of our own.
Mesh chess_piece(ChessPiece piece);

}  // namespace renderer
