// SPDX-License-Identifier: Apache-2.0
#include "page_aspheres.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

constexpr std::string_view letters = "ABCDEFGHIJ";
constexpr std::string_view ordinals =
    "zeroth first second third fourth fifth sixth seventh eighth ninth tenth eleventh twelfth thirteenth fourteenth "
    "fifteenth sixteenth seventeenth eighteenth nineteenth twentieth";

/// The text without blanks and brackets of all kinds but "(1+k)", in lower case, with "kappa" for the Greek letter.
std::string plain(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i).starts_with("\u03ba") || text.substr(i).starts_with("\u03b1")) {
      result += text.substr(i).starts_with("\u03ba") ? 'k' : 'a';
      ++i;
    } else if (std::string_view(" \t*\"'[]{}").find(text[i]) == std::string_view::npos) {
      result += lower(text[i]);
    }
  }
  return result;
}

/// The number of a surface in "2", "2nd", "S2", "r3", "*5".
std::optional<int> surface_number(std::string_view word) {
  const auto names = words(ordinals);
  const auto ordinal = std::ranges::find_if(names, [&](std::string_view name) { return same(name, word); });
  if (ordinal != names.end()) return static_cast<int>(ordinal - names.begin());
  for (const auto& [tens, value] : {std::pair("twenty-", 20), std::pair("thirty-", 30)}) {
    if (!lower(word).starts_with(tens)) continue;
    const auto ones = surface_number(word.substr(7));
    return ones ? std::optional(value + *ones) : std::nullopt;
  }
  for (const std::string_view ending : {"-th", "st", "nd", "rd", "th"}) {
    if (word.size() > 2 && lower(word).ends_with(ending)) word.remove_suffix(ending.size());
  }
  if (word.size() > 3 && lower(word).starts_with("no.")) word.remove_prefix(3);
  if (word.size() > 1 && (word[0] == 'r' || word[0] == 'R')) word.remove_prefix(1);
  return label_of(word);
}

}  // namespace

PageAspheres::PageAspheres(std::span<const PageLine> page, Import& in) : in_(in) {
  for (const PageLine& line : page) {
    const std::string text = plain(line.text);
    k_of_sphere_is_0_ = k_of_sphere_is_0_ || text.find("(1+k)") != text.npos || text.find("(k+1)") != text.npos;
    const bool sphere = lower(line.text).find(" spher") != std::string::npos;  // "K = 1 for a sphere"
    k_of_sphere_is_0_ = k_of_sphere_is_0_ || (sphere && text.find("k=0") != text.npos);
    k_of_sphere_is_1_ = k_of_sphere_is_1_ || (sphere && text.find("k=1") != text.npos) ||
                        text.find("1-k") != text.npos || text.find("1-\u03b5") != text.npos;
    for (std::size_t i = 1; i < text.size(); ++i) take_formula(std::string_view(text).substr(i - 1));
  }
}

/// Takes the order of a term from a formula: "+A h^4", "+B x y4" or "+A2 h^4".
void PageAspheres::take_formula(std::string_view text) {
  const auto digits = [&](std::size_t& i) {
    const std::size_t from = i;
    while (i < text.size() && text[i] >= '0' && text[i] <= '9') ++i;
    return number(text.substr(from, i - from));
  };
  if (text.size() < 4 || std::string_view("+=)").find(text[0]) == text.npos || (text[1] != 'a' && text[1] != 'b'))
    return;
  std::size_t i = 2;
  const auto own = digits(i);
  if (i < text.size() && text[i] == 'x') ++i;
  if (i >= text.size() || std::string_view("hyr").find(text[i]) == text.npos) return;
  ++i;
  if (i < text.size() && text[i] == '^') ++i;
  const auto order = digits(i);
  if (!order || *order < 2 || *order > 40) return;
  if (own) {
    orders_.emplace(static_cast<int>(*own), static_cast<int>(*order));
  } else if (!order_of_a_) {
    order_of_a_ = static_cast<int>(*order) - (text[1] == 'b' ? 2 : 0);
  }
}

