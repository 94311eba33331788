// SPDX-License-Identifier: Apache-2.0
#include "focus_pull.hpp"

#include <algorithm>
#include <cmath>

#include "files.hpp"
#include "focus_points.hpp"
#include "json_input.hpp"
#include "petzval/core/error.hpp"
#include "text.hpp"

namespace examples {
double FocusPull::distance_mm(std::uint32_t frame, std::uint32_t count) const {
  const double time =
      text.ends_with(".json") ? keys.front().time_s + time_s(frame) : frame / (static_cast<double>(count) - 1);
  const auto after = std::ranges::find_if(keys, [&](const Key& key) { return key.time_s > time; });
  if (after == keys.begin() || after == keys.end()) return 1 / (after == keys.end() ? keys.back() : *after).inverse_mm;
  const Key &a = after[-1], &b = *after;
  return 1 / std::lerp(a.inverse_mm, b.inverse_mm, (time - a.time_s) / (b.time_s - a.time_s));
}

double FocusPull::nearest_mm() const { return 1 / std::ranges::max(keys, {}, &Key::inverse_mm).inverse_mm; }

void add_focus_pull(App& app, FocusPull& pull, std::optional<double>& focus_mm, const std::string& frames_help) {
  app.add_option(
         "--focus",
         [&](const std::string& text) {
           pull.text = text, pull.keys.clear();
           if (text.ends_with(".json")) {
             pull.keys = read_distances(text, pull.origin);
             focus_mm = 1 / pull.keys.front().inverse_mm;
             return;
           }
           const std::size_t colon = text.find(':');
           focus_mm = parse_length("--focus", text.substr(0, colon), positive_length);
           if (colon == std::string::npos) return;
           const double last = parse_length("--focus", text.substr(colon + 1), positive_length);
           pull.keys = {{0, 1 / *focus_mm}, {1, 1 / last}};
         },
         "distance of the subject in focus (mm or inf), or A:B, from A to B over --frames; steps of 1/distance are "
         "equal; KEYS.json: distances over time, as petzval pull writes them")
      ->type_name("LENGTH|A:B|KEYS.json")
      ->required();
  add_count(app, "--frames", pull.frames, FocusPull::frame_counts, "number of frames; " + frames_help)
      ->default_str("1; KEYS.json: up to the last key");
  add_number(app, "--fps", pull.frames_per_s, positive_number, "frames per second, for times of keys")
      ->default_str("24");
}

std::string to_json(const std::vector<FocusPull::Key>& keys, const std::string& from) {
  Json list = Json::array();
  for (const FocusPull::Key& key : keys) {
    list.push_back({{"time_s", key.time_s}, {"distance_mm", finite_or_null(1 / key.inverse_mm)}});
  }
  return Json{{"distance_from", from}, {"keys", list}}.dump(1) + '\n';
}

std::string frame_number(std::uint32_t frame) {
  const std::string digits = std::to_string(frame + 1);
  return std::string(4 - std::min<std::size_t>(digits.size(), 4), '0') + digits;
}

}  // namespace examples
