"""The report: complete, safe, the same each time, and it opens without a network."""

import base64
import dataclasses
import re
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser
from urllib.parse import parse_qsl, urlsplit

import nbformat
import pytest
from entries import claim

from gearmesh.data import paths
from gearmesh.data.paths import Places
from gearmesh.data.writing import write_text
from gearmesh.identification import layout
from gearmesh.report import page as report
from gearmesh.report import why
from gearmesh.report.explorer import views
from gearmesh.report.explorer.controls import CONTROLS
from gearmesh.report.notebook_page import notebook_page
from gearmesh.report.presentation import claims_table, typeset
from gearmesh.reproduction.claims import Evidence, load_ledger, write_entries
from gearmesh.reproduction.claims.checking import check_figure
from gearmesh.reproduction.equations import EQUATIONS

PLACES = Places("smoke")


def embedded(svg: str) -> str:
    """Return a picture as the page holds it."""
    return f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"


class Page(HTMLParser):
    """Links, ids and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.links: list[str] = []
        self.ids: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            if name in ("href", "src", "srcset", "data", "action", "poster"):
                self.links.append(value)
            if name == "id":
                self.ids.append(value)

    def handle_data(self, data):
        self.text += data

    @property
    def words(self) -> str:
        return " ".join(self.text.split())


@pytest.fixture(scope="module")
def entries(root, study):
    """Return the whole ledger, with what the printed numbers give; the rest is not testable."""
    ledger = load_ledger(root / paths.CLAIMS)
    evidence = Evidence(pair=study.pair)
    figures = ("printed", *paths.NOTEBOOK_NAMES)
    return [entry for figure in figures for entry in check_figure(figure, evidence, ledger)]


@pytest.fixture(scope="module")
def built(root, small_run, small_study, entries):
    """Write the report of the smoke study, with stand-ins for its figures and notebooks.

    What lies behind the curves is left out: `tests/workflow` has the report of a whole run.
    """
    write_entries(small_run / PLACES.ledger, entries)
    for folder in ("workflow", "config", "docs"):
        (small_run / folder).symlink_to(root / folder)
    for name in paths.NOTEBOOK_NAMES:
        executed = small_run / PLACES.executed_notebook(name)
        executed.parent.mkdir(exist_ok=True)
        nbformat.write(executed_notebook(name), executed)
    drawn = [PLACES.figure_files(name)[1] for name in paths.FIGURE_NAMES]
    drawn += [path.with_suffix(".svg") for path in layout.reported(PLACES).values()]
    for file in drawn:
        (small_run / file).parent.mkdir(exist_ok=True)
        (small_run / file).write_text(f"<svg>{file.stem}</svg>")
    (small_run / PLACES.explorer).touch()
    plan = small_study.plan.model_copy(update={"mechanisms": None})
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(small_run)
        report.write_report(dataclasses.replace(small_study, plan=plan), PLACES)
        for name in paths.NOTEBOOK_NAMES:
            page = notebook_page(PLACES.executed_notebook(name))
            write_text(PLACES.notebook_page(name), page)
    return small_run


def executed_notebook(name: str):
    output = nbformat.v4.new_output(
        "execute_result", {"text/html": claims_table([claim(figure=name)])}, execution_count=1
    )
    cells = [
        nbformat.v4.new_markdown_cell(f"# {name}\n\nThe tuning ν<sub>s</sub>."),
        nbformat.v4.new_code_cell("1 < 2", outputs=[output], execution_count=1),
    ]
    return nbformat.v4.new_notebook(cells=cells)


@pytest.fixture(scope="module")
def pages(built):
    files = [PLACES.report, *map(PLACES.notebook_page, paths.NOTEBOOK_NAMES)]
    return {file: (built / file).read_text(encoding="utf-8") for file in files}


@pytest.fixture(scope="module")
def page(pages):
    return Page(pages[PLACES.report])


def test_nothing_is_loaded_from_a_network_and_nothing_runs(pages):
    for text in pages.values():
        parsed = Page(text)
        assert not {"script", "iframe", "object", "embed", "base"} & set(parsed.tags)
        assert not [link for link in parsed.links if urlsplit(link).scheme not in ("", "data")]
        assert not [link for link in parsed.links if link.startswith("//")]
        assert not re.search(r"@import|url\(", text)
        assert not re.search(r"\son\w+=", text)


def test_every_link_leads_to_something(pages, built):
    targets = {(built / file).resolve(): Page(text) for file, text in pages.items()}
    for file, parsed in targets.items():
        for link in parsed.links:
            place = urlsplit(link)
            if place.scheme == "data":
                continue
            target = (file.parent / place.path).resolve() if place.path else file
            assert target.is_file(), link
            if place.fragment and target in targets:
                assert place.fragment in targets[target].ids


def test_links_with_the_same_words_lead_to_the_same_place(pages):
    for text in pages.values():
        places = {}
        for target, words in re.findall(r'<a href="([^"]*)"[^>]*>(.*?)</a>', text):
            places.setdefault(words, set()).add(target)
        assert {words: targets for words, targets in places.items() if len(targets) > 1} == {}


def test_every_claim_is_quoted_and_every_view_has_its_claim(page, entries):
    assert all(entry.quote for entry in entries)
    assert page.tags.count("q") == len(entries)
    assert {*views.CLAIMS} <= {entry.id for entry in entries}
    assert {*views.FIGURES} == {*paths.NOTEBOOK_NAMES, *why.TITLES}


def test_views_lead_to_what_the_explorer_has(small_study):
    names = {variant.name for variant, _ in small_study.plan.frequencies()}
    known = {"variant", "nu", "beside", "periods", *(control.name for control in CONTROLS)}
    stops = [stop.view for stop in views.TOUR]
    for view in (*stops, *views.FIGURES.values(), *views.CLAIMS.values()):
        given = dict(parse_qsl(view))
        assert given.keys() <= known
        assert {given["variant"], given.get("beside", given["variant"])} <= names


def test_every_table_has_a_caption_and_headings(pages):
    for text in pages.values():
        for table in re.findall(r"<table.*?</table>", text, re.DOTALL):
            assert "<caption>" in table
            assert '<th scope="' in table


def test_no_two_places_share_an_id(page):
    assert len(page.ids) == len(set(page.ids))


def test_every_claim_is_in_the_ledger_table(page, entries):
    assert [name for name in page.ids if re.fullmatch(r"[A-Z]\d+(\.\d+[a-z]?)?", name)] == [
        entry.id for entry in entries
    ]
    for entry in entries:
        assert " ".join(Page(str(typeset(entry.statement))).words.split()) in page.words


def test_the_summary_counts_the_claims(page, entries):
    for status, label in (
        ("reproduced", "claims reproduced"),
        ("deviates", "claims? deviates?"),
        ("not_testable", "not testable"),
    ):
        count = sum(entry.status == status for entry in entries)
        assert re.search(rf"\b{count} ?{label}", page.words)


def test_every_figure_has_its_caption_and_its_notebook(page, root):
    for name in paths.FIGURE_NAMES:
        caption = (root / paths.CAPTIONS / f"{name}.rst").read_text(encoding="utf-8")
        assert Page(str(typeset(" ".join(caption.split())))).words in page.words
        assert embedded(f"<svg>{name}</svg>") in page.links
    for name in paths.NOTEBOOK_NAMES:
        assert f"notebooks/{name}.html" in page.links


def test_every_parameter_stands_with_its_description_and_reason(page, small_study):
    for parameter in small_study.pair.parameters:
        if parameter.value is None:  # left open
            continue
        for text in (parameter.description, parameter.reason):
            assert Page(str(typeset(text))).words in page.words


def test_what_a_study_states_itself_is_not_called_printed_or_assumed(small_run, small_study):
    resonance = report.open_dataset(small_run / PLACES.resonance)
    assert "Stated by this study" not in render(small_study, [], resonance)
    own = dataclasses.replace(small_study, pair=small_study.pair.replace(teeth=24, module="2 mm"))
    text = render(own, [], resonance)
    start = text.index("Stated by this study")
    listed = text[start : text.index("<h3>", start)]
    assert re.findall(r"<code>(\w+)</code>", listed) == ["teeth", "module"]
    assert "Stated by this study" not in text[:start]
    assert text.count("<code>teeth</code>") == text.count("<code>module</code>") == 1


def test_a_claim_whose_threshold_is_not_located_names_the_failed_run(small_run, small_study):
    detail = "not located: first_jump of c-lubricant: the run of c-lubricant at nu_s = 0.65"
    entry = claim(status="not_testable", measured=None, detail=detail)
    text = render(small_study, [entry], report.open_dataset(small_run / PLACES.resonance))
    summary = Page(text[: text.index('id="claims"')]).words
    assert Page(str(typeset(detail))).words in summary
    assert "unexpected status" in text


def test_the_numbers_of_the_study_are_on_the_page(page, small_study):
    assert "400\u202f000 N/mm" in page.text
    assert "328\u202f954 N/mm" in page.text
    assert small_study.pair.digest() in page.text
    cases = small_study.cases
    assert (
        f"{len(cases)}, of which {sum(c.time_course for c in cases)} with time cours" in page.text
    )


def test_failed_and_sensitive_cases_are_told(small_run, small_study, entries):
    resonance = report.open_dataset(small_run / PLACES.resonance)
    assert f"{int((resonance['status'] == 0).sum())} ok<" in render(small_study, entries, resonance)
    here = {"variant": "c-material", "nu": 0.9}
    resonance["status"].loc[here] = 1
    resonance["sensitive"].loc[{"variant": "d-both"}] = 1
    page = Page(render(small_study, entries, resonance))
    assert "1 step limit" in page.text
    total = int((resonance["status"].sel(variant="d-both") == 0).sum())
    assert f"d-both{total}{total}–" in page.words


def render(study, entries, resonance) -> str:
    captions = {"fig1": "A drawing.", "fig2": "A course."}
    return report.render(study, entries, resonance, captions, dict.fromkeys(captions, "data:,"))


def test_the_same_results_give_the_same_page(small_run, small_study, entries):
    resonance = report.open_dataset(small_run / PLACES.resonance)
    assert render(small_study, entries, resonance) == render(small_study, entries, resonance)


def test_text_of_the_ledger_cannot_become_markup(small_run, small_study):
    evil = claim(statement="<script>alert(1)</script>", measured={"<b>": 1.0}, detail="<i>")
    text = render(small_study, [evil], report.open_dataset(small_run / PLACES.resonance))
    for piece in (text, claims_table([evil])):
        assert not {"script", "b", "i"} & set(Page(piece).tags) - {"b"}
        assert "<script>" not in piece
        assert "&lt;b&gt;" in piece


def test_what_is_unexpected_is_said(small_run, small_study):
    resonance = report.open_dataset(small_run / PLACES.resonance)
    surprise = claim(status="deviates", measured=0.7)
    assert "unexpected status" in render(small_study, [surprise], resonance)
    assert "unexpected status" not in render(small_study, [claim()], resonance)


def test_all_seven_equations_are_mathml():
    assert [equation.number for equation in EQUATIONS] == list(range(1, 8))
    for equation in EQUATIONS:
        for line in equation.mathml:
            tree = ElementTree.fromstring(line)
            assert tree.tag.endswith("math")
            assert "\\" not in "".join(tree.itertext())


def test_captions_are_plain_text(root):
    for file in set((root / paths.CAPTIONS).glob("*.rst")) - {root / paths.CAPTIONS / "figure.rst"}:
        text = file.read_text(encoding="utf-8")
        assert not re.search(r"[*`|<>\\]|\.\. |::", text), file.name
        assert text.endswith(".\n")
