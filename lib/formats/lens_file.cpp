// SPDX-License-Identifier: Apache-2.0
#include "petzval/formats/lens_file.hpp"

#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "complete.hpp"
#include "io/json.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval {
namespace {

using namespace formats_detail;

constexpr const char* rule =
    "a lens: petzval JSON, Zemax .zmx, CODE V .seq, OSLO .len, FlareSim .lens, crayg .fx, LensHH .lhlt, an "
    "OpticalBench table, a table of surfaces, a page of a patent, or JSON of lentil, optiland or DeepLens";

/// The formats in the order in which they are tried; each accepts only files that it recognises with certainty.
constexpr std::array formats{
    Format{"zemax", is_zemax, read_zemax},
    Format{"oslo", is_oslo, read_oslo},
    Format{"opticalbench", is_opticalbench, read_opticalbench},
    Format{"optiland", is_optiland, read_optiland},
    Format{"lentil", is_lentil, read_lentil},
    Format{"lenshh", is_lenshh, read_lenshh},
    Format{"deeplens", is_deeplens, read_deeplens},
    Format{"crayg", is_crayg, read_crayg},
    Format{"flaresim", is_flaresim, read_flaresim},
    Format{"codev", is_codev, read_codev},
    Format{"patent page", is_page, read_page},
    Format{"table", is_table, read_table},
};

/// True for a line of dashes and colons, the ruler of columns in BEAM FOUR. Points mark decimals.
bool is_ruler(std::string_view line) {
  return line.size() >= 8 && line.find(':') != std::string_view::npos &&
         line.find_first_not_of("-_:. \t") == std::string_view::npos;
}

/// A kind of file that is not read, and the beginnings of two lines that it contains.
struct OtherKind {
  const char *first, *second, *kind, *rule;
};
constexpr OtherKind other_kinds[] = {
    {"SUT ", "CUY ", "an OpTaliX lens (.otx)", "exported as .seq or .zmx"},
    {"NM ", "CD ", "a glass catalogue (.agf)", "a lens; --glasses names glass catalogues"},
    {"const LENS_DATA", "surfaces:", "a lens of LensVisualizer (TypeScript)", "typed as a table (data/README.md)"},
    {"const LENS_DATA", "\"surfaces\":", "a lens of LensVisualizer (TypeScript)", "typed as a table (data/README.md)"}};

/// Throws Error for files of programs that are not read, and names a format that the program can export.
void refuse_other_programs(std::string_view text, const std::string& where) {
  const std::string_view start = trimmed(text);
  if (start.starts_with('{') && text.find("\"optical_model\"") != std::string_view::npos) {
    throw Error(where + ": is a ray-optics model (.roa); must be exported from ray-optics as .seq or .zmx");
  }
  std::string_view first;
  std::array<int, std::size(other_kinds)> found{};
  for (Lines lines(text); lines.next();) {
    const std::string_view line = trimmed(lines.text());
    if (first.empty()) first = line;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (line.starts_with(other_kinds[i].first)) found[i] |= 1;
      if (line.starts_with(other_kinds[i].second)) found[i] |= 2;
      if (found[i] == 3) throw Error(where + ": is " + other_kinds[i].kind + "; must be " + other_kinds[i].rule);
    }
    if (lines.number() > 8 || !is_ruler(line)) continue;
    const auto head = words(first, 3);
    const bool counts = head.size() > 1 && number(head[0]) &&
                        (lower(head[1]).starts_with("surf") || lower(head[1]).starts_with("entr"));
    if (counts) throw Error(where + ": is a table of BEAM FOUR (.OPT); must be exported as .zmx, or typed as a table");
  }
}

/// Throws Error for JSON that has neither the format nor a key of a known program.
void refuse_unknown_json(const std::string& text, const std::string& where) {
  if (text.find("petzval-") != std::string::npos || text.find("\"format\"") != std::string::npos) return;
  const io_detail::JsonTree tree(text, where, [](std::string_view path) { return std::string(path); });
  std::string keys;
  for (const auto& [key, value] : tree.root().items()) {
    if (keys.size() < 200) append(keys, ", ", io_detail::in_quotes(key));
  }
  throw Error(where + ": is JSON of an unknown program, with the keys " + keys + "; must be " + rule);
}

void refuse_warnings(const Prescription& lens, const std::string& where) {
  if (!lens.imported || lens.imported->warnings.empty()) return;
  const ImportWarning& first = lens.imported->warnings.front();
  throw Error(where + (first.line > 0 ? ": line " + std::to_string(first.line) : "") + ": " + first.command + ": " +
              first.message + "; must be a file without assumptions (strict)");
}

}  // namespace

Prescription parse_lens(std::string bytes, const std::string& where, const ReadOptions& options) {
  const bool own_json = [&] {
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    return first != std::string::npos && bytes[first] == '{' && bytes.find("\"petzval-lens 1\"") != std::string::npos;
  }();
  if (own_json) return with_apertures(parse_prescription(bytes, where), {.glasses = options.glasses});

  const std::string text = as_utf8(std::move(bytes), where, rule);
  refuse_other_programs(text, where);
  for (const Format& format : formats) {
    if (!format.is(text)) continue;
    Import in(where, format.name, options);
    format.read(text, in);
    Prescription lens = complete(std::move(in));
    if (options.strict) refuse_warnings(lens, where);
    return lens;
  }
  if (trimmed(text).empty()) throw Error(where + ": is empty; must be " + rule);
  // Probably a damaged file of this library: the messages of its parser name line and column.
  if (const std::string_view start = trimmed(text); start.starts_with('{')) {
    refuse_unknown_json(text, where);
    return parse_prescription(text, where);
  }
  std::string first_line(trimmed(text.substr(0, text.find_first_of("\r\n"))));
  throw Error(where + ": begins with " + io_detail::in_quotes(first_line) + "; must be " + rule);
}

Prescription read_lens(const std::filesystem::path& file, const ReadOptions& options) {
  return parse_lens(read_file(file, "a lens file"), file.string(), options);
}

}  // namespace petzval
