// SPDX-License-Identifier: Apache-2.0
#include "page_positions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "page_table.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

/// The names of Positions, with half angles and half heights, and the names of pages in lower case without blanks and
/// punctuation. "" names what is not read.
constexpr std::array<std::pair<const char*, std::string_view>, 12> quantities = {{
    {"Focal Length", "f f' fl efl focallength effectivefocallength focallengthf"},
    {"F-Number", "fno fnumber f/# f/no f/number fn f# numericalaperturefno fnumberfno"},
    {"Angle of View", "2w 2\u03c9 2omega fullangleofview fullfieldangle totalangleofview fov"},
    {"half angle", "w \u03c9 omega halfangle halfangleofview halffieldangle halfviewangle halfview hfov"},
    {"angle", "angleofview viewangle viewingangle fieldangle angleoffield fieldofview picturingangle"},
    {"half height", "imageheight y y' ymax maximumimageheight imageheighty maximageheight ih"},
    {"Image Height", "imagediagonal diagonal imagecircle imagecirclediameter"},
    {"Bf", "bf fb b.f bfl backfocus backfocallength bk"},
    {"Magnification", "\u03b2 beta magnification photographicmagnification imagingmagnification lateralmagnification"},
    {"d0", "d0 objectdistance subjectdistance shootingdistance workingdistance"},
    {"Total Length", "l tl totallength totallenslength overalllength lenstotallength totaltracklength ttl wholelength"},
    {"", "zr zoomratio zoomingratio variablemagnificationratio variablepowerratio"},
}};

std::string plain(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const std::size_t close = name[i] == '(' ? name.find(')', i) : name[i] == '[' ? name.find(']', i) : name.npos;
    if (close != name.npos) {
      i = close;
    } else if (std::string_view(" \t()[]:,.*-'").find(name[i]) == std::string_view::npos) {
      result += lower(name[i]);
    }
  }
  return result;
}

/// The number in "1:2.8", "f/2.8" and "F2.8"; empty for other words.
std::string f_number_of(std::string_view word) {
  for (const std::string_view start : {"1:", "f/", "F/", "F"}) {
    if (word.starts_with(start) && number(word.substr(start.size()))) return std::string(word.substr(start.size()));
  }
  return {};
}

/// The tokens of a line; "24.7-67.9" becomes two numbers.
std::vector<PageToken> with_ranges(const std::vector<PageToken>& tokens) {
  std::vector<PageToken> result;
  for (const PageToken& token : tokens) {
    std::string apart = token.text;
    if (apart.size() > 2 && apart.ends_with("mm") && number(apart.substr(0, apart.size() - 2))) {
      result.push_back({apart.substr(0, apart.size() - 2), true});  // "51.6mm"
      continue;
    }
    std::replace(apart.begin() + (apart.empty() ? 0 : 1), apart.end(), '-', ' ');
    const auto parts = words(apart);
    if (token.is_number || parts.size() < 2 ||
        !std::ranges::all_of(parts, [](auto p) { return number(p).has_value(); })) {
      result.push_back(token);
    } else {
      for (const std::string_view part : parts) result.push_back({std::string(part), true});
    }
  }
  // "14.4 - 20.0 - 29.1": dashes between all numbers are separators.
  const auto is_dash = [](const PageToken& token) { return is_one_of(token.text, "- to"); };
  const auto dashes = std::ranges::count_if(result, is_dash);
  std::size_t between = 0;
  for (std::size_t i = 1; i + 1 < result.size(); ++i) {
    between += is_dash(result[i]) && result[i - 1].is_number && result[i + 1].is_number;
  }
  const auto numbers = std::ranges::count(result, true, &PageToken::is_number);
  if (dashes > 0 && between == static_cast<std::size_t>(dashes) && dashes + 1 == numbers) {
    std::erase_if(result, is_dash);
  }
  return result;
}

}  // namespace

std::optional<std::string> PagePositions::quantity(std::string_view name) const {
  const std::string word = gaps_.contains(std::string(name)) ? std::string() : plain(name);
  const auto found = std::ranges::find_if(quantities, [&](const auto& q) { return is_one_of(word, q.second); });
  if (found != quantities.end()) return found->first;
  const std::string gap = gaps_.contains(std::string(name)) ? std::string(name) : variable_name(name);
  return gap.empty() || !gaps_.contains(gap) ? std::nullopt : std::optional(gap);
}

