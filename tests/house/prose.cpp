// SPDX-License-Identifier: Apache-2.0
// house_prose ROOT [FOLDER]: fails if too many sentences of the source tree match a pattern of prose that readers have
// to decode. Reads comments, string literals and Markdown. With FOLDER, such as lib/trace, it lists the matches of that
// folder.
//
// A match is a place to look at; a good sentence that matches may stay. .github/CONTRIBUTING.md explains the rules.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

constexpr double tree_limit_percent = 4;
constexpr double folder_limit_percent = 8;
constexpr int smallest_sample = 20;           // sentences; the percentage of a smaller folder says little
constexpr std::size_t shortest_sentence = 5;  // words; shorter texts are labels
constexpr std::size_t longest_sentence = 45;  // words

const std::string whole_tree = "tree";

/// Stands in a message for the values between its literals.
constexpr std::string_view placeholder = "<value>";

using Words = std::vector<std::string>;

bool any_of(std::string_view word, std::initializer_list<std::string_view> list) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

/// Lower-case words without punctuation. Code between backticks is a single word.
Words words_of(std::string_view sentence) {
  Words words;
  std::string word;
  bool code = false;
  for (const char c : sentence) {
    if (c == '`') code = !code;
    if (std::isspace(static_cast<unsigned char>(c)) && !code) {
      if (!word.empty()) words.push_back(std::exchange(word, {}));
    } else if (std::isalnum(static_cast<unsigned char>(c)) || code || c == '`' || c == '_' || c == '\'') {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (c == '-' && !word.empty()) {
      word += c;
    }
  }
  if (!word.empty()) words.push_back(word);
  return words;
}

/// True if words i and i + 1 replace a noun: `those of`, `one that`.
bool missing_noun(const Words& words, std::size_t i) {
  const std::string &first = words[i], &second = words[i + 1];
  if (any_of(first, {"that", "those"}) && second == "of") return true;
  if (first == "those" && any_of(second, {"that", "which", "whose", "who"})) return true;
  if (any_of(first, {"one", "ones"})) {
    if (any_of(second, {"that", "which", "whose", "who"})) return true;
    const bool counted =
        i + 2 < words.size() && any_of(words[i + 2], {"the", "these", "those", "two", "three", "several", "many", "its",
                                                      "their", "a", "our", "each", "every"});
    if (any_of(second, {"of", "for", "with", "in", "at"}) && !counted) return true;
  }
  return any_of(first, {"but", "save"}) && second == "for";
}

/// Name of the first rule that the sentence breaks; empty if it breaks no rule.
std::string_view broken_rule(std::string_view sentence) {
  const Words words = words_of(sentence);
  if (words.size() > longest_sentence) return "long";
  if (words.empty()) return {};
  const std::string second = words.size() > 1 ? words[1] : "";
  if (any_of(words[0], {"of", "what", "those", "where", "how", "whether", "nothing", "none", "such"}) && second != "if")
    return "start";
  if (any_of(words.back(),
             {"is", "are",  "was",  "were", "has",   "have",  "had",   "does", "do",   "did", "can", "may", "not",
              "it", "them", "this", "that", "these", "those", "there", "one",  "ones", "so",  "too", "none"}))
    return "end";
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "what" && sentence.back() != '?') return "what";
    if (any_of(words[i], {"beside", "alone", "none", "alike", "wanted"})) return "vague word";
    if (i + 1 < words.size() && missing_noun(words, i)) return "missing noun";
    if (i + 2 < words.size() && words[i] == "as" && words[i + 2] == "as" &&
        any_of(words[i + 1], {"near", "far", "much", "little", "many", "few"}))
      return "as ... as";
  }
  return {};
}

enum class Kind { prose, message };

struct Text {
  int line;
  std::string text;
  Kind kind = Kind::prose;
};

/// Sentences of at least `shortest_sentence` words. A sentence ends at punctuation before a space and a capital, digit
/// or code.
std::vector<std::string> sentences_of(const std::string& text) {
  std::vector<std::string> sentences;
  std::string sentence;
  const auto finish = [&] {
    std::size_t words = 0;
    for (std::size_t i = 0; i < sentence.size(); ++i) words += sentence[i] != ' ' && (i == 0 || sentence[i - 1] == ' ');
    if (words >= shortest_sentence) sentences.push_back(sentence);
    sentence.clear();
  };
  for (const char c : text) {
    const char character = std::isspace(static_cast<unsigned char>(c)) ? ' ' : c;
    if (character == ' ' && (sentence.empty() || sentence.back() == ' ')) continue;
    const bool begins = std::isupper(static_cast<unsigned char>(c)) || std::isdigit(static_cast<unsigned char>(c)) ||
                        c == '`' || c == '(';
    if (begins && sentence.size() > 1 && sentence.back() == ' ' &&
        std::string_view(".;:!?").find(sentence[sentence.size() - 2]) != std::string_view::npos)
      finish();
    sentence += character;
  }
  while (!sentence.empty() && sentence.back() == ' ') sentence.pop_back();
  finish();
  return sentences;
}

