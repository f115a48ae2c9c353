"""The page of `tachk report`."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import zlib
from base64 import b64decode, b64encode
from collections.abc import Iterator
from fractions import Fraction
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import tachk
from tachk.cli.main import app
from tachk.report.page.results import chapter_of, read_result
from tachk.report.statistics.text import interval_text

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
FISCHER = str(ROOT / "models/classics/fischer.ta")
BRIDGE = """
process P() {
    state Left, Right;
    init Left;
    trans Left -> Right { guard x > 2 && n < 9; assign n = n + 1; }, Right -> Left { assign n = n + 1, x = 0; };
}
clock x; int[0, 100] n;
system P;
property seen "over </script><script>alert(1)</script>" : E<> n == 3 expect holds;
property never : A[] n < 3 expect fails;
"""
EMPTY = {"meta", "link", "br", "img", "input", "circle", "line", "rect", "polyline", "polygon", "path"}


class Checked(HTMLParser):
    """Reads a page: every element is closed, and where it leads to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.addresses: list[str] = []
        self.ids: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.addresses += [value for name in ("src", "href") if (value := given.get(name))]
        self.ids += [value for name in ("id",) if (value := given.get(name))]
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open.pop() == tag


def page(tmp_path: Path, *arguments: str, status: int = 0) -> str:
    output = tmp_path / "report.html"
    result = CliRunner().invoke(app, ["report", *arguments, "-o", str(output)])
    assert result.exit_code == status, result.output
    return output.read_text(encoding="utf-8")


@pytest.fixture
def bridge(tmp_path: Path) -> str:
    path = tmp_path / "bridge.ta"
    path.write_text(BRIDGE, encoding="utf-8")
    return str(path)


def test_needs_nothing_else(tmp_path: Path) -> None:
    """It is well-formed, and everything it shows is in it."""
    checked = Checked(page(tmp_path, FISCHER, "-D", "N=3"))
    assert not checked.open
    assert len(set(checked.ids)) == len(checked.ids)
    inside = ("#", "data:image/svg+xml;base64,")
    assert all(address.startswith(inside) for address in checked.addresses)
    assert {f"#{name}" for name in checked.ids} >= {each for each in checked.addresses if each.startswith("#")}


def test_text_of_the_model_is_text(tmp_path: Path, bridge: str) -> None:
    text = page(tmp_path, bridge)
    assert "<script>alert" not in text
    assert "&lt;script&gt;alert" in text


def test_playback_is_the_run(tmp_path: Path, bridge: str) -> None:
    run = playback_on(page(tmp_path, bridge))
    verdict = tachk.load(bridge).verify(property="seen")["seen"]
    assert verdict.trace is not None
    assert run["variables"]["n"] == [[0, "0"], [1, "1"], [2, "2"], [3, "3"]]
    assert run["locations"]["P"] == [[0, "Left"], [1, "Right"], [2, "Left"], [3, "Right"]]
    on, back = ["P", "Left Right 0"], ["P", "Right Left 0"]
    assert run["moved"] == [[], [on], [back], [on]]
    assert [Fraction(time) for time in run["times"]] == [state.time for state in verdict.trace.states]


@pytest.mark.parametrize(
    ("arguments", "status"), [(["--max-states", "1"], 20), (["A[] n < 2"], 10), (["A[] n <= 100"], 0), (["n <"], 2)]
)
def test_status(tmp_path: Path, bridge: str, arguments: list[str], status: int) -> None:
    result = CliRunner().invoke(app, ["report", bridge, *arguments, "-o", str(tmp_path / "report.html")])
    assert result.exit_code == status


def test_added_pictures(tmp_path: Path, bridge: str) -> None:
    picture = tmp_path / "map.svg"
    picture.write_text('<svg xmlns="http://www.w3.org/2000/svg"/>', encoding="utf-8")
    assert "<figcaption>map.svg</figcaption>" in page(tmp_path, bridge, str(picture))

    page(tmp_path, bridge, str(tmp_path / "none.svg"), status=2)


