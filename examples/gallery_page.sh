# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh
#
# Sourced by examples/gallery.sh: runs the command of each picture of a gallery and writes the page around the pictures. POSIX sh.
#
#   gallery FOLDER PROGRAMS FUNCTION TITLE TEXT
#                               makes the gallery that FUNCTION describes, in FOLDER, with the programs of the folder PROGRAMS (an absolute
#                               path). TITLE and TEXT (HTML) open the page. FUNCTION calls:
#   section ID TITLE TEXT [halves]
#                               starts a section; TEXT is HTML; halves: two figures side by side on a wide screen
#   picture FILE TITLE CAPTION  runs the commands on standard input in FOLDER, which write FILE (.png, .svg, .html, .txt
#                               or a table in .md);
#                               CAPTION is HTML. Keeps FILE if the commands are the ones that made it and no program is newer.
#                               With $shipped, a folder: shows a JPEG of that folder instead, named like FILE without /picture.png, whose
#                               date and time are in made.txt; runs nothing
#   also FILE TITLE CAPTION     shows another file of the commands before
#
# index.html is written after each picture. A figure whose commands failed says so, and gallery returns 1. FOLDER/made has the
# commands, times and fragments of the page.

escaped() { sed -e 's/&/\&amp;/g' -e 's/</\&lt;/g' -e 's/>/\&gt;/g'; }

duration() {
  if [ "$1" -ge 120 ]; then echo "$((($1 + 30) / 60)) minutes"; elif [ "$1" -gt 1 ]; then echo "$1 seconds"; else echo "at most 1 second"; fi
}

section() {
  section=$((section + 1)) figure=0
  part=made/$(printf '%02d' "$section")
  [ "$counting" ] || return 0
  printf '<section id="%s">\n<h2>%s</h2>\n<p class="text">%s</p>\n<div class="figures %s">\n' \
    "$1" "$2" "$3" "${4-}" > "${part}_00.html"
  printf '<li><a href="#%s">%s</a></li>\n' "$1" "$2" > "$part.contents"
  written="$written ${part}_00.html $part.contents"
}

picture() {
  commands=$(cat)
  if [ "${shipped-}" ]; then shipped_picture "$1" "$2" "$3"; return; fi
  file=$1 made=$((made + 1))
  if [ "$counting" ]; then count=$((count + 1)); return 0; fi
  stamp=made/$(echo "$file" | tr / _).commands
  shown=$(printf '%s\n' "$commands" | escaped)
  printf '[%d/%d] %s' "$made" "$count" "$2"
  if [ -f "$file" ] && [ -f "$stamp" ] && [ "$(sed 1d "$stamp")" = "$commands" ] &&
    [ -z "$(find "$page_programs/." ! -name . -prune -type f -perm -100 -newer "$stamp")" ]; then
    seconds=$(sed -n 1p "$stamp") failure=
    echo ': kept'
    figure "$1" "$2" "$3"
  elif [ "$without_renderer" ] && printf '%s\n' "$commands" | grep -Eq '^petzval (render|blur|view) '; then
    echo ': left out, because petzval render and blur were not built (they need libembree-dev and libtinyobjloader-dev)'
    seconds='' failure='Left out: petzval render and blur were not built. They need Embree and tinyobjloader.'
    figure "$1" "$2" "$3"
  else
    echo
    rm -f "$stamp"
    begin=$(date +%s)
    status=0
    mkdir -p "$(dirname "$file")"
    printf '%s\n' "$commands" | PATH=$page_programs:$PATH sh -eu > made/output.txt || status=$?
    seconds=$(($(date +%s) - begin))
    failure=
    if [ "$status" -ge 128 ]; then interrupted; fi
    [ "$status" -ne 0 ] || [ -f "$file" ] || status="0, but without $file"
    if [ "$status" != 0 ]; then
      echo "  failed: exit status $status"
      failure="Not made: exit status $status."
      failed="$failed $file"
    else
      printf '%s\n%s\n' "$seconds" "$commands" > "$stamp"
      [ "$made" -ne 1 ] || echo "  The first picture: $PWD/$file"
    fi
    figure "$1" "$2" "$3"
  fi
  total=$((total + ${seconds:-0}))
  write_page "Still being made: $made of $count pictures. Reload the page for more."
}

shipped_picture() {
  [ -z "$counting" ] || return 0
  name=$(echo "${1%/picture.png}" | tr / _)
  mkdir -p full_size
  cp "$shipped/$name.jpg" full_size
  shown=$(printf '%s\n' "$commands" | escaped) failure=
  seconds= when=$(sed -n "s/^$name //p" "$shipped/made.txt")
  figure "full_size/$name.jpg" "$2" "$3"
}

also() {
  [ -z "$counting" ] || return 0
  shown=''
  figure "$1" "$2" "$3"
}