/// Joins lines to paragraphs.
class Paragraphs {
 public:
  bool empty() const { return open_.text.empty(); }
  void add(int line, std::string_view text) {
    if (open_.text.empty()) open_.line = line;
    open_.text.append(text).append(" ");
  }
  void finish() {
    if (!open_.text.empty()) texts_.push_back(std::exchange(open_, {}));
  }
  std::vector<Text> take() {
    finish();
    return std::move(texts_);
  }

 private:
  Text open_{};
  std::vector<Text> texts_;
};

bool starts_with(std::string_view text, std::string_view start) { return text.substr(0, start.size()) == start; }

/// Starts a list item or a numbered step.
bool is_item(std::string_view line) {
  const std::size_t first = line.find_first_not_of(' ');
  if (first == std::string_view::npos) return false;
  line.remove_prefix(first);
  if (starts_with(line, "- ") || starts_with(line, "* ")) return true;
  const std::size_t digits = std::min(line.find_first_not_of("0123456789"), line.size());
  return digits > 0 && starts_with(line.substr(digits), ". ");
}

/// Adds a line of a comment, without its marks. Indented lines are code; Doxygen tags start a paragraph.
void add_comment(Paragraphs& paragraphs, int line, std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of("/!<*"), text.size()));
  if (text.find_first_not_of(' ') == std::string_view::npos || starts_with(text, "    ") ||
      text.find("SPDX") != std::string_view::npos || text.find("clang-format") != std::string_view::npos ||
      text.find("NOLINT") != std::string_view::npos) {
    paragraphs.finish();
    return;
  }
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if ((text[i] == '@' || text[i] == '\\') && i + 1 < text.size() &&
        std::islower(static_cast<unsigned char>(text[i + 1]))) {
      std::size_t end = i + 1;
      while (end < text.size() && (std::isalpha(static_cast<unsigned char>(text[end])))) ++end;
      if (!any_of(text.substr(i + 1, end - i - 1), {"p", "c", "e", "b", "ref"})) paragraphs.finish();
      i = end - 1;
    } else {
      plain += text[i];
    }
  }
  if (is_item(plain)) paragraphs.finish();
  paragraphs.add(line, plain);
}

/// Comments and the string literals of each statement of C++.
std::vector<Text> texts_of_code(const std::string& code) {
  Paragraphs comments, literals;
  std::string between;  // code since the last literal of this statement
  int line = 1, last_comment_line = -1;
  bool code_on_line = false;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const std::string_view rest = std::string_view(code).substr(i);
    if (starts_with(rest, "//")) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      if (code_on_line || line != last_comment_line + 1) comments.finish();
      add_comment(comments, line, rest.substr(0, end));
      if (code_on_line) comments.finish();
      last_comment_line = code_on_line ? -1 : line;
      i += end - 1;
    } else if (starts_with(rest, "/*")) {
      std::size_t end = std::min(rest.find("*/"), rest.size());
      comments.finish();
      std::string_view block = rest.substr(2, end - 2);
      while (true) {
        const std::size_t length = std::min(block.find('\n'), block.size());
        std::string_view text = block.substr(0, length);
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
        add_comment(comments, line, text);
        if (length == block.size()) break;
        block.remove_prefix(length + 1);
        ++line;
      }
      comments.finish();
      i += end + 1;
    } else if (starts_with(rest, "R\"")) {  // data, not prose
      const std::size_t open = rest.find('(');
      const std::string close = ")" + std::string(rest.substr(2, open - 2)) + "\"";
      const std::size_t end = std::min(rest.find(close, open), rest.size());
      line += static_cast<int>(std::count(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
      i += end + close.size() - 1;
      code_on_line = true;
    } else if (code[i] == '"') {
      std::string literal;
      for (++i; i < code.size() && code[i] != '"' && code[i] != '\n'; ++i) {
        if (code[i] != '\\')
          literal += code[i];
        else if (code[++i] != 'n')
          literal += code[i];
        else
          literal += ' ';
      }
      if (between == ",")
        literals.finish();
      else if (!between.empty() && !literals.empty())
        literals.add(line, placeholder);
      literals.add(line, literal);
      between.clear();
      code_on_line = true;
    } else if (code[i] == '\'' && (i == 0 || !std::isalnum(static_cast<unsigned char>(code[i - 1])))) {
      i += code.substr(i + 1, 1) == "\\" ? 3 : 2;
    } else if (code[i] == '\n') {
      ++line;
      code_on_line = false;
    } else if (!std::isspace(static_cast<unsigned char>(code[i]))) {
      code_on_line = true;
      between += code[i];
      if (code[i] == ';' || code[i] == '{' || code[i] == '}') {
        if (!literals.empty() && between.find_first_not_of("(){};") != std::string::npos)
          literals.add(line, placeholder);
        literals.finish();
        between.clear();
      }
    }
  }
  std::vector<Text> texts = comments.take(), messages = literals.take();
  for (Text& message : messages) message.kind = Kind::message;
  texts.insert(texts.end(), std::make_move_iterator(messages.begin()), std::make_move_iterator(messages.end()));
  return texts;
}

