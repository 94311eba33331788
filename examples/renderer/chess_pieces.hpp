// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/scene_description.hpp"

namespace renderer {

enum class ChessPiece { pawn, rook, knight, bishop, queen, king };

/// A piece for squares of 40 mm with the centre of its foot at the origin; a knight looks along +x. The king is 81 mm
/// high. The pieces are solids of revolution in the Staunton pattern, with original outlines.
Mesh chess_piece(ChessPiece piece);

}  // namespace renderer