def output_of(path: Path, *arguments: str) -> str:
    """A result in a file."""
    path.write_text(CliRunner().invoke(app, [*arguments, "--format", "json"]).stdout, encoding="utf-8")
    return str(path)


def playback_on(text: str) -> dict[str, Any]:
    """The first run of a page, as its script gets it."""
    packed = re.findall(r'class="run">(.*?)</script>', text)[0]
    return json.loads(zlib.decompress(b64decode(packed)))


def test_a_long_run_is_a_small_page(tmp_path: Path) -> None:
    """What stays as it is takes no room: a state by itself would name a hundred variables."""
    path = tmp_path / "long.ta"
    still = " ".join(f"int still{number} = {number};" for number in range(100))
    path.write_text(
        f"int[0, 2000] n; {still} process P() {{ init location A {{ to A {{ guard n < 2000; assign n = n + 1; }} }} }}"
        " system P; property seen : E<> n == 2000;",
        encoding="utf-8",
    )
    text = page(tmp_path, str(path))
    run = playback_on(text)
    assert run["variables"]["n"][-1] == [2000, "2000"]
    assert run["variables"]["still7"] == [[0, "7"]]
    assert len(text) < 150_000


def answers_of(text: str) -> list[str]:
    """Everything on a page that depends on the answers, up to the run in words, and without measured times."""
    shown = re.sub(r"<details.*?</details>|\d+\.\d (ms|s)\b", "", text[text.index("<main>") :], flags=re.DOTALL)
    return shown[: shown.index("<h2>To repeat it")].split("\n")


def test_results_say_what_the_model_says(tmp_path: Path, bridge: str) -> None:
    answers = output_of(tmp_path / "answers.json", "verify", bridge, "--trace", "some")
    assert answers_of(page(tmp_path, answers)) == answers_of(page(tmp_path, bridge))


def test_the_edge_that_was_taken_of_two_between_the_same_locations(tmp_path: Path) -> None:
    path = tmp_path / "two.ta"
    path.write_text(
        "int[0, 3] n; process P() { init location A { to A { guard n < 2; assign n = n + 1; }"
        " to A { guard n == 2; assign n = 3; } } } system P; property seen : E<> n == 3;",
        encoding="utf-8",
    )
    result = output_of(tmp_path / "two.json", "verify", str(path), "--trace", "some")
    for source in (str(path), result):
        run = playback_on(page(tmp_path, source))
        assert run["moved"] == [[], *([["P", f"A A {n}"]] for n in (0, 0, 1))]


def test_automata_of_another_text_are_not_drawn(tmp_path: Path, bridge: str) -> None:
    answers = output_of(tmp_path / "answers.json", "verify", bridge, "--trace", "some")
    assert f'data-template="{bridge}/P"' in page(tmp_path, answers)
    Path(bridge).write_text("\n" + BRIDGE, encoding="utf-8")
    changed = page(tmp_path, answers)
    assert "has changed since" in changed
    assert f'data-template="{bridge}/P"' not in changed
    Path(bridge).unlink()
    assert "there is no file" in page(tmp_path, answers)