std::optional<PageAspheres::Key> PageAspheres::key_of(std::string_view word) const {
  const std::string name = plain(word);
  if (name.empty()) return {};
  Key key{.name = std::string(word), .order = {}};
  const bool greek = word.starts_with("\u03ba");
  if (is_one_of(name, "k p cc conic conicconstant kappa ka \u03b5 epsilon") || word == "e") {
    key.of_sphere = greek || (name != "k" && name != "cc" && !name.starts_with("conic")) ? 1 : 0;
    return key;
  }
  if (name == "r") {
    key.is_radius = true;
    return key;
  }
  if (name.size() == 1 && letters.find(word[0]) != letters.npos) {
    key.letter = name[0];
    key.order = 0;
    return key;
  }
  // "A4", "C6", "A(10)", "AD" to "AJ".
  const bool letter = name[0] >= 'a' && name[0] <= 'c';
  std::string digits = name.find("order") != name.npos ? name.substr(0, name.find_first_not_of("0123456789"))
                       : letter                        ? name.substr(1)
                                                       : std::string();
  std::erase_if(digits, [](char c) { return c == '(' || c == ')' || c == '_'; });
  if (name.size() == 2 && name[0] == 'a' && digits.size() == 1 && digits[0] >= 'd' && digits[0] <= 'j') {
    key.order = 4 + 2 * (digits[0] - 'd');
    return key;
  }
  if (digits.empty() || digits.size() > 2 || digits.find_first_not_of("0123456789") != digits.npos) return {};
  key.order = static_cast<int>(*number(digits));
  return key;
}

/// The keys of a head: all words of a line but the word for the surface. Empty if the line has other words.
std::vector<PageAspheres::Key> PageAspheres::keys_of(const PageLine& line, std::size_t from, bool titled) const {
  std::vector<Key> keys;
  for (std::size_t i = from; i < line.tokens.size(); ++i) {
    std::string word = line.tokens[i].text;
    const bool apart = i + 1 < line.tokens.size() && line.tokens[i + 1].is_number && is_one_of(word, "A C");
    if (apart) word += line.tokens[++i].text;
    if (i + 1 < line.tokens.size() && same(line.tokens[i + 1].text, "order")) word += line.tokens[++i].text;
    if (same(word, "conic") && i + 1 < line.tokens.size() && same(line.tokens[i + 1].text, "constant")) ++i;
    const auto key = key_of(word);
    if (!key) return {};
    keys.push_back(*key);
  }
  const bool terms = std::ranges::any_of(keys, [](const Key& k) { return k.order.value_or(0) > 0; });
  const bool letters_with_conic = keys.size() > 2 && std::ranges::any_of(keys, [](const Key& k) { return !k.order; });
  return terms || letters_with_conic || (titled && keys.size() > 1) ? keys : std::vector<Key>();
}

/// Takes the name of one surface or more: "Surface 2", "2nd surface", "Surface number: 1 5 8", "r3:". Returns the
/// number of tokens; 0 if the line begins with other words.
std::size_t PageAspheres::name_surfaces(const PageLine& whole) {
  PageLine line = whole;
  // "(2nd surface)", "[Aspheric data of surface 2]".
  const bool in_brackets = line.tokens[0].text[0] == '(' || line.tokens[0].text[0] == '[';
  if (in_brackets) {
    std::ranges::replace_if(
        line.text, [](char c) { return std::string_view("()[]").find(c) != std::string_view::npos; }, ' ');
    line.tokens = tokens_of(line.text, false);
    if (line.tokens.empty() || line.numbers() > 1) return 0;
  }
  const auto& t = line.tokens;
  const auto is_radius = [](const PageToken& x) { return lower(x.text)[0] == 'r' && surface_number(x.text); };
  const bool all_radii = t.size() > 1 && std::ranges::all_of(t, is_radius);
  const auto is_word = [](std::string_view word) {
    return is_one_of(
        word,
        "surface surfaces surf surf. s si sn m no no. # number numbers aspheric aspherical lens face data of for the");
  };
  std::vector<int> found;
  std::size_t i = 0;
  bool named = false;
  for (; i < t.size(); ++i) {
    std::string_view word = t[i].text;
    while (!word.empty() && std::string_view("[](),.:#*").find(word.front()) != word.npos) word.remove_prefix(1);
    while (word.size() > 1 && std::string_view("[](),.:#*").find(word.back()) != word.npos) word.remove_suffix(1);
    if (word.empty() || (word == "=" && (named || !found.empty()))) continue;
    if (is_word(word)) {
      named = true;
      continue;
    }
    const bool equals_next = i + 1 < t.size() && t[i + 1].text == "=";
    const auto number = surface_number(word);
    if (!number || (t[i].is_number && t[i].text.find_first_not_of("0123456789") != t[i].text.npos)) break;
    const bool key_next = i + 2 < t.size() && t[i + 2].text == "=" && key_of(t[i + 1].text);
    const bool radius =
        std::string_view("rRsS").find(word[0]) != word.npos && (t.size() == 1 || equals_next || key_next || all_radii);
    const bool star = t.size() == 1 && t[i].text[0] == '*';
    const bool marked = !t[i].is_number && (radius || star || lower(word).starts_with("no."));
    named = named || marked;
    found.push_back(*number);
  }
  const bool rest_has_numbers =
      std::any_of(t.begin() + static_cast<std::ptrdiff_t>(i), t.end(), [](const PageToken& x) { return x.is_number; });
  if (!named || found.empty() || (i < t.size() && !rest_has_numbers)) return 0;
  if (i < t.size() && keys_of({line.number, line.text, {t[i]}}, 0, true).empty() && !key_of(t[i].text)) return 0;
  surfaces_ = std::move(found);
  columns_.clear();
  return in_brackets ? whole.tokens.size() : i;
}