/// Takes the names of positions: "Wide Middle Tele", "infinity close".
bool PagePositions::take_names(const PageLine& line) {
  if (line.numbers() > 0) return false;
  std::vector<std::string> names;
  for (const PageToken& token : line.tokens) {
    const std::string word = lower(token.text);
    const auto starts = [&](std::initializer_list<const char*> any) {
      return std::ranges::any_of(any, [&](const char* a) { return word.starts_with(a); });
    };
    if (starts({"wide"}) || token.text == "W") names.emplace_back("wide");
    if (starts({"middle", "intermediate", "mid"}) || token.text == "M") names.emplace_back("middle");
    if (starts({"tele"}) || token.text == "T") names.emplace_back("tele");
    if (starts({"infinit", "inf"})) names.emplace_back("infinity");
    if (starts({"close", "near", "closest", "shortest"})) names.emplace_back("close");
  }
  if (names.size() < 2) return false;
  if (names_.empty()) names_ = std::move(names);
  return true;
}

/// Takes the names of columns, with at least one thickness: "f d5 d10 d16".
bool PagePositions::take_columns(const PageLine& line) {
  std::vector<std::string> found;
  bool any_gap = false;
  for (std::size_t i = 0; i < line.tokens.size(); ++i) {
    const PageToken& token = line.tokens[i];
    auto name = quantity(token.text);
    std::string joined = token.text;
    for (std::size_t more = 1; !name && more < 4 && i + more < line.tokens.size(); ++more) {
      name = quantity(joined += line.tokens[i + more].text);
      if (name) i += more;
    }
    if (!name && found.empty() && is_one_of(token.text, "position positions state zoom")) continue;
    if (!name || token.text == "=") return false;
    any_gap = any_gap || gaps_.contains(*name);
    found.push_back(*name);
  }
  if (!any_gap || found.size() < 2) return false;
  // The table has a value for each position, the heading only the first.
  for (const std::string& name : found) {
    if (!gaps_.contains(name)) values_.erase(name);
  }
  columns_ = std::move(found);
  return true;
}

/// Takes a row below names of columns: a number per column, behind the name of the position.
bool PagePositions::take_row(const PageLine& line) {
  if (columns_.empty()) return false;
  const std::size_t words = static_cast<std::size_t>(
      std::ranges::find_if(line.tokens, [](const PageToken& t) { return t.is_number || is_plane_word(t.text); }) -
      line.tokens.begin());
  if (line.tokens.size() - words != columns_.size() || words > 3) return false;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    put(columns_[i], {line.number, columns_[i], {line.tokens[words + i].text}});
  }
  return true;
}

void PagePositions::take_gaps(const PageLine& line) {
  const std::vector<PageToken> t = with_ranges(line.tokens);
  for (std::size_t i = 1; i + 1 < t.size(); ++i) {
    const std::string name = t[i].text == "=" ? variable_name(t[i - 1].text) : std::string();
    if (!gaps_.contains(name)) continue;
    Values values{line.number, name, {}};
    while (i + 1 < t.size() && t[i + 1].is_number) values.numbers.push_back(t[++i].text);
    if (values.numbers.size() > 1) put(name, std::move(values));
  }
}

void PagePositions::put(const std::string& quantity, Values values) {
  if (quantity.empty()) return;
  for (std::string& text : values.numbers) {
    if (is_plane_word(text)) text = "Infinity";
    if (is_none(text)) text = "undefined";
    if (text == "Infinity" || text == "undefined") continue;
    if (!number(text))
      in_.must_be(values.line, values.name, io_detail::in_quotes(text), "a number with a decimal point");
  }
  // "F = 4 f = 100": F is the f-number if f is the focal length.
  const auto known_f = values_.find(quantity);
  if (quantity == "Focal Length" && known_f != values_.end() && (values.name == "F") != (known_f->second.name == "F")) {
    Values& of_f = values.name == "F" ? values : known_f->second;
    values_.try_emplace("F-Number", of_f);
    if (&of_f != &values) known_f->second = std::move(values);
    return;
  }
  // The second block of positions begins with the distance of the object.
  if ((quantity == "d0" || quantity == "Magnification") && !values_.contains(quantity)) {
    std::size_t block = 0;
    for (const Values* row : gap_rows()) block = std::max(block, row->numbers.size());
    if (block > 1) values.numbers.insert(values.numbers.begin(), block, "undefined");
  }
  const auto [at, is_new] = values_.try_emplace(quantity, values);
  const bool gap = gaps_.contains(quantity) || quantity == "Bf" || quantity == "d0" || !columns_.empty();
  if (is_new || (!gap && at->second.numbers == values.numbers)) return;
  auto& known = at->second.numbers;
  const bool longer = values.numbers.size() > known.size() &&
                      std::equal(known.begin(), known.end(), values.numbers.begin(),
                                 [](const auto& a, const auto& b) { return number(a) == number(b); });
  if (longer) return void(at->second = std::move(values));
  if (gap || (known.size() > 1 && values.numbers.size() == known.size())) {
    known.insert(known.end(), values.numbers.begin(), values.numbers.end());
  } else if (known.size() < values.numbers.size()) {
    at->second = std::move(values);
  } else if (known.size() == 1) {
    in_.must_be(values.line, values.name,
                values.numbers.front() + ", and " + known.front() + " in line " + std::to_string(at->second.line),
                "the same number");
  }
}