def test_other_results_are_chapters(tmp_path: Path, bridge: str) -> None:
    sweep = output_of(tmp_path / "sweep.json", "sweep", FISCHER, "-D", "N=2", "-D", "WRITE=1,2", "-j", "1")
    drawn = ["simulate", bridge, "--runs", "5", "--until", "9", "--monitor", "G n < 9", "--seed", "1"]
    runs = output_of(tmp_path / "runs.json", *drawn)
    (tmp_path / "log.csv").write_text("time,n\n0,1\n5,11\n6,1\n", encoding="utf-8")
    log = output_of(tmp_path / "log.json", "monitor", "G n < 9", str(tmp_path / "log.csv"))
    (tmp_path / "said.md").write_text("## What we did\n\n<b>Nothing</b> | *new*.\n", encoding="utf-8")
    text = page(tmp_path, sweep, str(tmp_path / "said.md"), bridge, runs, log)
    assert not Checked(text).open
    assert "&lt;b&gt;Nothing&lt;/b&gt; | <em>new</em>." in text
    places = [
        text.index(words) for words in ("many values</h2>", "What we did</h2>", "<h2>Answers</h2>", "simulation</h2>")
    ]
    assert places == sorted(places), "everything stands where it is named"
    for words in (
        "fischer.ta: many values",
        "2 combinations",
        "5 runs until 9",
        "<td>G (n &lt; 9)</td>",
        "seed 1",
        "why it is false",
    ):
        assert words in text
    assert "data:image/svg+xml" in text[text.index("many values") :]


def test_estimates_and_sweeps_of_them(tmp_path: Path) -> None:
    path = tmp_path / "coin.ta"
    path.write_text(
        "const int WEIGHT = 1; process P() { init location A { invariant t <= 1; to b { guard t == 1; } } location Won;"
        " location Lost; branchpoint b { to Won { probability WEIGHT; } to Lost { probability 1; } } }"
        " clock t; system P; property won: Pr[<=2](<> P.Won); property safe: A[] true;",
        encoding="utf-8",
    )
    estimate = output_of(tmp_path / "estimate.json", "estimate", str(path), "--runs", "100", "--seed", "1")
    sweep = output_of(tmp_path / "sweep.json", "sweep", str(path), "-D", "WEIGHT=1,9", "-j", "1")
    answer = json.loads(Path(estimate).read_text(encoding="utf-8"))["answers"][0]
    text = page(tmp_path, estimate, sweep)
    assert interval_text(answer["low"], answer["high"]) in text
    assert text.count("data:image/svg+xml") == 2, "a map of answers and one of estimates"
    assert "won: estimated in 2." in text


def nullable(value: Any, schema: Any, whole: Any) -> Iterator[tuple[Any, Any]]:
    """Where a schema allows null in a value: what holds it, and its key there."""
    if "$ref" in schema:
        schema = whole["$defs"][schema["$ref"].rsplit("/", 1)[1]]
    if "oneOf" in schema:
        for each in schema["oneOf"]:
            yield from nullable(value, each, whole)
        return
    kind = schema.get("properties", {}).get("kind", {}).get("const")
    inside: list[tuple[Any, Any]] = []
    if isinstance(value, dict) and kind in (None, value.get("kind")):
        inside = [(key, each) for key, each in schema.get("properties", {}).items() if key in value]
    elif isinstance(value, list) and "items" in schema:
        inside = [(key, schema["items"]) for key in range(len(value))]
    for key, each in inside:
        if "null" in each.get("type", ()) or {"type": "null"} in each.get("oneOf", ()):
            yield value, key
        yield from nullable(value[key], each, whole)


def _kind_of(holder: Any, key: Any) -> tuple[Any, ...]:
    """What places have in common of which one is enough: the fields of an object, or being in a list."""
    return (key, *sorted(holder)) if isinstance(holder, dict) else ("item", isinstance(holder[key], list))