/// True unless a letter lacks the letter before it: "F = 3.5" below "A4 = ..." is no term.
bool PageAspheres::may_follow(const Key& key) const {
  const auto at = values_.find(surfaces_.front());
  if (key.letter <= 'b') return true;
  const auto before = [&](const Value& v) { return v.key.letter == key.letter - 1; };
  return at != values_.end() && std::ranges::any_of(at->second, before);
}

void PageAspheres::put(int surface, const Key& key, const PageLine& line, const PageToken& value) {
  if (key.is_radius || is_none(value.text)) return;
  // "1.23-5" is 1.23e-5.
  std::string text = value.text;
  const std::size_t sign = text.find_last_of("+-");
  if (!value.is_number && sign != text.npos && sign > 1) text.insert(sign, "e");
  if (!number(text)) {
    in_.must_be(line.number, key.name, io_detail::in_quotes(value.text), "a number with a decimal point");
  }
  if (key.order && *key.order == 1)
    in_.must_be(line.number, key.name, value.text, "a term of the second order or more");
  auto& values = values_[surface];
  const auto same_key = [&](const Value& v) { return v.key.order == key.order && v.key.letter == key.letter; };
  if (std::ranges::any_of(values, same_key)) {
    in_.must_be(line.number, key.name, "a second value for surface " + std::to_string(surface), "a single value");
  }
  values.push_back({key, line.number, in_.number(line.number, key.name, text)});
}

void PageAspheres::refuse_row() const {
  in_.must_be(row_line_, "aspheric data", std::to_string(row_.size()) + " values",
              std::to_string(columns_.size()) + ", one per head; \"-\" for a term that is absent");
}

/// A row below a head: the number of the surface and a value per key.
bool PageAspheres::take_row(const PageLine& line) {
  std::size_t star = line.tokens[0].text == "*" ? 1 : 0;
  if (columns_.empty() || star >= line.tokens.size()) return false;
  // A row may continue in the next line.
  const auto is_value = [](const PageToken& t) { return t.is_number && t.text.find('.') != t.text.npos; };
  const bool continues = !row_.empty() && std::ranges::all_of(line.tokens, is_value);
  const auto surface = surface_number(line.tokens[star].text);
  if (!continues && !row_.empty()) refuse_row();
  if (!continues && (!surface || line.numbers() < 2)) return false;
  if (!continues) surfaces_ = {*surface}, row_line_ = line.number;
  const auto from = line.tokens.begin() + static_cast<std::ptrdiff_t>(continues ? 0 : star + 1);
  row_.insert(row_.end(), from, line.tokens.end());
  if (row_.size() > columns_.size()) refuse_row();
  if (row_.size() < columns_.size()) return true;
  for (std::size_t i = 0; i < columns_.size(); ++i) put(surfaces_[0], columns_[i], line, row_[i]);
  row_.clear();
  surfaces_.clear();
  return true;
}