bool PagePositions::take(const PageLine& line) {
  if (take_names(line) || take_columns(line) || take_row(line)) return true;
  // "Variable separation / focal length" above a line of numbers.
  const bool bare = std::ranges::all_of(line.tokens, &PageToken::is_number);
  if (bare && focal_lengths_follow_) {
    Values values{line.number, "focal length", {}};
    for (const PageToken& token : line.tokens) values.numbers.push_back(token.text);
    put("Focal Length", std::move(values));
    return true;
  }
  focal_lengths_follow_ =
      line.numbers() == 0 && line.says("length") && line.says("focal") && !line.says("lens surface start group unit");
  const std::vector<PageToken> t = with_ranges(line.tokens);
  std::vector<std::pair<std::string, Values>> found;
  for (std::size_t i = 0; i < t.size();) {
    if (const std::string ratio = f_number_of(t[i].text); !ratio.empty() && !found.empty()) {
      found.emplace_back("F-Number", Values{line.number, t[i++].text, {ratio}});
      continue;
    }
    // The name is all words before the value, or the last words.
    std::size_t end = i;
    const auto is_value = [&](std::size_t at) {
      if (at >= t.size()) return false;
      return t[at].is_number || (at > i && (is_plane_word(t[at].text) || is_meant_as_number(t[at].text)));
    };
    const auto is_name = [&](std::size_t at) {
      return t[at].text != "=" && !is_value(at) &&
             (at == i || (!is_none(t[at].text) && f_number_of(t[at].text).empty()));
    };
    while (end < t.size() && is_name(end)) ++end;
    std::string joined;
    for (std::size_t k = i; k < end; ++k) joined += t[k].text;
    std::optional<std::string> name = quantity(joined);
    // "D 5 2.1 11.4" and "DD[5] = 2.1".
    if (!name && end == i + 1 && is_one_of(t[i].text, "d dd") && end < t.size() && t[end].is_number) {
      name = quantity(t[i].text + t[end].text);
      joined += t[end].text;
      if (name) ++end;
    }
    // "35 mm equivalent focal length" and "focal length of the first group" are other quantities.
    const std::string all_words = lower(joined);
    const auto says = [&](const char* word) { return all_words.find(word) != std::string::npos; };
    const bool other = says("equivalent") || says("group") || says("unit");
    if (!name && !other && all_words.starts_with("focallengthof") && says("system")) name = "Focal Length";
    for (std::size_t k = i + 1; !name && !other && k < end; ++k) {
      joined.clear();
      for (std::size_t m = k; m < end; ++m) joined += t[m].text;
      name = quantity(joined);
      if (name && !found.empty()) break;
    }
    if (end < t.size() && t[end].text == "=") ++end;
    Values values{line.number, joined, {}};
    const auto is_ratio = [&](std::size_t at) {
      return at < t.size() && !t[at].is_number && name == "F-Number" && !f_number_of(t[at].text).empty();
    };
    if (name == "Focal Length" && end < t.size() && t[end].text.starts_with("1:")) name = "F-Number";  // "F = 1:4"
    while (end < t.size() && (is_value(end) || is_none(t[end].text) || is_ratio(end))) {
      const std::string ratio = is_ratio(end) ? f_number_of(t[end].text) : std::string();
      values.numbers.push_back(ratio.empty() ? t[end].text : ratio);
      ++end;
    }
    if (end == i) ++end;
    i = end;
    if (name && !values.numbers.empty()) found.emplace_back(*name, std::move(values));
    // "f1 = 20.5" and other names are read over.
  }
  for (auto& [name, values] : found) put(name, std::move(values));
  return !found.empty();
}