def test_numbers_that_are_null(tmp_path: Path, bridge: str) -> None:
    """Each kind of value that a schema allows to be null, in turn: the page is written."""
    asked = ["E[<=5; 20](max: n)", "Pr[<=5](<> n > 3)", "simulate [<=5; 3] {n} : 1 : n > 1", "Pr[<=5](<> n > 3) >= 0.5"]
    results = {
        "estimate": output_of(tmp_path / "estimate.json", "estimate", bridge, *asked, "--runs", "20"),
        "sweep": output_of(tmp_path / "sweep.json", "sweep", FISCHER, "-D", "N=2", "-D", "WRITE=1,2", "-j", "1"),
    }
    (tmp_path / "log.csv").write_text("time,n\n0,1\n5,11\n6,1\n", encoding="utf-8")
    results["monitor"] = output_of(tmp_path / "log.json", "monitor", "G n < 9", str(tmp_path / "log.csv"))
    for report, path in results.items():
        schema = json.loads((ROOT / f"docs/schema/{report}.schema.json").read_text(encoding="utf-8"))
        document = json.loads(Path(path).read_text(encoding="utf-8"))
        alike = {_kind_of(holder, key): (holder, key) for holder, key in nullable(document, schema, schema)}
        assert alike, report
        for holder, key in alike.values():
            kept, holder[key] = holder[key], None
            Path(path).write_text(json.dumps(document), encoding="utf-8")
            chapter_of(read_result(Path(path)), Path(path))
            holder[key] = kept


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"runs": [{}]}', '{"cells": 1, "constants": 2, "rows": 3}', "\x00"])
def test_what_is_no_result(tmp_path: Path, text: str) -> None:
    (tmp_path / "wrong.json").write_text(text, encoding="utf-8")
    arguments = ["report", str(tmp_path / "wrong.json"), "-o", str(tmp_path / "report.html")]
    result = CliRunner().invoke(app, arguments)
    assert (result.exit_code, isinstance(result.exception, SystemExit)) == (2, True)
    assert "wrong.json" in result.stderr


@pytest.mark.parametrize("name", ["table.csv", "signals.parquet", "saved.run"])
def test_a_recording_is_not_read_as_a_model(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("time,x\n0,1\n", encoding="utf-8")
    result = CliRunner().invoke(app, ["report", str(tmp_path / name), "-o", str(tmp_path / "report.html")])
    assert (result.exit_code, isinstance(result.exception, SystemExit)) == (2, True)
    assert "cannot show" in result.stderr


def seen(folder: Path, name: str) -> str:
    """What a browser makes of a file."""
    command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}"]
    command += ["--virtual-time-budget=10000", "--allow-file-access-from-files"]  # until the runs are unpacked
    address = (folder / name).as_uri()
    return subprocess.run([*command, "--dump-dom", address], capture_output=True, text=True, check=True).stdout


@pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium")
def test_in_a_browser(tmp_path: Path, bridge: str) -> None:
    """The script shows the last step of each run, and lights up where the process is and which edge it took."""
    (tmp_path / "page.html").write_text(page(tmp_path, bridge), encoding="utf-8")
    shown = seen(tmp_path, "page.html")
    assert "3 of 3, time" in shown
    assert re.search(r'class="node here" data-location="Right"', shown)
    assert re.search(r'class="edge taken" data-edge="Left Right 0"', shown)
    assert not re.search(r'class="node here" data-location="Left"', shown)


def test_the_text_of_the_model_is_on_the_page_with_its_properties_marked(tmp_path: Path, bridge: str) -> None:
    text = page(tmp_path, bridge)
    assert '<span class="line"><i>3</i>    state Left, Right;</span>' in text
    assert re.search(r'<span class="line holds" id="0-seen-line"><i>9</i>.*<a href="#0-seen">✓ holds</a></span>', text)
    assert re.search(r'<span class="line fails" id="0-never-line"><i>10</i>', text)
    assert '<a href="#0-seen-line">' in text


def test_the_text_of_a_model_with_several_results_is_there_once(tmp_path: Path, bridge: str) -> None:
    results = [output_of(tmp_path / f"{name}.json", "verify", bridge, "--property", name) for name in ("seen", "never")]
    text = page(tmp_path, *results)
    assert text.count('<details class="source">') == 1
    checked = Checked(text)
    assert {f"#{name}" for name in checked.ids} >= {each for each in checked.addresses if each.startswith("#")}