/// "K = -0.5 A 4 = 1.2E-05", or a key with a value per surface.
bool PageAspheres::take_values(const PageLine& line, std::size_t from, bool titled) {
  if (surfaces_.empty()) return false;
  const auto& t = line.tokens;
  bool found = false;
  for (std::size_t i = from; i < t.size();) {
    std::string word = t[i].text;
    std::size_t next = i + 1;
    const auto is_value = [&](std::size_t at) {
      return at < t.size() && (t[at].is_number || is_meant_as_number(t[at].text) || is_none(t[at].text));
    };
    // "A 4 = 1.2E-05", and "A 4 1.2E-05".
    const bool integer = next < t.size() && t[next].text.size() <= 2 && t[next].is_number && t[next].text[0] != '-';
    if (integer && is_one_of(word, "A C") && next + 1 < t.size()) word += t[next++].text;
    // "Conic constant = 0.5", "4th order coefficient = 1.2E-05".
    const bool conic = same(word, "conic") && next < t.size() && is_one_of(t[next].text, "constant coefficient");
    if (conic) ++next;
    if (conic && next < t.size() && is_one_of(t[next].text, "k (k)")) ++next;
    const auto equals =
        static_cast<std::size_t>(std::ranges::find(t.begin() + i, t.end(), "=", &PageToken::text) - t.begin());
    for (const bool named = equals < t.size() && equals <= next + 2 && !key_of(word); named && next < equals;) {
      word += t[next++].text;
    }
    const auto key = key_of(word);
    if (!key || !may_follow(*key)) break;
    if (next < t.size() && t[next].text == "=") ++next;
    std::size_t count = 0;
    while (is_value(next + count) && count < surfaces_.size()) ++count;
    if (count == 0 && (found || t[next - 1].text == "=")) {
      in_.must_be(line.number, key->name, "without a value", "a name (K, A4) and a value");
    }
    if (count == 0) break;
    if (!titled && !found && from == 0 && key->letter != '\0') break;
    if (count != surfaces_.size()) {
      in_.must_be(line.number, key->name, std::to_string(count) + " values",
                  std::to_string(surfaces_.size()) + ", one per surface");
    }
    for (std::size_t s = 0; s < count; ++s) put(surfaces_[s], *key, line, t[next + s]);
    found = true;
    i = next + count;
    if (i < t.size() && !key_of(t[i].text)) {
      in_.must_be(line.number, "aspheric data", io_detail::in_quotes(t[i].text), "a name (K, A4) and a value");
    }
  }
  return found;
}

bool PageAspheres::take(const PageLine& line, bool titled) {
  if (take_row(line)) return true;
  if (!row_.empty()) refuse_row();
  const std::size_t named = name_surfaces(line);
  if (named > 0) return named == line.tokens.size() || take_values(line, named, true);
  if (take_values(line, 0, titled)) return true;
  const bool first_is_surface = is_one_of(line.tokens[0].text, "surface surf surf. s si sn m no no. i number");
  std::size_t from = first_is_surface ? 1 : 0;
  if (from > 0 && line.tokens.size() > 1 && is_one_of(line.tokens[1].text, "no no. number #")) ++from;
  if (auto keys = keys_of(line, from, titled); !keys.empty()) {
    // A head may continue in the next line.
    if (columns_.empty() || head_line_ + 1 != line.number || !keys.front().order) columns_.clear();
    columns_.insert(columns_.end(), keys.begin(), keys.end());
    head_line_ = line.number;
    surfaces_.clear();
    return true;
  }
  return false;
}

/// The number of a sphere in the conics of the page, by its formula, or by values of 0 and 1, which designs seldom have
/// by chance; else by the name.
int PageAspheres::number_of_sphere(const Key& key) const {
  if (same(key.name, "KA")) return 1;
  if (k_of_sphere_is_0_ || k_of_sphere_is_1_) return k_of_sphere_is_0_ ? 0 : 1;
  const auto any = [&](double number) {
    return std::ranges::any_of(values_, [&](const auto& entry) {
      return std::ranges::any_of(entry.second, [&](const Value& v) { return !v.key.order && v.number == number; });
    });
  };
  return any(0) == any(1) ? key.of_sphere : any(1);
}

