// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "petzval/focus/focus_point.hpp"

namespace examples {

/// Reads a list of [{"position_mm":[x,y,z],"weight":1,"blur_mm":0,"at_infinity":false,"extent_stops":2,
/// "fixes_distance":true}, ...]; only the position is required. The frame is the lens frame, with the scene at negative
/// z; at infinity the position is a direction towards the point.
///
/// @throws petzval::Error that names the file, the point (from 1) and the key
std::vector<petzval::FocusTarget> read_targets(const std::filesystem::path& file);

/// Reads a list of [{"from_s":0,"until_s":10,"keys":[{"time_s":0,"position_mm":[x,y,z],"weight":1,"blur_mm":0,
/// "at_infinity":false,"extent_stops":2}, ...],"fixes_distance":true}, ...]. A point without from_s and until_s is
/// valid at all times.
std::vector<petzval::FocusPoint> read_focus_points(const std::filesystem::path& file);

}  // namespace examples