# Writes the fragment of a figure with $shown (commands), $seconds and $failure.
figure() {
  figure=$((figure + 1))
  fragment=${part}_$(printf '%02d' "$figure").html
  written="$written $fragment"
  {
    echo '<figure>'
    if [ "$failure" ]; then echo "<p class=\"failure\">$failure</p>"; else
      case $1 in
        *.html) printf '<div class="scroll">\n' && cat "$1" && printf '</div>\n' ;;
        *.md) printf '<table class="scroll">\n' && sed -e '/^|-/d' -e 's,^| *,<tr><td>,' -e 's, *|$,</td></tr>,' -e 's, | ,</td><td>,g' "$1" &&
          printf '</table>\n' ;;
        *.txt) printf '<pre class="scroll">' && escaped < "$1" && printf '</pre>\n' ;;
        *) printf '<a href="%s"><img src="%s" alt="%s" loading="lazy"></a>\n' "$1" "$1" "$2" ;;
      esac
    fi
    printf '<figcaption><h3>%s</h3>\n<p>%s</p>\n' "$2" "$3"
    if [ "$shown" ]; then
      printf '<pre class="command">%s</pre>\n' "$shown"
      [ -z "$seconds" ] || when=$(duration "$seconds")
      [ -z "${when-}" ] || printf '<p class="time">%s</p>\n' "$when"
      when=
    fi
    printf '</figcaption></figure>\n'
  } > "$fragment"
}

# write_page STATE: index.html from all fragments, also those of earlier runs.
write_page() {
  {
    cat <<HTML
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$page_title</title>
<style>
  body { margin: 0 auto; max-width: 76rem; padding: 1.5rem 1rem 4rem; font: 16px/1.5 system-ui, sans-serif; color: #1d2026; background: #fbfbfa; }
  h1 { font-size: 1.9rem; margin: 0 0 .3rem; }
  h2 { font-size: 1.4rem; margin: 3rem 0 .4rem; border-top: 1px solid #c9c9c4; padding-top: 1.2rem; }
  h3 { font-size: 1rem; margin: .6rem 0 .2rem; }
  .text, figcaption p { max-width: 46rem; margin: .2rem 0 .6rem; }
  nav ul { columns: 16rem; max-width: 60rem; padding-left: 1.2rem; }
  .figures { display: grid; grid-template-columns: minmax(0, 1fr); gap: 2rem 1.6rem; }
  .halves { grid-template-columns: repeat(auto-fill, minmax(min(100%, 28rem), 1fr)); }
  figure { margin: 0; min-width: 0; }
  figure img { display: block; width: 100%; height: auto; box-sizing: border-box; border: 1px solid #c9c9c4; padding: 4px; background: #fff; }
  figcaption { font-size: .93rem; color: #40454f; }
  .command { margin: 0; padding: .5rem .7rem; background: #f0f0ec; font-size: .8rem; line-height: 1.4; max-height: 9rem; overflow: auto; white-space: pre-wrap; overflow-wrap: anywhere; }
  .time { font-size: .8rem; }
  .failure { color: #a5281b; border: 1px solid #c9c9c4; padding: 1rem; }
  .scroll { overflow-x: auto; font-size: .8rem; line-height: 1.35; margin: 0; }
  table { border-collapse: collapse; font-size: .85rem; line-height: 1.35; }
  th, td { text-align: left; vertical-align: top; padding: .35rem .7rem; border-bottom: 1px solid #e6e6e2; }
  thead th { border-bottom: 1px solid #a9acb3; }
  tr.first > * { border-top: 1px solid #a9acb3; }
  td.yes { color: #1b6b3a; }
  td.no { color: #a5281b; }
</style>
</head>
<body>
<h1>$page_title</h1>
<p class="text">$page_lead</p>
HTML
    [ -z "$1" ] || printf '<p class="failure">%s</p>\n' "$1"
    echo '<nav><ul>'
    cat made/*.contents
    echo '</ul></nav>'
    for head in made/*_00.html; do
      cat "${head%00.html}"[0-9][0-9].html
      printf '</div>\n</section>\n'
    done
    printf '</body>\n</html>\n'
  } > made/index.html
  mv made/index.html index.html
}

interrupted() {
  trap - INT TERM
  echo
  echo "Stopped. $PWD/index.html shows the pictures made so far; the same command makes the rest."
  exit 130
}

gallery() {
  mkdir -p "$1/made"
  cd "$1" || return 1
  page_programs=$2 page_title=$4 page_lead=$5
  trap interrupted INT TERM
  written='' failed='' failure='' count=0 total=0
  without_renderer=''
  "$page_programs/petzval" help render > made/output.txt 2>&1 || without_renderer=yes
  begin_of_all=$(date +%s)
  for counting in yes ''; do
    made=0 section=0
    "$3"
  done
  for fragment in made/*.html made/*.contents; do  # of earlier runs
    case "$written " in
      *" $fragment "*) ;;
      *) rm -f "$fragment" ;;
    esac
  done
  write_page ''
  echo "Done in $(duration $(($(date +%s) - begin_of_all))); all pictures together take $(duration $total)."
  echo "Open $PWD/index.html"
  [ -z "$failed" ] || { echo "Not made:$failed" >&2; return 1; }
}