int PageAspheres::order_of(const Value& value) const {
  // "A2 h^4": the formula gives the order of A2.
  const auto printed = orders_.find(value.key.order.value_or(0));
  if (value.key.letter == '\0') return printed != orders_.end() ? printed->second : *value.key.order;
  const auto any_a = [](const auto& entry) {
    return std::ranges::any_of(entry.second, [](const Value& v) { return v.key.letter == 'a' && v.number != 0; });
  };
  const int of_a = order_of_a_ ? *order_of_a_ : std::ranges::any_of(values_, any_a) ? 4 : 2;
  return of_a + 2 * (value.key.letter - 'a');
}

void PageAspheres::apply(const PageTable& table, bool several) {
  if (!row_.empty()) refuse_row();
  const auto& rows = table.rows();
  const bool labels = std::ranges::any_of(rows, [](const PageRow& row) { return row.label.has_value(); });
  std::vector<bool> has_data(rows.size(), false);
  const Value* letter = nullptr;
  const Value* conic = nullptr;
  for (const auto& [surface, values] : values_) {
    for (const Value& v : values) {
      if (v.key.letter != '\0') letter = &v;
      if (!v.key.order) conic = &v;
    }
  }
  double least_radius = HUGE_VAL;
  for (const SurfaceRow& surface : in_.lens.surfaces) {
    if (surface.radius != 0) least_radius = std::min(least_radius, std::abs(surface.radius));
  }
  for (const auto& [surface, values] : values_) {
    const auto at = labels ? std::ranges::find(rows, std::optional(surface), &PageRow::label)
                           : rows.begin() + std::clamp<std::ptrdiff_t>(surface - 1, 0, std::ssize(rows));
    if (at == rows.end() || surface < 0) {
      in_.must_be(values.front().line, "aspheric data", "surface " + std::to_string(surface), "a surface of the table");
    }
    const auto index = static_cast<std::size_t>(at - rows.begin());
    has_data[index] = true;
    SurfaceRow& to = in_.lens.surfaces[index];
    if (to.conic != 0 || !to.aspheric.empty()) {
      in_.must_be(values.front().line, "aspheric data", "of surface " + std::to_string(surface) + " again",
                  "stated once");
    }
    for (const Value& v : values) {
      if (!v.key.order) {
        to.conic = v.number - number_of_sphere(v.key);
      } else if (v.number != 0) {
        const int order = order_of(v);
        const double h = to.semi_diameter.value_or(least_radius / 2);
        // An exponent without its minus sign.
        if (std::abs(v.number) * std::pow(h, order - 1) > 3) {
          in_.must_be(v.line, v.key.name, to_text(v.number), "a term that leaves the surface within its lens");
        }
        to.aspheric.push_back({order, v.number});
      }
    }
    std::ranges::sort(to.aspheric, {}, &AsphereTerm::order);
  }
  const bool any_data = !values_.empty() || !columns_.empty() || several,
             any_mark = std::ranges::any_of(rows, &PageRow::asphere);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const SurfaceRow& surface = in_.lens.surfaces[i];
    const bool known = has_data[i] || surface.conic != 0 || !surface.aspheric.empty();
    if (rows[i].asphere && !known) {
      const std::string found = "marked as an asphere, and the page has no terms for it";
      if (any_data) in_.must_be(rows[i].line, "surface", found, "named in the aspheric data");
      in_.warn(rows[i].line, "surface", found + "; it is taken as a sphere");
    } else if (has_data[i] && any_mark && !rows[i].asphere) {
      in_.warn(rows[i].line, "surface", "has aspheric data, and is not marked as an asphere");
    }
  }
  if (conic && (number_of_sphere(conic->key) == 1 || conic->key.of_sphere == 1)) {
    const bool one = number_of_sphere(conic->key) == 1;
    in_.warn(conic->line, conic->key.name,
             one ? "is taken as 1 + k, so that a sphere has 1" : "is taken as k, so that a sphere has 0");
  }
  if (letter) {
    in_.warn(letter->line, std::string(1, static_cast<char>(letter->key.letter - 32)),
             "is the term of order " + std::to_string(order_of(*letter)) +
                 (order_of_a_ ? ", from the formula of the page" : "; the page has no formula for the orders"));
  }
}

}  // namespace petzval::formats_detail
