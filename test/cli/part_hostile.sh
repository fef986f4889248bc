# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Names that would break out of what they are written into: 200 columns through every writer, a file's name through messages.

if ! command -v python3 >/dev/null; then
   echo "skipped: there is no python3"
   return
fi
python3 - <<'END'
import random
pieces = ["=1+1", "+x", "-c", "@d", "'", "''", '"', '""', "`id`", "$(id)", "<script>alert(1)</script>", "</title>", "</svg>", "<!--", "-->", "]]>",
          "&amp", "&#0", "&", "\x1b[31m", "\x07", "\x7f", "\\", "\\n", "%s%n", "{", "}", "{{7*7}}", "$x_1^2$", "\\input{a}", "#", "~", "a:b",
          "- a", "!!python/object", "|", ">", "*", "[x]", "null", "nan", "1e400", "../../x", "/etc/passwd", "\u202e", "\ufeff", "\u00e9",
          "\u4e2d", " lead", "tail ", "javascript:alert(1)", "onload=x", "x" * 300]
random.seed(1)
names = ["gyro " + piece for piece in pieces]
while len(names) < 200:
    names.append("".join(random.sample([piece for piece in pieces if not set(piece) & set("'\"")], random.randint(1, 3))))
with open("hostile.csv", "w", newline="", encoding="utf-8") as f:
    print("time [s]", *[f"{name} {i} [deg/s]" for i, name in enumerate(names)], sep=",", file=f)
    for i in range(60):
        print(f"{i*0.01:.2f}", *[f"{random.gauss(0, 1):.4f}" for _ in names], sep=",", file=f)
END
good "200 hostile names" allan hostile.csv --out hostile --json hostile.json --unit deg/s --quiet
good "some of them, and all tables" run hostile.csv --column 2,3,4,5,6 --out hostile/run --quiet
"$gyroakf" allan hostile.csv --details >hostile.txt 2>&1
if python3 - <<'END'
import csv, glob, html.parser, json, re, xml.dom.minidom
count = 0
def clean(text, path):
    bad = re.search("[\x00-\x08\x0b-\x1f\x7f]", text)
    assert not bad, (path, text[max(bad.start() - 40, 0):bad.end() + 40])
channels = json.load(open("hostile.json", encoding="utf-8"))["channels"]
assert len(channels) == 200 and len({c["name"] for c in channels}) == 200
for path in glob.glob("hostile/**/*.csv", recursive=True):
    rows = list(csv.reader(open(path, encoding="utf-8", newline="")))
    assert len({len(row) for row in rows}) == 1, path
    for row in rows:
        for cell in row:
            assert cell[:1] not in ("=", "+", "@") and not re.match("-[^0-9nN]", cell), (path, cell)
    count += 1
for path in glob.glob("hostile/**/*.svg", recursive=True):
    document = xml.dom.minidom.parse(path)
    tags = {e.tagName for e in document.getElementsByTagName("*")}
    assert "script" not in tags, path
    count += 1
class Page(html.parser.HTMLParser):
    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            assert not name.startswith("on") and "javascript:" not in (value or ""), (tag, attributes)
        self.scripts = getattr(self, "scripts", 0) + (tag == "script")
page = Page()
text = open("hostile/report.html", encoding="utf-8").read()
page.feed(text)
assert page.scripts == 1, page.scripts
for path in ["hostile/report.html", "hostile/report.txt", "hostile.txt"]:
    clean(open(path, encoding="utf-8").read(), path)
assert count > 12
END
then pass; else fail "names get out of what they are written into"; fi
name=$'h\033[31m`id`$(id).txt'
cp hostile.csv "$name"
run inspect "$name"
is "a name that colors" "$(LC_ALL=C grep -c $'\033' out)" 0
for arguments in "--column 999" "--rate nan" "--json missing/x.json"; do
   # shellcheck disable=SC2086
   run allan "$name" $arguments
   is "no escape in the message for $arguments" "$(LC_ALL=C grep -c $'\033' err)" 0
done
run allan "no$name" hostile.csv --column 2
is "nor of many files" "$(cat out err | LC_ALL=C grep -c $'\033')" 0

# a result over the recording, by another way
cp hostile.csv first.csv && ln first.csv second.csv && ln -s first.csv third.csv
for other in second.csv third.csv "$PWD/first.csv"; do
   bad "over the recording as $other" 1 "--json would overwrite the recording" allan first.csv --column 2 --json "$other" --force
done
"$gyroakf" allan - --column 2 --json first.csv --force <first.csv >out 2>err
is "over the recording on standard input" "$?" 1
is "it is there" "$(cksum <first.csv)" "$(cksum <hostile.csv)"
bad "two results in one file" 1 "--json and --out name the same file" run first.csv --out hostile --json hostile/results.json
