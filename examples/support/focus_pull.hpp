// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli.hpp"

namespace examples {

/// A distance in focus that changes over frames: --focus A:B, or the file of keys that `petzval pull` writes.
///
/// 1/distance is linear in time between keys. The film then moves uniformly, and infinity is an ordinary distance.
struct FocusPull {
  static constexpr Range frame_counts{1, 100000, "a whole number from 1 to 100000"};
  struct Key {
    double time_s = 0, inverse_mm = 0;
  };
  std::vector<Key> keys = {};  ///< A:B: the times 0 and 1; empty: the focus does not move
  std::string text = {};       ///< value of --focus
  std::string origin = {};     ///< origin of the distances of a file; empty: --from
  std::uint32_t frames = 0;    ///< 0: not given
  double frames_per_s = 0;     ///< 0: not given, 24

  bool moves() const noexcept { return !keys.empty(); }
  /// Time of a frame, s.
  double time_s(std::uint32_t frame) const noexcept { return frame / (frames_per_s > 0 ? frames_per_s : 24); }
  /// Distance in focus in a frame of `count` frames, mm.
  double distance_mm(std::uint32_t frame, std::uint32_t count) const;
  /// The nearest distance of all keys, mm. Requires moves().
  double nearest_mm() const;
};

/// Adds --focus, which also sets focus_mm to the first distance, --frames and --fps.
/// @param frames_help  names of the results of frames
void add_focus_pull(App& app, FocusPull& pull, std::optional<double>& focus_mm, const std::string& frames_help);

/// The keys as a file. @param from  origin of the distances
std::string to_json(const std::vector<FocusPull::Key>& keys, const std::string& from);

/// Number of a frame in names of files and folders, such as 0001.
std::string frame_number(std::uint32_t frame);

}  // namespace examples