def test_imported_files_are_on_the_page_too(tmp_path: Path) -> None:
    (tmp_path / "rules.ta").write_text("property stays : A[] P.A;\n", encoding="utf-8")
    (tmp_path / "main.ta").write_text(
        'import "rules.ta";\nprocess P() { init location A; }\nsystem P;\n', encoding="utf-8"
    )
    text = page(tmp_path, str(tmp_path / "main.ta"))
    assert text.count('<details class="source">') == 2
    assert '<span class="line holds" id="0-stays-line"><i>1</i>property stays' in text


def test_values_of_clocks_have_their_unit(tmp_path: Path) -> None:
    path = tmp_path / "waits.ta"
    path.write_text(
        "time_unit = 1 ms; clock x; int[0, 7] n = 7; process P() { init location A { invariant x <= 5; } } system P;"
        " property longest : sup: x, n;",
        encoding="utf-8",
    )
    for source in (str(path), output_of(tmp_path / "waits.json", "verify", str(path))):
        text = page(tmp_path, source)
        assert "x ≤ 5 ms; n ≤ 7" in text


def test_what_was_written_is_printed(tmp_path: Path, bridge: str) -> None:
    output = tmp_path / "report.html"
    assert CliRunner().invoke(app, ["report", bridge, "-o", str(output)]).stdout == f"written: {output}\n"


@pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium")
def test_arrow_keys_step_from_anywhere_and_instances_have_titles(tmp_path: Path) -> None:
    """In one browser: the key is pressed on the page, not on the player; and no table is wider than a telephone."""
    text = page(tmp_path, FISCHER, "-D", "N=2", "-D", "WAIT=9", "--property", "mutual_exclusion")
    (tmp_path / "page.html").write_text(text, encoding="utf-8")
    (tmp_path / "outer.html").write_text(
        """<iframe src="page.html" style="width:360px;height:600px"></iframe><p id="told"></p><script>
        const frame = document.querySelector("iframe");
        const inner = () => frame.contentDocument;
        const poll = setInterval(() => {
          if (!inner().querySelector(".now")) return;
          clearInterval(poll);
          inner().body.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true, composed: true }));
          const titles = [...inner().querySelectorAll(".stage figcaption")].map((one) => one.textContent).join(", ");
          const wide = [...inner().querySelectorAll("table")].filter((one) => one.getBoundingClientRect().right > 360);
          const now = inner().querySelector(".now").textContent;
          document.getElementById("told").textContent = `${now} | ${titles} | ${wide.length} wide`;
        }, 50);
        </script>""",
        encoding="utf-8",
    )
    told = re.search(r'id="told">(.*?)</p>', seen(tmp_path, "outer.html"))
    assert told is not None
    now, titles, wide = told[1].split(" | ")
    assert now.startswith("5 of 6")
    assert titles == "P(1) in waiting, P(2) in critical"
    assert wide == "0 wide"


@pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium")
def test_widget_in_a_browser(tmp_path: Path, bridge: str) -> None:
    """What a notebook does with the widget: it calls render of its module with the model and an element."""
    widget = tachk.load(bridge).verify(property="seen").widget()
    content = json.dumps(widget.content).replace("</", "<\\/")
    module = b64encode(widget._esm.encode()).decode()
    (tmp_path / "notebook.html").write_text(
        f"""<div id="cell"></div><p id="told"></p><script type="module">
        import widget from "data:text/javascript;base64,{module}";
        const el = document.getElementById("cell");
        await widget.render({{ model: {{ get: () => {content} }}, el }});
        const shown = (name) => el.shadowRoot.querySelectorAll(name).length;
        const now = el.shadowRoot.querySelector(".now").textContent;
        document.getElementById("told").textContent = `${{now}}, ${{shown(".here")}} here, ${{shown(".taken")}} taken`;
        </script>""",
        encoding="utf-8",
    )
    assert "P goes from Left to Right, 1 here, 1 taken" in seen(tmp_path, "notebook.html")
