// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace examples {

/// Style of the page of a lens. Figures keep their white ground in dark mode because of their colours.
inline constexpr std::string_view page_style =
    R"(  body { margin: 0 auto; max-width: 62rem; padding: 2rem 1.5rem 4rem; font: 16px/1.55 system-ui, sans-serif;
         color: #1d2026; background: #fbfbfa; }
  h1 { font-size: 1.8rem; margin: 0 0 .3rem; }
  h2 { font-size: 1.2rem; margin: 2.6rem 0 .4rem; border-top: 1px solid #dcdcd8; padding-top: 1.2rem; }
  .lead, figcaption { color: #565b66; max-width: 46rem; }
  figure { margin: .8rem 0 0; }
  figure svg { display: block; min-width: 40rem; max-width: 100%; height: auto; border: 1px solid #dcdcd8; background: #fff; }
  figcaption { font-size: .93rem; margin-top: .5rem; }
  .scroll { overflow-x: auto; }
  nav { columns: 12rem; font-size: .93rem; margin: 1rem 0; }
  nav a { display: block; }
  table { border-collapse: collapse; font-size: .88rem; line-height: 1.35; }
  th, td { text-align: left; vertical-align: top; padding: .25rem .8rem .25rem 0; border-bottom: 1px solid #e6e6e2; }
  td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
  @media (prefers-color-scheme: dark) {
    body { color: #e2e3e6; background: #17181b; }
    a { color: #8ab4f8; }
    .lead, figcaption { color: #a3a8b3; }
    h2, figure svg { border-color: #3a3c42; }
    th, td { border-color: #2e3035; }
  }
)";

/// Inserts a list of contents in front of the first heading of a page.
inline std::string with_contents(std::string page) {
  constexpr std::string_view open = "<h2>", close = "</h2>";
  std::string list = "<nav>";
  const std::size_t first = page.find(open);
  int count = 0;
  for (std::size_t at = first; at != std::string::npos; at = page.find(open, at + 1)) {
    const std::string title = page.substr(at + open.size(), page.find(close, at) - at - open.size());
    const std::string id = "part" + std::to_string(++count);
    page.replace(at, open.size(), "<h2 id=\"" + id + "\">");
    list += "<a href=\"#" + id + "\">" + title + "</a>";
  }
  return page.insert(first, list + "</nav>\n");
}

}  // namespace examples