/// Paragraphs, list items and cells of tables of a Markdown page; no code, headings and pictures.
std::vector<Text> texts_of_page(const std::string& page) {
  Paragraphs paragraphs;
  bool fenced = false;
  int number = 0;
  for (std::size_t begin = 0; begin < page.size();) {
    const std::size_t end = std::min(page.find('\n', begin), page.size());
    const std::string_view line = std::string_view(page).substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (starts_with(line, "```")) fenced = !fenced;
    if (fenced || line.find_first_not_of(' ') == std::string_view::npos || starts_with(line, "    ") ||
        starts_with(line, "#") || starts_with(line, "<!--") || starts_with(line, "![") || starts_with(line, "```")) {
      paragraphs.finish();
    } else if (starts_with(line, "|")) {
      for (std::size_t cell = 0; cell < line.size();) {
        const std::size_t cell_end = std::min(line.find('|', cell), line.size());
        paragraphs.finish();
        paragraphs.add(number, line.substr(cell, cell_end - cell));
        cell = cell_end + 1;
      }
      paragraphs.finish();
    } else {
      if (is_item(line)) paragraphs.finish();
      paragraphs.add(number, line);
    }
  }
  return paragraphs.take();
}

/// Groups with a limit of their own: the top folder, the module folder, and each page.
std::set<std::string> groups_of(const std::filesystem::path& file) {
  std::vector<std::string> parts(file.begin(), file.end());
  const std::size_t depth = parts[0] == "include" ? 3 : 2;
  std::set<std::string> groups{whole_tree};
  if (file.extension() == ".md") groups.insert(file.generic_string());
  if (parts.size() > 1) groups.insert(parts[0]);
  if (parts.size() > depth) {
    std::string folder = parts[0];
    for (std::size_t i = 1; i < depth; ++i) folder += "/" + parts[i];
    groups.insert(folder);
  }
  return groups;
}

struct Count {
  int matches = 0;
  int sentences = 0;
  double percent() const { return sentences == 0 ? 0 : 100.0 * matches / sentences; }
};

int check(const std::filesystem::path& root, const std::string& listed) {
  std::vector<std::filesystem::path> files;
  for (const char* folder : {"include", "lib", "examples", "tests", "data", ".github"}) {
    if (!std::filesystem::exists(root / folder)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder))
      if (entry.is_regular_file()) files.push_back(entry.path());
  }
  files.push_back(root / "README.md");

  std::map<std::pair<std::string, Kind>, Count> counts;
  for (const std::filesystem::path& path : files) {
    const bool page = path.extension() == ".md";
    if (!page && path.extension() != ".hpp" && path.extension() != ".cpp") continue;
    std::ifstream stream(path, std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(stream), {}};
    const std::filesystem::path file = path.lexically_relative(root);
    const std::set<std::string> groups = groups_of(file);
    for (const Text& text : page ? texts_of_page(content) : texts_of_code(content)) {
      for (const std::string& sentence : sentences_of(text.text)) {
        const std::string_view rule = broken_rule(sentence);
        for (const std::string& group : groups) {
          Count& count = counts[{group, text.kind}];
          ++count.sentences;
          count.matches += !rule.empty();
        }
        if (!rule.empty() && !listed.empty() && starts_with(file.generic_string(), listed))
          std::printf("%s:%d: %.*s: %s\n", file.generic_string().c_str(), text.line, static_cast<int>(rule.size()),
                      rule.data(), sentence.c_str());
      }
    }
  }
  if (counts.empty()) throw std::runtime_error("ROOT = " + root.string() + "; must be the source tree");

  bool failed = false;
  for (const auto& [key, count] : counts) {
    const auto& [group, kind] = key;
    const double limit = group == whole_tree ? tree_limit_percent : folder_limit_percent;
    const bool high = count.sentences >= smallest_sample && count.percent() > limit;
    failed = failed || high;
    if (high || group == whole_tree || group == listed)
      std::printf("%s: %d of %d %s match (%.1f %%), limit %g %%\n", group.c_str(), count.matches, count.sentences,
                  kind == Kind::prose ? "sentences" : "messages", count.percent(), limit);
  }
  return failed ? 1 : 0;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 2) throw std::runtime_error("usage: house_prose ROOT [FOLDER]");
  return check(arguments[1], count > 2 ? arguments[2] : "");
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