/// Adds a quantity that is a multiple of another.
void PagePositions::scale(Positions& positions, const char* from, const char* to, double factor) {
  const auto at = positions.variables.find(from);
  if (at == positions.variables.end()) return;
  Variable variable = std::move(at->second);
  positions.variables.erase(at);
  for (std::string& text : variable.values) {
    if (const auto value = number(text)) text = to_text(factor * *value);
  }
  positions.variables.try_emplace(to, std::move(variable));
}

/// The rows of distances that vary.
std::vector<PagePositions::Values*> PagePositions::gap_rows() {
  std::vector<Values*> rows;
  for (const std::string& gap : gaps_) {
    if (const auto at = values_.find(gap); at != values_.end()) rows.push_back(&at->second);
  }
  return rows;
}

/// A second block of positions may list only the distances that differ.
void PagePositions::repeat_blocks(std::size_t& count) {
  const std::vector<Values*> rows = gap_rows();
  std::size_t block = count;
  for (const Values* row : rows) block = std::min(block, row->numbers.size());
  if (block < 2 || block == count || count % block != 0) return;
  // A row that stands twice is no second block.
  const auto twice = [&](const Values* row) {
    return std::equal(row->numbers.begin() + static_cast<std::ptrdiff_t>(block), row->numbers.end(),
                      row->numbers.begin());
  };
  if (std::ranges::all_of(rows, twice)) {
    for (Values* row : rows) row->numbers.resize(block);
    count = block;
    return;
  }
  for (Values* row : rows) {
    if (row->numbers.size() != block) continue;
    in_.warn(row->line, row->name,
             "has " + std::to_string(block) + " values; they are repeated for the other positions");
    for (std::size_t i = 0; row->numbers.size() < count; ++i) row->numbers.push_back(std::string(row->numbers[i]));
  }
}

void PagePositions::apply(Positions& positions) {
  std::size_t count = 1;
  for (const auto& [name, values] : values_) count = std::max(count, values.numbers.size());
  repeat_blocks(count);
  for (auto& [name, values] : values_) {
    // The ends of a range.
    if (values.numbers.size() == 2 && count % 2 == 1 && !gaps_.contains(name)) {
      values.numbers.insert(values.numbers.begin() + 1, count - 2, "undefined");
    }
    // A second block of positions may lack a quantity. A distance is stated for each position.
    const std::size_t own = values.numbers.size();
    const bool gap = gaps_.contains(name);
    if (own != count && (gap || (own > 1 && count % own != 0))) {
      in_.must_be(values.line, values.name, std::to_string(own) + " values",
                  std::to_string(count) + ", one per position");
    }
    positions.variables.emplace(name, Variable{values.line, values.numbers, gaps_.contains(name)});
  }
  // An angle of view may be the half or the whole: the image height and the focal length tell.
  const auto first = [&](const char* name) -> std::optional<double> {
    const auto at = positions.variables.find(name);
    return at == positions.variables.end() ? std::nullopt : number(at->second.values.front());
  };
  if (const auto angle = first("angle")) {
    const auto height = first("half height"), f = first("Focal Length");
    const auto off = [&](double half) {
      return std::abs(std::log(std::tan(half * std::numbers::pi / 180) * *f / *height));
    };
    const bool half = height && f && *angle < 89 && off(*angle) < off(*angle / 2);
    in_.warn(positions.variables.find("angle")->second.line, "angle of view",
             half ? "is taken as the half angle, by image height and focal length" : "is taken as the whole angle");
    scale(positions, "angle", half ? "half angle" : "Angle of View", 1);
  }
  scale(positions, "half angle", "Angle of View", 2);
  scale(positions, "half height", "Image Height", 2);
  if (!names_.empty() && count % names_.size() == 0) {
    std::map<std::string, int> used;
    for (std::size_t i = 0; i < count; ++i) {
      const std::string& name = names_[i % names_.size()];
      const int again = ++used[name];
      positions.names[std::to_string(i)] = name + (again > 1 ? ' ' + std::to_string(again) : "");
    }
  }
}

}  // namespace petzval::formats_detail
